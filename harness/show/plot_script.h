/* A picture in the making: data files and a short preamble of variables go to a temporary folder beside the picture,
   then one of the scripts in plots/ draws them. The picture is drawn there, too, and renamed when whole. Used within
   show/ only. */
#ifndef SASBENCH_SHOW_PLOT_SCRIPT_H
#define SASBENCH_SHOW_PLOT_SCRIPT_H

#include <limits.h>
#include <stdio.h>

#include "show/gnuplot.h"
#include "status.h"

enum { PANELS_MAX = 8 }; /* more do not fit a picture */

/* One picture in the making. */
struct plot {
    char directory[PATH_MAX];             /* temporary, with everything in it */
    char output[PATH_MAX + 32];           /* the picture until it is whole */
    const char *path;                     /* the picture */
    FILE *preamble;                       /* sets the script's variables */
    const char *plots_directory, *script; /* that it is drawn with, once it is prepared */
    struct gnuplot gnuplot;
};

/* Errors: STATUS_FAILED. plot_end removes what is left, and accepts a plot whose beginning failed. */
enum status plot_begin(struct plot *plot, const char *path);
void plot_end(struct plot *plot);
/* The path of a file in the temporary folder; the error of one that cannot be written. */
void plot_file(const struct plot *plot, const char *name, char path[PATH_MAX + 32]);
enum status plot_file_failed(const char *path);

/* Variables of the script: a text; an array of texts, index from 0. */
void plot_variable(FILE *file, const char *name, const char *text);
void plot_array(FILE *file, const char *name, int count);
void plot_array_write(FILE *file, const char *name, int index, const char *text);

/* Draw with plots_directory/script, then put the picture in its place; or both. */
enum status plot_run(struct plot *plot, const char *plots_directory, const char *script);
enum status plot_place(const struct plot *plot);
enum status plot_draw(struct plot *plot, const char *plots_directory, const char *script);

/* plot_run in steps, for several at a time: prepare, start, poll until *ended. */
enum status plot_prepare(struct plot *plot, const char *plots_directory, const char *script);
enum status plot_start(struct plot *plot);
enum status plot_poll(struct plot *plot, bool *ended);

#endif
