/* One image row of the translation-invariant engine (bp_row.h). For a row r, a receiver and a column phase rho, delay,
   sample and phase depend only on the shift s = ping - column: they are tabulated once, and
       image[rho + ratio j] += w(s) record[sample(s)][j + s]
   runs over contiguous pings: no gather, no trigonometry, 4 multiply-adds a pair. Exact: the same pairs, samples and
   weights as the general engine's plain path, in another order. Tables are made for many phases at once, in whole
   vectors; then a block of columns is summed for all of them, whose samples stay in the first-level cache. */
#include "bp_row.h"

#include <limits.h>
#include <math.h>

#include "lanes.h"
#include "turn.h"

#define BP_ROW REAL_ISA_NAME(bp_row)

#define INLINE static inline __attribute__((always_inline))

static int whole_vectors(int count)
{
    return (count + LANES - 1) / LANES * LANES;
}

/* ---- tables ---- */

/* Shifts begin .. begin + n of one phase, the first ping x from column 0; padded to whole vectors by the last. */
INLINE void places(const struct bp_medium *medium, const struct bp_raster *raster, double x, double r, int begin, int n,
                   double *restrict leg, double *restrict ahead, int *restrict shift)
{
    const double one_c = 1 / medium->sound_speed, v = raster->speed, spacing = raster->spacing, r2 = r * r;
    const int whole = whole_vectors(n);
#pragma omp simd
    for (int i = 0; i < whole; i++) {
        double u = x + i * spacing, seconds = sqrt(u * u + r2) * one_c;
        leg[i] = seconds;
        ahead[i] = u + v * seconds;
        shift[i] = begin + i;
    }
    for (int i = n; i < whole; i++) {
        leg[i] = leg[n - 1];
        ahead[i] = ahead[n - 1];
        shift[i] = shift[n - 1];
    }
}

/* Delay from transmission to a receiver `offset` ahead of the transmitter (delay.h): with b = ahead + offset,
   tau = leg + (v b + sqrt(c^2 b^2 + (c^2 - v^2) r^2))/(c^2 - v^2). */
struct delay_terms {
    double v, c2, er2, one_e;
};

static struct delay_terms delay_terms_make(const struct bp_medium *medium, const struct bp_raster *raster, double r)
{
    const double c = medium->sound_speed, v = raster->speed, e = (c - v) * (c + v);
    return (struct delay_terms){v, c * c, e * r * r, 1 / e};
}

/* Sample coordinate and weight exp(j 2 pi fc tau) of n entries, n whole vectors. */
INLINE void delays(const struct bp_medium *medium, const struct bp_raster *raster, const struct delay_terms *terms,
                   double offset, int n, const double *restrict leg, const double *restrict ahead, double *restrict q,
                   real *restrict wr, real *restrict wi)
{
    const double v = terms->v, c2 = terms->c2, er2 = terms->er2, one_e = terms->one_e;
    const double fc = medium->fc, fs = medium->fs, t0 = raster->t0;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        double b = ahead[i] + offset;
        double tau = leg[i] + (b * v + sqrt(c2 * (b * b) + er2)) * one_e;
        double cycles = fc * tau;
        q[i] = (tau - t0) * fs;
        turn((real)(cycles - floor(cycles + 0.5)), &wr[i], &wi[i]);
    }
}

/* The sample at or before q and the nearest of `steps` steps from there on to the next. */
INLINE void nearest_step(double q, int steps, int *sample, int *step)
{
    int whole = (int)q, near = (int)((q - whole) * steps + 0.5), next = near == steps;  /* q >= 0: the cast is floor */
    *sample = whole + next;
    *step = next ? 0 : near;
}

/* Leave out entries outside the record and, of upsampled records, those whose fine sample is not in the slab. */
static void keep(const struct bp_medium *medium, const struct bp_table *table, const struct bp_slab *slab,
                 struct bp_row_shifts *phase, int first, const struct bp_row_scratch *scratch)
{
    double *q = scratch->q + first;
    real *wr = (real *)scratch->wr + first, *wi = (real *)scratch->wi + first;
    int *kept = scratch->kept + first, count = 0, n = phase->end - phase->begin;
    for (int i = 0; i < n; i++) {
        if (!(q[i] >= 0 && q[i] <= medium->samples - 1))
            continue;
        int sample, step;
        nearest_step(q[i], table->upsample, &sample, &step);
        if (step < slab->phase || step >= slab->phase + slab->width)
            continue;
        q[count] = q[i];
        wr[count] = wr[i];
        wi[count] = wi[i];
        kept[count++] = phase->begin + i;
    }
    phase->count = count;
    phase->least = count > 0 ? kept[0] : phase->begin;
    phase->gapless = count == 0 || kept[count - 1] - kept[0] == count - 1;
    for (int i = count; i < whole_vectors(n); i++) {
        q[i] = 0;
        kept[i] = phase->begin;
    }
}

/* Where n entries read the slab, n whole vectors, and their weights. */
INLINE void tabulate(const struct bp_table *table, const struct bp_slab *slab, int n, const double *restrict q,
                     const int *restrict shift, int *restrict offset, int *restrict step, real *restrict weights)
{
    const int taps = table->taps, width = slab->width, stride = slab->ping_stride;
    const int row = table->upsample > 1 ? -slab->phase : table->guard + table->first;
    const real *values = table->weights;
    if (table->reading == BP_CUBICS) {
        for (int i = 0; i < n; i++) {
            int sample = (int)q[i];
            double interval = (q[i] - sample) * BP_INTERVALS;
            const real *w = values + (size_t)(int)interval * 4 * (size_t)taps;
            real u = (real)(interval - (int)interval);
            offset[i] = (sample + row) * stride + shift[i];
            for (int k = 0; k < taps; k++)
                weights[i * taps + k] = w[k] + u * (w[taps + k] + u * (w[2 * taps + k] + u * w[3 * taps + k]));
        }
        return;
    }
    if (taps == 1 && table->upsample == 1) {
#pragma omp simd
        for (int i = 0; i < n; i++)
            offset[i] = ((int)(q[i] + 0.5) + row) * stride + shift[i];
        return;
    }
    const int fine = table->upsample > 1, steps = fine ? table->upsample : table->phases;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        int sample, near;
        nearest_step(q[i], steps, &sample, &near);
        offset[i] = (sample * width + (fine ? near : 0) + row) * stride + shift[i];
        step[i] = near;
    }
    for (int i = 0; taps > 1 && i < n; i++)
        for (int k = 0; k < taps; k++)
            weights[i * taps + k] = values[step[i] * taps + k];
}

/* ---- sums ---- */

/* Entries of one phase, and what they add to: the sums of a block's first column. */
struct part {
    const int *offset;
    const real *wr, *wi, *weights;
    int begin, end, least;          /* the first one's shift */
    bool gapless;
    real *re, *im;
};

/* One value of each column, loaded once, times two weights: loads are the limit. */
INLINE void add_twice(int width, const real *values, real one, real two, vector_real *a, vector_real *b)
{
    for (int k = 0; k < width; k++) {
        vector_real v = *(const vector_real *)(values + k * LANES);
        HOLD(v);
        a[k] += v * one;
        b[k] += v * two;
    }
}

/* Sums of one block of `width` vectors of columns. sr, si: the receiver's records such that sr[offset] is the block's first
   column's value. Real and imaginary weights have accumulators of their own, so that enough independent chains hide the
   latency of multiply-adds; all real parts come before the imaginary ones, so that these chains and what they need fit 16
   registers. */
INLINE void sum_nearest(int width, const struct part *part, const real *sr, const real *si)
{
    const int *offset = part->offset, end = part->end;
    const real *wr = part->wr, *wi = part->wi;
    vector_real a[BP_BLOCK_VECTORS] = {{0}}, b[BP_BLOCK_VECTORS] = {{0}};
    vector_real c[BP_BLOCK_VECTORS] = {{0}}, d[BP_BLOCK_VECTORS] = {{0}};
    for (int i = part->begin; i < end; i++) {
        const real *x = sr + offset[i], *y = si + offset[i];
        real cosine = wr[i], sine = wi[i];
        add_twice(width, x, cosine, sine, a, c);
        add_twice(width, y, sine, cosine, b, d);
    }
    for (int k = 0; k < width; k++) {
        *(vector_real *)(part->re + k * LANES) += a[k] - b[k];
        *(vector_real *)(part->im + k * LANES) += c[k] + d[k];
    }
}

INLINE void sum_taps(int width, int taps, int stride, const struct part *part, const real *sr, const real *si)
{
    const int *offset = part->offset, end = part->end;
    const real *wr = part->wr, *wi = part->wi, *weights = part->weights;
    vector_real a[BP_BLOCK_VECTORS] = {{0}}, b[BP_BLOCK_VECTORS] = {{0}};
    for (int i = part->begin; i < end; i++) {
        const real *x = sr + offset[i], *y = si + offset[i], *w = weights + i * taps;
        vector_real vr[BP_BLOCK_VECTORS] = {{0}}, vi[BP_BLOCK_VECTORS] = {{0}};
        for (int t = 0; t < taps; t++)
            for (int k = 0; k < width; k++) {
                vr[k] += *(const vector_real *)(x + t * stride + k * LANES) * w[t];
                vi[k] += *(const vector_real *)(y + t * stride + k * LANES) * w[t];
            }
        real cosine = wr[i], sine = wi[i];
        for (int k = 0; k < width; k++) {
            a[k] = a[k] + vr[k] * cosine - vi[k] * sine;
            b[k] = b[k] + vr[k] * sine + vi[k] * cosine;
        }
    }
    for (int k = 0; k < width; k++) {
        *(vector_real *)(part->re + k * LANES) += a[k];
        *(vector_real *)(part->im + k * LANES) += b[k];
    }
}

/* Two phases, equally many entries for the same shifts: where both read the same samples, as neighbours mostly do, each
   value is loaded once. */
INLINE void sum_taps_pair(int width, int taps, int stride, const struct part *one, const struct part *two, const real *sr,
                          const real *si)
{
    const int count = one->end - one->begin;
    for (int i = 0; i < count; i++) {
        const int m = one->begin + i, n = two->begin + i;
        const real *x = sr + one->offset[m], *y = si + one->offset[m], *w = one->weights + m * taps;
        const real *x2 = sr + two->offset[n], *y2 = si + two->offset[n], *w2 = two->weights + n * taps;
        vector_real a[BP_BLOCK_VECTORS] = {{0}}, b[BP_BLOCK_VECTORS] = {{0}};
        vector_real a2[BP_BLOCK_VECTORS] = {{0}}, b2[BP_BLOCK_VECTORS] = {{0}};
        if (x == x2) {
            for (int t = 0; t < taps; t++) {
                add_twice(width, x + t * stride, w[t], w2[t], a, a2);
                add_twice(width, y + t * stride, w[t], w2[t], b, b2);
            }
        } else {
            for (int t = 0; t < taps; t++)
                for (int k = 0; k < width; k++) {
                    a[k] += *(const vector_real *)(x + t * stride + k * LANES) * w[t];
                    b[k] += *(const vector_real *)(y + t * stride + k * LANES) * w[t];
                    a2[k] += *(const vector_real *)(x2 + t * stride + k * LANES) * w2[t];
                    b2[k] += *(const vector_real *)(y2 + t * stride + k * LANES) * w2[t];
                }
        }
        real cosine = one->wr[m], sine = one->wi[m], cosine2 = two->wr[n], sine2 = two->wi[n];
        for (int k = 0; k < width; k++) {
            vector_real *re = (vector_real *)(one->re + k * LANES), *im = (vector_real *)(one->im + k * LANES);
            vector_real *re2 = (vector_real *)(two->re + k * LANES), *im2 = (vector_real *)(two->im + k * LANES);
            *re = *re + a[k] * cosine - b[k] * sine;
            *im = *im + a[k] * sine + b[k] * cosine;
            *re2 = *re2 + a2[k] * cosine2 - b2[k] * sine2;
            *im2 = *im2 + a2[k] * sine2 + b2[k] * cosine2;
        }
    }
}

/* The first of a phase's entries whose shift is >= bound. */
static int entry_find(const int *shift, int count, int bound)
{
    int low = 0;
    while (low < count) {
        int middle = low + (count - low) / 2;
        if (shift[middle] < bound)
            low = middle + 1;
        else
            count = middle;
    }
    return low;
}

/* A block of `width` vectors of columns of one phase. */
INLINE void sum_part(int width, int taps, int stride, const struct part *part, const real *sr, const real *si)
{
    if (taps > 1)
        sum_taps(width, taps, stride, part, sr, si);
    else
        sum_nearest(width, part, sr, si);
}

/* Two neighbouring phases: together for the shifts that both have. */
INLINE void sum_two(int width, int taps, int stride, const struct part *one, const struct part *two, const real *sr,
                    const real *si)
{
    struct part rest[4] = {*one, *one, *two, *two};
    rest[0].end = rest[1].begin;
    rest[2].end = rest[3].begin;
    int least = one->least > two->least ? one->least : two->least;
    int to = one->least + one->end - one->begin, to2 = two->least + two->end - two->begin, most = to < to2 ? to : to2;
    if (one->gapless && two->gapless && least < most) {
        struct part common = *one, common2 = *two;
        common.begin = rest[0].end = one->begin + least - one->least;
        common.end = rest[1].begin = one->begin + most - one->least;
        common2.begin = rest[2].end = two->begin + least - two->least;
        common2.end = rest[3].begin = two->begin + most - two->least;
        sum_taps_pair(width, taps, stride, &common, &common2, sr, si);
    }
    for (int n = 0; n < 4; n++)
        if (rest[n].begin < rest[n].end)
            sum_taps(width, taps, stride, &rest[n], sr, si);
}

/* Phases [begin, end) of one receiver, with their tables. */
struct group {
    const struct bp_raster *raster;
    const struct bp_slab *slab;
    const struct bp_row_scratch *scratch;
    const int *shift;
    int taps, begin, end;
    int from, to;                   /* shifts [from, to) are summed */
    const real *sr, *si;            /* the receiver's records, their ping 0 */
    real *re, *im;                  /* sums [phase][stride] */
    size_t stride;
};

/* `value` inside [least, most]. */
INLINE int between(int value, int least, int most)
{
    return value < least ? least : value < most ? value : most;
}

/* Phase p's part of the block of columns from j on. */
INLINE struct part part_make(const struct group *group, int taps, int p, int j)
{
    const struct bp_row_scratch *scratch = group->scratch;
    const struct bp_row_shifts *phase = &scratch->phases[p];
    const size_t first = (size_t)(phase->first - scratch->phases[group->begin].first);
    const int *shift = group->shift + first, from = group->from, to = group->to;
    int begin, end;
    if (phase->gapless) {
        begin = between(from - phase->least, 0, phase->count);
        end = between(to - phase->least, 0, phase->count);
    } else {
        begin = entry_find(shift, phase->count, from);
        end = entry_find(shift, phase->count, to);
    }
    const size_t at = (size_t)p * group->stride + (size_t)j;
    return (struct part){
        .offset = scratch->offset + first, .wr = (const real *)scratch->wr + first,
        .wi = (const real *)scratch->wi + first, .weights = (const real *)scratch->weights + first * (size_t)taps,
        .begin = begin, .end = end, .least = phase->least + begin, .gapless = phase->gapless,
        .re = group->re + at, .im = group->im + at};
}

/* A block of `width` vectors of columns from j on. */
INLINE void sum_block(int width, int taps, const struct group *group, int j)
{
    const real *sr = group->sr + j, *si = group->si + j;
    const int stride = group->slab->ping_stride;
    OPAQUE(sr);
    OPAQUE(si);
    for (int p = group->begin; p < group->end; p++) {
        struct part one = part_make(group, taps, p, j);
        if (taps > 2 && p + 1 < group->end) {
            struct part two = part_make(group, taps, ++p, j);
            sum_two(width, taps, stride, &one, &two, sr, si);
        } else {
            sum_part(width, taps, stride, &one, sr, si);
        }
    }
}

/* The shipped kernels unroll, any other length works as well. Functions of their own: the compiler runs out of registers
   where it inlines several. */
#define BLOCK(name, taps, width) \
    static __attribute__((noinline)) void name(const struct group *group, int j) \
    { \
        sum_block(width, taps, group, j); \
    }
#define BLOCKS(name, taps) \
    BLOCK(name##_1, taps, 1) \
    BLOCK(name##_2, taps, 2) \
    BLOCK(name##_3, taps, 3)
BLOCKS(nearest, 1)
BLOCKS(line, 2)
BLOCKS(eight, 8)
BLOCKS(any, group->taps)

static const struct kernel {
    int taps;                       /* 0: any number */
    void (*block[BP_BLOCK_VECTORS])(const struct group *group, int j);
} kernels[] = {
    {1, {nearest_1, nearest_2, nearest_3}},
    {2, {line_1, line_2, line_3}},
    {8, {eight_1, eight_2, eight_3}},
    {0, {any_1, any_2, any_3}},
};

/* All columns, in blocks as wide as each other. A shift whose pings begin or end inside a block is summed for those of
   its vectors only that have some; vector v has pings for the shifts [FIRST(v), END(v)). */
static void sum_columns(const struct kernel *kernel, struct group *group)
{
    const int columns = group->raster->blocks, pings = group->raster->pings;
    const struct bp_row_shifts *phases = group->scratch->phases;
    int least = INT_MAX, most = INT_MIN;
    for (int p = group->begin; p < group->end; p++) {
        least = phases[p].begin < least ? phases[p].begin : least;
        most = phases[p].end > most ? phases[p].end : most;
    }
    for (int j = 0, width; j < columns; j += width * LANES) {
        int left = (columns - j + LANES - 1) / LANES, parts = (left + BP_BLOCK_VECTORS - 1) / BP_BLOCK_VECTORS;
        width = (left + parts - 1) / parts;
#define FIRST(v) (1 - j - ((v) + 1) * LANES)
#define END(v) (pings - j - (v) * LANES)
        for (int v = 0; v < width; v++)
            for (int end = width; end > v; end--) {
                int from = FIRST(v), to = END(end - 1);
                if (end < width && from < END(end))
                    from = END(end);
                if (v > 0 && to > FIRST(v - 1))
                    to = FIRST(v - 1);
                group->from = from > least ? from : least;
                group->to = to < most ? to : most;
                if (group->from < group->to)
                    kernel->block[end - v - 1](group, j + v * LANES);
            }
    }
}

/* ---- the row ---- */

/* `value`, a whole number, inside [least, most]: fmin and fmax are calls. */
static int clamp(double value, int least, int most)
{
    return !(value > least) ? least : value < most ? (int)value : most;
}

/* Shifts [begin, end) of one phase inside the aperture: |u| <= limit sqrt(u^2 + r^2), that is, |u| <= edge, u = x + s
   spacing. */
static void shift_bounds(const struct bp_raster *raster, double edge, double x, double r, int *begin, int *end)
{
    const double limit = raster->limit, spacing = raster->spacing, one_spacing = 1 / spacing;
    const double first = (-edge - x) * one_spacing, last = (edge - x) * one_spacing;
    int low = clamp(ceil(first), *begin, *end), high = clamp(floor(last) + 1, *begin, *end);
    if (fabs(first - floor(first + 0.5)) < 1e-6 || fabs(last - floor(last + 0.5)) < 1e-6) {
        /* so near a shift that rounding decides: as it is defined */
#define INSIDE(s) (fabs(x + (s) * spacing) <= limit * sqrt((x + (s) * spacing) * (x + (s) * spacing) + r * r))
        while (low < high && !INSIDE(low))
            low++;
        while (low > *begin && INSIDE(low - 1))
            low--;
        while (high > low && !INSIDE(high - 1))
            high--;
        while (high < *end && high > low && INSIDE(high))
            high++;
#undef INSIDE
    }
    *begin = low;
    *end = high;
}

/* Are all delays of a row inside the record, by the least and the longest there could be? `furthest` and `offset`: largest
   distances along the track between ping and pixel and between transmitter and receiver. */
static bool inside_record(const struct bp_medium *medium, const struct bp_raster *raster, const struct delay_terms *terms,
                          double r, double offset, double furthest)
{
    const double v = fabs(terms->v), c = medium->sound_speed, leg = sqrt(furthest * furthest + r * r) / c;
    const double b = furthest + offset + v * leg;
    const double least = fabs(r) / c + (sqrt(terms->er2) - v * b) * terms->one_e;
    const double most = leg + (v * b + sqrt(terms->c2 * b * b + terms->er2)) * terms->one_e;
    const double slack = 1e-9 / medium->fs, last = raster->t0 + (medium->samples - 1) / medium->fs;
    return least >= raster->t0 + slack && most <= last - slack;
}

void BP_ROW(const struct bp_medium *medium, const struct bp_table *table, const struct bp_raster *raster,
            const struct bp_slab *slab, double r, const double *offsets, int count, const struct bp_row_scratch *scratch,
            void *re, void *im, int stride)
{
    const int phases = raster->ratio < raster->columns ? raster->ratio : raster->columns;
    const double limit = raster->limit, edge = limit < 1 ? fabs(r) * limit / sqrt((1 - limit) * (1 + limit)) : INFINITY;
    const struct delay_terms terms = delay_terms_make(medium, raster, r);
    struct bp_row_shifts *all = scratch->phases;
    const struct kernel *kernel = kernels;
    while (kernel->taps != 0 && kernel->taps != table->taps)
        kernel++;
    double furthest = 0, offset = 0;
    int total = 0;
    for (int p = 0; p < phases; p++) {
        double x = raster->x_first - (raster->grid_first + p * raster->grid_step);
        int begin = 1 - (raster->columns - p + raster->ratio - 1) / raster->ratio, end = raster->pings;
        if (limit < 1)
            shift_bounds(raster, edge, x, r, &begin, &end);
        all[p] = (struct bp_row_shifts){begin, end, total, end - begin, begin, true};
        if (begin == end)
            continue;
        places(medium, raster, x + begin * raster->spacing, r, begin, end - begin, scratch->leg + total,
               scratch->ahead + total, scratch->shift + total);
        furthest = fmax(furthest, fmax(fabs(x + begin * raster->spacing), fabs(x + (end - 1) * raster->spacing)));
        total += whole_vectors(end - begin);
    }
    all[phases].first = total;
    for (int g = 0; g < count; g++)
        offset = fmax(offset, fabs(offsets[g]));
    /* Of all receivers or none, so that none inherits what another one kept. */
    const bool whole = slab->width == table->upsample && inside_record(medium, raster, &terms, r, offset, furthest);
    for (int g = 0; g < count; g++) {
        const size_t receiver = (size_t)g * slab->receiver_stride + (size_t)slab->lead;
        struct group group = {raster, slab, scratch, NULL, table->taps, 0, 0, 0, 0, (const real *)slab->re + receiver,
                              (const real *)slab->im + receiver, re, im, (size_t)stride};
        while (group.begin < phases) {
            const int first = all[group.begin].first;
            do
                group.end++;
            while (group.end < phases && all[group.end + 1].first - first <= scratch->capacity);
            const int n = all[group.end].first - first;
            delays(medium, raster, &terms, offsets[g], n, scratch->leg + first, scratch->ahead + first, scratch->q,
                   scratch->wr, scratch->wi);
            for (int p = group.begin; !whole && p < group.end; p++)
                keep(medium, table, slab, &all[p], all[p].first - first, scratch);
            group.shift = whole ? scratch->shift + first : scratch->kept;
            tabulate(table, slab, n, scratch->q, group.shift, scratch->offset, scratch->step, scratch->weights);
            sum_columns(kernel, &group);
            group.begin = group.end;
        }
    }
}
