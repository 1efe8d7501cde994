/* What the plots of a results folder show: measured settings as points, their sampling rates, the Pareto fronts. */
#ifndef SASBENCH_SHOW_PLOT_POINTS_H
#define SASBENCH_SHOW_PLOT_POINTS_H

#include "results/results.h"

/* The options of a row, split: the first that is a number, and the rest. */
struct setting {
    char name[32], rest[256]; /* empty name: no option is a number */
    double value;             /* NAN without a name */
};

/* The Pareto front: the points of which no other has both less or equal cost and less or equal error. Of equal points
   the first stays. Their indices go to front [count], cost ascending; returns how many. Values that are not > 0 are no
   points. */
int pareto_front_find(int count, const double *cost, const double *error, int *front);

/* Behind the `size` indices of a front, those of points that no other, with less or equal error, surely costs less
   than: whose interval [low, high] of the cost lies below theirs. Returns how many. */
int pareto_ties_find(int count, const double *low, const double *high, const double *error, int size, int *front);

/* The fastest row of a scene with an error up to error_most, `reference` left out, and `auto`, which is one of the
   others, where another comes as far; NULL: no row does. */
const struct measurement *scene_fastest(const struct results *results, const char *scene, double error_most);
/* The scenes in the order of their first rows, in *scenes [*count], to be freed; the names are borrowed. Errors:
   STATUS_FAILED without memory. */
enum status scenes_find(const struct results *results, const char ***scenes, int *count);

/* A point of a picture; those of one series stand together, in the order of their settings. */
struct point {
    const struct measurement *row; /* borrowed, like the scene's name */
    struct setting setting;
    double rate; /* samples for each one recorded; NAN where nothing is upsampled */
    int series;
    bool on_front; /* the Pareto front by run time */
};
/* The settings of an algorithm that differ in one number alone. */
struct series {
    int first, count; /* points */
    int member;       /* which of its algorithm's, from 0 */
    bool alone;       /* the algorithm has no other point */
    char title[300];  /* algorithm and the other settings */
};
struct points {
    const char *scene;
    struct point *list;    /* [count] */
    struct series *series; /* [series_count] */
    int *front;            /* [front_count] points, the fastest first */
    int count, series_count, front_count;
    double control_s; /* median time of the scalar reference loop; NAN: unknown */
};
/* What a scene's pictures show. Errors: STATUS_FAILED without memory; points_free accepts a zeroed struct. */
enum status points_find(const struct results *results, const char *scene, struct points *points);
void points_free(struct points *points);

#endif
