/* Range migration of multi-receiver echoes (rma.h): the order of work, and its count. One thread works on each azimuth
   wavenumber, receivers in order, so that the bits do not depend on the number of threads. */
#include "range_migration/rma.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/clock.h"
#include "common/fft_length.h"
#include "common/progress.h"
#include "range_migration/rma_engine.h"

static const char *const variants[] = {"printed", "corrected", NULL}, *const spacings[] = {"uniform", "inverse", NULL},
                         *const blends[] = {"off", "on", NULL}, *const orders[] = {"before", "after", NULL},
                         *const phases[] = {"recurrence", "libm", NULL};
const char *const rma_stolt_names[] = {"4", "6", "8", "12", "16", NULL};
const char *const rma_delay_taps_names[] = {"8", "12", "16", "24", NULL};

const struct param rma_params[] = {
    {PARAM_NAMED(struct rma_options, variant, variants), .summary = "theta at the carrier, as printed, or at F",
     .initial = RMA_CORRECTED, .max = RMA_CORRECTED, .sweep = "printed corrected"},
    {PARAM(struct rma_options, blocks), .summary = "range blocks of the conversion; 0: as many as Eq. (13) requires",
     .initial = 0, .min = 0, .max = 4096, .sweep = "1 2 4 8 16 32"},
    {PARAM(struct rma_options, limit), .summary = "largest phase error inside a block (rad) where blocks = 0",
     .initial = 0.78539816339744831, .min = 1e-3, .max = 100, .terse = true},
    {PARAM_NAMED(struct rma_options, spacing, spacings), .summary = "blocks of equal width in r or in 1/r",
     .initial = RMA_INVERSE, .max = RMA_INVERSE, .sweep = "uniform inverse", .terse = true},
    {PARAM_NAMED(struct rma_options, blend, blends),
     .summary = "blocks blend: each row is the cubic through the nearest four", .initial = 1, .max = 1,
     .sweep = "off on", .terse = true},
    {PARAM_NAMED(struct rma_options, stolt, rma_stolt_names), .summary = "Kaiser taps of the Stolt interpolation",
     .initial = 2, .max = 4, .sweep = "4 6 8 12 16", .terse = true},
    {PARAM_NAMED(struct rma_options, sum, orders), .summary = "receivers are summed before or after the range IFFT",
     .initial = RMA_SUM_BEFORE, .max = RMA_SUM_AFTER, .terse = true, .hidden = true},
    {PARAM_NAMED(struct rma_options, phases, phases),
     .summary = "by recurrence over the receivers, or by libm for each cell", .initial = RMA_RECURRENCE,
     .max = RMA_LIBM, .terse = true, .hidden = true},
    {.name = NULL},
};

static const double WORK_LIMIT = 1e11;                      /* operations: some twenty seconds */
static const double MEMORY_LIMIT = 5e8, MEMORY_FACTOR = 50; /* bytes */

static const char *const stage_names[RMA_STAGES] = {"receivers",   "bulk",  "differential",
                                                    "reconstruct", "stolt", "focus"};

static const struct rma_transform *transform(const struct rma *rma)
{
    return rma->problem.precision == PRECISION_DOUBLE ? &rma_transform_double : &rma_transform_float;
}

/* One swath's share of the counted FLOPs, by the rule of back projection: operations on samples and pixels, 8 for a
   product added to a sum. Phases, recurrences, places and weights are not counted. */
static double swath_flops(const struct rma *rma, const struct rma_swath *swath)
{
    const double receivers = rma->receivers, band = swath->band, q = swath->wavenumbers, length = swath->length;
    const double sums = rma->options.sum == RMA_SUM_AFTER ? receivers : 1;
    const double weights = swath->needed * sums > 1 ? 4 * (rma->options.blend ? rma_nodes_blended(rma) : 1) : 0;
    double flops = q * (fft_flops(swath->stolt_length) + 2 * length);
    if (rma->delay)
        flops += receivers
                     * (rma->pings * swath->held * (8.0 * rma->delay->taps.taps + 10)
                        + swath->row * fft_flops(swath->period))
                 + (double)swath->period * swath->held * rma_fold_flops(rma);
    else
        flops += receivers * rma->pings * fft_flops(length) + receivers * band * fft_flops(swath->period)
                 + q * receivers * band * (rma->converts ? 8 : 0) * swath->needed
                 + q * sums * (swath->needed * fft_flops(length) + weights * length);
    for (int k = 0; k < swath->patch_count; k++) {
        const struct rma_patch *patch = &swath->patches[k];
        double rows = patch->grid.r_count,
               points = patch->length * patch->step * 2 * rma->fs / rma->setting.sound_speed;
        flops += q
                 * (rma->method.chirps ? chirp_flops(rma, swath, patch)
                                       : points * (4.0 * rma->taps + 8) + fft_flops(patch->length));
        flops +=
            rows
            * (patch->folds ? fft_flops(patch->columns) + 2 * q : 2 * fft_flops(patch->columns) + 6 * patch->columns);
        flops += rows * 6 * (q + patch->grid.x_count + (rma->turns_rows ? q : 0));
    }
    return flops;
}

/* LBF21 Eqs. (20) to (22): N_a x N_r the full-rate data. Eq. (20) counts one sub-block, whatever their number: each one
   more costs its products and its range transforms. */
static void count_published(struct rma *rma)
{
    const struct rma_method *method = &rma->method;
    struct work *work = &rma->work;
    double receivers = rma->receivers, na = (double)rma->pings * receivers, nr = rma->problem.acquisition->samples;
    double taps = rma->taps, range = method->range[0] * receivers + method->range[1];
    double azimuth = method->azimuth[0] * receivers + method->azimuth[1];
    double products = method->products[0] * receivers + method->products[1];
    if (!method->source)
        return;
    double paper =
        na * nr
        * (1.5 * range * log2(nr) + 1.5 * azimuth * log2(na) + products + method->interpolations * (2 * taps - 1));
    work->published[0].source = method->source;
    work->published[0].flops = paper;
    work->published[1].source = "with the factor of the range blocks";
    work->published[1].flops = paper + (rma->block_count - 1) * receivers * na * nr * (1.5 * log2(nr) + 1);
}

static enum status count_work(struct rma *rma)
{
    struct work *work = &rma->work;
    double taken = 0, bins = 0, all = 0;
    int needed = 0;
    bool *used = calloc((size_t)rma->block_count, sizeof *used), differential = false;
    if (!used)
        return status_set(STATUS_FAILED, "%s: no memory for %d blocks", rma->method.name, rma->block_count);
    work->flops = rma_compression_flops(rma);
    for (const struct rma_swath *s = rma->swaths; s < rma->swaths + rma->swath_count; s++) {
        work->flops += swath_flops(rma, s);
        taken += s->end - s->begin;
        bins += s->band;
        all += s->length;
        differential = differential || s->needed > 1;
        for (int n = 0; n < s->needed; n++)
            used[s->blocks[n]] = true;
    }
    for (int n = 0; n < rma->block_count; n++)
        needed += used[n];
    free(used);
    count_published(rma);
    if (rma->delay)
        snprintf(work->engine, sizeof work->engine, "%d terms, %d taps", rma->delay->terms.terms,
                 rma->delay->taps.taps);
    else
        snprintf(work->engine, sizeof work->engine, "%d of %d blocks", needed, rma->block_count);
    const struct {
        bool happens;
        const char *format;
        double values[2];
    } notes[] = {
        {!rma->turns_rows, "; azimuth correction: the monostatic phase is exact", {0}},
        {!rma->converts && !rma->delay, "; conversion: one receiver at the transmitter", {0}},
        {rma->converts && !rma->delay && !differential, "; differential preprocessing: one block", {0}},
        {needed < rma->block_count, "; %.0f blocks without rows", {rma->block_count - needed, 0}},
        {taken < rma->samples, "; %.0f %% of each record", {100 * (1 - taken / rma->samples)}},
        {rma->rate_up < rma->rate_down,
         "; %.0f %% of the sampling rate",
         {100 * (1 - (double)rma->rate_up / rma->rate_down)}},
        {bins < all && !rma->delay,
         "; %.0f %% of the band: %.1g of the pulse's energy",
         {100 * (1 - bins / all), rma->loss}},
    };
    size_t length = 0;
    for (size_t k = 0; k < sizeof notes / sizeof *notes; k++)
        if (notes[k].happens && length < sizeof work->skipped)
            length += (size_t)snprintf(work->skipped + length, sizeof work->skipped - length,
                                       notes[k].format + (length > 0 ? 0 : sizeof "; " - 1), notes[k].values[0],
                                       notes[k].values[1]);
    return STATUS_OK;
}

/* Scenes that back projection images in moments may take range migration hours or all memory, as its transforms do not
   shrink with a small image. They are refused before anything is allocated. */
static enum status check_work(const struct rma *rma)
{
    const double real_bytes = rma->problem.precision == PRECISION_DOUBLE ? 8 : 4, much = 1000;
    const double records = (double)rma->pings * rma->receivers;
    double pixels = 0, bytes = (double)rma->threads * (double)rma->scratch_bytes;
    for (const struct rma_swath *s = rma->swaths; s < rma->swaths + rma->swath_count; s++)
        bytes += 2 * real_bytes * ((double)s->period * rma->receivers * s->row + (double)s->rows * (double)s->columns);
    for (int k = 0; k < rma->patch_count; k++)
        pixels += (double)grid_pixels(&rma->patches[k].grid);
    double given = 2 * real_bytes * (records * rma->problem.acquisition->samples + pixels),
           direct = 16 * records * pixels;
    if (!(rma->work.flops <= fmax(WORK_LIMIT, much * direct)))
        return status_set(STATUS_UNSUPPORTED,
                          "%s: condition work: %.2g operations, %.2g times those of back projection; at "
                          "most %g of them, or %g times, are accepted (cure: back projection; coarser pixels, or pings "
                          "farther apart)",
                          rma->method.name, rma->work.flops, rma->work.flops / direct, WORK_LIMIT, much);
    if (!(bytes <= fmax(MEMORY_LIMIT, MEMORY_FACTOR * given)))
        return status_set(
            STATUS_UNSUPPORTED,
            "%s: condition memory: %.2g bytes, %.2g times those of echoes and image; at most "
            "%g of them, or %g times, are accepted (cure: back projection; coarser pixels, or pings farther "
            "apart)",
            rma->method.name, bytes, bytes / given, MEMORY_LIMIT, MEMORY_FACTOR);
    return STATUS_OK;
}

/* The pings of a window. The filter ends at one angle for all rows: rma_focused at the nearest one. A pair's middle is
   half an offset from its transmitter. */
static void stretch_find(const struct problem *problem, const struct rma_method *method, struct stretch *stretch)
{
    stretch_begin(problem, stretch);
    if (!stretch->cut)
        return;
    const struct rma_bounds bounds = rma_view_of(&stretch->problem, method, &stretch->track).bounds;
    const struct grid *g = &stretch->grid;
    const double tangent = bounds.sine / sqrt(1 - bounds.sine * bounds.sine);
    stretch_cut(stretch, (const double[2]){-tangent, tangent}, bounds.aside / 2 * (1 + rma_last_row(g) / g->r_first));
}

/* A plan laid out, and nothing more; *made is NULL on error. */
static enum status lay_out(const struct problem *problem, const struct rma_method *method,
                           const struct rma_options *options, struct rma **made)
{
    struct rma *rma = *made = calloc(1, sizeof *rma);
    if (!rma)
        return status_set(STATUS_FAILED, "no memory for the plan");
    stretch_find(problem, method, &rma->stretch);
    rma->problem = rma->stretch.problem;
    rma->method = *method;
    rma->options = *options;
    if (method->terms > 0)
        rma->options.blocks = 1;
    rma->threads = omp_get_max_threads();
    rma->work.bytes = sizeof *rma - sizeof rma->store;
    fit_nodes_fill(FIT_DEGREE + 1, rma->fit.nodes, rma->fit.powers);
    const enum status status = rma_layout(rma);
    if (status != STATUS_OK) {
        rma_destroy(rma);
        *made = NULL;
    }
    return status;
}

enum status rma_count(const struct problem *problem, const struct rma_method *method, const struct rma_options *options,
                      struct rma **counted)
{
    enum status status = lay_out(problem, method, options, counted);
    if (status == STATUS_OK)
        status = count_work(*counted);
    if (status == STATUS_OK && !problem->window) /* who asks for windows chooses their sizes */
        status = check_work(*counted);
    if (status != STATUS_OK) {
        rma_destroy(*counted);
        *counted = NULL;
    }
    return status;
}

/* The whole image decides whether a window of it is formed; of the conditions, by those that cost little. */
static enum status whole_check(const struct problem *problem, const struct rma_method *method,
                               const struct rma_options *options)
{
    struct problem whole = *problem;
    struct rma *rma;
    whole.window = NULL;
    enum status status = rma_requirements_check(&whole, method->name);
    if (status != STATUS_OK)
        return status;
    status = lay_out(&whole, method, options, &rma);
    rma_destroy(rma);
    return status;
}

static enum status check(const struct problem *problem, const void *given, const struct rma_method *method,
                         const void *options)
{
    struct condition list[CONDITIONS_MAX];
    if (problem->window)
        return whole_check(problem, method, options);
    const int count = rma_conditions(problem, given, options, list, CONDITIONS_MAX);
    return rma_conditions_check(method->name, list, count);
}

enum status rma_plan(const struct problem *problem, const void *given, const void *options, void **plan)
{
    const struct rma_method method = rma_choose(given, options);
    struct rma *rma = NULL;
    enum status status = check(problem, given, &method, options);
    *plan = NULL;
    if (status == STATUS_OK)
        status = rma_count(problem, &method, options, &rma);
    if (status == STATUS_OK && rma->delay)
        status = rma_delay_tables(rma);
    if (status == STATUS_OK)
        status = transform(rma)->plan(rma);
    if (status != STATUS_OK) {
        rma_destroy(rma);
        return status;
    }
    rma->work.bytes += rma->store.bytes;
    *plan = rma;
    return STATUS_OK;
}

/* All wavenumbers of a swath, from the receivers' spectra to focused rows. */
static void migrate(const struct rma *rma, const struct rma_swath *swath, struct stages *stages)
{
    rma_column_function *column = ISA_CHOOSE(rma_column, rma->problem.precision);
    double seconds[RMA_STAGES] = {0};
#pragma omp parallel num_threads(rma->threads) reduction(+ : seconds[:RMA_STAGES])
    {
#pragma omp for schedule(dynamic)
        for (int turn = 0; turn < swath->wavenumbers; turn += rma_turns(rma))
            if (progress_step())
                column(rma, swath, omp_get_thread_num(), turn, seconds);
    }
    stages_share(stages, RMA_STAGES, stage_names, seconds);
}

enum status rma_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    struct rma *rma = plan;
    static const char *const first_stages[RMA_SPREADS] = {"compress", "map", "spread"};
    double seconds[RMA_SPREADS];
    transform(rma)->receive(rma, ISA_CHOOSE(rma_map, rma->problem.precision),
                            stretch_samples(&rma->stretch, echoes->samples), seconds);
    stages_share(stages, RMA_SPREADS, first_stages, seconds);
    for (const struct rma_swath *swath = rma->swaths; swath < rma->swaths + rma->swath_count; swath++) {
        const double done = (double)(swath - rma->swaths) / rma->swath_count;
        progress_part(done, done + 1.0 / rma->swath_count, swath->wavenumbers / rma_turns(rma));
        migrate(rma, swath, stages);
        for (int k = 0; k < swath->patch_count; k++)
            transform(rma)->inverse(rma, swath, &swath->patches[k], image->pixels[swath->patches[k].index]);
        stages_end(stages, "inverse");
    }
    return STATUS_OK;
}

void rma_reads(const void *plan, bool *read)
{
    stretch_reads(&((const struct rma *)plan)->stretch, read);
}

struct work rma_work(const void *plan)
{
    return ((const struct rma *)plan)->work;
}

void rma_destroy(void *plan)
{
    struct rma *rma = plan;
    if (!rma)
        return;
    if (rma->delay)
        delay_terms_free(&rma->delay->terms);
    store_release(&rma->store);
    free(rma);
}
