/* Shared objects as algorithms: sasbench.h on their side, struct algorithm on ours. */
#include <math.h>
#include <omp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/pairs/pairs.h"
#include "backprojection/traces.h"
#include "contract/delay.h"
#include "contract/param.h"
#include "echoes/echo_data.h"
#include "guests/plugin.h"
#include "guests/shown.h"

/* A plan: what they see of the problem, and what the host's functions need. */
struct plugin_plan {
    struct sas_problem shown; /* first: the host's functions get its address */
    const struct plugin *plugin;
    void *theirs;
    struct problem problem;
    struct sas_acquisition acquisition;
    struct sas_acquisition out;      /* of a filter */
    struct sas_grid *grids;          /* [patch_count] */
    const struct sas_grid **patches; /* [patch_count] into them */
    double numbers[SETTINGS_MOST];
    const char *texts[SETTINGS_MOST];
    void *options;         /* a copy; texts point into it */
    struct traces *traces; /* of raw echoes */
    struct traces_shape shape;
    double bytes;
};

static const struct plugin_plan *plan_of(const struct sas_problem *shown)
{
    return (const struct plugin_plan *)shown;
}

/* ---- the host's functions ---- */

/* The patch of a pixel, whose number then counts within it. */
static int patch_of(const struct problem *problem, int64_t *pixel)
{
    int k = 0;
    for (; k < problem->patch_count - 1; k++) {
        const int64_t count = (int64_t)problem->patches[k].x_count * problem->patches[k].r_count;
        if (*pixel < count)
            break;
        *pixel -= count;
    }
    return k;
}

static struct vector place_of(const struct problem *problem, int64_t pixel)
{
    const struct grid *grid = &problem->patches[patch_of(problem, &pixel)];
    return grid_point(grid, (double)(pixel / grid->x_count), (double)(pixel % grid->x_count));
}

static void host_place(const struct sas_problem *shown, int64_t pixel, double place_m[3])
{
    const struct vector place = place_of(&plan_of(shown)->problem, pixel);
    memcpy(place_m, &place, sizeof place);
}

static int host_pair(const struct sas_problem *shown, int32_t record, int64_t pixel, double *delay_s, double *q)
{
    const struct problem *problem = &plan_of(shown)->problem;
    const struct acquisition *a = problem->acquisition;
    const int ping = record / a->receivers;
    const struct vector place = place_of(problem, pixel);
    const struct pixel_line line = {place.x, place.y, 1, 0, 1};
    struct pair_span spans[2];
    *delay_s = delay_exact(a->tx[ping], a->rx[record], a->velocity[ping], place, a->sound_speed);
    *q = (*delay_s - a->t0[ping]) * a->fs;
    return *q >= 0 && *q <= a->samples - 1
           && (!(a->aperture_limit < 1) || pair_spans(a, ping, acquisition_normal(a, ping), &line, spans) > 0);
}

static double host_pairs(const struct sas_problem *shown)
{
    return pairs_count(&plan_of(shown)->problem);
}

/* In float, a row's values first stand side by side at its beginning. */
static void host_compress(const struct sas_problem *shown, int thread, const void *samples, int32_t record, void *row)
{
    const struct plugin_plan *plan = plan_of(shown);
    const enum precision precision = plan->problem.precision;
    const size_t count = (size_t)plan->acquisition.samples, size = precision_size(precision);
    const void *from = (const char *)samples + (size_t)record * count * size;
    float complex *single = row;
    double complex *both = row;
    if (plan->traces)
        traces_of(precision)->fill(plan->traces, thread, from, row);
    else
        memcpy(row, from, count * size);
    for (size_t n = count; precision == PRECISION_FLOAT && n-- > 0;)
        both[n] = single[n];
}

static double host_compress_flops(const struct sas_problem *shown)
{
    const struct plugin_plan *plan = plan_of(shown);
    return plan->shape.flops * plan->acquisition.pings * plan->acquisition.receivers;
}

static void host_store(const struct sas_problem *shown, void *const *pixels, int64_t pixel, double re, double im)
{
    const struct problem *problem = &plan_of(shown)->problem;
    const int patch = patch_of(problem, &pixel);
    if (problem->precision == PRECISION_DOUBLE)
        ((double complex *)pixels[patch])[pixel] = re + im * I;
    else
        ((float complex *)pixels[patch])[pixel] = (float complex)(re + im * I);
}

static int host_fail(int status, const char *format, ...)
{
    char text[900];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return *text ? (int)status_set((enum status)status, "%s", text) : status;
}

static void host_stage(void *run, const char *name)
{
    stages_end(run, name);
}

static const struct sas_host host = {sizeof host,         SAS_ABI,    host_pair,  host_place, host_pairs, host_compress,
                                     host_compress_flops, host_store, host_stage, host_fail};

/* ---- struct algorithm ---- */

/* What one of their functions returned: with the name ahead of its reason. */
static enum status returned(const struct plugin *plugin, const char *function, int status)
{
    if (status == SAS_OK)
        return STATUS_OK;
    if (status < SAS_OK || status > SAS_UNSUPPORTED)
        return status_set(STATUS_FAILED, "%s: its %s returned status %d, must be 0 to 3", plugin->name, function,
                          status);
    return status_set((enum status)status, "%s: %s", plugin->name, status_message());
}

/* Ahead of a call that may fail: what is printed if it has no message. */
static void reason_clear(const char *function)
{
    status_set(STATUS_FAILED, "its %s failed without a reason", function);
}

static void plan_free(struct plugin_plan *plan)
{
    if (plan && plan->traces)
        traces_of(plan->problem.precision)->destroy(plan->traces);
    if (plan) {
        free(plan->grids);
        free(plan->patches);
        free(plan->options);
    }
    free(plan);
}

static void settings_show(struct plugin_plan *plan, const void *options, size_t size)
{
    const struct plugin *plugin = plan->plugin;
    memcpy(plan->options, options, size);
    for (uint32_t k = 0; k < plugin->theirs.setting_count; k++) {
        const struct param *param = &plugin->params[k];
        if (param->type == PARAM_TEXT)
            plan->texts[k] = (const char *)plan->options + param->offset;
        else
            plan->numbers[k] = param_load(param, plan->options);
    }
}

static void problem_show(struct plugin_plan *plan)
{
    plan->acquisition = acquisition_show(plan->problem.acquisition);
    for (int k = 0; k < plan->problem.patch_count; k++) {
        plan->grids[k] = grid_show(&plan->problem.patches[k]);
        plan->patches[k] = &plan->grids[k];
    }
    plan->shown = (struct sas_problem){sizeof plan->shown,
                                       plan->problem.precision == PRECISION_DOUBLE ? SAS_DOUBLE : SAS_FLOAT,
                                       &plan->acquisition,
                                       (int64_t)problem_pixels(&plan->problem),
                                       plan->problem.patch_count,
                                       omp_get_max_threads(),
                                       plan->patches,
                                       plan->numbers,
                                       plan->texts,
                                       &host};
}

enum status plugin_plan(const struct problem *problem, const void *method, const void *options, void **out)
{
    const struct plugin *plugin = method;
    const size_t patches = (size_t)problem->patch_count, size = plugin->theirs.setting_count * (8 + TEXT_SIZE) + 1;
    const struct acquisition *a = problem->acquisition;
    struct plugin_plan *plan = calloc(1, sizeof *plan);
    *out = NULL;
    if (plan) {
        *plan = (struct plugin_plan){.plugin = plugin, .problem = *problem};
        plan->grids = calloc(patches, sizeof *plan->grids);
        plan->patches = calloc(patches, sizeof(void *));
        plan->options = calloc(1, size);
    }
    enum status status = STATUS_OK;
    if (!plan || !plan->grids || !plan->patches || !plan->options)
        status = status_set(STATUS_FAILED, "%s: no memory for a plan", plugin->name);
    if (status == STATUS_OK && !a->compressed)
        status =
            traces_of(problem->precision)
                ->plan(a, &(struct traces_form){.upsample = 1}, omp_get_max_threads(), &plan->shape, &plan->traces);
    if (status == STATUS_OK) {
        plan->bytes =
            (double)(sizeof *plan + patches * (sizeof *plan->grids + sizeof(void *)) + size) + plan->shape.bytes;
        if (options)
            settings_show(plan, options, size - 1);
        problem_show(plan);
        reason_clear("plan");
        plan->out = plan->acquisition;
        status = returned(plugin, "plan",
                          plugin->filter.plan ? plugin->filter.plan(&plan->shown, &plan->out, &plan->theirs)
                                              : plugin->theirs.plan(&plan->shown, &plan->theirs));
    }
    if (status == STATUS_OK)
        *out = plan;
    else
        plan_free(plan);
    return status;
}

enum status plugin_execute(void *data, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    const struct plugin_plan *plan = data;
    reason_clear("execute");
    return returned(plan->plugin, "execute",
                    plan->plugin->theirs.execute(plan->theirs, echoes->samples, image->pixels, stages));
}

enum status plugin_filter(void *data, const void *samples, void *filtered, struct stages *stages)
{
    const struct plugin_plan *plan = data;
    reason_clear("execute");
    return returned(plan->plugin, "execute", plan->plugin->filter.execute(plan->theirs, samples, filtered, stages));
}

enum status plugin_filtered(const void *data, struct acquisition *out)
{
    const struct plugin_plan *plan = data;
    *out = *plan->problem.acquisition;
    out->pri = plan->out.pings == out->pings ? out->pri : 0;
    return acquisition_take(plan->plugin->name, &plan->out, out) == STATUS_OK
               ? STATUS_OK
               : status_set(STATUS_FAILED, "its echoes are refused: %s", status_message());
}

struct work plugin_work(const void *data)
{
    const struct plugin_plan *plan = data;
    struct sas_work theirs = {.size = sizeof theirs};
    plan->plugin->theirs.work(plan->theirs, &theirs);
    struct work work = {.flops = theirs.flops, .pairs = fmax(theirs.pairs, 0)}; /* no NAN: only other guests leave it */
    work.bytes = theirs.bytes + plan->bytes;
    snprintf(work.engine, sizeof work.engine, "%.*s", (int)sizeof theirs.engine,
             *theirs.engine ? theirs.engine : "plug-in");
    snprintf(work.skipped, sizeof work.skipped, "%.*s", (int)sizeof theirs.skipped, theirs.skipped);
    return work;
}

void plugin_destroy(void *data)
{
    struct plugin_plan *plan = data;
    if (plan)
        plan->plugin->theirs.destroy(plan->theirs);
    plan_free(plan);
}
