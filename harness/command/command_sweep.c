/* The command `sweep`: every algorithm over its settings, error against run time. */
#include <stdio.h>
#include <string.h>

#include "run/batch.h"
#include "advise/machine_rates.h"
#include "advise/predicted.h"
#include "ranks/ranks.h"
#include "show/plot.h"
#include "show/table.h"
#include "sweep/sweep_settings.h"
#include "sweep/sweep_tables.h"
#include "command/task.h"

/* A point, speckle, and the two ends of the range. */
static const char *const default_scenes[] = {"sweep/point", "sweep/speckle", "sweep/near", "sweep/far"};

/* Does one of them choose by the machine's rates? */
static bool settings_choose(const struct sweep_settings *settings)
{
    for (int k = 0; k < settings->count; k++)
        if (strcmp(settings->specs[k].algorithm->name, "auto") == 0)
            return true;
    return false;
}

static enum status precision_check(const struct task *task)
{
    if (!task->precision || strcmp(task->precision, "float") == 0 || strcmp(task->precision, "double") == 0)
        return STATUS_OK;
    return status_set(STATUS_INVALID, "sweep: --precision is '%s', must be float or double", task->precision);
}

/* Tables and pictures of one scene. */
static enum status scene_finish(struct batch *batch, const struct scene *scenes, int scene_count, int k)
{
    const enum status status = sweep_tables(batch->directory, scenes, scene_count, scenes[k].name);
    return status == STATUS_OK ? plot_results(batch->directory, scenes[k].name, &batch->undrawn) : status;
}

static enum status sweep_finish(struct batch *batch, const struct scene *scenes, int scene_count)
{
    const char *directory = batch->directory;
    bool predicted = false;
    enum status status = predicted_write(directory, scenes, scene_count, &predicted);
    if (predicted && status == STATUS_OK)
        undrawn_note(predicted_draw(directory), &batch->undrawn);
    if (status == STATUS_OK)
        printf("\nResults: %s/measurements.csv, targets.csv, fronts.csv, cheapest.csv, slopes.csv, rules.csv%s "
               "and plots.\n",
               directory, predicted ? ", predicted.csv, predictions.csv" : "");
    return status;
}

enum status command_sweep(const struct task *task)
{
    int default_count = sizeof default_scenes / sizeof *default_scenes, scene_count = 0;
    struct scene *scenes = NULL;
    struct sweep_settings settings = {0};
    struct batch batch = {0};
    struct shard shard;
    enum status status = shard_parse("sweep", task->shard, &shard);
    if (status == STATUS_OK)
        status = precision_check(task);
    if (status == STATUS_OK)
        status = settings_load(task->spec_count, task->specs, task->precision, &settings);
    if (status == STATUS_OK)
        status = task_scenes("sweep", task, default_count, default_scenes, &scenes, &scene_count);
    if (status == STATUS_OK)
        status = batch_open(task->output ? task->output : "results/sweep", scene_count * settings.count, false, &batch);
    if (status == STATUS_OK && settings_choose(&settings))
        status = machine_rates_need();
    batch.in_turn = true;
    batch.shard = shard;
    for (int k = 0; k < scene_count && status == STATUS_OK; k++)
        status = batch_cells(&batch, &scenes[k], settings.count, settings.specs);
    if (status == STATUS_OK)
        status = batch_deal(&batch);
    if (task->all)
        table_begin(stdout, false);
    const bool alone = shard.count == 0 && ranks_count() == 1;
    for (int k = 0; k < scene_count && status == STATUS_OK; k++) {
        status = batch_scene(&batch, batch_nth(&batch, scenes, k), settings.count, settings.specs);
        if (status == STATUS_OK && alone)
            status = scene_finish(&batch, scenes, scene_count, k);
    }
    bool whole = false;
    if (status == STATUS_OK)
        status = batch_join(&batch, &whole);
    for (int k = 0; k < scene_count && status == STATUS_OK && whole && !alone; k++)
        status = scene_finish(&batch, scenes, scene_count, k);
    if (status == STATUS_OK && whole)
        status = sweep_finish(&batch, scenes, scene_count);
    status = batch_close(&batch, status);
    scenes_free(scenes, scene_count);
    settings_free(&settings);
    return status;
}
