/* Tables from the rows of a sweep: the Pareto fronts, the cheapest setting for each decade of error, the fall of the
   error along each series of settings that differ in one parameter, and the papers' rules for the upsampling rate. */
#ifndef SASBENCH_SWEEP_SWEEP_TABLES_H
#define SASBENCH_SWEEP_SWEEP_TABLES_H

#include <stddef.h>
#include <stdio.h>

#include "results/results.h"
#include "scene/scene.h"
#include "show/plot_points.h"

/* A straight line through log10 error against log10 rate, by least squares. */
struct line_fit {
    int points;
    double slope;          /* NAN with fewer than two points, or one rate only */
    double first, last;    /* the line's error at the first and the last rate */
    double residual_log10; /* rms distance of the points from the line */
};
struct line_fit line_fit(int count, const double *rate, const double *error);

/* The first point from which on no error differs from the last one's by more than 5 %; `count` when the last two
   differ more: there is no floor. */
int floor_find(int count, const double *error);

/* Read DIR/measurements.csv, write fronts.csv, cheapest.csv, slopes.csv and rules.csv beside it (results/README.md
   has their columns) and print the last three of the scene `told` (NULL: of none). `scenes` are the measured ones;
   others are looked up by name among the shipped ones. Errors: as results_read; STATUS_INVALID for a folder that
   cannot be written; STATUS_FAILED without memory. */
enum status sweep_tables(const char *directory, const struct scene *scenes, int scene_count, const char *told);

/* The scene of this name as it was measured: of `scenes`, or a shipped one, read into *loaded, which is to be freed in
   any case. NULL for one that is missing or has changed since. */
const struct scene *scene_measured(const struct csv *csv, const struct scene *scenes, int count, const char *name,
                                   struct scene *loaded);

/* A cost of a setting: run time, of which only an interval is measured, or counted operations. */
struct sweep_cost {
    const char *name, *title;
    size_t offset; /* of the double in struct measurement */
};
enum { SWEEP_RUN_TIME, SWEEP_FLOPS, SWEEP_COSTS };
extern const struct sweep_cost sweep_costs[SWEEP_COSTS];

/* The cheapest setting for each decade of error, of all algorithms and of each family, as rows of cheapest.csv; `told`:
   on the terminal as well. */
void cheapest_write(const struct points *points, bool told, FILE *file);
/* The lines through the series, as rows of slopes.csv. Errors: STATUS_FAILED without memory. */
enum status slopes_write(const struct points *points, bool told, FILE *file);

/* Does a folder contain an algorithm in two settings on one scene? */
bool sweep_is(const char *directory);

#endif
