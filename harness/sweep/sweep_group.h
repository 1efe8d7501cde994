/* The points of one scene for the tables of a sweep. */
#ifndef SASBENCH_SWEEP_SWEEP_GROUP_H
#define SASBENCH_SWEEP_SWEEP_GROUP_H

#include <stdio.h>

#include "results/results.h"
#include "scene/scene.h"
#include "show/plot_points.h"

/* The points of one scene (plot_points.h), and room for values of each. */
struct group {
    struct points points;
    double *error, *cost; /* [count] of a front, or of a series */
    double *low, *high;   /* [count] the interval of the cost */
    int *front;           /* [count] */
    bool told;            /* on the terminal as well */
};

/* Does an earlier row have the same scene? */
bool scene_seen(const struct results *results, int row);
/* The scene with a name, or NULL. */
const struct scene *scene_find(const struct scene *scenes, int count, const char *name);

/* Errors: STATUS_FAILED without memory; *group is to be freed in any case. */
enum status group_fill(const struct results *results, const char *scene, struct group *group);
void group_free(struct group *group);

/* A cost of a setting: run time, of which only an interval is measured, or counted operations. */
struct sweep_cost {
    const char *name, *title;
    size_t offset; /* of the double in struct measurement */
};
enum { SWEEP_RUN_TIME, SWEEP_FLOPS, SWEEP_COSTS };
extern const struct sweep_cost sweep_costs[SWEEP_COSTS];
/* Fill error, cost, low and high. */
void group_values(struct group *group, const struct sweep_cost *cost);

/* The cheapest setting for each decade of error, of all algorithms and of each family, as rows of cheapest.csv. */
void cheapest_write(struct group *group, FILE *file);

/* The lines through the group's series (sweep_tables.h: line_fit), as rows of slopes.csv. */
void slopes_write(struct group *group, FILE *file);

#endif
