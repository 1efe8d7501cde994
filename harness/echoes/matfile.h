/* Echo files and image files in MATLAB format (variables and shapes: README, "Echo files"). */
#ifndef SASBENCH_ECHOES_MATFILE_H
#define SASBENCH_ECHOES_MATFILE_H

#include "echoes/echo_data.h"

/* From now on a thread reads all files, one file at a time, and no process: for a program that is not ours, whose
   threads a process of its own would stop in the middle. Damage that crashes libmatio then ends the program. */
void variables_read_by_thread(void);

/* Read an echo file. *acquisition and *echoes (double, samples pointing to that acquisition) are the caller's:
   acquisition_free, echoes_free. Of a pulse beyond 2^+-20 both pulse and samples are divided by its power of two.
   Errors: STATUS_INVALID, naming file, variable, value and what is accepted. */
enum status echo_file_read(const char *path, struct acquisition *acquisition, struct echoes *echoes);

/* Read all but the samples, and do not measure noise. *exponent: of the power of two that the pulse was divided by. */
enum status echo_file_open(const char *path, struct acquisition *acquisition, int *exponent);
/* The pings to read, of `count` (0: none, whatever their number), and where to. */
struct pings {
    int count;
    const bool *read;
    enum precision precision;
    int exponent;    /* samples are divided by 2^exponent */
    size_t each;     /* numbers of one */
    void *samples;   /* complex [count][each] of the precision; other pings are left as they are */
    double *largest; /* raised to the largest magnitude of a part, in double */
};
/* Is all of it read for some pings: of version 5? */
bool echo_file_is_read_whole(const char *path);
/* Read some pings of a file that was opened, alone where the file is of version 7.3. */
enum status echo_file_read_pings(const char *path, const struct acquisition *acquisition, const struct pings *pings);

/* What a simulator knows beside the echoes: the image that the scene asks for, and its point targets. */
struct echo_notes {
    const char *description; /* NULL: none. Written only */
    int patch_count, target_count;
    struct grid *patches;   /* [patch_count], each as grid_check accepts */
    struct target *targets; /* [target_count] */
};
/* Read the notes of an echo file; all of them may be missing. Errors: as echo_file_read. */
enum status echo_notes_read(const char *path, struct echo_notes *notes);
void echo_notes_free(struct echo_notes *notes);

/* Write an echo file: v5, or v7.3 where v5 cannot hold a variable (2 GiB). It is written beside `path` and renamed when
   whole, so that no half of a file remains. Samples are stored in the echoes' own precision. `notes` may be NULL.
   Errors: STATUS_INVALID when the place cannot be written. */
enum status echo_file_write(const char *path, const struct echoes *echoes, const struct echo_notes *notes);

/* Samples that are made while they are written: some pings, [count][receivers][samples], divided by 2^exponent. */
struct sample_source {
    int exponent;
    enum status (*pings)(void *with, int first, int count, double complex *samples);
    void *with;
};
/* The same file of samples that need not fit into memory: of version 7.3 they are written some pings at a time. Errors:
   as echo_file_write, and those of the source. */
enum status echo_file_stream(const char *path, const struct acquisition *acquisition,
                             const struct sample_source *source, const struct echo_notes *notes);

/* The same of version 7.3, at most so many pings at a time. */
enum status echo_file_blocks(const char *path, const struct acquisition *acquisition,
                             const struct sample_source *source, int most_pings, const struct echo_notes *notes);

/* Can a file be made here? Asked before long work. Errors: STATUS_INVALID. */
enum status matfile_place(const char *path);

/* An image's origin as its file has it: texts of plain characters, empty where missing, and numbers, NAN where
   missing. */
struct image_origin {
    char algorithm[260], options[260], scene[260];
    char engine[260]; /* the plan's choice, as the column `engine`: of `auto` the setting */
    char scene_hash[260], commit[260], date[260];
    char status[260];       /* of a file that is filled tile by tile (mat_tiles.h): "unfinished", "whole" */
    double fc, sound_speed; /* Hz, m/s */
};

/* Write an image with x, r, angle (of turned axes), and its origin, each a variable. The second patch is image_2, x_2,
   r_2, and so on. Same rules. */
enum status image_file_write(const char *path, const struct image *image, const struct image_origin *origin);

/* Read all patches of an image file, their grids from x, r (uniform to 1e-6 of a step) and angle, and its origin.
   Errors: STATUS_INVALID; nothing to close then. */
struct image_file {
    struct image image; /* double */
    struct grid *patches;
    struct image_origin origin;
};
enum status image_file_open(const char *path, struct image_file *file);
/* The same of an image that is measured: one whose tiles are not all done is refused. */
enum status image_file_open_whole(const char *path, struct image_file *file);
void image_file_close(struct image_file *file);

/* Is it an echo file, by its variable `format` or `t0`? An image file, by its axis `x`? Errors: as variables_read. */
enum status echo_file_is(const char *path, bool *is);
enum status image_file_is(const char *path, bool *is);

#endif
