/* The interface of an imaging algorithm: the only header that a contributor must read.

   An algorithm is one constant struct in one file, `NAME.c` defining `const struct algorithm NAME`, whose name is also
   the name on the command line. Adding NAME to the list in algorithms/meson.build adds the source, the registry entry,
   the conformance test and the benchmark.

   Rules for the callbacks
   - `plan` does all that depends on geometry and settings only: tables, FFTW plans, scratch memory. It is timed apart.
   - `execute` is the timed part. It goes from the samples in memory to the image in memory, allocates nothing, writes
     every pixel, gives the same bits for any number of threads, and may be called any number of times.
   - Neither prints, exits or keeps state outside the plan. Errors are reported with status_set.
   - Threads are OpenMP's; a plan is executed with at most the omp_get_max_threads() it was made with.
   - The acquisition and the patches outlive the plan; samples and pixels belong to the caller. */
#ifndef SASBENCH_CONTRACT_ALGORITHM_H
#define SASBENCH_CONTRACT_ALGORITHM_H

#include <stddef.h>

#include "contract/acquisition.h"
#include "contract/condition.h"
#include "contract/forecast.h"
#include "contract/status.h"

enum precision { PRECISION_FLOAT, PRECISION_DOUBLE };

/* Pixel (i, j), range row i and azimuth column j, lies at x' = x_first + j x_step, r' = r_first + i r_step, z = 0, in
   axes turned by angle_rad about the origin:  x = x' cos + r' sin,  r = -x' sin + r' cos  (SQ18's rotated image; 0: the
   track's axes). */
struct grid {
    double x_first, x_step; /* m, x_step > 0 */
    int x_count;            /* >= 1 */
    double r_first, r_step; /* m, r_step > 0; r of either sign */
    int r_count;            /* >= 1 */
    double angle_rad;       /* within +-pi/2; an algorithm refuses turned grids that it cannot image */
};

size_t grid_pixels(const struct grid *grid);
/* The place of row i and column j, which need not be whole numbers. */
struct vector grid_point(const struct grid *grid, double i, double j);
/* The inverse: (x', r', 0) of a place in the track's axes. */
struct vector grid_coordinates(const struct grid *grid, double x, double r);

struct target {
    double x, r;              /* m */
    double complex amplitude; /* 1 */
};

/* Rows and columns of a grid. */
struct pixel_window {
    int row, rows, column, columns; /* first ones, and how many, >= 1 */
};
/* The grid of a part of the pixels. Its axes begin at a pixel of the whole, rounded. */
struct grid grid_part(const struct grid *grid, const struct pixel_window *window);

/* One imaging task: all patches of the image; or a window of the only patch. Its pixels have the same bits as in the
   whole image, or differ within the error that the algorithm promises. All conditions are the whole image's. */
struct problem {
    const struct acquisition *acquisition;
    int patch_count;                   /* >= 1 */
    const struct grid *patches;        /* [patch_count] */
    enum precision precision;          /* of samples, sums and pixels; geometry and phase are always double */
    bool estimate;                     /* pairs, and what follows from them, may be counted to 2 %: nothing is imaged */
    const struct pixel_window *window; /* NULL: all; else TRAIT_WINDOW is needed, and patch_count 1 */
};
struct problem problem_make(const struct acquisition *acquisition, int patch_count, const struct grid *patches,
                            enum precision precision);
/* The window, or all of a patch. */
struct pixel_window problem_window(const struct problem *problem, int patch);

/* The recorded samples, read only. */
struct echoes {
    const struct acquisition *acquisition;
    enum precision precision;
    const void *samples; /* complex float or double [pings][receivers][samples] */
    int exponent;        /* the recording is the samples times 2^exponent, 0 unless it would not fit the precision; the
                            caller of execute multiplies the image, an algorithm ignores it */
};

/* The image: sum over pings and receivers of the compressed echo at the exact delay times exp(+j 2 pi fc tau), without
   1/N, so that a lone unit target shows the sum of its weights with phase 0. */
struct image {
    int patch_count;
    const struct grid *patches; /* [patch_count] */
    enum precision precision;
    void **pixels; /* [patch_count] of complex float or double [r_count][x_count] */
};

/* Where the seconds of one execute went. At most 12 stages: the time of further names goes to the last. */
struct stages {
    int count;
    double mark; /* monotonic clock at the last stages_begin or stages_end, s */
    struct {
        const char *name; /* static text: compress, focus, ... */
        double seconds;
    } stage[12];
};

void stages_begin(struct stages *stages);                 /* forget all, start the clock */
void stages_end(struct stages *stages, const char *name); /* time since the last mark goes to `name` (summed) */
double seconds_now(void);                                 /* monotonic clock, s */

/* The work of a plan, and the work that it leaves out. */
struct work {
    double flops; /* counted from the plan: 5 N log2 N an FFT, machine-independent */
    double pairs; /* pixel-record pairs summed; 0 where an algorithm has none */
    double bytes; /* the plan's own allocations with one thread */
    struct {
        const char *source; /* "BP22 Eq. (11)"; NULL ends the list */
        double flops;
    } published[3];    /* the papers' formulas for this task, the algorithm's own paper first */
    char engine[96];   /* the plan's choice among several engines: "general" */
    char skipped[256]; /* work left out because the scene does not need it; may be empty */
};

enum param_type { PARAM_INTEGER, PARAM_REAL, PARAM_CHOICE, PARAM_TEXT };

/* One setting: parsing, bounds, `info`, the CSV's options column and the sweep all come from this row. Name, type and
   place come from the field by PARAM or PARAM_NAMED. */
struct param {
    const char *name, *summary; /* name NULL ends the table */
    enum param_type type;       /* the field: an int (integer; choice: index), a double (real) or a char array (text) */
    size_t offset, size;        /* of the field in the options struct */
    double initial, min, max;   /* default and closed bounds; for a choice initial is the index */
    const char *const *choices; /* NULL-terminated names of a choice, else NULL */
    const char *text;           /* default of a text */
    const char *sweep;          /* the values that `sweep` runs, separated by blanks; may be NULL */
    bool terse;                 /* left out of the options text while it has its default */
    bool hidden;                /* the plain path, for tests and the papers' times: no user's setting */
};

/* A row begins with  {PARAM(struct options, taps), .summary = ...  for a number, an int or a double, or with
   {PARAM_NAMED(struct options, window, windows), ...  for a choice among names, an int. A field of another type does
   not compile. */
#define PARAM(options, field)                                                                                          \
    PARAM_PLACE(options, field), .type = _Generic(((options *)NULL)->field, int : PARAM_INTEGER, double : PARAM_REAL)
#define PARAM_NAMED(options, field, names)                                                                             \
    PARAM_PLACE(options, field), .type = _Generic(((options *)NULL)->field, int : PARAM_CHOICE), .choices = names
#define PARAM_PLACE(options, field)                                                                                    \
    .name = #field, .offset = offsetof(options, field), .size = sizeof((options *)NULL)->field

/* Promises that the conformance test checks. */
enum trait {
    TRAIT_EXACT = 1,          /* the image equals `reference` to 1e-8 in double */
    TRAIT_ANY_TRACK = 2,      /* images any track in space, not only uniform straight ones */
    TRAIT_APERTURE_LIMIT = 4, /* honours aperture_limit pixel by pixel */
    TRAIT_WINDOW = 8,         /* forms a window of an image, of the pings that `reads` lists */
    TRAIT_AREA = 16,          /* removes what lies outside the scene's target area: far from the image of all echoes */
    TRAIT_FILTERED = 32       /* other algorithms' filters come first: not linear, and the work is of their echoes */
};

/* Settings that `auto` chooses among, as in a SPEC: fixed ones "key=value,key=value", and the values of one more key,
   "value value"; `budget`: the planner sets it. Each value is slower than the one before. */
struct candidate_family {
    const char *fixed, *varied, *values; /* fixed NULL ends a table */
};

/* How an algorithm reads a record between its samples, where it images pair by pair. */
enum record_reading {
    READING_NONE, /* it does not, or by a rule of its own */
    READING_NEAREST,
    READING_LINEAR,
    READING_SINC,
    READING_FITTED,    /* taps of least squared error over a band */
    READING_BAND,      /* the band-limited record itself */
    READING_POLYNOMIAL /* around each sample the polynomial nearest to the band-limited record (least squares) */
};

struct algorithm {
    const char *name, *summary, *reference; /* reference: paper and equations */
    const char *origin; /* what identifies the code of one that the program does not contain, for provenance, a line */
    unsigned traits;    /* of enum trait */
    enum record_reading reading; /* for images in extended precision */
    double extreme_error; /* with a reading: relative L2, at fs = 2 B, measured over the extreme scenes, with room */
    size_t options_size;  /* of the options struct; 0 without params */
    const struct param *params; /* NULL-terminated; NULL without options */
    const char *const *gated;   /* settings that the baseline measures beside the defaults; NULL-terminated, or NULL */
    const struct candidate_family *candidates; /* with a `cost`: what `auto` chooses among; NULL: nothing */
    const void *method; /* its engine's description of it, passed to the callbacks; NULL: its callbacks are its own */

    /* Fill list[room] with the conditions of the whole problem, before any work, and return the number. `plan` refuses
       by the same conditions; for a window it may leave those to the caller that cost much, as each window has the same
       ones. NULL: conditions_general. */
    int (*conditions)(const struct problem *problem, const void *method, const void *options, struct condition *list,
                      int room);
    /* The promised relative L2 error of an image by these settings; a row with more warns. NAN, or NULL: no promise. */
    double (*promise)(const void *options);
    /* Count the work of the settings for a problem, without a plan, into *forecast, and predict those errors that take
       no longer. Errors: STATUS_UNSUPPORTED with the reason, as plan, STATUS_FAILED without memory. NULL: no
       prediction, and no planner chooses the algorithm. */
    enum status (*cost)(const struct problem *problem, const void *method, const void *options,
                        struct forecast *forecast);
    /* Predict the other errors into the same forecast; a filter adds its own to those of what images its echoes.
       Errors: as cost, with the reasons that it does not look for. NULL: there are none. */
    enum status (*errors)(const struct problem *problem, const void *method, const void *options,
                          struct forecast *forecast);
    /* Make a plan in *plan. Errors: STATUS_UNSUPPORTED with the reason, STATUS_FAILED; *plan is then NULL. */
    enum status (*plan)(const struct problem *problem, const void *method, const void *options, void **plan);
    /* Echoes of the plan's acquisition and precision into an image of the plan's patches and precision. */
    enum status (*execute)(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages);
    /* Of a filter, which forms no image but other echoes, in place of execute; what images them is another algorithm.
       `filtered` copies the acquisition of its echoes, freed by the caller; `filter` writes their samples, and may
       change what `filtered` copies, but its sizes. Errors: STATUS_FAILED naming what is not accepted; *out is then
       empty. */
    enum status (*filtered)(const void *plan, struct acquisition *out);
    enum status (*filter)(void *plan, const void *samples, void *filtered, struct stages *stages);
    /* Set read[pings] where the plan reads a ping's records; other records may have any values. NULL: all. */
    void (*reads)(const void *plan, bool *read);
    struct work (*work)(const void *plan); /* may be slow: it counts what the timed plan does not need */
    void (*destroy)(void *plan);           /* destroy(NULL) does nothing */
};

/* The registered algorithms in the order of algorithms/meson.build; NULL ends the list. */
extern const struct algorithm *const algorithms[];
/* The same of filters, which only stand ahead of an algorithm. */
extern const struct algorithm *const algorithm_filters[];

/* Call its callbacks: conditions are the general ones without its own, and a forecast is cost and errors. */
static inline enum status algorithm_plan(const struct algorithm *algorithm, const struct problem *problem,
                                         const void *options, void **plan)
{
    return algorithm->plan(problem, algorithm->method, options, plan);
}
static inline enum status algorithm_cost(const struct algorithm *algorithm, const struct problem *problem,
                                         const void *options, struct forecast *forecast)
{
    return algorithm->cost(problem, algorithm->method, options, forecast);
}
static inline enum status algorithm_errors(const struct algorithm *algorithm, const struct problem *problem,
                                           const void *options, struct forecast *forecast)
{
    return algorithm->errors ? algorithm->errors(problem, algorithm->method, options, forecast) : STATUS_OK;
}
static inline enum status algorithm_forecast(const struct algorithm *algorithm, const struct problem *problem,
                                             const void *options, struct forecast *forecast)
{
    const enum status status = algorithm_cost(algorithm, problem, options, forecast);
    return status == STATUS_OK ? algorithm_errors(algorithm, problem, options, forecast) : status;
}
int algorithm_conditions(const struct algorithm *algorithm, const struct problem *problem, const void *options,
                         struct condition *list, int room);

/* By name; NULL if there is none. */
const struct algorithm *algorithm_find(const char *name);

#endif
