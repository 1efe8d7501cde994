/* The rows of one scene of a sweep (sweep_group.h). */
#include "sweep/sweep_group.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "files/csv.h"

const struct sweep_cost sweep_costs[SWEEP_COSTS] = {
    [SWEEP_RUN_TIME] = {"run_s", "run time", offsetof(struct measurement, run_s)},
    [SWEEP_FLOPS] = {"flops", "counted FLOPs", offsetof(struct measurement, flops)},
};

void group_values(struct group *group, const struct sweep_cost *cost)
{
    for (int k = 0; k < group->points.count; k++) {
        const struct measurement *row = group->points.list[k].row;
        group->cost[k] = *(const double *)((const char *)row + cost->offset);
        group->error[k] = row->error;
        group->low[k] = group->high[k] = group->cost[k];
        if (cost == &sweep_costs[SWEEP_RUN_TIME])
            measurement_interval(row, &group->low[k], &group->high[k]);
    }
}

void group_free(struct group *group)
{
    points_free(&group->points);
    free(group->error);
    free(group->front);
}

enum status group_fill(const struct results *results, const char *scene, struct group *group)
{
    *group = (struct group){.told = false};
    const enum status status = points_find(results, scene, &group->points);
    if (status != STATUS_OK)
        return status;
    const size_t most = (size_t)group->points.count + 1;
    group->error = calloc(4 * most, sizeof *group->error);
    group->front = calloc(most, sizeof *group->front);
    if (!group->error || !group->front)
        return status_set(STATUS_FAILED, "%s: no memory for %zu rows", scene, most);
    group->cost = group->error + most;
    group->low = group->cost + most;
    group->high = group->low + most;
    return STATUS_OK;
}
