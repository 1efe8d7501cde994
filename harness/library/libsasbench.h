/* sasbench as a library: scenes, echoes, images and their errors, as the program makes them, to the bit. C11 and C++11.

       struct sasbench *context;
       struct sasbench_scene *scene;
       if (sasbench_open(0, NULL, &context) != SAS_OK || sasbench_scene_load(context, "study/quick", &scene) != SAS_OK)
           puts(sasbench_message());

   - Status: functions that return int return SAS_OK or another enum sas_status of sasbench.h. The reason is then
     sasbench_message(). Nothing is printed, no process is started, the program is never ended; but a damaged MATLAB
     file may crash libmatio, which the program `sasbench info FILE` stands.
   - Units: m, s, Hz, rad. x runs along the track, r across it. Complex numbers are pairs of reals, real part first,
     float[2] or double[2] by an enum sas_precision. Arrays are dense, the last index side by side.
   - Ownership: what a function makes in its last argument is the caller's, released by the function named with it. A
     context outlives its scenes, a scene its plans. Arrays are read or written during the call only.
   - Threads: all functions may be called by several threads at once. Images by different plans are formed side by side;
     one plan forms one image at a time, delays wait for nothing, and everything else takes turns. An algorithm of the
     caller's that is measured may call all but score and run, in threads of its own sasbench_delays alone. A program
     that plans with FFTW itself in another thread calls fftw_make_planner_thread_safe first. */
#ifndef LIBSASBENCH_H
#define LIBSASBENCH_H

#include "sasbench.h"

#ifdef __cplusplus
extern "C" {
#endif

struct sasbench;
struct sasbench_scene;
struct sasbench_plan;
struct sasbench_table;

/* "1.0.0": a static text. */
const char *sasbench_version(void);
/* The calling thread's last error, one line; valid until its next one. */
const char *sasbench_message(void);
/* From now on SIGINT ends the calls of all threads that form images or simulate echoes, while the calling thread is in
   one: they fail with "interrupted". The process's own handler is called as well, unless it ignores the signal or is
   ended by it. For one thread of a process, as Python's main thread. */
void sasbench_interruptible(void);

/* `threads` of OpenMP for each call, 1 to 1024; 0: as many as OpenMP takes by itself. `scenes`: the folder of shipped
   scenes; NULL: the one that was installed with the library, or the source's. Errors: SAS_INVALID, SAS_FAILED. */
int sasbench_open(int threads, const char *scenes, struct sasbench **context);
void sasbench_close(struct sasbench *context);

/* Algorithm `index` from 0: its name, and its summary and reference, a line each (each may be NULL); static texts. NULL
   behind the last one. */
const char *sasbench_algorithm(int index, const char **summary, const char **reference);
/* Setting `setting` of it, from 0. Returns 0 behind the last one. */
int sasbench_setting(int index, int setting, struct sas_setting *out);

/* A scene by the path of its .cfg file, or by the name of a shipped one. Errors: SAS_INVALID naming file, line, key,
   value and what is accepted. */
int sasbench_scene_load(struct sasbench *context, const char *name, struct sasbench_scene **scene);
/* The echoes of a MATLAB file; the image is `grid`, or where it is NULL the file's own. Errors: SAS_INVALID naming
   file, variable, value and what is accepted. */
int sasbench_scene_read(struct sasbench *context, const char *path, const struct sas_grid *grid,
                        struct sasbench_scene **scene);
/* A scene of arrays, copied. `samples`: the echoes, double [pings][receivers][samples][2]; NULL: they are simulated, of
   `points` [point_count][4], x, r, and the amplitude's real and imaginary part, seen from everywhere alike; without
   points as well only plans, whose samples are the caller's, and delays are made. With samples the points are those
   that are measured. Errors: SAS_INVALID naming number, value and what is accepted. */
struct sasbench_arrays {
    uint32_t size;    /* sizeof(struct sasbench_arrays) */
    const char *name; /* of rows and messages */
    const struct sas_acquisition *acquisition;
    int32_t patch_count, point_count; /* >= 1, >= 0 */
    const struct sas_grid *patches;   /* [patch_count] the image */
    const double *points;
    const double *samples;
};
int sasbench_scene_make(struct sasbench *context, const struct sasbench_arrays *arrays, struct sasbench_scene **scene);
/* The scene as arrays, which belong to it, but for the samples (NULL). */
const struct sasbench_arrays *sasbench_scene_arrays(const struct sasbench_scene *scene);
/* Without any of its plans. NULL does nothing. */
void sasbench_scene_free(struct sasbench_scene *scene);

/* The scene's echoes, recorded or simulated, into [pings][receivers][samples]. Errors: SAS_INVALID where one does not
   fit the precision, or of a scene without samples and points; SAS_FAILED without memory. */
int sasbench_echoes(struct sasbench_scene *scene, int precision, void *samples);
/* The echoes of a reflectivity pixels[patch][row][column], double, into [pings][receivers][samples], double: those that
   the simulator makes of a point of this amplitude at each pixel, under the scene's beam, without noise. It is linear;
   the cost is pixels times echoes. Errors: SAS_INVALID for numbers that are not finite or too extreme; SAS_FAILED. */
int sasbench_forward(struct sasbench_scene *scene, const void *const *pixels, void *samples);
/* Its exact adjoint, double: each pixel sums all echoes times the conjugate of what a unit amplitude there adds.
   Errors: the same. */
int sasbench_adjoint(struct sasbench_scene *scene, const void *samples, void *const *pixels);
/* The exact delays, s, of points [count][3], x, y, z, into [pings][receivers][count]. Errors: SAS_INVALID for points
   that are not finite. */
int sasbench_delays(const struct sasbench_scene *scene, size_t count, const double *points, double *delays);

/* Plan the scene's image by a SPEC as on the command line, "bp_sinc:taps=8"; one of the program's own algorithms.
   `precision` counts where the SPEC gives none. Errors: SAS_INVALID, SAS_UNSUPPORTED with the reason, SAS_FAILED. */
int sasbench_plan(struct sasbench_scene *scene, const char *spec, int precision, struct sasbench_plan **plan);
/* The precision of its images. */
int sasbench_plan_precision(const struct sasbench_plan *plan);
/* Form the image of samples [pings][receivers][samples] of a precision, into pixels[patch][row][column] of the plan's.
   Errors: SAS_INVALID naming a sample that is not finite, or for an image that the precision cannot hold. */
int sasbench_execute(struct sasbench_plan *plan, int precision, const void *samples, void *const *pixels);
void sasbench_plan_free(struct sasbench_plan *plan);

/* Rows of measurements and of point targets, with the columns of measurements.csv and targets.csv; and what
   sasbench_compare found. */
enum sasbench_rows { SASBENCH_MEASUREMENTS, SASBENCH_TARGETS, SASBENCH_FINDINGS };
enum sasbench_type { SASBENCH_TEXT, SASBENCH_INTEGER, SASBENCH_REAL };
/* Released by sasbench_table_free. Errors: SAS_FAILED. */
int sasbench_table(struct sasbench_table **table);
void sasbench_table_free(struct sasbench_table *table);
/* Name and enum sasbench_type of column `index` from 0, a static text; NULL behind the last one. */
const char *sasbench_column(int rows, int index, int *type);
int sasbench_table_count(const struct sasbench_table *table, int rows);
/* One cell: a text that belongs to the table, "" if it is none; a number, NAN where the field is empty or a text. */
const char *sasbench_table_text(const struct sasbench_table *table, int rows, int row, int column);
double sasbench_table_number(const struct sasbench_table *table, int rows, int row, int column);

/* Measure an image [patch][row][column] of the scene against the exact one, as `sasbench score`, and add its rows.
   `name`: whose it is. `seconds` it took, NAN where unknown. Errors: SAS_INVALID, also for pixels that are not finite;
   SAS_UNSUPPORTED where there is no exact image. */
int sasbench_score(struct sasbench_scene *scene, const char *name, int precision, const void *const *pixels,
                   double seconds, struct sasbench_table *table);
/* Measure an algorithm as `sasbench run`, and add its rows; without `timed` the image is formed once, without times.
   `own` NULL: that of a SPEC, in single precision where it names none. Else `spec` is a name for `own`, in `precision`:
   its plan's pairs and FLOPs do not count, and `work` is not called. A refusal or a failure of the algorithm is a row
   as well. While it is timed nothing else should run. Errors: SAS_INVALID for the SPEC, SAS_FAILED. */
int sasbench_run(struct sasbench_scene *scene, const char *spec, int precision, const struct sas_algorithm *own,
                 int timed, struct sasbench_table *table);
/* Measure SPECs [count] over their settings as `sasbench sweep`, the exact image first, and add their rows.
   `precision`: "float" or "double" where a SPEC states none; NULL: both. `timed`: as of sasbench_run. Errors:
   SAS_INVALID for a SPEC or the precision, SAS_FAILED. */
int sasbench_sweep(struct sasbench_scene *scene, int count, const char *const *specs, const char *precision, int timed,
                   struct sasbench_table *table);
/* Compare two results folders or CSV files as `sasbench compare`, and add a row for each finding: `verdict` (worse,
   gone, changed, better, new, same), its class (quality, work, time), scene, SPEC, target, metric and unit, the values
   `before` and `after` (texts where they are no numbers), the relative `change` and the `slack` within which values
   count as the same. Errors: SAS_INVALID naming file, line, column and value; SAS_FAILED. */
int sasbench_compare(const char *before, const char *after, struct sasbench_table *table);

#ifdef __cplusplus
}
#endif

#endif
