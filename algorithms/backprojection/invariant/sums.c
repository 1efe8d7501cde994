/* The sums of a chunk (row.h): one or several constants times contiguous pings, vectors of columns at a time. This file
   is compiled once for each precision and instruction set (BP_ISA names it). */
#include <limits.h>

#include "backprojection/invariant/chunk.h"

/* A group's entries for some shifts, and the sums of a block's first column. */
struct part {
    int begin, end; /* shifts, counted from the group's first one */
    const int *offset, *rows;
    const real *wr, *wi, *weights;
    real *re, *im; /* of the group's first residue */
    size_t stride;
};

/* An entry of two residues that read different samples costs a branch if 32 registers have room for a block of all
   columns. With several blocks, each mispredicts the branch: such an entry is summed by itself (sum_apart). */
#define APART_INSIDE (VECTOR_BYTES == 64)

/* One residue, one or two samples with complex weights, `width` vectors of columns. Real and imaginary weights have
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

/* Two residues' values of one entry; `second` has other samples only if `apart`. Real and imaginary parts of samples
   and weights. */
INLINE void add_two(bool apart, int width, int taps, int stride, const real *const first[2],
                    const real *const second[2], const real *const weights[2], vector_real *sums)
{
    const real *r = weights[0], *m = weights[1], *x = first[0], *y = first[1];
    vector_real *a = sums, *b = a + BP_BLOCK_VECTORS, *a2 = b + BP_BLOCK_VECTORS, *b2 = a2 + BP_BLOCK_VECTORS;
    if (apart) { /* else the compiler loads for both branches ahead of them, and runs out of registers */
        OPAQUE(x);
        OPAQUE(y);
    }
    for (int t = 0; t < taps; t++) {
        const real cosine = r[t], sine = m[t], cosine2 = r[taps + t], sine2 = m[taps + t];
        for (int k = 0; k < width; k++) {
            LOAD(v, x + t * stride + k * LANES);
            a[k] += v * cosine;
            b[k] += v * sine;
            if (apart) {
                LOAD(w, second[0] + t * stride + k * LANES);
                a2[k] += w * cosine2;
                b2[k] += w * sine2;
            } else {
                a2[k] += v * cosine2;
                b2[k] += v * sine2;
            }
        }
        for (int k = 0; k < width; k++) {
            LOAD(v, y + t * stride + k * LANES);
            a[k] -= v * sine;
            b[k] += v * cosine;
            if (apart) {
                LOAD(w, second[1] + t * stride + k * LANES);
                a2[k] -= w * sine2;
                b2[k] += w * cosine2;
            } else {
                a2[k] -= v * sine2;
                b2[k] += v * cosine2;
            }
        }
    }
}

/* The same of two residues, most of whose entries read the same samples. */
INLINE void sum_two(int width, int taps, int stride, const struct part *part, const real *sr, const real *si)
{
    vector_real sums[4 * BP_BLOCK_VECTORS] = {{0}};
    const int *offset = part->offset, end = part->end;
    for (int i = part->begin; i < end; i++) {
        const int at = offset[2 * i], at2 = offset[2 * i + 1];
        const real *const first[2] = {sr + at, si + at}, *const second[2] = {sr + at2, si + at2};
        const real *const weights[2] = {part->wr + 2 * i * taps, part->wi + 2 * i * taps};
        if (!APART_INSIDE || __builtin_expect(at == at2, 1))
            add_two(false, width, taps, stride, first, second, weights, sums);
        else
            add_two(true, width, taps, stride, first, second, weights, sums);
    }
    for (int k = 0; k < width; k++)
        for (int n = 0; n < 2; n++) {
            *(vector_real *)(part->re + (size_t)n * part->stride + k * LANES) += sums[2 * n * BP_BLOCK_VECTORS + k];
            *(vector_real *)(part->im + (size_t)n * part->stride + k * LANES) +=
                sums[(2 * n + 1) * BP_BLOCK_VECTORS + k];
        }
}

/* Some residues, many samples with real weights, whose sum is rotated. rows[i] >= taps samples serve all residues of
   the group; a residue's weights are 0 for those that are not its own. Registers have room for the block's sums of one
   residue only. */
INLINE void sum_taps(int residues, int width, int taps, int stride, const struct part *part, const real *sr,
                     const real *si)
{
    const int spread = taps + BP_SPREAD;
    vector_real sum_re[BP_BLOCK_VECTORS] = {{0}}, sum_im[BP_BLOCK_VECTORS] = {{0}};
    for (int i = part->begin; i < part->end; i++) {
        const real *x = sr + part->offset[i], *y = si + part->offset[i], *w = part->weights + i * residues * spread;
        vector_real vr[BP_TOGETHER] = {{0}}, vi[BP_TOGETHER] = {{0}}; /* [residues][width] */
#define TAP(t)                                                                                                         \
    for (int k = 0; k < width; k++) {                                                                                  \
        LOAD(v, x + (t)*stride + k * LANES);                                                                           \
        LOAD(u, y + (t)*stride + k * LANES);                                                                           \
        for (int p = 0; p < residues; p++) {                                                                           \
            vr[p * width + k] += v * w[p * spread + (t)];                                                              \
            vi[p * width + k] += u * w[p * spread + (t)];                                                              \
        }                                                                                                              \
    }
        const int rows = part->rows[i];
        int first = 0;
        for (; first <= rows - 4; first += 4)
            for (int t = first; t < first + 4; t++)
                TAP(t)
        for (; first < rows; first++)
            TAP(first)
        for (int p = 0; p < residues; p++) {
            real cosine = part->wr[i * residues + p], sine = part->wi[i * residues + p];
            for (int k = 0; k < width; k++) {
                const size_t at = (size_t)p * part->stride + (size_t)(k * LANES);
                vector_real *re = residues == 1 ? &sum_re[k] : (vector_real *)(part->re + at);
                vector_real *im = residues == 1 ? &sum_im[k] : (vector_real *)(part->im + at);
                vector_real a = vr[p * width + k], b = vi[p * width + k];
                *re = *re + a * cosine - b * sine;
                *im = *im + a * sine + b * cosine;
            }
        }
    }
    for (int k = 0; residues == 1 && k < width; k++) {
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

/* A block of `width` vectors of columns from j on; `few`: of one or two taps, 0 of more. Works on copies: else each
   store of a sum makes the compiler reload the pointers of a chunk and its scratch. */
INLINE void sum_block(int residues, int width, int few, const struct chunk *shared, int j)
{
    const struct chunk own_chunk = *shared, *chunk = &own_chunk;
    const struct bp_row_scratch own_scratch = *chunk->scratch, *scratch = &own_scratch;
    const struct bp_row_group *groups = scratch->groups;
    const int origin = groups[chunk->begin].first;
    const real *sr = chunk->sr + j, *si = chunk->si + j;
    const int stride = chunk->slab->ping_stride, taps = few > 0 ? few : chunk->table->taps;
    OPAQUE(sr);
    OPAQUE(si);
    for (int g = chunk->begin; g < chunk->end; g++) {
        const struct bp_row_group *group = &groups[g];
        const size_t first = (size_t)(group->first - origin), complex_taps = few > 0 ? (size_t)few : 1;
        const size_t at = (size_t)group->residue * chunk->stride + (size_t)(j - chunk->raster->stored);
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
        if (few == 0)
            sum_taps(residues, width, taps, stride, &part, sr, si);
        else if (residues == 2)
            sum_two(width, few, stride, &part, sr, si);
        else
            sum_one(width, few, stride, &part, sr, si);
    }
}

/* Functions of their own: the compiler runs out of registers where it inlines several. */
#define BLOCK(name, few, residues, width)                                                                              \
    static __attribute__((noinline)) void name##_##residues##_##width(const struct chunk *chunk, int j)                \
    {                                                                                                                  \
        sum_block(residues, width, few, chunk, j);                                                                     \
    }
/* clang-format off */
#if VECTOR_BYTES == 64
#define BLOCKS_FEW(name, few) \
    BLOCK(name, few, 1, 1) BLOCK(name, few, 1, 2) BLOCK(name, few, 1, 3) \
    BLOCK(name, few, 1, 4) BLOCK(name, few, 1, 5) \
    BLOCK(name, few, 2, 1) BLOCK(name, few, 2, 2) BLOCK(name, few, 2, 3) \
    BLOCK(name, few, 2, 4) BLOCK(name, few, 2, 5)
#define TABLE_FEW(name) \
    {{name##_1_1, name##_1_2, name##_1_3, name##_1_4, name##_1_5}, \
     {name##_2_1, name##_2_2, name##_2_3, name##_2_4, name##_2_5}}
#else
#define BLOCKS_FEW(name, few) \
    BLOCK(name, few, 1, 1) BLOCK(name, few, 1, 2) BLOCK(name, few, 1, 3) \
    BLOCK(name, few, 2, 1) BLOCK(name, few, 2, 2)
#define TABLE_FEW(name) {{name##_1_1, name##_1_2, name##_1_3}, {name##_2_1, name##_2_2}}
#endif
#define BLOCKS_MANY(name, few) \
    BLOCK(name, few, 1, 1) BLOCK(name, few, 1, 2) BLOCK(name, few, 1, 3) \
    BLOCK(name, few, 2, 1) BLOCK(name, few, 2, 2) BLOCK(name, few, 2, 3) \
    BLOCK(name, few, 3, 1) BLOCK(name, few, 3, 2) \
    BLOCK(name, few, 4, 1) BLOCK(name, few, 5, 1) BLOCK(name, few, 6, 1)
#define TABLE_MANY(name) \
    {{name##_1_1, name##_1_2, name##_1_3}, {name##_2_1, name##_2_2, name##_2_3}, {name##_3_1, name##_3_2}, \
     {name##_4_1}, {name##_5_1}, {name##_6_1}}
/* clang-format on */
BLOCKS_FEW(nearest, 1)
BLOCKS_FEW(line, 2)
BLOCKS_MANY(many, 0)

typedef void block_function(const struct chunk *chunk, int j);

/* Of one tap, of two, of more: [residues - 1][vectors - 1], as many as registers hold. */
static block_function *const kernels[][BP_TOGETHER][BP_BLOCK_VECTORS] = {TABLE_FEW(nearest), TABLE_FEW(line),
                                                                         TABLE_MANY(many)};

/* Shifts below `end` bring pings to the same vectors of a block: `width` of them from column j on. */
struct region {
    int j, width, end;
};

/* The region that begins with shift s of a block's columns [j, last), some of which have pings. Vectors begin at whole
   vectors of the block. If only the first columns lack pings, vectors end with its last column: of 72 columns four
   vectors of 16 are the last 64. */
INLINE struct region region_from(int s, int pings, int j, int last)
{
    const int low = -s > j ? -s : j, high = pings - s < last ? pings - s : last;
    const int short_by = low - j, ending = (last - low + LANES - 1) / LANES;
    if (high == last && last - ending * LANES > j) {
        const int begin = last - ending * LANES, more = 1 - begin, fewer = pings - last + 1;
        return (struct region){begin, ending, more < fewer ? more : fewer};
    }
    const int begin = j + short_by / LANES * LANES, width = (high - begin + LANES - 1) / LANES;
    const int more = 1 - begin, fewer = pings - begin - (width - 1) * LANES;
    return (struct region){begin, width, begin > j && more < fewer ? more : fewer};
}

/* All columns, in blocks of equal width. If the lead is as wide as a block, a shift with pings for some of its vectors
   is summed for all of them (zeros for the others); else only for those with pings. */
static void sum_columns(struct chunk *chunk)
{
    const int columns = chunk->raster->residue_columns, pings = chunk->raster->pings;
    const struct pair_span *shown = &chunk->raster->shown;
    const struct bp_row_group *groups = chunk->scratch->groups;
    const int taps = chunk->table->taps, residues = groups[chunk->begin].residues;
    block_function *const *block = kernels[taps < 3 ? taps - 1 : 2][residues - 1];
    int least = INT_MAX, most = INT_MIN, widest = BP_BLOCK_VECTORS;
    while (!block[widest - 1])
        widest--;
    for (int g = chunk->begin; g < chunk->end; g++) {
        least = groups[g].begin < least ? groups[g].begin : least;
        most = groups[g].end > most ? groups[g].end : most;
    }
    for (int j = 0, width; j < columns; j += width * LANES) {
        const int left = (columns - j + LANES - 1) / LANES, parts = (left + widest - 1) / widest;
        width = (left + parts - 1) / parts;
        const int last = columns < j + width * LANES ? columns : j + width * LANES;
        if (last <= shown->begin || j >= shown->end)
            continue;
        const int stop = most < pings - j ? most : pings - j;
        for (int s = least > 1 - last ? least : 1 - last; s < stop; s = chunk->to) {
            struct region region = {j, width, stop};
            if (width * LANES > chunk->slab->lead)
                region = region_from(s, pings, j, last);
            chunk->from = s;
            chunk->to = region.end < stop ? region.end : stop;
            /* Of its vectors, those with wanted columns. */
            const int before = shown->begin - region.j, until = shown->end - region.j;
            const int begin = before > 0 ? before / LANES : 0;
            const int end = until < region.width * LANES ? (until + LANES - 1) / LANES : region.width;
            if (begin < end)
                block[end - begin - 1](chunk, region.j + begin * LANES);
        }
    }
}

#if !APART_INSIDE
/* Add one entry, with one or two complex weights, to all columns with a ping. */
INLINE void sum_entry(const struct chunk *chunk, int taps, int residue, int entry, const real *wr, const real *wi)
{
    const int shift = chunk->shift[entry], offset = chunk->scratch->offset[entry];
    const int stride = chunk->slab->ping_stride, pings = chunk->raster->pings, columns = chunk->raster->shown.end;
    const int low = -shift > chunk->raster->shown.begin ? -shift : chunk->raster->shown.begin;
    const int begin = low / LANES * LANES, end = pings - shift < columns ? pings - shift : columns;
    const real *sr = chunk->sr + offset, *si = chunk->si + offset;
    const size_t at = (size_t)residue * chunk->stride + (size_t)(begin - chunk->raster->stored);
    real *re = chunk->re + at, *im = chunk->im + at;
    for (int j = begin; j < end; j += LANES, re += LANES, im += LANES) {
        vector_real a = *(vector_real *)re, b = *(vector_real *)im;
        for (int t = 0; t < taps; t++) {
            vector_real x = *(const vector_real *)(sr + t * stride + j),
                        y = *(const vector_real *)(si + t * stride + j);
            a = a + x * wr[t] - y * wi[t];
            b = b + x * wi[t] + y * wr[t];
        }
        *(vector_real *)re = a;
        *(vector_real *)im = b;
    }
}

/* In pairs of residues, one or two taps: each second entry with samples other than the first one's is summed by
   itself. */
INLINE void sum_apart(const struct chunk *chunk, int taps)
{
    const struct bp_row_scratch *scratch = chunk->scratch;
    const struct bp_row_group *groups = scratch->groups;
    const int first = groups[chunk->begin].first, n = chunk->entries, *offset = scratch->offset;
    int *apart = scratch->rows, count = 0;
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
        real *r = (real *)scratch->wr + e * taps, *m = (real *)scratch->wi + e * taps;
        while (groups[g + 1].first - first <= e)
            g++;
        sum_entry(chunk, taps, groups[g].residue + 1, e, r, m);
        for (int t = 0; t < taps; t++)
            r[t] = m[t] = 0;
    }
}
#endif

void SUMS_ADD(struct chunk *chunk, int rows)
{
    if (chunk->table->reading == BP_BRANCHES) {
        BRANCHES_ADD(chunk, rows);
        return;
    }
#if !APART_INSIDE
    const int taps = chunk->table->taps;
    if (taps <= 2 && chunk->scratch->groups[chunk->begin].residues == 2) {
        if (taps == 1)
            sum_apart(chunk, 1);
        else
            sum_apart(chunk, 2);
    }
#endif
    sum_columns(chunk);
}
