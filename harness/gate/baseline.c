/* The baseline (baseline.h) and the command that makes it. */
#include "gate/baseline.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "files/folder.h"
#include "files/paths.h"
#include "run/progress_line.h"

#define GATE "gate/" /* the folder of its scenes */

/* To a power of ten not above a tenth of the slack, so that rounding elsewhere seldom shows in the text. */
static void round_values(struct measurement *row, enum precision precision)
{
    for (const struct column *metric = metric_first(measurement_columns); metric; metric = metric_first(metric + 1)) {
        double value, slack = metric->absolute_slack[precision];
        memcpy(&value, (char *)row + metric->offset, sizeof value);
        slack = fmax(slack, metric->relative_slack * fabs(value));
        if (slack > 0) {
            double scale = pow(10, ceil(-log10(slack / 10)));
            value = rint(value * scale) / scale;
            memcpy((char *)row + metric->offset, &value, sizeof value);
        }
    }
}

void baseline_row(struct session *session, const struct spec *spec, char *reason, size_t reason_size,
                  struct measurement *row)
{
    struct outcome outcome;
    outcome_measure(session, spec, EFFORT_NONE, NULL, &outcome);
    snprintf(reason, reason_size, "%s", outcome.reason);
    *row = outcome.row;
    row->reason = reason;
    row->engine = row->skipped = row->stages = "";
    round_values(row, spec->precision);
    outcome_free(&outcome);
}

static void specs_free(struct spec *specs, int count)
{
    for (int k = 0; k < count; k++)
        spec_free(&specs[k]);
    free(specs);
}

/* Every algorithm in both precisions, then the settings that it names. */
static enum status specs_make(struct spec **specs, int *count)
{
    static const char *const precisions[] = {"precision=float", "precision=double", NULL};
    int most = 0;
    for (int k = 0; algorithms[k]; k++) {
        most += 2;
        for (const char *const *gated = algorithms[k]->gated; gated && *gated; gated++)
            most++;
    }
    *count = 0;
    *specs = calloc((size_t)most + 1, sizeof **specs);
    if (!*specs)
        return status_set(STATUS_FAILED, "no memory for %d settings", most);
    enum status status = STATUS_OK;
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; algorithms[k]; k++)
            for (const char *const *s = pass ? algorithms[k]->gated : precisions; s && *s && status == STATUS_OK; s++) {
                char text[120];
                snprintf(text, sizeof text, "%s:%s", algorithms[k]->name, *s);
                status = spec_parse(text, &(*specs)[*count]);
                *count += status == STATUS_OK;
            }
    return status;
}

/* Does it repeat a refusal for the same reason? Other settings of a refused algorithm often do. */
static bool adds_nothing(const struct measurement *row, const struct measurement *before, int count)
{
    for (int k = 0; k < count; k++)
        if (strcmp(row->status, "unsupported") == 0 && strcmp(before[k].status, "unsupported") == 0
            && strcmp(row->algorithm, before[k].algorithm) == 0 && strcmp(row->precision, before[k].precision) == 0
            && strcmp(row->reason, before[k].reason) == 0)
            return true;
    return false;
}

struct reason {
    char text[512];
};

/* Adds to *row_count. */
static enum status measure_scene(const char *name, const struct spec *specs, int count, struct scene *scene,
                                 struct measurement *rows, struct reason *reasons, int *row_count)
{
    int first = *row_count;
    struct session session;
    enum status status = scene_load(name, data_path(DATA_SCENES), scene);
    if (status == STATUS_OK)
        status = session_open(scene, &session);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < count; k++) {
        int n = *row_count;
        baseline_row(&session, &specs[k], reasons[n].text, sizeof reasons[n].text, &rows[n]);
        *row_count += !adds_nothing(&rows[n], rows + first, n - first);
    }
    session_close(&session);
    return status;
}

enum status baseline_accept(const struct algorithm *algorithm, const struct measurement *rows, int count)
{
    const struct measurement *refused = NULL;
    bool imaged = false;
    for (int k = 0; k < count; k++) {
        const struct measurement *row = &rows[k];
        if (strcmp(row->algorithm, algorithm->name) != 0)
            continue;
        const bool ok = strcmp(row->status, "ok") == 0;
        if (strcmp(row->status, "failed") == 0)
            return status_set(STATUS_FAILED, "no baseline: %s on %s failed: %s", row->algorithm, row->scene,
                              row->reason);
        if (ok && !(algorithm->traits & TRAIT_AREA) && !(row->error <= BASELINE_ERROR))
            return status_set(STATUS_FAILED,
                              "no baseline: %s:%s in %s has an error of %.3g on %s, must be at most %g: it images "
                              "something else",
                              row->algorithm, row->options, row->precision, row->error, row->scene, BASELINE_ERROR);
        imaged = imaged || ok;
        refused = ok || refused ? refused : row;
    }
    if (imaged)
        return STATUS_OK;
    return status_set(STATUS_FAILED,
                      "no baseline: %s images no scene of scenes/gate (%s: %s); add one that it images to that folder",
                      algorithm->name, refused ? refused->scene : "none", refused ? refused->reason : "no row");
}

/* Measure the scenes [count] with all specs, and write the file. */
static enum status gate_write(const char *path, char **names, int scene_count, const struct spec *specs, int count)
{
    const size_t most = (size_t)scene_count * (size_t)count;
    struct scene *scenes = calloc((size_t)scene_count + 1, sizeof *scenes);
    struct content *hashes = calloc((size_t)scene_count + 1, sizeof *hashes);
    struct measurement *rows = calloc(most + 1, sizeof *rows);
    struct reason *reasons = calloc(most + 1, sizeof *reasons);
    int row_count = 0;
    enum status status = STATUS_OK;
    if (!scenes || !hashes || !rows || !reasons)
        status = status_set(STATUS_FAILED, "no memory for %zu rows", most);
    for (int k = 0; k < scene_count && status == STATUS_OK; k++) {
        progress_line(false, "[%d/%d] %s", k + 1, scene_count, names[k]);
        status = measure_scene(names[k], specs, count, &scenes[k], rows, reasons, &row_count);
        hashes[k] = content_scene(scenes[k].name, scenes[k].hash);
    }
    progress_line_clear();
    for (int k = 0; algorithms[k] && status == STATUS_OK; k++)
        status = baseline_accept(algorithms[k], rows, row_count);
    if (status == STATUS_OK)
        status = measurements_write(path, "baseline: quality and work, no seconds; made by ./sasbench baseline", hashes,
                                    scene_count, rows, row_count);
    for (int k = 0; k < scene_count && scenes; k++)
        scene_free(&scenes[k]);
    free(scenes);
    free(hashes);
    free(rows);
    free(reasons);
    return status;
}

enum status baseline_write(const char *path)
{
    struct spec *specs;
    char **names = NULL;
    int count, name_count = 0, first = 0, last, lock = -1;
    enum status status = specs_make(&specs, &count);
    if (status == STATUS_OK)
        status = scene_names(data_path(DATA_SCENES), &names, &name_count);
    if (status == STATUS_OK)
        status = folder_take_around(path, &lock);
    while (first < name_count && strncmp(names[first], GATE, strlen(GATE)) != 0)
        first++;
    for (last = first; last < name_count && strncmp(names[last], GATE, strlen(GATE)) == 0;)
        last++;
    if (status == STATUS_OK)
        status = gate_write(path, names + first, last - first, specs, count);
    folder_leave(lock);
    scene_names_free(names, name_count);
    specs_free(specs, count);
    return status;
}
