/* A picture in the making: data files and a short preamble of variables, all in memory. gnuplot draws them with one
   of the scripts in plots/. The picture goes to memory, too, and to its place when it is complete. Used within show/
   and by report/thumbnails. */
#ifndef SASBENCH_SHOW_PLOT_SCRIPT_H
#define SASBENCH_SHOW_PLOT_SCRIPT_H

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

#include "contract/status.h"

/* gnuplot as a process. */
struct gnuplot {
    pid_t process;
    double begin;    /* seconds_now() */
    int exit_status; /* its exit status from waitpid */
};

enum { PANELS_MAX = 8, PLOT_FILES_MOST = 66 }; /* limit of panels in one picture */

/* One picture in the making. */
struct plot {
    FILE *files[PLOT_FILES_MOST]; /* [file_count] in memory: the preamble, then data files */
    int file_count;
    int picture, log; /* files in memory: the picture until it is complete, gnuplot's messages; -1 */
    const char *path; /* the picture */
    bool named;       /* the user gave it: follow links */
    FILE *preamble;   /* files[0], sets the script's variables */
    const char *plots_directory, *script; /* to draw it with, once prepared */
    struct gnuplot gnuplot;
};

/* `named` as in text_file_open_named. Errors: STATUS_FAILED. plot_end removes what is left, and accepts a plot whose
   beginning failed. */
enum status plot_begin(struct plot *plot, const char *path, bool named);
void plot_end(struct plot *plot);
/* A new file; the script finds its name in array[index]. Flushed before it is read. Errors: STATUS_FAILED. */
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

/* Draw with plots_directory/script, without putting the picture in its place. */
enum status plot_run(struct plot *plot, const char *plots_directory, const char *script);

enum { PLOT_QUEUE_MOST = 48 };

/* Accepts zeroes; emptied by plot_queue_draw or plot_queue_free. */
struct plot_queue {
    struct queued_plot *list; /* [count] */
    int count, undrawn;       /* undrawn: pictures so far that failed, each of which is noted (undrawn_note) */
};

/* End a plot whose data and variables were written with `status`: without a queue it is drawn, else the queue takes
   it over and draws it later, at the latest when it has PLOT_QUEUE_MOST; `plots_directory` and `script` are borrowed
   until then. Errors, which a queue counts: `status`; as plot_run; STATUS_FAILED for a full disk or no memory. */
enum status plot_finish(struct plot *plot, enum status status, struct plot_queue *queue, const char *plots_directory,
                        const char *script);
/* Draw all, as many at a time as OpenMP has threads. */
void plot_queue_draw(struct plot_queue *queue);
/* Drop what is not drawn. */
void plot_queue_free(struct plot_queue *queue);

#endif
