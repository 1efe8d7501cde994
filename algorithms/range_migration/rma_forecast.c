/* The forecast of range migration (rma_cost and rma_errors in rma_conditions.h): estimates of an image's error, where
   its conditions refuse by bounds, and counts for its time. The error by the terms of delay compensation is their
   bound. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/fft_length.h"
#include "common/pulse_band.h"
#include "common/kaiser.h"
#include "range_migration/rma_engine.h"

static const int stolt_taps[] = {4, 6, 8, 12, 16}; /* of rma_stolt_names */
static const double STOLT_SHARE = 4;               /* of kaiser_error: measured */
/* rad, root mean square over a block, for each rad at its ends: a lone block is used up to 1/(4 pi); several that blend
   have less (docs/range_migration.md). */
static const double BLOCK_SHARE = 0.08;
static const double TERMS_SHARE = 1.2; /* of the terms' error, which is larger at targets than in the mean: measured */
static const double PULSE_PERIODS = 8; /* of B: of a record beside its rows (rma_layout.c) */
static const double PULSE_SHARE = 1.0 / 16; /* of that, where the pulse's own spectrum reaches so far */
static const double EDGE_BINS = 4;  /* of a record's transform that are wrong at half the sampling rate: measured */
static const double TAPERED = 0.06; /* of that error, where tapered ends exclude half the sampling rate: measured */
/* Rounding, relative L2: of the transforms. */
static const double ROUNDING[] = {1e-6, 1e-13};

/* The part of the band that range migration keeps. */
struct band {
    double half;  /* cycles a sample */
    double lost;  /* energy, relative: beyond it, or at half the sampling rate */
    double share; /* of the sampling rate: of the compressed records */
};

/* Energy density at half the sampling rate over that of the band, by the records' ends: a cut D samples beside an echo
   is a step of 1/(sqrt 2 pi D B/fs) of it, whose spectrum has half of that there. */
static double density_of_ends(const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    double before = INFINITY, after = INFINITY;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        const double last = g->r_first + (g->r_count - 1) * g->r_step;
        const double delay = 2 / cos(a->echo_squint - g->angle_rad) / a->sound_speed; /* s/m: along the beam's axis */
        before = fmin(before, (g->r_first * delay - a->t0[0]) * a->fs);
        after = fmin(after, a->samples - 1 - (last * delay - a->t0[0]) * a->fs);
    }
    return (pow(fmax(before, 1), -2) + pow(fmax(after, 1), -2)) / (8 * M_PI * M_PI);
}

/* Raw echoes keep the pulse's band. Range migration keeps more: the smear by tapers, where the first row lets the
   records be cut, and the reach of Stolt interpolation, where only samples have anything. */
static enum status raw_band(const struct rma_view *view, double edge, struct band *band, double *density)
{
    const struct problem *problem = view->problem;
    const struct acquisition *a = problem->acquisition;
    const double pulse = PULSE_PERIODS * a->fs / a->bandwidth, taper = rma_taper(a), cells = image_cells(problem);
    const int length = fft_length_fast((long long)a->samples + a->pulse_length);
    struct pulse_band found;
    double nearest = INFINITY, total = 0, outside = 0;
    double *energy = pulse_energy(a, length);
    enum status status = energy ? pulse_band_find(a, length, &found) : STATUS_FAILED;
    for (int k = 0; k < problem->patch_count; k++)
        nearest = fmin(nearest, problem->patches[k].r_first);
    if (status == STATUS_OK) {
        band->half = found.half_hz / a->fs;
        band->share = rma_share(a, view->method, found.half_hz);
        if (view->period == 0 && (2 * nearest / a->sound_speed - a->t0[0]) * a->fs > fmax(2 * taper, pulse))
            band->half += 2 / taper;
        if (view->method->terms > 0)
            band->half += RMA_GUARD / (a->samples + 2 * pulse);
        band->half = fmin(band->half, band->share / 2);
        for (int k = 0; k < length; k++) {
            energy[k] *= image_gain(a, cells, pulse_bin_frequency(a, k, length));
            total += energy[k];
            outside += fmin(k, length - k) > (band->half - edge) * length ? energy[k] : 0;
        }
        band->lost = outside / total;
        *density += PULSE_SHARE * energy[length / 2] / (total / length) * a->bandwidth / a->fs;
    }
    free(energy);
    return status;
}

static enum status band_of(const struct rma_view *view, double edge, struct band *band)
{
    const struct acquisition *a = view->problem->acquisition;
    const double cut = density_of_ends(view->problem);
    double density = cut;
    *band = (struct band){fmin(fmax(a->bandwidth / a->fs, 32.0 / a->samples), 0.5), 0, 1};
    enum status status = a->compressed ? STATUS_OK : raw_band(view, edge, band, &density);
    const double ends = EDGE_BINS * density / (a->samples * a->bandwidth / a->fs + 2 * PULSE_PERIODS);
    band->lost += band->half >= 0.5 ? ends : pow(TAPERED, 2) * ends;
    band->lost += a->noise; /* noise also comes from beyond the wavenumbers and the band kept */
    if (view->period > 0)   /* no tapers: all energy of the cuts beyond the band */
        band->lost += cut * (1 - 2 * (band->half - edge)) * a->fs / a->bandwidth;
    return status;
}

enum status rma_band_lost(const struct rma_view *view, double edge, double *lost)
{
    struct band band;
    const enum status status = band_of(view, edge, &band);
    *lost = band.lost;
    return status;
}

/* ---- cost ---- */

/* The share of a swath's wavenumbers that rma_line keeps, by a sample of them. */
static double share_kept(const struct rma *rma, const struct rma_swath *swath)
{
    enum { LOOKED_AT = 500 };
    const int step = swath->wavenumbers / LOOKED_AT + 1;
    int kept = 0, count = 0;
    for (int q = 0; q < swath->wavenumbers; q += step, count++)
        kept += rma_line(rma, swath, q).begin < swath->band;
    return (double)kept / count;
}

/* FLOPs of a receiver's bin, 8 for a block's product, with a recurrence for each: so many operations as convert.c
   has. */
static double blocks_cost(const struct rma_swath *swath)
{
    const double alone = 12, shared = 26, block = 3; /* operations on vectors */
    double operations = swath->even ? 0 : alone * swath->needed;
    for (int n = 0; swath->even && n < swath->needed; n += rma_blocks_together(swath->needed - n))
        operations += shared;
    return 8 / alone * (operations + (swath->even ? block * swath->needed : 0));
}

static void swath_cost(const struct rma *rma, const struct rma_swath *swath, double cost[MIGRATIONS])
{
    const double receivers = rma->receivers, length = swath->length,
                 sums = rma->options.sum == RMA_SUM_AFTER ? receivers : 1;
    const double all = swath->wavenumbers, kept = all * share_kept(rma, swath);
    cost[MIGRATION_SPREAD] += all * swath->row;
    cost[MIGRATION_FOCUS] += kept * swath->stolt_length;
    if (rma->delay) {
        cost[MIGRATION_RECORDS] += receivers * rma->pings * swath->held * (8.0 * rma->delay->taps.taps + 10);
        cost[MIGRATION_TERMS] += kept / receivers * swath->held * rma_fold_flops(rma);
    } else {
        cost[MIGRATION_RECORDS] += receivers * rma->pings * fft_flops(length);
        cost[MIGRATION_BLOCKS] += rma->converts ? kept * receivers * swath->band * blocks_cost(swath) : 0;
        cost[MIGRATION_FOCUS] += kept * swath->needed * sums * length;
    }
    /* FLOPs of a value in a transform: half of a value's time, without a spectrum to split for the interpolation. */
    const double of_value = fft_flops(swath->stolt_length) / swath->stolt_length;
    for (int k = 0; k < swath->patch_count; k++) {
        const struct rma_patch *patch = &swath->patches[k];
        const double rows = patch->grid.r_count;
        cost[MIGRATION_FOCUS] += rma->method.chirps ? all * chirp_flops(rma, swath, patch) / of_value / 2
                                                    : kept * patch->length * (1 + rma->taps / 8.0);
        cost[MIGRATION_FOCUS] += rows * patch->columns;
    }
}

/* The error of the conversion by the settings: blocks or terms, taps. */
static enum status settings_errors(const struct problem *problem, const struct rma_method *method,
                                   const struct rma_options *options, double error[CAUSES])
{
    struct band band;
    struct straight_track track;
    acquisition_is_straight(problem->acquisition, &track);
    const struct rma_view view = rma_view_of(problem, method, &track);
    const bool terms = method->terms > 0 && view.converts;
    enum status status = band_of(&view, 0, &band);
    if (status != STATUS_OK)
        return status;
    error[CAUSE_DELAYS] = terms ? delay_taps_expected(&view, band.share, method->taps, band.half) : 0;
    /* Blocks with a given number, or with hard edges, have no law. */
    const bool lawless = options->blocks || !options->blend; /* not of terms */
    error[CAUSE_BLOCKS] = terms            ? TERMS_SHARE * delay_terms_left(&view, method->terms)
                          : !view.converts ? 0
                          : lawless        ? INFINITY
                                           : BLOCK_SHARE * options->limit;
    error[CAUSE_STOLT] =
        method->chirps ? options->limit : STOLT_SHARE * kaiser_error(stolt_taps[options->stolt], RMA_OVERSAMPLING);
    error[CAUSE_FLOAT] = ROUNDING[problem->precision];
    return isnan(error[CAUSE_DELAYS]) || isnan(error[CAUSE_BLOCKS])
               ? status_set(STATUS_FAILED, "%s: no memory to forecast the image's error", method->name)
               : STATUS_OK;
}

enum status rma_cost(const struct problem *problem, const void *given, const void *options, struct forecast *forecast)
{
    const struct rma_method method = rma_choose(given, options);
    struct rma *rma = NULL;
    enum status status = rma_requirements_check(problem, method.name);
    *forecast = (struct forecast){.sums_pairs = false};
    if (status == STATUS_OK)
        status = settings_errors(problem, &method, options, forecast->error);
    if (status == STATUS_OK)
        status = rma_count(problem, &method, options, &rma);
    if (status != STATUS_OK)
        return status;
    forecast->migration_flops = rma->work.flops;
    forecast->migration[MIGRATION_RECORDS] = rma_compression_flops(rma);
    for (const struct rma_swath *s = rma->swaths; s < rma->swaths + rma->swath_count; s++)
        swath_cost(rma, s, forecast->migration);
    rma_destroy(rma);
    return STATUS_OK;
}

enum status rma_errors(const struct problem *problem, const void *given, const void *options, struct forecast *forecast)
{
    const struct rma_method method = rma_choose(given, options);
    struct condition list[CONDITIONS_MAX];
    struct straight_track track;
    struct band band;
    const int count = rma_conditions(problem, given, options, list, CONDITIONS_MAX);
    enum status status = rma_conditions_check(method.name, list, count);
    if (status != STATUS_OK)
        return status;
    acquisition_is_straight(problem->acquisition, &track);
    const struct rma_view view = rma_view_of(problem, &method, &track);
    status = band_of(&view, 0, &band);
    /* No law at B = fs: the bin at fs/2 is both ends of the band. */
    forecast->error[CAUSE_SPECTRUM] =
        problem->acquisition->bandwidth < problem->acquisition->fs ? sqrt(band.lost) : INFINITY;
    for (int k = 0; k < count; k++)
        if (strcmp(list[k].name, "predicted_error") == 0)
            forecast->error[CAUSE_SPECTRUM] = hypot(forecast->error[CAUSE_SPECTRUM], list[k].value);
    return status;
}
