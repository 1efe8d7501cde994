/* Omega-k imaging (wk.h): the order of work, and its count. One thread works on each line, so that the bits do not
   depend on the number of threads. */
#include "wavenumber/wk.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/clock.h"
#include "common/fft_length.h"
#include "common/progress.h"
#include "wavenumber/wk_engine.h"

const char *const wk_taps_names[] = {"4", "6", "8", "12", "16", NULL};
const char *const wk_unfold_names[] = {"stuff", "baseband", "support", NULL};

static const char *const stage_names[WK_STAGES] = {"rotate", "stolt", "focus"};

static const struct wk_transform *transform(const struct wk *wk)
{
    return wk->problem.precision == PRECISION_DOUBLE ? &wk_transform_double : &wk_transform_float;
}

double wk_stolt_cells(const struct wk *wk, const struct wk_patch *patch)
{
    const double step = 2 * M_PI / (patch->length * patch->own.r_step), half = M_PI / wk->spacing;
    const double first = wk->fc + wk->band_first * wk->fs / wk->range_length;
    const double last = first + (wk->band - 1) * wk->fs / wk->range_length;
    const double slope = 4 * M_PI / wk->sound_speed * wk->slope;
    double cells = 0;
    for (int i = 0; i < wk->lines; i++) {
        double kx = wk->kx_first + i * wk->kx_step, low = first, high = last;
        if (wk->skips && wk->angle == 0 && fabs(slope) * wk->fc > 1e-9 * half) {
            low = fmax(low, fmin((kx - half) / slope, (kx + half) / slope));
            high = fmin(high, fmax((kx - half) / slope, (kx + half) / slope));
        }
        double from = wk_ky(wk, low, kx), to = wk_ky(wk, high, kx);
        cells += isfinite(to) && high > low ? floor(to / step) - (isfinite(from) ? ceil(from / step) : 1) + 1 : 0;
    }
    return cells;
}

void wk_count(struct wk *wk)
{
    struct work *work = &wk->work;
    const double lines = wk->lines, pings = wk->pings, band = wk->band;
    work->flops += pings * (fft_flops(wk->range_length) + 4.0 * wk->samples) + band * fft_flops(wk->azimuth_length);
    if (wk->angle != 0 || wk->kx_base != 0)
        work->flops += pings * band * 6;
    if (wk->angle != 0)
        work->flops += lines * band * (4.0 * wk->taps);
    for (int k = 0; k < wk->patch_count; k++) {
        const struct wk_patch *patch = &wk->patches[k];
        double rows = patch->own.r_count, columns = patch->own.x_count;
        work->flops += wk_stolt_cells(wk, patch) * (4.0 * wk->taps + 8) + lines * fft_flops(patch->length);
        work->flops += rows
                       * (lines * 8 + columns * 8 + (patch->folds ? 1 : 2) * fft_flops(patch->columns)
                          + (patch->folds ? 0 : 6 * patch->columns));
        if (patch->resampled)
            work->flops += (double)grid_pixels(&patch->grid) * 4.0 * wk->taps * wk->taps;
    }
    const bool turned = wk->method.rotates && wk->angle == 0, unfiltered = wk->method.filters && !wk->filter;
    snprintf(work->engine, sizeof work->engine, "%s", wk->angle != 0 ? "rotated" : wk_unfold_names[wk->options.unfold]);
    snprintf(work->skipped, sizeof work->skipped, "%s%s%s", turned ? "rotation (no squint)" : "",
             turned && unfiltered ? "; " : "", unfiltered ? "filter (no target area)" : "");
}

enum status wk_lay_out(const struct problem *problem, const void *method, const void *options, struct wk **made)
{
    struct wk *wk = *made = calloc(1, sizeof *wk);
    if (!wk)
        return status_set(STATUS_FAILED, "no memory for %s", ((const struct wk_method *)method)->name);
    stretch_begin(problem, &wk->stretch);
    wk->problem = wk->stretch.problem;
    wk->method = *(const struct wk_method *)method;
    wk->options = *(const struct wk_options *)options;
    if (wk->method.rotates || wk->method.filters)
        wk->options.unfold = WK_SUPPORT;
    if (wk->method.filters)
        wk->options.pad = 1;
    const enum status status = wk_layout(wk);
    if (status != STATUS_OK) {
        wk_destroy(wk);
        *made = NULL;
    }
    return status;
}

/* The whole image decides whether a window of it is formed; of the conditions, by those that cost little. */
static enum status whole_check(const struct problem *problem, const void *method, const void *options)
{
    struct problem whole = *problem;
    struct wk *wk;
    whole.window = NULL;
    enum status status = wk_requirements_check(&whole, method);
    if (status != STATUS_OK)
        return status;
    status = wk_lay_out(&whole, method, options, &wk);
    wk_destroy(wk);
    return status;
}

enum status wk_plan(const struct problem *problem, const void *method, const void *options, void **plan)
{
    struct wk *wk = NULL;
    *plan = NULL;
    enum status status = problem->window ? whole_check(problem, method, options) : wk_conditions_check(problem, method);
    if (status == STATUS_OK)
        status = wk_lay_out(problem, method, options, &wk);
    if (status != STATUS_OK)
        return status;
    wk->threads = omp_get_max_threads();
    wk->record_loop = ISA_CHOOSE(wk_record, problem->precision);
    wk->line_loop = ISA_CHOOSE(wk_line, problem->precision);
    wk->row_loop = ISA_CHOOSE(wk_row, problem->precision);
    fit_nodes_fill(FIT_DEGREE + 1, wk->fit.nodes, wk->fit.powers);
    wk->work.bytes = sizeof *wk - sizeof wk->store + (double)problem->patch_count * sizeof *wk->patches;
    status = transform(wk)->plan(wk);
    if (status != STATUS_OK) {
        wk_destroy(wk);
        return status;
    }
    wk_count(wk);
    *plan = wk;
    return STATUS_OK;
}

static void focus_lines(const struct wk *wk, struct stages *stages)
{
    double seconds[WK_STAGES] = {0};
    progress_part(0, 1, wk->lines / WK_TILE);
#pragma omp parallel for schedule(static) num_threads(wk->threads) reduction(+ : seconds[:WK_STAGES])
    for (int first = 0; first < wk->lines; first += WK_TILE)
        if (progress_step())
            wk->line_loop(wk, omp_get_thread_num(), first, seconds);
    stages_share(stages, WK_STAGES, stage_names, seconds);
}

enum status wk_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    struct wk *wk = plan;
    const struct wk_transform *t = transform(wk);
    const void *samples = stretch_samples(&wk->stretch, echoes->samples);
    if (wk->filter) {
        t->compress(wk, samples);
        samples = wk->compressed;
        stages_end(stages, "compress");
    }
    t->range(wk, samples);
    stages_end(stages, wk->traces ? "compress" : "range");
    t->azimuth(wk);
    stages_end(stages, "azimuth");
    focus_lines(wk, stages);
    for (int k = 0; k < wk->patch_count; k++) {
        const struct wk_patch *patch = &wk->patches[k];
        t->inverse(wk, patch, patch->resampled ? patch->wide : image->pixels[k]);
        stages_end(stages, "inverse");
        if (patch->resampled) {
            t->resample(wk, patch, image->pixels[k]);
            stages_end(stages, "resample");
        }
    }
    return STATUS_OK;
}

void wk_reads(const void *plan, bool *read)
{
    stretch_reads(&((const struct wk *)plan)->stretch, read);
}

struct work wk_work(const void *plan)
{
    return ((const struct wk *)plan)->work;
}

double wk_size_factor(const void *plan)
{
    const struct wk *wk = plan;
    if (wk->angle != 0)
        return (double)wk->azimuth_length / wk->pings;
    return wk->lines * wk->kx_step * wk->spacing / (2 * M_PI);
}

void wk_destroy(void *plan)
{
    struct wk *wk = plan;
    if (!wk)
        return;
    store_release(&wk->store);
    free(wk);
}
