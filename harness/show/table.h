/* The terminal's table of measurements: one line a row, grouped by scene; 110 columns wide, or 80 on a narrower
   terminal (or where the environment variable COLUMNS says so), without rate and gain. */
#ifndef SASBENCH_SHOW_TABLE_H
#define SASBENCH_SHOW_TABLE_H

#include <stdbool.h>
#include <stdio.h>

#include "results/results.h"

/* A new table; `brief`: of each scene one line, when it ends. */
void table_begin(FILE *stream, bool brief);
/* What the columns mean. */
void table_columns(FILE *stream);
/* A scene's heading line, and what it images; ends the scene before it. */
void table_scene(FILE *stream, const char *name, const char *what);
/* What was refused in it, each reason once. */
void table_scene_end(FILE *stream);
/* A warning of the scene, below its heading; it is not said again below its rows. */
void table_warning(FILE *stream, const char *text);
/* One measurement in a line, its SPEC without defaults, with its warnings that no row of the scene had before; the
   sharpness in place of lobes where the scene has no targets; a heading line whenever the scene is another than the
   row's before. Undefined values are "-". A refusal waits for the end of its scene. */
void table_row(FILE *stream, const struct measurement *row);

/* Text broken at blanks to the width of the terminal (110 where there is none), each line behind `indent` blanks. */
void table_text(FILE *stream, int indent, const char *text);
/* That width, at least 80. */
int table_width(FILE *stream);

/* A number with its unit as the table shows it. */
struct cell {
    char text[24];
};
struct cell cell_significant(double value, const char *unit); /* three digits, the unit directly behind; "-" for NAN */
struct cell cell_time(double seconds);                        /* "-" also for 0: below what the clock tells */
struct cell cell_place(double place, double step);            /* six digits, or as many as tell places a step apart */
struct cell cell_run_time(const struct measurement *row);     /* with ~ where it is noisy */
/* A metric in the unit that tables show it in (struct column). */
struct cell cell_metric(const struct column *column, const struct measurement *row);
/* Has its scene no targets, so that the metrics of images without them are shown? */
bool measurement_is_blind(const struct measurement *row);
bool is_noisy(const struct measurement *row);
/* The next warning in a row's reason, of which *at is what is left. Noise is none: it has its mark. False at the
   end. */
bool warning_next(const char **at, char *text, size_t size);
/* The row's SPEC as on the command line, so that it can be taken from here; float is the default there. */
void measurement_spec(const struct measurement *row, char *text, size_t size);

/* One line an algorithm: the FLOPs that the plan counted, and those of the papers' formulas, which contradict each
   other. */
void table_works_header(FILE *stream);
void table_work(FILE *stream, const char *spec, const struct work *work);

#endif
