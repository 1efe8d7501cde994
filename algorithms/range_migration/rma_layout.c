/* The layout of a range migration for a scene (rma_engine.h): the track, the blocks of the conversion, and the swaths
   with their cuts of the record and their transforms. All in double and independent of the echoes. */
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "contract/delay.h"
#include "common/fft_length.h"
#include "common/kaiser.h"
#include "range_migration/rma_conditions.h"
#include "range_migration/rma_engine.h"

static const double OUTSIDE_MOST = 2;  /* of the record's length: rows outside it */
static const double PULSE_PERIODS = 8; /* of B: beside the rows, so that no pulse wraps around the cut */
static const double EVEN = 1e-12;      /* relative: columns that divide the period but for rounding */
static const int stolt_taps[] = {4, 6, 8, 12, 16};

static enum status too_long(const struct rma *rma, const struct rma_swath *swath, double samples)
{
    return status_set(
        STATUS_UNSUPPORTED,
        "%s: condition transform_length: the samples of a record that rows from %g to %g m need are %.3g; "
        "at most %d is needed (cure: fewer rows, columns nearer to the track, or back projection)",
        rma->method.name, swath->nearest, swath->farthest, samples, INT_MAX / 64);
}

/* Offsets of the receivers, their extremes, and whether they are evenly spaced. */
static enum status lay_receivers(struct rma *rma)
{
    const struct acquisition *a = rma->problem.acquisition;
    const double tolerance = a->sound_speed / a->fc / 1000;
    rma->receivers = a->receivers;
    rma->offset = store_take(&rma->store, (size_t)a->receivers, sizeof *rma->offset, 0);
    if (!rma->offset)
        return status_set(STATUS_FAILED, "no memory for %d receivers", a->receivers);
    rma->groups = (a->receivers + RMA_GROUP - 1) / RMA_GROUP;
    rma->recurs = rma->options.phases == RMA_RECURRENCE;
    for (int m = 0; m < a->receivers; m++)
        rma->offset[m] = a->rx[m].x - a->tx[0].x;
    double pitch = a->receivers > 1 ? (rma->offset[a->receivers - 1] - rma->offset[0]) / (a->receivers - 1) : 0;
    for (int m = 0; m < a->receivers; m++) {
        rma->extremes[0] = rma->offset[m] < rma->offset[rma->extremes[0]] ? m : rma->extremes[0];
        rma->extremes[1] = rma->offset[m] > rma->offset[rma->extremes[1]] ? m : rma->extremes[1];
        rma->recurs = rma->recurs && fabs(rma->offset[m] - rma->offset[0] - m * pitch) <= tolerance;
    }
    return STATUS_OK;
}

/* Delay compensation without its tables. */
static enum status lay_delay(struct rma *rma)
{
    struct rma_delay *delay = rma->delay = store_take(&rma->store, 1, sizeof *delay, 0);
    if (!delay)
        return status_set(STATUS_FAILED, "%s: no memory for %d receivers", rma->method.name, rma->receivers);
    delay->terms.terms = rma->method.terms < rma->receivers ? rma->method.terms : rma->receivers;
    delay->taps.taps = rma->method.taps;
    delay->guard = RMA_RUN + rma->method.taps;
    rma_fold(rma);
    return STATUS_OK;
}

enum status rma_delay_tables(struct rma *rma)
{
    struct rma_delay *delay = rma->delay;
    const struct rma_view view = rma_view_of(&rma->problem, &rma->method, &rma->stretch.track);
    if (!delay_terms_make(&view, rma->method.terms, &delay->terms))
        return status_set(STATUS_FAILED, "%s: no memory for %d receivers", rma->method.name, rma->receivers);
    rma->work.bytes += (double)sizeof *delay + delay->terms.bytes;
    return delay_taps_make(rma->problem.acquisition, (double)rma->rate_up / rma->rate_down, rma->method.taps,
                           &delay->taps);
}

static enum status lay_track(struct rma *rma)
{
    const struct acquisition *a = rma->problem.acquisition;
    const struct straight_track *track = &rma->stretch.track;
    enum status status = lay_receivers(rma);
    if (status != STATUS_OK)
        return status;
    struct rma_view view = rma_view_of(&rma->problem, &rma->method, track);
    rma->x_first = track->x_first;
    rma->spacing = track->spacing;
    rma->pings = a->pings;
    rma->setting = view.setting;
    rma->bounds = view.bounds;
    rma->converts = view.converts;
    rma->turns_rows = rma->converts && rma->method.spectrum == spectrum_lbf_printed;
    rma->monostatic = rma->setting;
    if (rma->turns_rows)
        rma->monostatic.speed = 0;
    rma->nearest = INFINITY;
    rma->farthest = -INFINITY;
    for (int k = 0; k < rma->problem.patch_count; k++) {
        rma->nearest = fmin(rma->nearest, rma->problem.patches[k].r_first);
        rma->farthest = fmax(rma->farthest, rma_last_row(&rma->problem.patches[k]));
    }
    return rma->method.terms > 0 ? lay_delay(rma) : STATUS_OK;
}

/* ---- swaths ---- */

/* Samples, as fractions counted from the record's first, in which the rows' echoes lie before and after the
   conversion. */
static void delays_span(const struct rma *rma, double nearest, double farthest, double *first, double *last)
{
    double c = rma->setting.sound_speed, reach = rma_reach(rma->problem.acquisition, &rma->bounds, farthest);
    struct vector velocity = {rma->setting.speed, 0, 0}, target = {0, farthest, 0};
    double delay = 2 * hypot(farthest, reach) / c * (1 + 2 * fabs(rma->setting.speed) / c);
    for (int k = 0; k < 4; k++) {
        double d = rma->offset[rma->extremes[k / 2]], u = (k % 2 ? 1 : -1) * reach - d / 2;
        struct vector tx = {u, 0, 0}, rx = {u + d, 0, 0};
        delay = fmax(delay, delay_exact(tx, rx, velocity, target, c));
    }
    *first = (2 * nearest / c - rma->t0) * rma->fs;
    *last = (delay - rma->t0) * rma->fs;
}

static int patches_order(const void *a, const void *b)
{
    const struct rma_patch *p = a, *q = b;
    if (p->grid.r_first != q->grid.r_first)
        return p->grid.r_first < q->grid.r_first ? -1 : 1;
    return (p->index > q->index) - (p->index < q->index);
}

/* Patches by range; those whose cuts of the record overlap share a swath. */
static enum status lay_patches(struct rma *rma)
{
    int count = rma->problem.patch_count;
    rma->patches = store_take(&rma->store, (size_t)count, sizeof *rma->patches, 0);
    rma->swaths = store_take(&rma->store, (size_t)count, sizeof *rma->swaths, 0);
    if (!rma->patches || !rma->swaths)
        return status_set(STATUS_FAILED, "no memory for %d patches", count);
    rma->patch_count = count;
    for (int k = 0; k < count; k++) {
        rma->patches[k].grid = rma->problem.patches[k];
        rma->patches[k].index = k;
    }
    qsort(rma->patches, (size_t)count, sizeof *rma->patches, patches_order);
    for (int k = 0; k < count; k++) {
        struct rma_patch *patch = &rma->patches[k];
        struct rma_swath *swath = rma->swaths + rma->swath_count - 1;
        double first, last, end = -INFINITY;
        if (k > 0)
            delays_span(rma, swath->nearest, swath->farthest, &first, &end);
        delays_span(rma, patch->grid.r_first, patch->grid.r_first, &first, &last);
        if (k == 0 || first - 2 * rma->taper > end + 2 * rma->taper) {
            swath++;
            rma->swath_count++;
            *swath = (struct rma_swath){.nearest = patch->grid.r_first, .farthest = -INFINITY, .patches = patch};
        }
        patch->row = swath->rows;
        swath->patch_count++;
        swath->rows += (size_t)patch->grid.r_count;
        swath->farthest = fmax(swath->farthest, rma_last_row(&patch->grid));
    }
    return STATUS_OK;
}

/* Pings and zeros after them that rows up to `farthest` need whose columns lie `overhang` m beyond the track. The
   period wraps around: targets focused beyond either end of the track, up to the widest angle, must not reach a wanted
   column. */
static double rma_period(const struct acquisition *a, const struct rma_bounds *bounds, double spacing, double farthest,
                         double overhang)
{
    const double angle = farthest * bounds->sine / sqrt(1 - bounds->sine * bounds->sine);
    const double reach = rma_reach(a, bounds, farthest), folds = reach < angle ? bounds->way + reach : 0;
    /* A receiver aside sees half its offset farther; less than a Fresnel zone tapers like any edge. */
    const double zone = sqrt(a->sound_speed / a->fc * farthest / 2);
    const double extent = (a->pings - 1) * spacing + overhang + angle + fmax(0, bounds->aside / 2 - zone);
    return fmax(fmax(ceil(extent / spacing) + 1, a->pings), folds / spacing);
}

/* Azimuth: the full rate of M receivers (LBF21 Eq. (10)). */
static enum status swath_azimuth(const struct rma *rma, struct rma_swath *swath)
{
    double spacing = fabs(rma->spacing),
           angle = swath->farthest * rma->bounds.sine / sqrt(1 - rma->bounds.sine * rma->bounds.sine);
    double x_low = fmin(rma->x_first, rma->x_first + (rma->pings - 1) * rma->spacing);
    /* A stretch ends so far from its window's columns that nothing else wraps around onto them. */
    double x_high = x_low + (rma->pings - 1) * spacing, overhang = rma->stretch.cut ? -INFINITY : 0;
    for (int k = 0; k < swath->patch_count; k++) {
        const struct grid *g = &swath->patches[k].grid;
        double last = g->x_first + (g->x_count - 1) * g->x_step;
        if (!rma->stretch.cut && (g->x_first < x_low - angle || last > x_high + angle))
            return status_set(STATUS_UNSUPPORTED,
                              "%s: condition in_wavenumbers: how far columns from %g to %g m lie outside the %g to %g "
                              "m that the track's wavenumbers cover is %.3g m; at most 0 is needed (cure: "
                              "columns nearer to the track, rows farther away, or a shorter transmitter)",
                              rma->method.name, g->x_first, last, x_low - angle, x_high + angle,
                              fmax(x_low - angle - g->x_first, last - x_high - angle));
        overhang = fmax(overhang, fmax(x_low - g->x_first, last - x_high));
    }
    const double period = rma_period(rma->problem.acquisition, &rma->bounds, spacing, swath->farthest, overhang);
    swath->period = fft_length((long long)fmin(1e9, period));
    if (swath->period == 0 || (double)swath->period * rma->receivers > INT_MAX / 4)
        return status_set(STATUS_UNSUPPORTED,
                          "%s: condition transform_length: the wavenumbers of %g m to either side of a target, pings "
                          "%g m apart, %d receivers, are %.3g; at most %d is needed (cure: columns nearer to the "
                          "track, fewer receivers, or back projection)",
                          rma->method.name, rma_reach(rma->problem.acquisition, &rma->bounds, swath->farthest), spacing,
                          rma->receivers, period * rma->receivers, INT_MAX / 4);
    swath->wavenumbers = swath->period * rma->receivers;
    swath->columns = (size_t)(swath->wavenumbers + RMA_TILE - 1) / RMA_TILE * RMA_TILE;
    return STATUS_OK;
}

/* Range: the part of the record for the rows, with tapers, and zeros for the pulse at the first row and the delays of
   the widest angle beyond it. */
static enum status swath_range(const struct rma *rma, struct rma_swath *swath)
{
    double first, last, c = rma->setting.sound_speed, end = rma->samples - 1, margin = 2 * rma->taper;
    delays_span(rma, swath->nearest, swath->farthest, &first, &last);
    double pulse = fmin(PULSE_PERIODS * rma->fs / rma->problem.acquisition->bandwidth, rma->samples);
    double before = fmax(0, -first), after = fmax(0, (2 * swath->farthest / c - rma->t0) * rma->fs - end);
    if (!(before + after <= OUTSIDE_MOST * rma->samples))
        return status_set(STATUS_UNSUPPORTED,
                          "%s: condition in_record: how far rows from %g to %g m lie outside the record's %g to %g m, "
                          "over its length, is %.3g; at most %g is needed (cure: longer records, or rows nearer to "
                          "them)",
                          rma->method.name, swath->nearest, swath->farthest, c * (rma->t0 + rma->early / rma->fs) / 2,
                          c * (rma->t0 + end / rma->fs) / 2, (before + after) / rma->samples, OUTSIDE_MOST);
    double from = floor(fmin(first - pulse, fmax(first - margin, 0)));
    double to = ceil(fmax(last + pulse, fmin(last + margin, end)));
    if (!(to - from < INT_MAX / 64))
        return too_long(rma, swath, to - from);
    swath->first = (int)from;
    bool recorded = from <= end && to >= 0; /* else no samples: the rows lie beside the record */
    swath->begin = recorded ? (int)fmax(from, 0) : swath->first;
    swath->end = recorded ? (int)fmin(to, end) + 1 : swath->first;
    swath->t_first = rma->t0 + from / rma->fs;
    swath->centre = (int)((to - from) / 2);
    swath->length = fft_length_fast((long long)(to - from) + 1 + RMA_GUARD);
    const double longer = rma->method.chirps ? 1 : RMA_OVERSAMPLING;
    swath->stolt_length = fft_length_fast((long long)(longer * swath->length));
    if (swath->length == 0 || swath->stolt_length == 0 || swath->stolt_length > INT_MAX / 64)
        return too_long(rma, swath, longer * (to - from));

    /* The tapers' smear beyond the pulse's band is part of it. */
    int lanes = RMA_ALIGNMENT / (rma->problem.precision == PRECISION_DOUBLE ? 8 : 4);
    double half = ceil(rma->half_band / rma->fs * swath->length);
    if (swath->begin > 0 || rma->early > 0 || swath->end < rma->samples)
        half += 2 * ceil((double)swath->length / rma->taper);
    swath->band_first = half < (swath->length - 1) / 2 ? -(int)half : -(swath->length / 2);
    swath->band = half < (swath->length - 1) / 2 ? 2 * (int)half + 1 : swath->length;
    swath->row = (swath->band + lanes - 1) / lanes * lanes;
    return STATUS_OK;
}

/* Delay compensation keeps samples in place of bins, and only those that were recorded. */
static enum status swath_samples(const struct rma *rma, struct rma_swath *swath)
{
    int lanes = RMA_ALIGNMENT / (rma->problem.precision == PRECISION_DOUBLE ? 8 : 4);
    if (!rma->delay)
        return STATUS_OK;
    if (swath->end == swath->begin) /* the rows lie beside the record: a stretch of zeros */
        swath->begin = swath->end = 0;
    swath->held = swath->end > swath->begin ? swath->end - swath->begin : RMA_RUN;
    swath->first = swath->begin;
    swath->t_first = rma->t0 + swath->begin / rma->fs;
    if (swath->end > swath->begin && !(rma->setting.sound_speed / 2 * swath->t_first >= DELAY_NEAREST * swath->nearest))
        return status_set(
            STATUS_UNSUPPORTED,
            "%s: condition delay_near: the range where the nearest row's pulse begins, over that row's "
            "%g m, is %.3g; at least %g is needed (cure: rows farther away, or more bandwidth; rma_numeric)",
            rma->method.name, swath->nearest, rma->setting.sound_speed / 2 * swath->t_first / swath->nearest,
            DELAY_NEAREST);
    swath->centre = swath->held / 2 / lanes * lanes;
    swath->row = (swath->held + RMA_RUN - 1) / RMA_RUN * RMA_RUN;
    /* Rows a power of two apart would share some sets of the cache. */
    swath->row += swath->row * lanes % 4096 == 0 ? lanes : 0;
    /* As much to either side of `centre` as lies behind it; for chirp transforms, the rows beside the record too. */
    if (!rma->method.chirps)
        swath->stolt_length = fft_length_fast((long long)ceil(RMA_OVERSAMPLING * 2 * (swath->held - swath->centre)));
    return STATUS_OK;
}

static enum status swath_patches(const struct rma *rma, struct rma_swath *swath)
{
    double c = rma->setting.sound_speed, bin = c / (2 * rma->fs);
    double extent = swath->length * bin * (1 + 2 * fabs(rma->setting.speed) / c);
    for (int k = 0; k < swath->patch_count; k++) {
        struct rma_patch *patch = &swath->patches[k];
        patch->step = patch->grid.r_count > 1 ? patch->grid.r_step : bin;
        double rows = fmax(ceil(extent / patch->step), patch->grid.r_count);
        patch->length = rows < 1e8 ? fft_length_fast((long long)rows) : 0;
        if (rma->method.chirps)
            chirp_lay(rma, swath, patch);
        double columns = swath->period * fabs(rma->spacing) / patch->grid.x_step, whole = floor(columns + 0.5);
        patch->folds = fabs(columns - whole) <= EVEN * whole && whole >= patch->grid.x_count && whole <= INT_MAX
                       && fft_length((long long)whole) == whole;
        patch->columns =
            patch->folds ? (int)whole : fft_length_fast((long long)swath->wavenumbers + patch->grid.x_count - 1);
        if (patch->length == 0 || patch->columns == 0)
            return status_set(STATUS_UNSUPPORTED,
                              "%s: condition transform_length: the rows %g m apart over %g m are %.3g; at most 1e8 is "
                              "needed (cure: rows farther apart, or back projection)",
                              rma->method.name, patch->step, extent, rows);
    }
    return STATUS_OK;
}

static enum status lay_swaths(struct rma *rma)
{
    static enum status (*const steps[])(const struct rma *, struct rma_swath *) = {swath_azimuth, swath_range,
                                                                                   swath_samples, swath_patches};
    rma->taps = stolt_taps[rma->options.stolt];
    rma->shape = kaiser_shape(rma->taps, RMA_OVERSAMPLING);
    chirp_phases(rma);
    rma->block_list =
        store_take(&rma->store, (size_t)rma->block_count * (size_t)rma->swath_count, sizeof *rma->block_list, 0);
    if (!rma->block_list)
        return status_set(STATUS_FAILED, "no memory for %d blocks", rma->block_count);
    const size_t lanes = RMA_ALIGNMENT / (rma->problem.precision == PRECISION_DOUBLE ? 8 : 4);
    enum status status = STATUS_OK;
    for (int n = 0; n < rma->swath_count; n++) {
        for (size_t k = 0; status == STATUS_OK && k < sizeof steps / sizeof *steps; k++)
            status = steps[k](rma, &rma->swaths[n]);
        if (status == STATUS_OK)
            rma->swaths[n].apart = ((size_t)rma->swaths[n].period * (size_t)rma->swaths[n].row / lanes | 1) * 2 * lanes;
        rma_blocks_choose(rma, &rma->swaths[n], rma->block_list + n * rma->block_count);
    }
    return status;
}

/* The scratch of a thread: room for each swath in turn. */
static void lay_scratch(struct rma *rma)
{
    const size_t real_bytes = rma->problem.precision == PRECISION_DOUBLE ? sizeof(double) : sizeof(float);
    const size_t receivers = (size_t)rma->receivers, summed = rma->options.sum == RMA_SUM_AFTER ? receivers : 1;
    const size_t record = 2 * (size_t)rma->record_length * real_bytes;
    const size_t compressed = (size_t)(rma->record_length > 0 ? rma->inverse_length : rma->held);
    size_t most[RMA_BUFFERS] = {[RMA_RECORD] = record, [RMA_TRANSFORMED] = record};
    for (const struct rma_swath *s = rma->swaths; s < rma->swaths + rma->swath_count; s++) {
        size_t row = 2 * (size_t)s->row * real_bytes, stolt = (size_t)s->stolt_length, needed = (size_t)s->needed;
        size_t longest = stolt, chirps = 0, terms = rma->delay ? (size_t)rma->delay->terms.terms : 0;
        for (int k = 0; k < s->patch_count; k++) {
            size_t length = (size_t)s->patches[k].length;
            longest = length > longest ? length : longest;
            chirps = rma->method.chirps && length > chirps ? length : chirps;
        }
        const size_t bytes[RMA_BUFFERS] = {
            [RMA_RAMPS] = (1 + needed) * (size_t)rma->groups * sizeof(struct rma_ramp),
            [RMA_ABSCISSAS] = (size_t)s->row * sizeof(double),
            [RMA_CONVERTED] = receivers * 2 * RMA_SPAN * real_bytes,
            [RMA_SUMS] = needed * summed * row,
            [RMA_WAVE] = 2 * longest * real_bytes,
            [RMA_TRANSFORMED] = 2 * longest * real_bytes,
            [RMA_CUT] = rma->delay ? (size_t)rma_turns(rma) * row : 2 * stolt * real_bytes,
            [RMA_PLACES] = (size_t)s->length * real_bytes,
            [RMA_SPECTRUM] = 2 * (stolt + 2 * RMA_GUARD) * real_bytes,
            [RMA_STORED] = 2 * RMA_TILE * (s->rows + RMA_TILE) * real_bytes,
            [RMA_PADDED] = rma->delay ? 2 * (compressed + 2 * (size_t)rma->delay->guard) * real_bytes : 0,
            [RMA_TURNS] = rma->delay ? 2 * RMA_CLASSES * receivers * real_bytes : 0,
            [RMA_EDGES] = receivers * terms * ((size_t)s->row * real_bytes / RMA_ALIGNMENT + 1) * 2 * real_bytes,
            [RMA_MEMBERS] = rma->delay ? receivers * sizeof(struct rma_member) : 0,
            [RMA_CHIRP] = chirps > 0 ? 2 * (chirps > stolt ? chirps : stolt) * real_bytes : 0,
            [RMA_KERNEL] = 2 * chirps * real_bytes,
            [RMA_LINE] = chirps > 0 ? 2 * stolt * real_bytes : 0,
            [RMA_SHARES] = chirps > 0 ? (stolt + chirps) * real_bytes : 0,
        };
        for (int k = 0; k < RMA_BUFFERS; k++)
            most[k] = bytes[k] > most[k] ? bytes[k] : most[k];
    }
    for (int k = 0; k < RMA_BUFFERS; k++) {
        rma->scratch_at[k] = rma->scratch_bytes;
        rma->scratch_bytes += (most[k] + RMA_ALIGNMENT - 1) / RMA_ALIGNMENT * RMA_ALIGNMENT;
    }
}

enum status rma_layout(struct rma *rma)
{
    static enum status (*const steps[])(struct rma *) = {lay_track,   rma_band_lay, rma_blocks_lay,
                                                         lay_patches, lay_swaths,   rma_records_lay};
    enum status status = STATUS_OK;
    for (size_t k = 0; status == STATUS_OK && k < sizeof steps / sizeof *steps; k++)
        status = steps[k](rma);
    if (status == STATUS_OK)
        lay_scratch(rma);
    return status;
}
