/* The command `run`: every scene with every algorithm, measured, recorded and drawn. */
#include <stdio.h>
#include <unistd.h>

#include "run/batch.h"
#include "advise/machine_rates.h"
#include "command/task.h"
#include "text/text_append.h"
#include "results/results.h"
#include "measure/timing.h"
#include "run/run_summary.h"
#include "show/plot.h"
#include "show/table.h"

static enum status check_twice(const struct task *task)
{
    for (int a = 0; a < task->spec_count; a++)
        for (int b = 0; b < a; b++)
            if (spec_equal(&task->specs[a], &task->specs[b]))
                return status_set(STATUS_INVALID, "run: --algorithm %s is given twice with the same settings",
                                  task->specs[a].algorithm->name);
    return STATUS_OK;
}

/* A short table of the measurements, half a terminal long. */
static enum status summary_print(const struct batch *batch, int scene_count, const struct scene *scenes, int spec_count,
                                 const struct spec *specs, bool tables)
{
    const struct spent *spent = &batch->spent;
    const double all = seconds_now() - batch->begin;
    struct results results;
    char path[4200], text[8600] = "";
    snprintf(path, sizeof path, "%s/measurements.csv", batch->directory);
    if (batch->measured > 0)
        snprintf(text, sizeof text, "%.3g s: imaging %.0f, pictures %.0f, plans %.0f, rest %.0f", all, spent->imaging,
                 batch->drawn_s, spent->planning, all - spent->imaging - batch->drawn_s - spent->planning);
    else
        snprintf(text, sizeof text, "no row was measured anew: all are of an earlier run");
    enum status status = results_read(path, &results);
    if (status == STATUS_OK)
        run_summary_print(stdout, &results, scene_count, scenes, spec_count, specs, text);
    results_free(&results);
    if (status != STATUS_OK)
        return status;
    snprintf(path, sizeof path, "%s/overview.png", batch->directory);
    const bool drawn = access(path, F_OK) == 0;
    snprintf(text, sizeof text, "Next: %s%s%s report ", drawn ? path : "", drawn ? "; " : "", program_called());
    text_append_word(text, sizeof text, batch->directory);
    if (tables)
        text_append(text, sizeof text, "; %s help columns", program_called());
    table_text(stdout, 0, text);
    return STATUS_OK;
}

enum status command_run(const struct task *task)
{
    struct scene *scenes = NULL;
    int scene_count = 0;
    struct batch batch = {0};
    struct shard shard;
    double memory = 0;
    machine_rates_use(NULL);
    enum status status = shard_parse("run", task->shard, &shard);
    if (status == STATUS_OK)
        status = memory_of_tiles("run", task, &memory);
    if (status == STATUS_OK)
        status = check_twice(task);
    if (status == STATUS_OK)
        status = task_scenes("run", task, 0, NULL, &scenes, &scene_count);
    if (status == STATUS_OK)
        status =
            batch_open(task->output ? task->output : "results/latest", scene_count * task->spec_count, true, &batch);
    if (batch.rows > ROWS_MANY)
        batch.effort = EFFORT_BRIEF;
    batch.works = task->flops;
    batch.memory = memory;
    batch.details = !(memory > 0); /* `image --memory` and `show` draw tiled images */
    batch.shard = shard;
    for (int k = 0; k < scene_count && status == STATUS_OK; k++)
        status = batch_cells(&batch, &scenes[k], task->spec_count, task->specs);
    if (status == STATUS_OK)
        status = batch_deal(&batch);
    if (task->all)
        table_begin(stdout, false);
    for (int k = 0; k < scene_count && status == STATUS_OK; k++)
        status = batch_scene(&batch, batch_nth(&batch, scenes, k), task->spec_count, task->specs);
    bool whole = false;
    if (status == STATUS_OK)
        status = batch_join(&batch, &whole);
    const double begin = seconds_now();
    if (whole && status == STATUS_OK)
        status = plot_results(batch.directory, NULL, &batch.undrawn);
    batch.drawn_s += seconds_now() - begin;
    if (whole && status == STATUS_OK)
        status = summary_print(&batch, scene_count, scenes, task->spec_count, task->specs,
                               task->all || batch.rows <= ROWS_MANY);
    status = batch_close(&batch, status);
    scenes_free(scenes, scene_count);
    return status;
}
