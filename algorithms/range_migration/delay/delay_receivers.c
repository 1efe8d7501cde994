/* The receivers of some azimuth wavenumbers, added up to monostatic echoes (delay_compensation.h). Compiled once for
   each precision and instruction set (BP_ISA names it). */
#include <string.h>

#include "range_migration/column.h"

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

/* Wavenumbers that read the same spectra: some classes, and all members of each. */
struct group {
    const struct rma *rma;
    const struct rma_swath *swath;
    const real *data; /* of the first receiver */
    int classes;
    const real *turns[RMA_CLASSES]; /* [receivers][2]: of a class's first wavenumber */
    int begin[RMA_CLASSES + 1];     /* of its members */
    const struct rma_member *members;
    real factors[RMA_FOLD][2]; /* exp(-j 2 pi n/fold) */
};

/* exp(-j pi nu d) of each receiver. */
static void turns_fill(const struct rma *rma, double nu, real *turns)
{
    for (int m = 0; m < rma->receivers; m++) {
        double cycles = -nu * rma->offset[m] / 2;
        phasor((real)(cycles - floor(cycles + 0.5)), &turns[2 * m], &turns[2 * m + 1]);
    }
}

/* U at the edges of the row's vectors, turned by `cycles`. */
static void edges_fill(const struct workspace *w, double nu, double cycles, real *restrict edges)
{
    const struct delay_terms *terms = &w->rma->delay->terms;
    const size_t count = 2 * (size_t)terms->terms * (size_t)(w->swath->row / LANES + 1);
    double weights[4];
    const size_t first = (size_t)delay_terms_place(terms, &w->rma->setting, nu, weights);
    const real *a = (const real *)w->swath->map.edges + first * count, *b = a + count, *c = b + count, *d = c + count;
    const real wa = (real)weights[0], wb = (real)weights[1], wc = (real)weights[2], wd = (real)weights[3];
    real tr, ti;
    phasor((real)(cycles - floor(cycles + 0.5)), &tr, &ti);
    for (size_t k = 0; k < count; k += 2) {
        const real re = wa * a[k] + wb * b[k] + wc * c[k] + wd * d[k],
                   im = wa * a[k + 1] + wb * b[k + 1] + wc * c[k + 1] + wd * d[k + 1];
        edges[k] = re * tr - im * ti;
        edges[k + 1] = re * ti + im * tr;
    }
}

/* Receivers at one vector of samples: turned, weighted and summed over equal numbers modulo fold. With an even fold,
   then sums and differences of those fold/2 apart. */
static inline __attribute__((always_inline)) void partial_sums(const struct group *g, const real *x, const real *turns,
                                                               int terms, vec sums[RMA_FOLD][DELAY_TERMS][2])
{
    const struct rma *rma = g->rma;
    const size_t apart = g->swath->apart;
    const int receivers = rma->receivers, fold = rma->delay->fold, half = fold / 2;
    const real *basis = rma->delay->basis;
    for (int c = 0; c < fold; c++) {
        vec re[DELAY_TERMS], im[DELAY_TERMS];
        for (int q = 0; q < terms; q++)
            re[q] = im[q] = (vec){0};
        for (int m = c; m < receivers; m += fold) {
            const vec xr = *(const vec *)(x + (size_t)m * apart), xi = *(const vec *)(x + (size_t)m * apart + LANES);
            const real *turn = turns + 2 * (size_t)m;
            const vec pr = xr * turn[0] - xi * turn[1], pi = xr * turn[1] + xi * turn[0];
            for (int q = 0; q < terms; q++) {
                const real weight = basis[q * receivers + m];
                re[q] += pr * weight;
                im[q] += pi * weight;
            }
        }
        for (int q = 0; q < terms; q++) {
            sums[c][q][0] = re[q];
            sums[c][q][1] = im[q];
        }
    }
    for (int c = 0; fold % 2 == 0 && c < half; c++)
        for (int q = 0; q < terms; q++)
            for (int part = 0; part < 2; part++) {
                const vec a = sums[c][q][part], b = sums[c + half][q][part];
                sums[c][q][part] = a + b;
                sums[c + half][q][part] = a - b;
            }
}

/* One member's vector of samples, `v` within block. */
static inline __attribute__((always_inline)) void member_store(const struct group *g, const struct rma_member *member,
                                                               int terms, int block, int v,
                                                               vec sums[RMA_FOLD][DELAY_TERMS][2])
{
    const int edges = g->swath->row / LANES + 1, fold = g->rma->delay->fold;
    const int count = fold % 2 == 0 ? fold / 2 : fold;
    vec(*from)[DELAY_TERMS][2] = sums + (fold % 2 == 0 && member->number % 2 != 0 ? count : 0);
    vec re[DELAY_TERMS], im[DELAY_TERMS], along = {0}, zr = {0}, zi = {0};
    for (int q = 0; q < terms; q++) {
        re[q] = from[0][q][0];
        im[q] = from[0][q][1];
    }
    for (int c = 1, n = 0; c < count; c++) {
        n += member->number;
        n -= n >= fold ? fold : 0;
        const real wr = g->factors[n][0], wi = g->factors[n][1];
        for (int q = 0; q < terms; q++) {
            re[q] += from[c][q][0] * wr - from[c][q][1] * wi;
            im[q] += from[c][q][0] * wi + from[c][q][1] * wr;
        }
    }
    for (int l = 0; l < VECTOR; l++)
        along[l] = (real)(v * VECTOR + l) / LANES;
    for (int q = 0; q < terms; q++) {
        const real *u = (const real *)member->edges + 2 * ((size_t)q * (size_t)edges + (size_t)block);
        const vec ur = u[0] + along * (u[2] - u[0]), ui = u[1] + along * (u[3] - u[1]);
        zr += re[q] * ur - im[q] * ui;
        zi += re[q] * ui + im[q] * ur;
    }
    real *to = (real *)member->cut + 2 * ((size_t)block * LANES + (size_t)v * VECTOR);
    *(vec *)to = FIRST(zr, zi);
    *(vec *)(to + VECTOR) = SECOND(zr, zi);
}

static inline __attribute__((always_inline)) void group_add(const struct group *g, int terms)
{
    const int blocks = (g->swath->held + LANES - 1) / LANES;
    const size_t apart = g->swath->apart;
    for (int block = 0; block < blocks; block++) {
        const real *x = g->data + 2 * (size_t)block * LANES;
        for (int m = 0; m < g->rma->receivers; m++) { /* more streams than the processor prefetches itself */
            __builtin_prefetch(x + (size_t)m * apart + 2 * LANES);
            __builtin_prefetch(x + (size_t)m * apart + 3 * LANES);
        }
        for (int v = 0; v < LANES / VECTOR; v++)
            for (int n = 0; n < g->classes; n++) {
                vec sums[RMA_FOLD][DELAY_TERMS][2];
                partial_sums(g, x + v * VECTOR, g->turns[n], terms, sums);
                for (int k = g->begin[n]; k < g->begin[n + 1]; k++)
                    member_store(g, &g->members[k], terms, block, v, sums);
            }
    }
}

/* The members of classes [from, from + RMA_CLASSES) among `count` wavenumbers that read column p. */
static void group_fill(struct workspace *w, int p, int from, real *cuts, struct group *g)
{
    const struct rma *rma = w->rma;
    const struct rma_swath *swath = w->swath;
    const struct rma_delay *delay = rma->delay;
    struct rma_member *members = buffer(w, RMA_MEMBERS);
    const size_t row = 2 * (size_t)swath->row,
                 edges = 2 * (size_t)delay->terms.terms * ((size_t)swath->row / LANES + 1);
    int count = 0;
    g->classes = 0;
    g->members = members;
    for (int n = from; n < from + RMA_CLASSES && n < delay->stride && n < rma->receivers; n++) {
        real *turns = (real *)buffer(w, RMA_TURNS) + 2 * (size_t)(n - from) * (size_t)rma->receivers;
        g->begin[g->classes] = count;
        for (int k = n; k < rma->receivers; k += delay->stride) {
            const struct rma_line line = rma_line(rma, swath, p + k * swath->period);
            const int number = (k - n) / delay->stride;
            if (line.begin >= swath->band)
                continue;
            real *values = (real *)buffer(w, RMA_EDGES) + (size_t)count * edges;
            edges_fill(w, line.nu, number * delay->turn, values);
            members[count++] = (struct rma_member){number % delay->fold, values, cuts + (size_t)k * row};
        }
        if (count == g->begin[g->classes])
            continue;
        turns_fill(rma, rma_line(rma, swath, p + n * swath->period).nu, turns);
        g->turns[g->classes++] = turns;
    }
    g->begin[g->classes] = count;
}

void REAL_ISA_NAME(rma_receivers)(struct workspace *w, int p, real *cuts)
{
    const struct rma *rma = w->rma;
    const struct rma_swath *swath = w->swath;
    const int period = swath->period, wraps = p - swath->wavenumbers / 2;
    const int column = ((rma->spacing < 0 ? -wraps : wraps) % period + period) % period;
    struct group group = {.rma = rma, .swath = swath};
    group.data = (const real *)swath->data + rma_row(swath, 0, column);
    for (int n = 0; n < rma->delay->fold; n++)
        phasor((real)(n * rma->delay->step - floor(n * rma->delay->step + 0.5)), &group.factors[n][0],
               &group.factors[n][1]);
    for (int from = 0; from < rma->delay->stride && from < rma->receivers; from += RMA_CLASSES) {
        group_fill(w, p, from, cuts, &group);
        switch (rma->delay->terms.terms) {
        case 1: group_add(&group, 1); break;
        case 2: group_add(&group, 2); break;
        default: group_add(&group, 3); break;
        }
    }
    stage_end(w, RMA_RECEIVERS);
}
