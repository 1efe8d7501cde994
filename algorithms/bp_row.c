/* One image row of the translation-invariant engine (bp_row.h). For a row r, a receiver and a column phase rho, delay,
   sample and phase depend only on the shift s = ping - column: they are tabulated once, and
       image[rho + ratio j] += w(s) record[sample(s)][j + s]
   runs over contiguous pings: no gather, no trigonometry, 4 multiply-adds a pair. Exact: the same pairs, samples and
   weights as the general engine's plain path, in another order. */
#include "bp_row.h"

#include <math.h>
#include <string.h>

#include "lanes.h"
#include "turn.h"

#define BP_ROW REAL_ISA_NAME(bp_row)

#define INLINE static inline __attribute__((always_inline))

/* Seconds from the transmitter to the pixel, for n shifts. */
INLINE void legs(double x, double spacing, double r, double c, int n, double *restrict leg)
{
#pragma omp simd
    for (int i = 0; i < n; i++) {
        double u = x + i * spacing;
        leg[i] = sqrt(u * u + r * r) / c;
    }
}

/* Sample coordinate q and phase (turns, |f| <= 1/2) of n shifts from `first` on; `leg` holds |tx - p|/c. */
INLINE void delays(const struct bp_medium *medium, const struct bp_raster *raster, double x, double r, double offset,
                   int n, const double *restrict leg, double *restrict q, double *restrict f)
{
    const double c = medium->sound_speed, v = raster->speed, e = (c - v) * (c + v), one_e = 1 / e, r2 = r * r;
    const double fc = medium->fc, fs = medium->fs, t0 = raster->t0, spacing = raster->spacing;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        double b = x + i * spacing + offset + v * leg[i], p = b * v;
        double tau = leg[i] + (p + sqrt(p * p + e * (b * b + r2))) * one_e;
        double cycles = fc * tau;
        q[i] = (tau - t0) * fs;
        f[i] = cycles - floor(cycles + 0.5);
    }
}

/* Tables of one receiver: shifts begin .. begin + n whose delays lie inside the record (and, of upsampled records, whose
   fine sample is in the slab). Returns how many there are. */
INLINE int tabulate(const struct bp_medium *medium, const struct bp_table *table, const struct bp_slab *slab, int begin,
                    int n, const struct bp_row_scratch *scratch)
{
    double *restrict q = scratch->q, *restrict f = scratch->f;
    int *restrict shift = scratch->shift, *restrict offset = scratch->offset;
    real *restrict wr = scratch->wr, *restrict wi = scratch->wi, *restrict weights = scratch->weights;
    const double last = medium->samples - 1;
    const int taps = table->taps, phases = table->phases, upsample = table->upsample, stride = slab->ping_stride;
    int outside = 0;
#pragma omp simd reduction(+ : outside)
    for (int i = 0; i < n; i++)
        outside += !(q[i] >= 0 && q[i] <= last);
    int count = 0;
    if (outside == 0 && slab->width == upsample) {
        for (int i = 0; i < n; i++)
            shift[i] = begin + i;
        count = n;
    } else {
        for (int i = 0; i < n; i++) {
            if (!(q[i] >= 0 && q[i] <= last))
                continue;
            if (slab->width < upsample) {
                int phase = (int)(q[i] * upsample + 0.5) % upsample - slab->phase;
                if (phase < 0 || phase >= slab->width)
                    continue;
            }
            q[count] = q[i];
            f[count] = f[i];
            shift[count++] = begin + i;
        }
    }
#pragma omp simd
    for (int i = 0; i < count; i++)
        turn(f[i], &wr[i], &wi[i]);
    if (taps == 1 && upsample == 1) {
        int row = table->guard + table->first;
#pragma omp simd
        for (int i = 0; i < count; i++)         /* q >= 0: the cast is floor */
            offset[i] = ((int)(q[i] + 0.5) + row) * stride + shift[i];
    } else if (taps == 1) {
        for (int i = 0; i < count; i++) {
            int fine = (int)(q[i] * upsample + 0.5);
            offset[i] = (fine / upsample * slab->width + fine % upsample - slab->phase) * stride + shift[i];
        }
    } else if (phases > 0) {
        const real *values = table->weights;
        for (int i = 0; i < count; i++) {
            long long point = (long long)(q[i] * phases + 0.5);
            const real *w = values + (point % phases) * taps;
            offset[i] = ((int)(point / phases) + table->guard + table->first) * stride + shift[i];
            for (int k = 0; k < taps; k++)
                weights[i * taps + k] = w[k];
        }
    } else {
        const real *values = table->weights;
        for (int i = 0; i < count; i++) {
            int sample = (int)q[i];
            double interval = (q[i] - sample) * BP_INTERVALS;
            const real *w = values + (size_t)(int)interval * 4 * (size_t)taps;
            real u = (real)(interval - (int)interval);
            offset[i] = (sample + table->guard + table->first) * stride + shift[i];
            for (int k = 0; k < taps; k++)
                weights[i * taps + k] = w[k] + u * (w[taps + k] + u * (w[2 * taps + k] + u * w[3 * taps + k]));
        }
    }
    return count;
}

/* Sums of one block of `width` vectors of columns over entries [begin, end). re, im: the block's first column; sr, si: the
   receiver's records such that sr[offset] is the block's first column's value. Real and imaginary weights have
   accumulators of their own, so that enough independent chains hide the latency of multiply-adds; all real parts come
   before the imaginary ones, so that these chains and what they need fit 16 registers. */
INLINE void sum_nearest(int width, const struct bp_row_scratch *scratch, int begin, int end, const real *sr,
                        const real *si, real *re, real *im)
{
    const int *offset = scratch->offset;
    const real *wr = scratch->wr, *wi = scratch->wi;
    vector_real a[3] = {{0}}, b[3] = {{0}}, c[3] = {{0}}, d[3] = {{0}};
    for (int i = begin; i < end; i++) {
        const real *x = sr + offset[i], *y = si + offset[i];
        real cosine = wr[i], sine = wi[i];
        for (int k = 0; k < width; k++) {
            vector_real v = *(const vector_real *)(x + k * LANES);
            HOLD(v);
            a[k] += v * cosine;
            c[k] += v * sine;
        }
        for (int k = 0; k < width; k++) {
            vector_real v = *(const vector_real *)(y + k * LANES);
            HOLD(v);
            b[k] += v * sine;
            d[k] += v * cosine;
        }
    }
    for (int k = 0; k < width; k++) {
        *(vector_real *)(re + k * LANES) += a[k] - b[k];
        *(vector_real *)(im + k * LANES) += c[k] + d[k];
    }
}

INLINE void sum_taps(int width, int taps, int stride, const struct bp_row_scratch *scratch, int begin, int end,
                     const real *sr, const real *si, real *re, real *im)
{
    const int *offset = scratch->offset;
    const real *wr = scratch->wr, *wi = scratch->wi, *weights = scratch->weights;
    vector_real a[2] = {{0}}, b[2] = {{0}};
    for (int i = begin; i < end; i++) {
        const real *x = sr + offset[i], *y = si + offset[i], *w = weights + i * taps;
        vector_real vr[2] = {{0}}, vi[2] = {{0}};
        for (int t = 0; t < taps; t++)
            for (int k = 0; k < width; k++) {
                vr[k] += *(const vector_real *)(x + t * stride + k * LANES) * w[t];
                vi[k] += *(const vector_real *)(y + t * stride + k * LANES) * w[t];
            }
        real cosine = wr[i], sine = wi[i];
        for (int k = 0; k < width; k++) {
            a[k] += vr[k] * cosine - vi[k] * sine;
            b[k] += vr[k] * sine + vi[k] * cosine;
        }
    }
    for (int k = 0; k < width; k++) {
        *(vector_real *)(re + k * LANES) += a[k];
        *(vector_real *)(im + k * LANES) += b[k];
    }
}

/* The first entry whose shift is >= bound. */
static int entry_find(const int *shift, int count, int bound)
{
    int low = 0;
    if (count > 0 && shift[count - 1] - shift[0] == count - 1)      /* as is usual, none is left out */
        return bound < shift[0] ? 0 : bound - shift[0] < count ? bound - shift[0] : count;
    while (low < count) {
        int middle = low + (count - low) / 2;
        if (shift[middle] < bound)
            low = middle + 1;
        else
            count = middle;
    }
    return low;
}

/* Blocks of up to `most` vectors over all columns of one phase. */
INLINE void sum_columns(int taps, int most, const struct bp_raster *raster, const struct bp_slab *slab, int columns,
                        const struct bp_row_scratch *scratch, int count, const real *sr, const real *si, real *re, real *im)
{
    for (int j = 0; j < columns;) {
        int left = (columns - j + LANES - 1) / LANES, width = left < most ? left : most, wide = width * LANES;
        int begin = entry_find(scratch->shift, count, -j - wide + 1);
        int end = entry_find(scratch->shift, count, raster->pings - j);
        const real *xr = sr + slab->lead + j, *xi = si + slab->lead + j;
        if (taps == 1) {
            switch (width) {
            case 1: sum_nearest(1, scratch, begin, end, xr, xi, re + j, im + j); break;
            case 2: sum_nearest(2, scratch, begin, end, xr, xi, re + j, im + j); break;
            default: sum_nearest(3, scratch, begin, end, xr, xi, re + j, im + j); break;
            }
        } else if (width == 1) {
            sum_taps(1, taps, slab->ping_stride, scratch, begin, end, xr, xi, re + j, im + j);
        } else {
            sum_taps(2, taps, slab->ping_stride, scratch, begin, end, xr, xi, re + j, im + j);
        }
        j += wide;
    }
}

/* Shifts [begin, end) of phase rho inside the aperture: |u| <= limit sqrt(u^2 + r^2), u = x + s spacing. */
static void shift_bounds(const struct bp_raster *raster, double x, double r, int *begin, int *end)
{
    double limit = raster->limit, spacing = raster->spacing;
    if (!(limit < 1))
        return;
    double edge = fabs(r) * limit / sqrt((1 - limit) * (1 + limit));
#define INSIDE(s) (fabs(x + (s) * spacing) <= limit * sqrt((x + (s) * spacing) * (x + (s) * spacing) + r * r))
    int low = (int)fmax(*begin, fmin(*end, ceil((-edge - x) / spacing)));
    int high = (int)fmax(*begin, fmin(*end, floor((edge - x) / spacing) + 1));
    while (low < high && !INSIDE(low))          /* the quotient's rounding, at most one shift off */
        low++;
    while (low > *begin && INSIDE(low - 1))
        low--;
    while (high > low && !INSIDE(high - 1))
        high--;
    while (high < *end && high > low && INSIDE(high))
        high++;
#undef INSIDE
    *begin = low;
    *end = high;
}

void BP_ROW(const struct bp_medium *medium, const struct bp_table *table, const struct bp_raster *raster,
            const struct bp_slab *slab, double r, const double *offsets, int count, const struct bp_row_scratch *scratch,
            void *re_, void *im_, int stride)
{
    const int phases = raster->ratio < raster->columns ? raster->ratio : raster->columns;
    const size_t most = (size_t)(raster->pings + raster->blocks);
    struct bp_row_shifts *all = scratch->shifts;
    for (int rho = 0; rho < phases; rho++) {
        struct bp_row_shifts *shifts = &all[rho];
        shifts->columns = (raster->columns - rho + raster->ratio - 1) / raster->ratio;
        shifts->begin = 1 - shifts->columns;
        shifts->end = raster->pings;
        shifts->x = raster->x_first - (raster->grid_first + rho * raster->grid_step);
        shift_bounds(raster, shifts->x, r, &shifts->begin, &shifts->end);
        shifts->x += shifts->begin * raster->spacing;
        legs(shifts->x, raster->spacing, r, medium->sound_speed, shifts->end - shifts->begin, scratch->leg + (size_t)rho * most);
    }
    /* Receiver by receiver: the few samples that a row reads of one stay in the first-level cache over all phases. */
    for (int g = 0; g < count; g++) {
        const real *sr = (const real *)slab->re + (size_t)g * slab->receiver_stride;
        const real *si = (const real *)slab->im + (size_t)g * slab->receiver_stride;
        for (int rho = 0; rho < phases; rho++) {
            const struct bp_row_shifts *shifts = &all[rho];
            const int n = shifts->end - shifts->begin, columns = shifts->columns;
            real *re = (real *)re_ + (size_t)rho * (size_t)stride, *im = (real *)im_ + (size_t)rho * (size_t)stride;
            if (n <= 0)
                continue;
            delays(medium, raster, shifts->x, r, offsets[g], n, scratch->leg + (size_t)rho * most, scratch->q, scratch->f);
            int entries = tabulate(medium, table, slab, shifts->begin, n, scratch);
            switch (table->taps) {              /* the shipped kernels unroll, any other length works as well */
            case 1: sum_columns(1, BP_BLOCK_VECTORS, raster, slab, columns, scratch, entries, sr, si, re, im); break;
            case 2: sum_columns(2, 2, raster, slab, columns, scratch, entries, sr, si, re, im); break;
            case 8: sum_columns(8, 2, raster, slab, columns, scratch, entries, sr, si, re, im); break;
            default: sum_columns(table->taps, 2, raster, slab, columns, scratch, entries, sr, si, re, im); break;
            }
        }
    }
}
