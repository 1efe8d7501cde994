/* The rows of one scene as the tables of a sweep take them. */
#ifndef SASBENCH_SWEEP_SWEEP_GROUP_H
#define SASBENCH_SWEEP_SWEEP_GROUP_H

#include <stdio.h>

#include "results/results.h"
#include "scene/scene.h"
#include "show/plot_points.h"

/* A measured setting as a point of its series. */
struct sweep_point {
    const struct measurement *row;
    struct setting setting; /* what varies along the series, and what does not */
    bool taken;             /* belongs to a series that is done */
};

/* The rows of one scene that have both time and error, but for exact ones that image only a part of it. */
struct group {
    const char *scene;
    const struct measurement **rows; /* [count] borrowed */
    struct sweep_point *points;      /* [count] */
    double *error, *cost;            /* [count] room for a front's or a series' values */
    double *low, *high;              /* [count] room for the interval of the cost */
    int *front;                      /* [count] room for a front */
    struct sweep_point *series;      /* [count] room for a series */
    int count;
    bool told; /* on the terminal as well */
};

/* Has a row ahead of this one the same scene? */
bool scene_seen(const struct results *results, int row);
/* The scene of a name, or NULL. */
const struct scene *scene_find(const struct scene *scenes, int count, const char *name);

/* Errors: STATUS_FAILED without memory; *group is to be freed in any case. */
enum status group_fill(const struct results *results, const char *scene, struct group *group);
void group_free(struct group *group);

/* What a setting costs: run time, which is known to an interval only, and counted operations. */
struct sweep_cost {
    const char *name, *title;
    size_t offset; /* of the double in struct measurement */
};
enum { SWEEP_RUN_TIME, SWEEP_FLOPS, SWEEP_COSTS };
extern const struct sweep_cost sweep_costs[SWEEP_COSTS];
/* Fill error, cost, low and high. */
void group_values(struct group *group, const struct sweep_cost *cost);

/* Fields of a row of CSV, texts first, then numbers; NULL ends the texts. `ends`: they are the row's last. */
void fields_write(FILE *file, const char *const *texts, const double *numbers, int number_count, bool ends);

/* The cheapest setting for each decade of error, of all algorithms and of each family, as rows of cheapest.csv. */
void cheapest_write(struct group *group, FILE *file);

/* The lines through the group's series (sweep_tables.h: line_fit), as rows of slopes.csv. */
void slopes_write(struct group *group, FILE *file);

#endif
