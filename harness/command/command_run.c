/* The command `run`: every scene with every algorithm, measured, recorded and drawn. */
#include <stdio.h>
#include <stdlib.h>

#include "run/batch.h"
#include "advise/machine_rates.h"
#include "command/task.h"
#include "measure/timing.h"
#include "show/table.h"

enum { ROWS_MANY = 100 }; /* more than that are timed briefly */

/* All algorithms with their defaults. */
static enum status load_specs(struct spec **specs, int *count)
{
    *count = 0;
    for (int k = 0; algorithms[k]; k++)
        ++*count;
    *specs = calloc((size_t)*count, sizeof **specs);
    if (!*specs)
        return status_set(STATUS_FAILED, "no memory for %d algorithms", *count);
    enum status status = STATUS_OK;
    for (int k = 0; k < *count && status == STATUS_OK; k++)
        status = spec_parse(algorithms[k]->name, &(*specs)[k]);
    return status;
}

static enum status check_twice(const struct task *task)
{
    for (int a = 0; a < task->spec_count; a++)
        for (int b = 0; b < a; b++)
            if (spec_equal(&task->specs[a], &task->specs[b]))
                return status_set(STATUS_INVALID, "run: --algorithm %s is given twice with the same settings",
                                  task->specs[a].algorithm->name);
    return STATUS_OK;
}

static void time_print(const struct batch *batch)
{
    const struct spent *spent = &batch->spent;
    char text[300];
    snprintf(text, sizeof text,
             "Time: %.3g s, of which imaging %.3g s, planning %.3g s, echoes %.3g s, exact images %.3g s, the scalar "
             "reference loop %.3g s, pictures %.3g s.",
             seconds_now() - batch->begin, spent->imaging, spent->planning, spent->echoes, spent->reference,
             spent->control, batch->drawn_s);
    putchar('\n');
    table_text(stdout, 0, text);
}

enum status command_run(const struct task *task)
{
    struct scene *scenes = NULL;
    struct spec *all = NULL;
    int scene_count = 0, all_count = 0;
    struct batch batch = {0};
    machine_rates_use(NULL);
    enum status status = check_twice(task);
    if (status == STATUS_OK && task->spec_count == 0)
        status = load_specs(&all, &all_count);
    int spec_count = task->spec_count ? task->spec_count : all_count;
    if (status == STATUS_OK)
        status = task_scenes("run", task, 0, NULL, &scenes, &scene_count);
    if (status == STATUS_OK)
        status = batch_open(task->output ? task->output : "results/latest", scene_count * spec_count, true, &batch);
    if (batch.rows > ROWS_MANY)
        batch.effort = EFFORT_BRIEF;
    for (int k = 0; k < scene_count && status == STATUS_OK; k++)
        status = batch_scene(&batch, &scenes[k], spec_count, task->spec_count ? task->specs : all);
    if (status == STATUS_OK && batch.measured > 0)
        time_print(&batch);
    if (status == STATUS_OK)
        printf("\nOf each time %.2g us are the harness's own: an algorithm that does nothing takes them.\n"
               "Results: %s/measurements.csv, targets.csv and pictures.\n",
               1e6 * timing_floor(), batch.directory);
    status = batch_close(&batch, status);
    scenes_free(scenes, scene_count);
    for (int k = 0; k < all_count; k++)
        spec_free(&all[k]);
    free(all);
    return status;
}
