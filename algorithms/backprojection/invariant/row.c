/* One image row of the translation-invariant engine (invariant/row.h). For a row r, a receiver and a column phase rho, delay,
   sample and phase depend only on the shift s = ping - column: they are tabulated once, and
       image[rho + ratio j] += w(s) record[sample(s)][j + s]
   runs over contiguous pings: no gather, no trigonometry, 4 multiply-adds a pair. Exact: the same pairs, samples and
   weights as the general engine's plain path, in another order. Loads of the records are the limit, half of which cross a
   cache line: neighbouring phases, which mostly read the same samples, are summed together and share them. Tables are
   made for some groups of phases at once, in whole vectors; then a block of columns is summed for all of these, whose
   samples stay in the first-level cache. */
#include "backprojection/invariant/row.h"

#include <limits.h>
#include <math.h>

#include "common/lanes.h"
#include "common/turn.h"

#define BP_ROW REAL_ISA_NAME(bp_row)

#define INLINE static inline __attribute__((always_inline))

static int whole_vectors(int count)
{
    return (count + LANES - 1) / LANES * LANES;
}

/* ---- tables ---- */

/* The shifts [begin, end) of one phase inside the aperture. */
struct shifts {
    int begin, end;
};

/* A group's entries, by shift and then phase, padded to whole vectors by the last. Those outside their phase's aperture
   have gate 0, all others 1. */
static void places(const struct bp_medium *medium, const struct bp_raster *raster, const struct bp_row_group *group,
                   const struct shifts *inside, double r, double *restrict leg, double *restrict ahead,
                   int *restrict shift, real *restrict gate)
{
    const double one_c = 1 / medium->sound_speed, v = raster->speed, r2 = r * r;
    const int phases = group->phases, n = (group->end - group->begin) * phases, whole = whole_vectors(n);
    for (int k = 0; k < phases; k++) {
        const double x = raster->x_first - (raster->grid_first + (group->phase + k) * raster->grid_step);
        for (int s = group->begin, i = k; s < group->end; s++, i += phases) {
            ahead[i] = x + s * raster->spacing;
            shift[i] = s;
            gate[i] = s >= inside[k].begin && s < inside[k].end;
        }
    }
    for (int i = n; i < whole; i++) {
        ahead[i] = ahead[n - 1];
        shift[i] = shift[n - 1];
        gate[i] = 0;
    }
#pragma omp simd
    for (int i = 0; i < whole; i++) {
        double u = ahead[i], seconds = sqrt(u * u + r2) * one_c;
        leg[i] = seconds;
        ahead[i] = u + v * seconds;
    }
}

/* Delay from transmission to a receiver `offset` ahead of the transmitter (delay.h): with b = ahead + offset,
   tau = leg + (v b + s)/(c^2 - v^2) = leg + (b^2 + r^2)/(s - v b), s = sqrt(c^2 b^2 + (c^2 - v^2) r^2). */
struct delay_terms {
    double v, c2, r2, er2, one_e;
    bool slow; /* the first form will do */
};

static struct delay_terms delay_terms_make(const struct bp_medium *medium, const struct bp_raster *raster, double r)
{
    const double c = medium->sound_speed, v = raster->speed, e = (c - v) * (c + v);
    return (struct delay_terms){v, c * c, r * r, e * r * r, 1 / e, fabs(v) <= BP_SLOW * c};
}

/* Sample coordinate and weight exp(j 2 pi fc tau) of n entries, n whole vectors; weight 0 where the gate is. Two loops, so
   that several of each one's chains are under way at once. `slow` is a constant where this is inlined. */
INLINE void delays(bool slow, const struct bp_medium *medium, const struct bp_raster *raster,
                   const struct delay_terms *terms, double offset, int n, const double *restrict leg,
                   const double *restrict ahead, const real *restrict gate, double *restrict q, real *restrict wr,
                   real *restrict wi)
{
    const double v = terms->v, c2 = terms->c2, r2 = terms->r2, er2 = terms->er2, one_e = terms->one_e;
    const double fc = medium->fc, fs = medium->fs, t0 = raster->t0;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        double b = ahead[i] + offset, p = b * v, s = sqrt(c2 * (b * b) + er2);
        double tau = leg[i] + (slow || p >= 0 ? (p + s) * one_e : (b * b + r2) / (s - p));
        double cycles = fc * tau;
        q[i] = (tau - t0) * fs;
        wr[i] = (real)(cycles - floor(cycles + 0.5));
    }
#pragma omp simd
    for (int i = 0; i < n; i++) {
        real cosine, sine;
        turn(wr[i], &cosine, &sine);
        wr[i] = cosine * gate[i];
        wi[i] = sine * gate[i];
    }
}

/* The sample at or before q and the nearest of `steps` steps from there on to the next. */
INLINE void nearest_step(double q, int steps, int *sample, int *step)
{
    int whole = (int)q, near = (int)((q - whole) * steps + 0.5), next = near == steps; /* q >= 0: the cast is floor */
    *sample = whole + next;
    *step = next ? 0 : near;
}

/* Entries outside the record weigh nothing, and read its nearest sample; shifts before the first and after the last that
   has an entry inside are left out. */
static void confine(const struct bp_medium *medium, struct bp_row_group *group, double *restrict q, real *restrict wr,
                    real *restrict wi)
{
    const double last = medium->samples - 1;
    const int phases = group->phases, n = (group->end - group->begin) * phases, whole = whole_vectors(n);
    int from = n, to = 0;
    for (int i = 0; i < whole; i++) {
        if (q[i] >= 0 && q[i] <= last) {
            from = i < from ? i : from;
            to = i + 1;
            continue;
        }
        wr[i] = wi[i] = 0;
        q[i] = q[i] < 0 ? 0 : last;
    }
    to = to < n ? to : n;
    group->from = from < to ? from / phases : 0;
    group->to = from < to ? (to + phases - 1) / phases : 0;
}

/* Of one phase's entries, keep those inside the record whose fine sample is in the slab. */
static void keep(const struct bp_medium *medium, const struct bp_table *table, const struct bp_slab *slab,
                 struct bp_row_group *group, double *q, real *wr, real *wi, int *kept)
{
    int count = 0, n = group->end - group->begin;
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
        kept[count++] = group->begin + i;
    }
    group->to = count;
    for (int i = count; i < whole_vectors(n); i++) {
        q[i] = 0;
        kept[i] = group->begin;
    }
}

/* Where n entries read the slab, n whole vectors: the first tap's row, and its value for ping `shift`. What their weights
   are made of: the fine step from the sample to the next one, or the interval, and with cubics the position inside it, in
   place of q. */
INLINE void tabulate(const struct bp_table *table, const struct bp_slab *slab, int n, double *restrict q,
                     const int *restrict shift, int *restrict row, int *restrict offset, int *restrict step)
{
    const int first = table->upsample > 1 ? -slab->phase : table->guard + table->first;
    const int width = slab->width, stride = slab->ping_stride;
    if (table->reading == BP_CUBICS) {
#pragma omp simd
        for (int i = 0; i < n; i++) {
            int sample = (int)q[i];
            double interval = (q[i] - sample) * BP_INTERVALS;
            row[i] = sample + first;
            offset[i] = row[i] * stride + shift[i];
            step[i] = (int)interval;
            q[i] = interval - step[i];
        }
        return;
    }
    if (table->taps == 1 && table->upsample == 1) {
#pragma omp simd
        for (int i = 0; i < n; i++) {
            row[i] = (int)(q[i] + 0.5) + first;
            offset[i] = row[i] * stride + shift[i];
        }
        return;
    }
    const int fine = table->upsample > 1, steps = fine ? table->upsample : table->phases;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        int sample, near;
        nearest_step(q[i], steps, &sample, &near);
        row[i] = sample * width + (fine ? near : 0) + first;
        offset[i] = row[i] * stride + shift[i];
        step[i] = near;
    }
}

/* The weights of one entry's taps, from its step and, with cubics, its position u. */
INLINE void weigh(const struct bp_table *table, int taps, int step, real u, real *restrict weights)
{
    const real *values = table->weights;
    if (table->reading == BP_CUBICS) {
        const real *w = values + step * 4 * taps;
#pragma omp simd
        for (int t = 0; t < taps; t++)
            weights[t] = w[t] + u * (w[taps + t] + u * (w[2 * taps + t] + u * w[3 * taps + t]));
    } else {
        for (int t = 0; t < taps; t++)
            weights[t] = values[step * taps + t];
    }
}

/* ---- sums ---- */

/* Groups [begin, end) of one receiver, all of as many phases, with their tables. */
struct chunk {
    const struct bp_raster *raster;
    const struct bp_table *table;
    const struct bp_slab *slab;
    const struct bp_row_scratch *scratch;
    int begin, end;
    bool sparse;         /* shifts are left out: scratch->kept holds those that are there */
    int from, to;        /* shifts [from, to) are summed */
    const real *sr, *si; /* the receiver's records, their ping 0 */
    real *re, *im;       /* sums [phase][stride] */
    size_t stride;
};

/* A group's entries for some shifts, and the sums of a block's first column. */
struct part {
    int begin, end; /* shifts, counted from the group's first one */
    const int *offset, *rows;
    const real *wr, *wi, *weights;
    real *re, *im; /* of the group's first phase */
    size_t stride;
};

/* A vector of samples, loaded once for all its products: loads are the limit. */
#define LOAD(name, pointer)                                                                                            \
    vector_real name = *(const vector_real *)(pointer);                                                                \
    HOLD(name)

/* One phase, one or two samples with complex weights, `width` vectors of columns. Real and imaginary weights have
   accumulators of their own, so that enough independent chains hide the latency of multiply-adds; all real parts come
   before the imaginary ones, so that these chains and what they need fit 16 registers. */
INLINE void sum_one(int width, int taps, int stride, const struct part *part, const real *sr, const real *si)
{
    vector_real a[BP_BLOCK_VECTORS] = {{0}}, b[BP_BLOCK_VECTORS] = {{0}};
    vector_real c[BP_BLOCK_VECTORS] = {{0}}, d[BP_BLOCK_VECTORS] = {{0}};
    const int *offset = part->offset, end = part->end;
    const real *wr = part->wr, *wi = part->wi;
    for (int i = part->begin; i < end; i++) {
        const real *x = sr + offset[i], *y = si + offset[i];
        for (int t = 0; t < taps; t++) {
            real cosine = wr[i * taps + t], sine = wi[i * taps + t];
            for (int k = 0; k < width; k++) {
                LOAD(v, x + t * stride + k * LANES);
                a[k] += v * cosine;
                c[k] += v * sine;
            }
            for (int k = 0; k < width; k++) {
                LOAD(v, y + t * stride + k * LANES);
                b[k] += v * sine;
                d[k] += v * cosine;
            }
        }
    }
    for (int k = 0; k < width; k++) {
        *(vector_real *)(part->re + k * LANES) += a[k] - b[k];
        *(vector_real *)(part->im + k * LANES) += c[k] + d[k];
    }
}

/* The same of two phases that read the same samples. */
INLINE void sum_two(int width, int taps, int stride, const struct part *part, const real *sr, const real *si)
{
    vector_real a[BP_BLOCK_VECTORS] = {{0}}, b[BP_BLOCK_VECTORS] = {{0}};
    vector_real a2[BP_BLOCK_VECTORS] = {{0}}, b2[BP_BLOCK_VECTORS] = {{0}};
    const int *offset = part->offset, end = part->end;
    const real *wr = part->wr, *wi = part->wi;
    for (int i = part->begin; i < end; i++) {
        const real *x = sr + offset[2 * i], *y = si + offset[2 * i];
        for (int t = 0; t < taps; t++) {
            const real *r = wr + 2 * i * taps + t, *m = wi + 2 * i * taps + t;
            real cosine = r[0], sine = m[0], cosine2 = r[taps], sine2 = m[taps];
            for (int k = 0; k < width; k++) {
                LOAD(v, x + t * stride + k * LANES);
                a[k] += v * cosine;
                b[k] += v * sine;
                a2[k] += v * cosine2;
                b2[k] += v * sine2;
            }
            for (int k = 0; k < width; k++) {
                LOAD(v, y + t * stride + k * LANES);
                a[k] -= v * sine;
                b[k] += v * cosine;
                a2[k] -= v * sine2;
                b2[k] += v * cosine2;
            }
        }
    }
    for (int k = 0; k < width; k++) {
        *(vector_real *)(part->re + k * LANES) += a[k];
        *(vector_real *)(part->im + k * LANES) += b[k];
        *(vector_real *)(part->re + part->stride + k * LANES) += a2[k];
        *(vector_real *)(part->im + part->stride + k * LANES) += b2[k];
    }
}

/* Some phases, many samples with real weights, whose sum is rotated. rows[i] >= taps samples serve all phases of the
   group; a phase's weights are 0 for those that are not its own. Registers hold the block's sums of one phase, not of more. */
INLINE void sum_taps(int phases, int width, int taps, int stride, const struct part *part, const real *sr,
                     const real *si)
{
    const int spread = taps + BP_SPREAD;
    vector_real sum_re[BP_BLOCK_VECTORS] = {{0}}, sum_im[BP_BLOCK_VECTORS] = {{0}};
    for (int i = part->begin; i < part->end; i++) {
        const real *x = sr + part->offset[i], *y = si + part->offset[i], *w = part->weights + i * phases * spread;
        vector_real vr[BP_TOGETHER] = {{0}}, vi[BP_TOGETHER] = {{0}}; /* [phases][width] */
#define TAP(t)                                                                                                         \
    for (int k = 0; k < width; k++) {                                                                                  \
        LOAD(v, x + (t)*stride + k * LANES);                                                                           \
        LOAD(u, y + (t)*stride + k * LANES);                                                                           \
        for (int p = 0; p < phases; p++) {                                                                             \
            vr[p * width + k] += v * w[p * spread + (t)];                                                              \
            vi[p * width + k] += u * w[p * spread + (t)];                                                              \
        }                                                                                                              \
    }
        for (int t = 0; t < taps; t++)
            TAP(t)
        for (int t = taps; t < part->rows[i]; t++)
            TAP(t)
        for (int p = 0; p < phases; p++) {
            real cosine = part->wr[i * phases + p], sine = part->wi[i * phases + p];
            for (int k = 0; k < width; k++) {
                const size_t at = (size_t)p * part->stride + (size_t)(k * LANES);
                vector_real *re = phases == 1 ? &sum_re[k] : (vector_real *)(part->re + at);
                vector_real *im = phases == 1 ? &sum_im[k] : (vector_real *)(part->im + at);
                vector_real a = vr[p * width + k], b = vi[p * width + k];
                *re = *re + a * cosine - b * sine;
                *im = *im + a * sine + b * cosine;
            }
        }
    }
    for (int k = 0; phases == 1 && k < width; k++) {
        *(vector_real *)(part->re + k * LANES) += sum_re[k];
        *(vector_real *)(part->im + k * LANES) += sum_im[k];
    }
}

/* `value` inside [least, most]. */
INLINE int between(int value, int least, int most)
{
    return value < least ? least : value < most ? value : most;
}

/* The first of `count` rising shifts that is >= bound. */
static int find(const int *shift, int count, int bound)
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

/* A block of `width` vectors of columns from j on. Works on copies: else all that a chunk and its scratch point to is read
   anew after each store of a sum. */
INLINE void sum_block(int phases, int width, int taps, const struct chunk *shared, int j)
{
    const struct chunk own_chunk = *shared, *chunk = &own_chunk;
    const struct bp_row_scratch own_scratch = *chunk->scratch, *scratch = &own_scratch;
    const struct bp_row_group *groups = scratch->groups;
    const int origin = groups[chunk->begin].first;
    const real *sr = chunk->sr + j, *si = chunk->si + j;
    const int stride = chunk->slab->ping_stride;
    OPAQUE(sr);
    OPAQUE(si);
    for (int g = chunk->begin; g < chunk->end; g++) {
        const struct bp_row_group *group = &groups[g];
        const size_t first = (size_t)(group->first - origin), complex_taps = taps < 3 ? (size_t)taps : 1;
        const size_t at = (size_t)group->phase * chunk->stride + (size_t)j;
        struct part part = {.offset = scratch->offset + first,
                            .rows = scratch->rows + first,
                            .wr = (const real *)scratch->wr + first * complex_taps,
                            .wi = (const real *)scratch->wi + first * complex_taps,
                            .weights = (const real *)scratch->weights + first * (size_t)(taps + BP_SPREAD),
                            .re = chunk->re + at,
                            .im = chunk->im + at,
                            .stride = chunk->stride};
        if (chunk->sparse) {
            part.begin = find(scratch->kept + first, group->to, chunk->from);
            part.end = find(scratch->kept + first, group->to, chunk->to);
        } else {
            part.begin = between(chunk->from - group->begin, group->from, group->to);
            part.end = between(chunk->to - group->begin, group->from, group->to);
        }
        if (taps > 2)
            sum_taps(phases, width, taps, stride, &part, sr, si);
        else if (phases == 2)
            sum_two(width, taps, stride, &part, sr, si);
        else
            sum_one(width, taps, stride, &part, sr, si);
    }
}

/* The shipped kernels unroll, any other length works as well. Functions of their own: the compiler runs out of registers
   where it inlines several. */
#define BLOCK(name, taps, phases, width)                                                                               \
    static __attribute__((noinline)) void name##_##phases##_##width(const struct chunk *chunk, int j)                  \
    {                                                                                                                  \
        sum_block(phases, width, taps, chunk, j);                                                                      \
    }
/* clang-format off */
#define BLOCKS_FEW(name, taps) \
    BLOCK(name, taps, 1, 1) BLOCK(name, taps, 1, 2) BLOCK(name, taps, 1, 3) \
    BLOCK(name, taps, 2, 1) BLOCK(name, taps, 2, 2)
#define BLOCKS_MANY(name, taps) \
    BLOCK(name, taps, 1, 1) BLOCK(name, taps, 1, 2) BLOCK(name, taps, 1, 3) \
    BLOCK(name, taps, 2, 1) BLOCK(name, taps, 2, 2) BLOCK(name, taps, 2, 3) \
    BLOCK(name, taps, 3, 1) BLOCK(name, taps, 3, 2) \
    BLOCK(name, taps, 4, 1) BLOCK(name, taps, 5, 1) BLOCK(name, taps, 6, 1)
#define TABLE_FEW(name) {{name##_1_1, name##_1_2, name##_1_3}, {name##_2_1, name##_2_2}}
#define TABLE_MANY(name) \
    {{name##_1_1, name##_1_2, name##_1_3}, {name##_2_1, name##_2_2, name##_2_3}, {name##_3_1, name##_3_2}, \
     {name##_4_1}, {name##_5_1}, {name##_6_1}}
/* clang-format on */
BLOCKS_FEW(nearest, 1)
BLOCKS_FEW(line, 2)
BLOCKS_MANY(eight, 8)
BLOCKS_MANY(any, chunk->table->taps)

typedef void block_function(const struct chunk *chunk, int j);

static const struct kernel {
    int taps;                                             /* 0: any number */
    block_function *block[BP_TOGETHER][BP_BLOCK_VECTORS]; /* [phases - 1][vectors - 1], as many as registers hold */
} kernels[] = {
    {1, TABLE_FEW(nearest)},
    {2, TABLE_FEW(line)},
    {8, TABLE_MANY(eight)},
    {0, TABLE_MANY(any)},
};

/* The shifts [from, to) of those that the row has, for a block of columns from j on. */
INLINE void sum_shifts(block_function *block, struct chunk *chunk, int least, int most, int from, int to, int j)
{
    chunk->from = from > least ? from : least;
    chunk->to = to < most ? to : most;
    if (chunk->from < chunk->to)
        block(chunk, j);
}

/* All columns, in blocks as wide as each other. Vector v of one has pings for the shifts [FIRST(v), END(v)). Where the lead is as
   wide as a block, a shift that has pings for some of its vectors is summed for all, for the others zeros; else for
   those only that have some. */
static void sum_columns(const struct kernel *kernel, struct chunk *chunk)
{
    const int columns = chunk->raster->blocks, pings = chunk->raster->pings;
    const struct bp_row_group *groups = chunk->scratch->groups;
    block_function *const *block = kernel->block[groups[chunk->begin].phases - 1];
    int least = INT_MAX, most = INT_MIN, widest = BP_BLOCK_VECTORS;
    while (!block[widest - 1])
        widest--;
    for (int g = chunk->begin; g < chunk->end; g++) {
        least = groups[g].begin < least ? groups[g].begin : least;
        most = groups[g].end > most ? groups[g].end : most;
    }
    for (int j = 0, width; j < columns; j += width * LANES) {
        int left = (columns - j + LANES - 1) / LANES, parts = (left + widest - 1) / widest;
        width = (left + parts - 1) / parts;
#define FIRST(v) (1 - j - ((v) + 1) * LANES)
#define END(v)   (pings - j - (v)*LANES)
        if (width * LANES <= chunk->slab->lead) {
            sum_shifts(block[width - 1], chunk, least, most, FIRST(width - 1), END(0), j);
            continue;
        }
        for (int v = 0; v < width; v++)
            for (int end = width; end > v; end--) {
                int from = FIRST(v), to = END(end - 1);
                if (end < width && from < END(end))
                    from = END(end);
                if (v > 0 && to > FIRST(v - 1))
                    to = FIRST(v - 1);
                sum_shifts(block[end - v - 1], chunk, least, most, from, to, j + v * LANES);
            }
    }
}

/* One entry, with one or two complex weights, onto all columns that have a ping. */
INLINE void sum_entry(const struct chunk *chunk, int taps, int phase, int shift, int offset, const real *wr,
                      const real *wi)
{
    const int stride = chunk->slab->ping_stride, pings = chunk->raster->pings, columns = chunk->raster->blocks;
    const int begin = shift < 0 ? -shift / LANES * LANES : 0, end = pings - shift < columns ? pings - shift : columns;
    const real *sr = chunk->sr + offset, *si = chunk->si + offset;
    real *re = chunk->re + (size_t)phase * chunk->stride, *im = chunk->im + (size_t)phase * chunk->stride;
    for (int j = begin; j < end; j += LANES) {
        vector_real a = *(vector_real *)(re + j), b = *(vector_real *)(im + j);
        for (int t = 0; t < taps; t++) {
            vector_real x = *(const vector_real *)(sr + t * stride + j),
                        y = *(const vector_real *)(si + t * stride + j);
            a = a + x * wr[t] - y * wi[t];
            b = b + x * wi[t] + y * wr[t];
        }
        *(vector_real *)(re + j) = a;
        *(vector_real *)(im + j) = b;
    }
}

/* One or two taps, n entries: the weights times the taps' own, and in pairs of phases each second one whose samples are
   not the first one's is summed by itself. */
INLINE void join_few(const struct chunk *chunk, int taps, int n, const int *shift)
{
    const struct bp_row_scratch *scratch = chunk->scratch;
    const struct bp_row_group *groups = scratch->groups;
    const int first = groups[chunk->begin].first, *offset = scratch->offset;
    int *apart = scratch->rows, count = 0;
    real *wr = scratch->wr, *wi = scratch->wi;
    for (int e = n - 1; taps == 2 && e >= 0; e--) {
        real weights[2], cosine = wr[e], sine = wi[e];
        weigh(chunk->table, 2, scratch->step[e], (real)scratch->q[e], weights);
        for (int t = 0; t < 2; t++) {
            wr[2 * e + t] = cosine * weights[t];
            wi[2 * e + t] = sine * weights[t];
        }
    }
    if (groups[chunk->begin].phases == 1)
        return;
    for (int e = 0; e < n; e += LANES) { /* most pairs read the same sample, and so do their neighbours */
        int differ = 0;
        for (int k = 0; k < LANES; k += 2)
            differ |= offset[e + k] ^ offset[e + k + 1];
        for (int k = 1; differ && k < LANES; k += 2) {
            apart[count] = e + k;
            count += offset[e + k] != offset[e + k - 1];
        }
    }
    for (int i = 0, g = chunk->begin; i < count; i++) {
        int e = apart[i];
        real *r = wr + e * taps, *m = wi + e * taps;
        while (groups[g + 1].first - first <= e)
            g++;
        sum_entry(chunk, taps, groups[g].phase + 1, shift[e], offset[e], r, m);
        for (int t = 0; t < taps; t++)
            r[t] = m[t] = 0;
    }
}

/* Many taps: the samples that serve all phases of a group, and each one's weights for them. */
INLINE void join_many(const struct chunk *chunk, int taps, const struct bp_row_group *group, int first)
{
    const struct bp_row_scratch *scratch = chunk->scratch;
    const int phases = group->phases, n = group->end - group->begin, spread = taps + BP_SPREAD;
    const int *row = scratch->row + first, *step = scratch->step + first;
    const double *u = scratch->q + first;
    int *offset = scratch->offset + first, *rows = scratch->rows + first;
    real *weights = (real *)scratch->weights + (size_t)first * (size_t)spread;
    for (int i = 0; i < n; i++) {
        const int e = i * phases;
        int least = e, most = e;
        for (int p = 1; p < phases; p++) {
            least = row[e + p] < row[least] ? e + p : least;
            most = row[e + p] > row[most] ? e + p : most;
        }
        for (int p = 0; p < phases; p++) {
            real *w = weights + (e + p) * spread;
            for (int t = 0; t < spread; t++)
                w[t] = 0;
            weigh(chunk->table, taps, step[e + p], (real)u[e + p], w + row[e + p] - row[least]);
        }
        rows[i] = taps + row[most] - row[least];
        offset[i] = offset[least]; /* i <= e: what is overwritten has been read */
    }
}

/* ---- the row ---- */

/* `value`, a whole number, inside [least, most]: fmin and fmax are calls. */
static int clamp(double value, int least, int most)
{
    return !(value > least) ? least : value < most ? (int)value : most;
}

/* As pairs.c defines it, for a ping that is u ahead of the pixel. */
static bool inside_limit(const struct bp_raster *raster, double u, double r)
{
    const double distance = sqrt(u * u + r * r),
                 grid_last = raster->grid_first + (raster->columns - 1) * raster->grid_step;
    const double track_last = raster->x_first + (raster->pings - 1) * raster->spacing;
    return fabs(u) <= raster->limit * distance
           || distance <= apex_slack(fmax(fabs(raster->grid_first), fabs(grid_last)),
                                     fmax(fabs(raster->x_first), fabs(track_last)));
}

/* Shifts [begin, end) of one phase inside the aperture: |u| <= limit sqrt(u^2 + r^2), that is, |u| <= edge, u = x + s
   spacing. */
static void shift_bounds(const struct bp_raster *raster, double edge, double x, double r, int *begin, int *end)
{
    const double one_spacing = 1 / raster->spacing;
    const double first = (-edge - x) * one_spacing, last = (edge - x) * one_spacing;
    int low = clamp(ceil(first), *begin, *end), high = clamp(floor(last) + 1, *begin, *end);
    if (fabs(first - floor(first + 0.5)) < 1e-6 || fabs(last - floor(last + 0.5)) < 1e-6) {
        /* so near a shift that rounding decides: as it is defined */
#define INSIDE(s) inside_limit(raster, x + (s)*raster->spacing, r)
        while (low < high && !INSIDE(low))
            low++;
        while (low > *begin && INSIDE(low - 1))
            low--;
        while (high > low && !INSIDE(high - 1))
            high--;
        while (high < *end && INSIDE(high))
            high++;
#undef INSIDE
    }
    *begin = low;
    *end = high;
}

/* Are all delays of a row inside the record, by the least and the longest there could be? `furthest` and `offset`: largest
   distances along the track between ping and pixel and between transmitter and receiver. */
static bool inside_record(const struct bp_medium *medium, const struct bp_raster *raster,
                          const struct delay_terms *terms, double r, double offset, double furthest)
{
    const double v = fabs(terms->v), c = medium->sound_speed, leg = sqrt(furthest * furthest + r * r) / c;
    const double b = furthest + offset + v * leg;
    const double least = fabs(r) / c + (sqrt(terms->er2) - v * b) * terms->one_e;
    const double most = leg + (v * b + sqrt(terms->c2 * b * b + terms->er2)) * terms->one_e;
    const double slack = 1e-9 / medium->fs, last = raster->t0 + (medium->samples - 1) / medium->fs;
    return least >= raster->t0 + slack && most <= last - slack;
}

/* The row's phases in groups that differ by one at the most, and their shifts; returns the largest distance along the track
   between a ping and a pixel. */
static double make_groups(const struct bp_medium *medium, const struct bp_raster *raster, double r, int phases,
                          int group_count, const struct bp_row_scratch *scratch)
{
    const double limit = raster->limit, edge = limit < 1 ? fabs(r) * limit / sqrt((1 - limit) * (1 + limit)) : INFINITY;
    double furthest = 0;
    int total = 0;
    for (int g = 0; g < group_count; g++) {
        const int size = phases / group_count, larger = phases % group_count; /* the first ones have one phase more */
        const int first = g * size + (g < larger ? g : larger), count = size + (g < larger);
        struct bp_row_group *group = &scratch->groups[g];
        struct shifts inside[BP_TOGETHER];
        *group = (struct bp_row_group){.phase = first, .phases = count, .first = total};
        for (int k = 0; k < count; k++) {
            const int p = first + k;
            double x = raster->x_first - (raster->grid_first + p * raster->grid_step);
            int begin = 1 - (raster->columns - p + raster->ratio - 1) / raster->ratio, end = raster->pings;
            if (limit < 1)
                shift_bounds(raster, edge, x, r, &begin, &end);
            inside[k] = (struct shifts){begin, end};
            if (begin == end)
                continue;
            bool empty = group->begin == group->end;
            group->begin = empty || begin < group->begin ? begin : group->begin;
            group->end = empty || end > group->end ? end : group->end;
            furthest = fmax(furthest, fmax(fabs(x + begin * raster->spacing), fabs(x + (end - 1) * raster->spacing)));
        }
        group->to = group->end - group->begin;
        if (group->to == 0)
            continue;
        places(medium, raster, group, inside, r, scratch->leg + total, scratch->ahead + total, scratch->shift + total,
               (real *)scratch->gate + total);
        total += whole_vectors(group->to * count);
    }
    scratch->groups[group_count].first = total;
    return furthest + raster->spacing; /* a group has entries outside the aperture of some of its phases */
}

void BP_ROW(const struct bp_medium *medium, const struct bp_table *table, const struct bp_raster *raster,
            const struct bp_slab *slab, double r, const double *offsets, int count,
            const struct bp_row_scratch *scratch, void *re, void *im, int stride)
{
    const int phases = raster->ratio < raster->columns ? raster->ratio : raster->columns;
    const int group_count = (phases + raster->together - 1) / raster->together;
    const struct delay_terms terms = delay_terms_make(medium, raster, r);
    struct bp_row_group *groups = scratch->groups;
    const struct kernel *kernel = kernels;
    while (kernel->taps != 0 && kernel->taps != table->taps)
        kernel++;
    const double furthest = make_groups(medium, raster, r, phases, group_count, scratch);
    double offset = 0;
    for (int m = 0; m < count; m++)
        offset = fmax(offset, fabs(offsets[m]));
    const bool whole = inside_record(medium, raster, &terms, r, offset, furthest);
    for (int m = 0; m < count; m++) {
        const size_t receiver = (size_t)m * slab->receiver_stride + (size_t)slab->lead;
        struct chunk chunk = {.raster = raster,
                              .table = table,
                              .slab = slab,
                              .scratch = scratch,
                              .sparse = slab->width < table->upsample,
                              .sr = (const real *)slab->re + receiver,
                              .si = (const real *)slab->im + receiver,
                              .re = re,
                              .im = im,
                              .stride = (size_t)stride};
        for (; chunk.begin < group_count; chunk.begin = chunk.end) {
            const int first = groups[chunk.begin].first, together = groups[chunk.begin].phases;
            do
                chunk.end++;
            while (chunk.end < group_count && groups[chunk.end].phases == together
                   && groups[chunk.end + 1].first - first <= scratch->capacity);
            const int n = groups[chunk.end].first - first;
            real *wr = scratch->wr, *wi = scratch->wi;
            const double *leg = scratch->leg + first, *ahead = scratch->ahead + first;
            const real *gate = (const real *)scratch->gate + first;
            if (terms.slow)
                delays(true, medium, raster, &terms, offsets[m], n, leg, ahead, gate, scratch->q, wr, wi);
            else
                delays(false, medium, raster, &terms, offsets[m], n, leg, ahead, gate, scratch->q, wr, wi);
            for (int g = chunk.begin; g < chunk.end; g++) {
                const int e = groups[g].first - first;
                if (chunk.sparse)
                    keep(medium, table, slab, &groups[g], scratch->q + e, wr + e, wi + e, scratch->kept + e);
                else if (!whole)
                    confine(medium, &groups[g], scratch->q + e, wr + e, wi + e);
            }
            const int *shift = chunk.sparse ? scratch->kept : scratch->shift + first;
            tabulate(table, slab, n, scratch->q, shift, scratch->row, scratch->offset, scratch->step);
            if (table->taps == 1)
                join_few(&chunk, 1, n, shift);
            else if (table->taps == 2)
                join_few(&chunk, 2, n, shift);
            for (int g = chunk.begin; table->taps > 2 && g < chunk.end; g++) {
                if (table->taps == 8)
                    join_many(&chunk, 8, &groups[g], groups[g].first - first);
                else
                    join_many(&chunk, table->taps, &groups[g], groups[g].first - first);
            }
            sum_columns(kernel, &chunk);
        }
    }
}
