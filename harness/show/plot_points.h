/* What the plots of a results folder show: measured settings as points, their sampling rates, the Pareto fronts. */
#ifndef SASBENCH_SHOW_PLOT_POINTS_H
#define SASBENCH_SHOW_PLOT_POINTS_H

#include "results/results.h"

/* The options of a row, split: the first that is a number, and the rest. */
struct setting {
    char name[32], rest[256]; /* empty name: no option is a number */
    double value;             /* NAN without a name */
};
struct setting setting_read(const char *options);

/* Samples for each one recorded: beta points are inserted between two, zero padding multiplies them, the nearest sample
   alone is rate 1. NAN where nothing is upsampled. */
double setting_rate(const char *algorithm, const struct setting *setting);

/* Whether a row is a point: measured, with time and error, and its image is not only a part of the scene's (exact
   ones). most_pairs: of any row of the scene. */
bool row_is_point(const struct measurement *row, double most_pairs);
double scene_most_pairs(const struct results *results, const char *scene);

/* The Pareto front: the points of which no other has both less or equal cost and less or equal error. Of equal points
   the first stays. Their indices go to front [count], cost ascending; returns how many. Values that are not > 0 are no
   points. */
int pareto_front_find(int count, const double *cost, const double *error, int *front);

/* Behind the `size` indices of a front, those of points that no other, with less or equal error, surely costs less
   than: whose interval [low, high] of the cost lies below theirs. Returns how many. */
int pareto_ties_find(int count, const double *low, const double *high, const double *error, int size, int *front);

/* Write DIR/points.csv from DIR/measurements.csv: a row for each that was measured (results/README.md has its columns),
   which is all that plots/scene.awk knows of them. Errors: as results_read; STATUS_INVALID for a folder that cannot be
   written; STATUS_FAILED without memory. */
enum status plot_points_write(const char *directory);

#endif
