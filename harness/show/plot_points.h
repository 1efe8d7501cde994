/* The data of a results folder's plots: measured settings as points, their sampling rates, the Pareto fronts. */
#ifndef SASBENCH_SHOW_PLOT_POINTS_H
#define SASBENCH_SHOW_PLOT_POINTS_H

#include "results/results.h"

/* The options of a row, split into the first number and the rest. */
struct setting {
    char name[32], rest[256]; /* empty name: no option is a number */
    double value;             /* NAN without a name */
};

/* The Pareto front: the points such that no other has both less or equal cost and less or equal error. Of equal
   points the first stays. Their indices go to front [count], cost ascending; returns their number. Values that are
   not > 0 are no points. */
int pareto_front_find(int count, const double *cost, const double *error, int *front);

/* Append, behind the `size` indices of a front, the points that tie with it: no other point with less or equal error
   has an interval [low, high] of the cost entirely below theirs. Returns their number. */
int pareto_ties_find(int count, const double *low, const double *high, const double *error, int size, int *front);

/* The fastest row of a scene with an error up to error_most, without `reference`, and without `auto`, which is one
   of the others, where another is within error_most; NULL without such a row. */
const struct measurement *scene_fastest(const struct results *results, const char *scene, double error_most);
/* The scenes in the order of their first rows, in *scenes [*count], to be freed; the names are borrowed. Errors:
   STATUS_FAILED without memory. */
enum status scenes_find(const struct results *results, const char ***scenes, int *count);

/* A point of a picture; those of one series stand together, in the order of their settings. */
struct point {
    const struct measurement *row; /* borrowed, like the scene's name */
    struct setting setting;
    double rate; /* samples for each one recorded; NAN without upsampling */
    int series;
    bool on_front; /* the Pareto front by run time */
};
/* The settings of an algorithm that differ in one number only. */
struct series {
    int first, count; /* points */
    int member;       /* its index among the algorithm's series, from 0 */
    bool alone;       /* the algorithm has no other point */
    char title[300];  /* algorithm and the other settings */
};
struct points {
    const char *scene;
    struct point *list;    /* [count] */
    struct series *series; /* [series_count] */
    int *front;            /* [front_count] points, the fastest first */
    int count, series_count, front_count;
    double control_s; /* median time of the scalar reference loop; NAN: none */
};
/* The points of a scene's pictures. Errors: STATUS_FAILED without memory; points_free accepts a zeroed struct. */
enum status points_find(const struct results *results, const char *scene, struct points *points);
void points_free(struct points *points);

#endif
