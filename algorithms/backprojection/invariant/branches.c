/* The sums of a chunk (row.h) where samples are polynomials of Farrow branches. This file is compiled once for each
   precision and instruction set (BP_ISA names it). */
#include <limits.h>

#include "backprojection/farrow.h"
#include "backprojection/invariant/chunk.h"

enum { BRANCHES_MOST = FARROW_MOST + 1, BLOCK_VECTORS = 320 / VECTOR_BYTES };

/* Neighbouring residues of a row that read the same sample in one shift: polynomials of its branches, a vector of
   columns at a time whose branches stay in registers for all of them, and for other rows' that read it. */
struct run {
    const real *x, *y;       /* the sample's first branch of ping `shift` */
    const real *u, *wr, *wi; /* [count] */
    int count, begin, end;   /* columns [begin, end) have pings, begin in whole vectors */
    real *re, *im;           /* of the first residue, from column `stored` on */
    int stored;
    const struct run *next; /* of another row; NULL: none */
};

/* A run's sums in columns of `width` vectors from j on, from the values x, y [branches][width] of its sample. */
INLINE void add_values(int branches, int width, const vector_real *x, const vector_real *y, const struct run *run,
                       size_t stride, int j)
{
    real *re = run->re + (j - run->stored), *im = run->im + (j - run->stored);
    for (int p = 0; p < run->count; p++, re += stride, im += stride) {
        const real u = run->u[p], cosine = run->wr[p], sine = run->wi[p];
        for (int k = 0; k < width; k++) {
            vector_real a = x[(branches - 1) * width + k], b = y[(branches - 1) * width + k];
            for (int m = branches - 2; m >= 0; m--) {
                a = a * u + x[m * width + k];
                b = b * u + y[m * width + k];
            }
            *(vector_real *)(re + k * LANES) = *(vector_real *)(re + k * LANES) + a * cosine - b * sine;
            *(vector_real *)(im + k * LANES) = *(vector_real *)(im + k * LANES) + a * sine + b * cosine;
        }
    }
}

/* These columns of a run, and, where there are other rows, of those that follow it. */
INLINE void add_vectors(int branches, bool rows, int width, const struct run *run, int branch_stride, size_t stride,
                        int j)
{
    vector_real x[2 * BRANCHES_MOST], y[2 * BRANCHES_MOST];
    for (int m = 0; m < branches; m++)
        for (int k = 0; k < width; k++) {
            LOAD(v, run->x + m * branch_stride + j + k * LANES);
            LOAD(w, run->y + m * branch_stride + j + k * LANES);
            x[m * width + k] = v;
            y[m * width + k] = w;
        }
    add_values(branches, width, x, y, run, stride, j);
    if (rows)
        for (const struct run *next = run->next; next; next = next->next)
            add_values(branches, width, x, y, next, stride, j);
}

INLINE void add_run(int branches, bool rows, const struct run *run, int branch_stride, size_t stride)
{
    int j = run->begin;
    for (; VECTOR_BYTES == 64 && branches <= 6 && j + LANES < run->end; j += 2 * LANES)
        add_vectors(branches, rows, 2, run, branch_stride, stride, j);
    for (; j < run->end; j += LANES)
        add_vectors(branches, rows, 1, run, branch_stride, stride, j);
}

/* The run from entry e on, of the residue `residue`; the shift's entries end at `last`. */
INLINE void run_read(const struct chunk *chunk, const struct bp_row_scratch *scratch, int residue, int e, int last,
                     struct run *run)
{
    const int *offset = scratch->offset;
    run->count = 1;
    while (e + run->count < last && offset[e + run->count] == offset[e])
        run->count++;
    run->x = chunk->sr + offset[e];
    run->y = chunk->si + offset[e];
    run->u = (const real *)scratch->weights + e;
    run->wr = (const real *)scratch->wr + e;
    run->wi = (const real *)scratch->wi + e;
    run->re = chunk->re + (size_t)residue * chunk->stride;
    run->im = chunk->im + (size_t)residue * chunk->stride;
}

/* A block's columns [j, end), all shifts of the groups. */
INLINE void sum_block(int branches, const struct chunk *chunk, const struct bp_row_scratch *scratch, int j, int end)
{
    const int pings = chunk->raster->pings, origin = scratch->groups[chunk->begin].first;
    for (int g = chunk->begin; g < chunk->end; g++) {
        const struct bp_row_group group = scratch->groups[g];
        for (int i = group.from; i < group.to; i++) {
            const int first = group.first - origin + i * group.residues, last = first + group.residues;
            const int shift = group.begin + i, low = -shift > j ? -shift : j;
            struct run run = {.begin = j + (low - j) / LANES * LANES,
                              .end = pings - shift < end ? pings - shift : end,
                              .stored = chunk->raster->stored};
            if (low >= run.end)
                continue;
            for (int e = first; e < last; e += run.count) {
                run_read(chunk, scratch, group.residue + e - first, e, last, &run);
                add_run(branches, false, &run, chunk->slab->ping_stride, chunk->stride);
            }
        }
    }
}

/* The runs of a row in a shift, into runs [count]; those that read a sample of an earlier one follow it. Returns the
   new number. */
INLINE int runs_find(const struct chunk *chunk, int g, const struct run *empty, int shift, int count, struct run *runs,
                     bool *follows)
{
    const struct bp_row_scratch *scratch = chunk->scratch;
    const struct bp_row_group group = scratch->groups[g];
    const int i = shift - group.begin, first = group.first - scratch->groups[chunk->begin].first + i * group.residues;
    const int last = first + group.residues;
    if (i < group.from || i >= group.to)
        return count;
    for (int e = first, before; e < last; e += runs[count++].count) {
        struct run *run = &runs[count];
        *run = *empty;
        run_read(chunk, scratch, group.residue + e - first, e, last, run);
        for (before = count - 1; before >= 0 && runs[before].x != run->x; before--)
            ;
        follows[count] = before >= 0;
        if (before >= 0)
            runs[before].next = run;
    }
    return count;
}

/* The same of several rows, shift by shift: they read the same samples, or nearby ones, which are in the cache then. */
INLINE void sum_rows_block(int branches, const struct chunk *chunks, int rows, int j, int end)
{
    const int pings = chunks->raster->pings;
    for (int g = chunks->begin; g < chunks->end; g++) {
        int from = INT_MAX, to = INT_MIN;
        for (int k = 0; k < rows; k++) {
            const struct bp_row_group *group = &chunks[k].scratch->groups[g];
            from = group->begin + group->from < from ? group->begin + group->from : from;
            to = group->begin + group->to > to ? group->begin + group->to : to;
        }
        for (int shift = from; shift < to; shift++) {
            struct run runs[BP_ROWS_MOST];
            bool follows[BP_ROWS_MOST];
            int count = 0;
            const int low = -shift > j ? -shift : j;
            const struct run empty = {.begin = j + (low - j) / LANES * LANES,
                                      .end = pings - shift < end ? pings - shift : end,
                                      .stored = chunks->raster->stored};
            for (int k = 0; k < rows && low < empty.end; k++)
                count = runs_find(&chunks[k], g, &empty, shift, count, runs, follows);
            for (int n = 0; n < count; n++)
                if (!follows[n])
                    add_run(branches, true, &runs[n], chunks->slab->ping_stride, chunks->stride);
        }
    }
}

/* The wanted columns, in blocks of equal width whose sums stay in the cache. Others' pings may not be there. */
INLINE void sum_branches(int branches, const struct chunk *chunks, int rows)
{
    const struct chunk own_chunk = *chunks, *chunk = &own_chunk;
    const struct bp_row_scratch own_scratch = *chunk->scratch, *scratch = &own_scratch;
    const int columns = chunk->raster->residue_columns, wanted = chunk->raster->shown.end;
    const int begin = chunk->raster->shown.begin / LANES * LANES, vectors = (wanted - begin + LANES - 1) / LANES;
    const int end = columns < begin + vectors * LANES ? columns : begin + vectors * LANES;
    const int most = BLOCK_VECTORS * BP_TOGETHER_BRANCHES / (rows * scratch->groups[chunk->begin].residues);
    const int parts = (vectors + most - 1) / most, width = (vectors + parts - 1) / parts * LANES;
    for (int j = begin; j < end; j += width)
        if (rows == 1)
            sum_block(branches, chunk, scratch, j, end < j + width ? end : j + width);
        else
            sum_rows_block(branches, chunks, rows, j, end < j + width ? end : j + width);
}

/* Of each count of branches a function of its own, and one for several rows. */
#define BRANCHES(count)                                                                                                \
    static __attribute__((noinline)) void rows_##count(const struct chunk *chunks, int rows)                           \
    {                                                                                                                  \
        sum_branches(count, chunks, rows);                                                                             \
    }                                                                                                                  \
    static __attribute__((noinline)) void branches_##count(const struct chunk *chunk)                                  \
    {                                                                                                                  \
        sum_branches(count, chunk, 1);                                                                                 \
    }
BRANCHES(3)
BRANCHES(4)
BRANCHES(5)
BRANCHES(6)
BRANCHES(7)
BRANCHES(8)
BRANCHES(9)
BRANCHES(10)
static void (*const branches_add[])(const struct chunk *chunk) = {branches_3, branches_4, branches_5, branches_6,
                                                                  branches_7, branches_8, branches_9, branches_10};
static void (*const rows_add[])(const struct chunk *chunks, int rows) = {rows_3, rows_4, rows_5, rows_6,
                                                                         rows_7, rows_8, rows_9, rows_10};
_Static_assert(sizeof branches_add / sizeof *branches_add == BRANCHES_MOST - FARROW_LEAST, "one for each degree");

void BRANCHES_ADD(const struct chunk *chunks, int rows)
{
    const int degree = chunks->table->branches - 1 - FARROW_LEAST;
    if (rows > 1)
        rows_add[degree](chunks, rows);
    else
        branches_add[degree](chunks);
}
