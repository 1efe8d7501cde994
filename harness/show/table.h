/* The terminal's table of measurements: one line a row, grouped by scene; 110 columns wide, or 80 without rate and
   gain on a narrower terminal (or where the environment variable COLUMNS is smaller). */
#ifndef SASBENCH_SHOW_TABLE_H
#define SASBENCH_SHOW_TABLE_H

#include <stdbool.h>
#include <stdio.h>

#include "results/results.h"

/* A new table; `brief`: one line for each scene, when it ends. */
void table_begin(FILE *stream, bool brief);
/* The legend of the columns. */
void table_columns(FILE *stream);
/* A scene's heading line, with its image `what`; ends the scene before it. */
void table_scene(FILE *stream, const char *name, const char *what);
/* The scene's refusals, each reason once. */
void table_scene_end(FILE *stream);
/* A warning of the scene, below its heading and not again below its rows. */
void table_warning(FILE *stream, const char *text);
/* One measurement in a line: its SPEC without defaults, and its warnings that no earlier row of the scene had.
   Sharpness takes the place of lobes where the scene has no targets. A heading line comes first whenever the scene
   changes. Undefined values are "-". Refusals wait for the end of their scene. */
void table_row(FILE *stream, const struct measurement *row);

/* Text broken at blanks to the width of the terminal (110 where there is none), each line behind `indent` blanks. */
void table_text(FILE *stream, int indent, const char *text);
/* The width of table_text, at least 80. */
int table_width(FILE *stream);

/* A number with its unit as the table shows it. */
struct cell {
    char text[24];
};
struct cell cell_significant(double value, const char *unit); /* three digits, the unit directly behind; "-" for NAN */
struct cell cell_time(double seconds);                        /* "-" also for 0: below the clock's resolution */
struct cell cell_place(double place, double step); /* six digits, or as many as distinguish places a step apart */
struct cell cell_run_time(const struct measurement *row); /* with ~ where it is noisy */
/* A metric in the unit of the tables (struct column). */
struct cell cell_metric(const struct column *column, const struct measurement *row);
/* Has its scene no targets, so that the metrics of images without them are shown? */
bool measurement_is_blind(const struct measurement *row);
bool is_noisy(const struct measurement *row);
/* The next warning in a row's reason; *at is the rest of it. Noise is left out: it has its own mark. False at the
   end. */
bool warning_next(const char **at, char *text, size_t size);
/* The row's SPEC as on the command line, to be copied there; float is the default there. */
void measurement_spec(const struct measurement *row, char *text, size_t size);

/* One line an algorithm: the plan's FLOPs, and those of the papers' formulas, which contradict each other. */
void table_works_header(FILE *stream);
void table_work(FILE *stream, const char *spec, const struct work *work);

#endif
