/* The forecast of omega-k (wk.h): range migration's, of a lone receiver at the transmitter, with the interpolations of
   turned axes, and counts for its time. */
#include <math.h>

#include "backprojection/traces.h"
#include "common/fft_length.h"
#include "common/kaiser.h"
#include "range_migration/rma_conditions.h"
#include "wavenumber/wk_engine.h"

/* Padded less, the error by the record's ends depends on the targets' places: no law. */
static const double PADDED_LEAST = 1.25;
/* Error of interpolation beyond the band's edges, where records are transformed with the lesser oversampling: measured,
   1e-4 to 8e-4. */
static const double EDGES = 8e-4;
static const double EDGE_BINS = 1; /* at either end of the band, that are interpolated from zeros beyond: measured */
/* Rounding, relative L2: of the transforms. */
static const double ROUNDING[] = {1e-6, 1e-13};

/* Without a window, or with weights, there is no law. Else of all interpolations of the spectrum, and of the image
   where it is resampled along both its axes. */
static double interpolations_error(const struct wk *wk)
{
    const double padded = (double)wk->azimuth_length / wk->pings;
    if (wk->options.window || wk->options.weighting)
        return INFINITY;
    double squares = pow(kaiser_error(wk->taps, wk->oversampling), 2);
    if (wk->oversampling < WK_OVERSAMPLING)
        squares += EDGES * EDGES;
    if (wk->angle != 0)
        squares += padded < PADDED_LEAST ? INFINITY : pow(kaiser_error(wk->taps, padded), 2);
    for (int k = 0; k < wk->patch_count; k++)
        if (wk->patches[k].resampled)
            return sqrt(squares + 2 * pow(kaiser_error(wk->taps, WK_OVERSAMPLING), 2));
    return sqrt(squares);
}

static enum status spectrum_error(const struct wk *wk, double *error)
{
    struct straight_track track;
    acquisition_is_straight(wk->problem.acquisition, &track); /* as wk_conditions requires */
    struct rma_view view = wk_view_of(&wk->problem, &track);
    double lost;
    view.slope = wk->slope;
    enum status status = wk_period(wk, &view.period);
    if (status == STATUS_OK)
        status = rma_band_lost(&view, EDGE_BINS / wk->range_length, &lost);
    if (status != STATUS_OK)
        return status;
    const double azimuth = prediction_error(&view);
    if (isnan(azimuth))
        return status_set(STATUS_FAILED, "%s: no memory to forecast the image's error", wk->method.name);
    const bool whole = wk->problem.acquisition->bandwidth < wk->problem.acquisition->fs; /* else fs/2 has no law */
    *error = whole ? hypot(azimuth, sqrt(lost)) : INFINITY;
    return STATUS_OK;
}

enum status wk_errors(const struct problem *problem, const void *method, const void *options, struct forecast *forecast)
{
    struct wk *wk = NULL;
    enum status status = wk_conditions_check(problem, method);
    if (status == STATUS_OK)
        status = wk_lay_out(problem, method, options, &wk);
    if (status == STATUS_OK)
        status = spectrum_error(wk, &forecast->error[CAUSE_SPECTRUM]);
    wk_destroy(wk);
    return status;
}

/* Cost of a bin, in bins that range migration focuses, measured: rotation, without taps and for each tap; Stolt
   interpolation of up to eight taps, which take one vector, and of more; the transform onto rows. */
static const double ROTATED = 0.3, ROTATED_TAP = 1.0 / 12, STOLT[] = {1.9, 2.6}, FOCUSED = 0.55;

/* In range migration's measures: values along the pings, and bins that are focused. */
static void cost_fill(const struct wk *wk, double cost[MIGRATIONS])
{
    const double lines = wk->lines;
    cost[MIGRATION_RECORDS] = wk->work.flops + wk->pings * (fft_flops(wk->range_length) + 4.0 * wk->samples);
    cost[MIGRATION_SPREAD] = (double)wk->azimuth_length * wk->row;
    if (wk->angle != 0)
        cost[MIGRATION_FOCUS] += lines * wk->band * (ROTATED + ROTATED_TAP * wk->taps);
    for (int k = 0; k < wk->patch_count; k++) {
        const struct wk_patch *patch = &wk->patches[k];
        const double rows = patch->own.r_count, transforms = patch->folds ? 1 : 2;
        cost[MIGRATION_FOCUS] += wk_stolt_cells(wk, patch) * STOLT[wk->taps > 8] + lines * patch->length * FOCUSED;
        cost[MIGRATION_FOCUS] += rows * patch->columns * transforms;
        if (patch->resampled)
            cost[MIGRATION_FOCUS] += (double)grid_pixels(&patch->grid) * wk->taps;
    }
}

enum status wk_cost(const struct problem *problem, const void *method, const void *options, struct forecast *forecast)
{
    const struct acquisition *a = problem->acquisition;
    const struct traces_form form = {.upsample = 1};
    struct wk *wk = NULL;
    double sums = 0;
    enum status status = wk_requirements_check(problem, method);
    *forecast = (struct forecast){.sums_pairs = false};
    if (status == STATUS_OK)
        status = wk_lay_out(problem, method, options, &wk);
    if (status != STATUS_OK)
        return status;
    if (!a->compressed)
        wk->work.flops += wk->pings * traces_float.flops(a, &form, &sums);
    cost_fill(wk, forecast->migration);
    wk_count(wk);
    forecast->error[CAUSE_STOLT] = interpolations_error(wk);
    forecast->error[CAUSE_FLOAT] = ROUNDING[problem->precision];
    forecast->migration_flops = wk->work.flops;
    wk_destroy(wk);
    return STATUS_OK;
}
