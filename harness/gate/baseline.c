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

static const char *const scene_list[] = {"gate/points", "gate/field", "gate/blocks", "gate/squint"};
enum { SCENES = sizeof scene_list / sizeof *scene_list };

/* Beside every algorithm as it is by default, in both precisions. */
static const char *const settings[] = {
    "bp_nearest:engine=general",
    "bp_nearest:engine=general,precision=double",
    "bp_linear:beta=2",
    "bp_linear:preemphasis=on",
    "bp_linear:engine=general",
    "bp_linear:engine=general,precision=double",
    "bp_sinc:taps=4,engine=general",
    "bp_sinc:taps=16,window=kaiser",
    "bp_sinc:taps=16,window=kaiser,precision=double",
    "bp_sinc:taps=16,window=kaiser,engine=general",
    "bp_sinc:taps=16,window=kaiser,engine=general,precision=double",
    "bp_zeropad:factor=3",
    "bp_zeropad:factor=3,engine=general",
    "bp_farrow:degree=3",
    "bp_farrow:degree=6,factor=2,precision=double",
    "bp_farrow:degree=5,engine=general",
    "bp_farrow:degree=5,engine=general,precision=double",
    "bp_fitted:taps=6,factor=2,precision=double",
    "bp_fitted:taps=6,factor=2,engine=general",
    "bp_factorised:stages=1,base=4",
    "bp_factorised:stages=2,base=2,factor=4,error=1e-3",
    "bp_factorised:stages=2,base=2,factor=4,error=1e-3,precision=double",
    "rma_lbf:variant=printed",
    "rma_lbf:blocks=16",
    "rma_lbf:blocks=16,spacing=uniform",
    "rma_lbf:blocks=16,blend=off",
    "rma_lbf:stolt=4",
    "rma_pca:blocks=16",
    "rma_wu:blocks=16",
    "rma_numeric:blocks=16,stolt=16",
    "rma_numeric:blocks=16,stolt=16,precision=double",
    "rma_delay:terms=1",
    "rma_delay:taps=24,terms=3,stolt=16,precision=double",
    "wk_classic:unfold=stuff",
    "wk_classic:unfold=baseband",
    "wk_classic:taps=16,precision=double",
    "wk_squint:taps=16,pad=2,precision=double",
    "wk_squint:pad=1",
    "wk_polar:subapertures=1",
    "wk_polar:subapertures=1,curvature=on,precision=double",
};
enum { SETTINGS = sizeof settings / sizeof *settings };

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

/* Every algorithm in both precisions, then the settings above. */
static enum status specs_make(struct spec **specs, int *count)
{
    int most = SETTINGS;
    for (int k = 0; algorithms[k]; k++)
        most += 2;
    *count = 0;
    *specs = calloc((size_t)most, sizeof **specs);
    if (!*specs)
        return status_set(STATUS_FAILED, "no memory for %d settings", most);
    enum status status = STATUS_OK;
    for (int k = 0; k < most && status == STATUS_OK; k++) {
        char text[120];
        if (k < most - SETTINGS)
            snprintf(text, sizeof text, "%s:precision=%s", algorithms[k / 2]->name, k % 2 ? "double" : "float");
        else
            snprintf(text, sizeof text, "%s", settings[k - (most - SETTINGS)]);
        status = spec_parse(text, &(*specs)[k]);
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
    enum status status = scene_load(name, SCENE_DIRECTORY, scene);
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

enum status baseline_write(const char *path)
{
    struct scene scenes[SCENES] = {0};
    struct content hashes[SCENES];
    struct spec *specs;
    int count, row_count = 0;
    int lock = -1;
    enum status status = specs_make(&specs, &count);
    struct measurement *rows = calloc(SCENES * (size_t)count + 1, sizeof *rows);
    struct reason *reasons = calloc(SCENES * (size_t)count + 1, sizeof *reasons);
    if (status == STATUS_OK && (!rows || !reasons))
        status = status_set(STATUS_FAILED, "no memory for %d rows", SCENES * count);
    if (status == STATUS_OK)
        status = folder_take_around(path, &lock);
    for (int k = 0; k < SCENES && status == STATUS_OK; k++) {
        progress_line(false, "[%d/%d] %s", k + 1, SCENES, scene_list[k]);
        status = measure_scene(scene_list[k], specs, count, &scenes[k], rows, reasons, &row_count);
        hashes[k] = content_scene(scenes[k].name, scenes[k].hash);
    }
    progress_line_clear();
    if (status == STATUS_OK)
        status = measurements_write(path, "baseline: quality and work, no seconds; made by ./sasbench baseline", hashes,
                                    SCENES, rows, row_count);
    folder_leave(lock);
    free(rows);
    free(reasons);
    specs_free(specs, count);
    for (int k = 0; k < SCENES; k++)
        scene_free(&scenes[k]);
    return status;
}
