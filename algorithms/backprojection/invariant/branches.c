/* The sums of a chunk (row.h) where samples are polynomials of Farrow branches. This file is compiled once for each
   precision and instruction set (BP_ISA names it). */
#include "backprojection/farrow.h"
#include "backprojection/invariant/chunk.h"

enum { BRANCHES_MOST = FARROW_MOST + 1, BLOCK_VECTORS = 320 / VECTOR_BYTES };

/* Residues that read the same sample in one shift: polynomials of its branches, a vector of columns at a time whose
   branches stay in registers for all of them. */
struct run {
    const real *x, *y;       /* the sample's first branch of ping `shift` */
    const real *u, *wr, *wi; /* [count] */
    int count, begin, end;   /* columns [begin, end) have pings, begin in whole vectors */
    real *re, *im;           /* of the first residue, from column `stored` on */
    int stored;
};

/* Columns of `width` vectors from j on. */
INLINE void add_vectors(int branches, int width, const struct run *run, int branch_stride, size_t stride, int j)
{
    vector_real x[2 * BRANCHES_MOST], y[2 * BRANCHES_MOST];
    for (int m = 0; m < branches; m++)
        for (int k = 0; k < width; k++) {
            LOAD(v, run->x + m * branch_stride + j + k * LANES);
            LOAD(w, run->y + m * branch_stride + j + k * LANES);
            x[m * width + k] = v;
            y[m * width + k] = w;
        }
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

INLINE void add_run(int branches, const struct run *run, int branch_stride, size_t stride)
{
    int j = run->begin;
    for (; VECTOR_BYTES == 64 && branches <= 6 && j + LANES < run->end; j += 2 * LANES)
        add_vectors(branches, 2, run, branch_stride, stride, j);
    for (; j < run->end; j += LANES)
        add_vectors(branches, 1, run, branch_stride, stride, j);
}

/* A block's columns [j, end), all shifts of the groups. */
INLINE void sum_block(int branches, const struct chunk *chunk, const struct bp_row_scratch *scratch, int j, int end)
{
    const int pings = chunk->raster->pings, origin = scratch->groups[chunk->begin].first, *offset = scratch->offset;
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
                run.count = 1;
                while (e + run.count < last && offset[e + run.count] == offset[e])
                    run.count++;
                run.x = chunk->sr + offset[e];
                run.y = chunk->si + offset[e];
                run.u = (const real *)scratch->weights + e;
                run.wr = (const real *)scratch->wr + e;
                run.wi = (const real *)scratch->wi + e;
                run.re = chunk->re + (size_t)(group.residue + e - first) * chunk->stride;
                run.im = chunk->im + (size_t)(group.residue + e - first) * chunk->stride;
                add_run(branches, &run, chunk->slab->ping_stride, chunk->stride);
            }
        }
    }
}

/* The wanted columns, in blocks of equal width whose sums stay in the cache. Others' pings may not be there. */
INLINE void sum_branches(int branches, const struct chunk *shared)
{
    const struct chunk own_chunk = *shared, *chunk = &own_chunk;
    const struct bp_row_scratch own_scratch = *chunk->scratch, *scratch = &own_scratch;
    const int columns = chunk->raster->residue_columns, wanted = chunk->raster->shown.end;
    const int begin = chunk->raster->shown.begin / LANES * LANES, vectors = (wanted - begin + LANES - 1) / LANES;
    const int end = columns < begin + vectors * LANES ? columns : begin + vectors * LANES;
    const int most = BLOCK_VECTORS * BP_TOGETHER_BRANCHES / scratch->groups[chunk->begin].residues;
    const int parts = (vectors + most - 1) / most, width = (vectors + parts - 1) / parts * LANES;
    for (int j = begin; j < end; j += width)
        sum_block(branches, chunk, scratch, j, end < j + width ? end : j + width);
}

/* Of each count of branches a function of its own. */
#define BRANCHES(count)                                                                                                \
    static __attribute__((noinline)) void branches_##count(const struct chunk *chunk)                                  \
    {                                                                                                                  \
        sum_branches(count, chunk);                                                                                    \
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
_Static_assert(sizeof branches_add / sizeof *branches_add == BRANCHES_MOST - FARROW_LEAST, "one for each degree");

void BRANCHES_ADD(const struct chunk *chunk)
{
    branches_add[chunk->table->branches - 1 - FARROW_LEAST](chunk);
}
