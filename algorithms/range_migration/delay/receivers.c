/* The receivers of some azimuth wavenumbers, added up to monostatic echoes (delay.h). Compiled once for each precision
   and instruction set (BP_ISA names it). */
#include <string.h>

#include "range_migration/column.h"

enum { TOGETHER = VECTOR_BYTES == 64 ? 4 : 2 }; /* wavenumbers, as many as registers hold */

/* The first and the second half of the complex numbers with these real and imaginary parts. */
#if defined __AVX512F__ && !REAL_DOUBLE
#define FIRST(a, b)  __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23)
#define SECOND(a, b) __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31)
#elif defined __AVX512F__ || (defined __AVX__ && !REAL_DOUBLE)
#define FIRST(a, b)  __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11)
#define SECOND(a, b) __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15)
#elif defined __AVX__ || !REAL_DOUBLE
#define FIRST(a, b)  __builtin_shufflevector(a, b, 0, 4, 1, 5)
#define SECOND(a, b) __builtin_shufflevector(a, b, 2, 6, 3, 7)
#else
#define FIRST(a, b)  __builtin_shufflevector(a, b, 0, 2)
#define SECOND(a, b) __builtin_shufflevector(a, b, 1, 3)
#endif

/* Wavenumbers that read the same spectra. */
struct group {
    const struct rma *rma;
    const struct rma_swath *swath;
    const real *data;            /* [receivers][row] */
    int count, member[RMA_TILE]; /* of the tile */
    const real *turns;           /* [RMA_TILE][receivers][2] */
    const complex_real *edges;   /* [RMA_TILE][terms][edges] */
    real *cuts;                  /* [RMA_TILE][stolt_length] complex */
};

/* exp(-j pi nu d) of each receiver. */
static void turns_fill(const struct rma *rma, double nu, real *turns)
{
    for (int m = 0; m < rma->receivers; m++) {
        double cycles = -nu * rma->offset[m] / 2;
        phasor((real)(cycles - floor(cycles + 0.5)), &turns[2 * m], &turns[2 * m + 1]);
    }
}

/* U at the edges of the row's vectors. */
static void edges_fill(const struct workspace *w, double nu, real *restrict edges)
{
    const struct delay_terms *terms = &w->rma->delay->terms;
    const size_t count = 2 * (size_t)terms->terms * (size_t)(w->swath->row / LANES + 1);
    double weights[4];
    const size_t first = (size_t)delay_terms_place(terms, &w->rma->setting, nu, weights);
    const real *a = (const real *)w->swath->map.edges + first * count, *b = a + count, *c = b + count, *d = c + count;
    const real wa = (real)weights[0], wb = (real)weights[1], wc = (real)weights[2], wd = (real)weights[3];
    for (size_t k = 0; k < count; k++)
        edges[k] = wa * a[k] + wb * b[k] + wc * c[k] + wd * d[k];
}

/* One vector of samples of `count` wavenumbers from `member` on; both are constants where this is inlined. */
static inline __attribute__((always_inline)) void samples_add(const struct group *g, const int *member, int count,
                                                              int terms, int block)
{
    const struct rma *rma = g->rma;
    const struct rma_swath *swath = g->swath;
    const size_t row = 2 * (size_t)swath->row;
    const int receivers = rma->receivers, edges = swath->row / LANES + 1, first = block * LANES;
    for (int v = 0; v < LANES / VECTOR; v++) {
        const real *x = g->data + 2 * first + v * VECTOR;
        vec re[TOGETHER][DELAY_TERMS], im[TOGETHER][DELAY_TERMS];
        const vec zero = {0};
        for (int n = 0; n < count; n++)
            for (int q = 0; q < terms; q++)
                re[n][q] = im[n][q] = zero;
        const real *basis = rma->delay->basis;
        for (int m = 0; m < receivers; m++, x += row) {
            const vec xr = *(const vec *)x, xi = *(const vec *)(x + LANES);
            __builtin_prefetch(x
                               + 2 * LANES); /* the next vector's: more streams than the processor follows by itself */
            __builtin_prefetch(x + 3 * LANES);
            for (int n = 0; n < count; n++) {
                const real *turn = g->turns + 2 * ((size_t)member[n] * (size_t)receivers + (size_t)m);
                const vec pr = xr * turn[0] - xi * turn[1], pi = xr * turn[1] + xi * turn[0];
                for (int q = 0; q < terms; q++) {
                    const real weight = basis[q * receivers + m];
                    re[n][q] += pr * weight;
                    im[n][q] += pi * weight;
                }
            }
        }
        vec along = zero;
        for (int l = 0; l < VECTOR; l++)
            along[l] = (real)(v * VECTOR + l) / LANES;
        for (int n = 0; n < count; n++) {
            vec zr = zero, zi = zero;
            for (int q = 0; q < terms; q++) {
                const real *u =
                    (const real *)(g->edges + ((size_t)member[n] * (size_t)terms + (size_t)q) * (size_t)edges
                                   + (size_t)block);
                const vec ur = u[0] + along * (u[2] - u[0]), ui = u[1] + along * (u[3] - u[1]);
                zr += re[n][q] * ur - im[n][q] * ui;
                zi += re[n][q] * ui + im[n][q] * ur;
            }
            /* Samples count from `centre`, a multiple of the vector; those before it are the cut's last. */
            const int sample = first + v * VECTOR, ahead = sample - swath->centre;
            real *to = g->cuts
                       + 2
                             * ((size_t)member[n] * (size_t)swath->stolt_length
                                + (size_t)(ahead < 0 ? ahead + swath->stolt_length : ahead));
            const int kept = swath->held - sample < VECTOR ? swath->held - sample : VECTOR;
            if (kept == VECTOR) {
                *(vec_unaligned *)to = FIRST(zr, zi);
                *(vec_unaligned *)(to + VECTOR) = SECOND(zr, zi);
                continue;
            }
            for (int l = 0; l < kept; l++) {
                to[2 * l] = zr[l];
                to[2 * l + 1] = zi[l];
            }
        }
    }
}

static inline __attribute__((always_inline)) void group_add(const struct group *g, int terms)
{
    const int blocks = (g->swath->held + LANES - 1) / LANES;
    for (int block = 0; block < blocks; block++) {
        int n = 0;
        for (; n + TOGETHER <= g->count; n += TOGETHER)
            samples_add(g, g->member + n, TOGETHER, terms, block);
        for (; n < g->count; n++)
            samples_add(g, g->member + n, 1, terms, block);
    }
}

void REAL_ISA_NAME(rma_receivers)(struct workspace *w, const int *q, const struct rma_line *lines, real *cuts)
{
    const struct rma *rma = w->rma;
    const struct rma_swath *swath = w->swath;
    const int period = swath->period, edges = swath->row / LANES + 1;
    real *turns = buffer(w, RMA_TURNS);
    complex_real *values = buffer(w, RMA_EDGES);
    struct group group = {.rma = rma, .swath = swath, .turns = turns, .edges = values, .cuts = cuts};
    int column[RMA_TILE];
    for (int n = 0; n < RMA_TILE; n++) {
        column[n] = -1;
        if (q[n] < 0 || lines[n].begin >= swath->band)
            continue;
        const int wraps = q[n] - swath->wavenumbers / 2;
        column[n] = ((rma->spacing < 0 ? -wraps : wraps) % period + period) % period;
        /* Zeros between the last sample and the first. */
        memset(cuts + 2 * ((size_t)n * (size_t)swath->stolt_length + (size_t)(swath->held - swath->centre)), 0,
               2 * (size_t)(swath->stolt_length - swath->held) * sizeof *cuts);
        turns_fill(rma, lines[n].nu, turns + 2 * (size_t)n * (size_t)rma->receivers);
        edges_fill(w, lines[n].nu, (real *)(values + (size_t)n * (size_t)rma->delay->terms.terms * (size_t)edges));
    }
    for (int n = 0; n < RMA_TILE; n++) {
        if (column[n] < 0)
            continue;
        group.count = 0;
        group.data = (const real *)swath->data + (size_t)column[n] * (size_t)rma->receivers * 2 * (size_t)swath->row;
        for (int k = RMA_TILE - 1; k >= n; k--)
            if (column[k] == column[n]) {
                group.member[group.count++] = k;
                column[k] = k > n ? -1 : column[k];
            }
        switch (rma->delay->terms.terms) {
        case 1: group_add(&group, 1); break;
        case 2: group_add(&group, 2); break;
        default: group_add(&group, 3); break;
        }
    }
    stage_end(w, RMA_RECEIVERS);
}
