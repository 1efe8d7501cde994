/* A picture in the making: data files and a short preamble of variables, all in memory, where gnuplot reads them: one
   of the scripts in plots/ draws them. The picture goes to memory, too, and to its place when it is whole. Used within
   show/ only. */
#ifndef SASBENCH_SHOW_PLOT_SCRIPT_H
#define SASBENCH_SHOW_PLOT_SCRIPT_H

#include <stdio.h>

#include "show/gnuplot.h"
#include "contract/status.h"

enum { PANELS_MAX = 8, PLOT_FILES_MOST = 66 }; /* more panels do not fit a picture */

/* One picture in the making. */
struct plot {
    FILE *files[PLOT_FILES_MOST]; /* [file_count] in memory: the preamble, then what data it has */
    int file_count;
    int picture, log;                     /* files in memory: the picture until it is whole, what gnuplot prints; -1 */
    const char *path;                     /* the picture */
    bool named;                           /* by the user: links are followed */
    FILE *preamble;                       /* files[0], sets the script's variables */
    const char *plots_directory, *script; /* that it is drawn with, once it is prepared */
    struct gnuplot gnuplot;
};

/* `named` as of text_file_open_named. Errors: STATUS_FAILED. plot_end removes what is left, and accepts a plot whose
   beginning failed. */
enum status plot_begin(struct plot *plot, const char *path, bool named);
void plot_end(struct plot *plot);
/* A new file, by whose name, array[index], the script finds it; flushed before it is read. Errors: STATUS_FAILED. */
enum status plot_file_open(struct plot *plot, const char *array, int index, FILE **file);
enum status plot_file_flush(const struct plot *plot, FILE *file);
/* The name by which gnuplot finds an open file. */
enum { PLOT_NAME = 48 };
void plot_file_name(int descriptor, char name[PLOT_NAME]);

/* Variables of the script: a text; a path, whatever folder gnuplot works in; an array of texts, index from 0. */
void plot_variable(FILE *file, const char *name, const char *text);
void plot_path_variable(FILE *file, const char *name, const char *path);
void plot_array(FILE *file, const char *name, int count);
void plot_array_write(FILE *file, const char *name, int index, const char *text);

/* Draw with plots_directory/script, then put the picture in its place; or both. */
enum status plot_run(struct plot *plot, const char *plots_directory, const char *script);
enum status plot_place(const struct plot *plot);
bool plot_is_empty(const struct plot *plot); /* it has drawn nothing */
enum status plot_draw(struct plot *plot, const char *plots_directory, const char *script);

/* plot_run in steps, for several at a time: prepare, start, poll until *ended. */
enum status plot_prepare(struct plot *plot, const char *plots_directory, const char *script);
enum status plot_start(struct plot *plot);
enum status plot_poll(struct plot *plot, bool *ended);

#endif
