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
    for (int k = 0; k < group->count; k++) {
        const struct measurement *row = group->rows[k];
        group->cost[k] = *(const double *)((const char *)row + cost->offset);
        group->error[k] = row->error;
        group->low[k] = group->high[k] = group->cost[k];
        if (cost == &sweep_costs[SWEEP_RUN_TIME])
            measurement_interval(row, &group->low[k], &group->high[k]);
    }
}

static struct sweep_point point_read(const struct measurement *row)
{
    return (struct sweep_point){.row = row, .setting = setting_read(row->options)};
}

void group_free(struct group *group)
{
    free(group->rows);
    free(group->error);
    free(group->cost);
    free(group->low);
    free(group->high);
    free(group->front);
    free(group->points);
    free(group->series);
}

enum status group_fill(const struct results *results, const char *scene, struct group *group)
{
    size_t most = (size_t)results->csv.row_count + 1;
    *group = (struct group){.scene = scene,
                            .rows = calloc(most, sizeof *group->rows),
                            .error = calloc(most, sizeof *group->error),
                            .cost = calloc(most, sizeof *group->cost),
                            .low = calloc(most, sizeof *group->low),
                            .high = calloc(most, sizeof *group->high),
                            .front = calloc(most, sizeof *group->front),
                            .points = calloc(most, sizeof *group->points),
                            .series = calloc(most, sizeof *group->series)};
    if (!group->rows || !group->error || !group->cost || !group->low || !group->high || !group->front || !group->points
        || !group->series)
        return status_set(STATUS_FAILED, "%s: no memory for %zu rows", scene, most);
    double most_pairs = scene_most_pairs(results, scene);
    for (int k = 0; k < results->csv.row_count; k++) {
        const struct measurement *row = &results->measurements[k];
        if (strcmp(row->scene, scene) == 0 && row_is_point(row, most_pairs)) {
            group->rows[group->count] = row;
            group->points[group->count++] = point_read(row);
        }
    }
    return STATUS_OK;
}

void fields_write(FILE *file, const char *const *texts, const double *numbers, int number_count, bool ends)
{
    for (int k = 0; texts[k]; k++) {
        csv_write_text(file, texts[k]);
        fputc(texts[k + 1] || number_count || !ends ? ',' : '\n', file);
    }
    for (int k = 0; k < number_count; k++) {
        csv_write_number(file, numbers[k]);
        fputc(k < number_count - 1 || !ends ? ',' : '\n', file);
    }
}
