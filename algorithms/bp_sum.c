/* The inner loops of the general engine: delays of a line of pixels, exactly or from a block's quintic, then the sums. Delay
   and phase are double, reduced to a fraction of a turn before they become `real`. Short loops over arrays in the
   first-level cache, so that many pixels are in flight at once. This file is compiled once for each precision and
   instruction set (BP_ISA names it). */
#include "bp_sum.h"

#include <math.h>

#include "lanes.h"
#include "turn.h"

#define BP_SUM REAL_ISA_NAME(bp_sum)

#define INLINE static inline __attribute__((always_inline))

enum {
    RUN = 256,                      /* pixels at a time: the run's arrays stay in the first-level cache */
    NODES = 6                       /* of a quintic */
};

struct sample {
    real re, im;
};

/* Where a run of pixels reads a record, on the grid of bp_table_fine(table) points a sample. */
struct run {
    int count;
    int point[RUN];                 /* whole part, >= 0 */
    real rest[RUN];                 /* fraction; of tables of cubics only */
    real turns[RUN];                /* phase, |turns| <= 1/2 */
};

/* ---- sums ---- */

/* Values LANES indices long, real and imaginary parts apart: copies of whole values, which are faster than gathers, in
   the order from which one shuffle takes the parts. */
#if REAL_DOUBLE
#if VECTOR_BYTES == 64
#define EACH(v) {v(0), v(1), v(2), v(3), v(4), v(5), v(6), v(7)}
#elif VECTOR_BYTES == 32
#define EACH(v) {v(0), v(1), v(2), v(3)}
#else
#define EACH(v) {v(0), v(1)}
#endif
INLINE void gather(const struct sample *from, const int *index, vector_real *re, vector_real *im)
{
#define RE(n) from[index[n]].re
#define IM(n) from[index[n]].im
    *re = (vector_real)EACH(RE);
    *im = (vector_real)EACH(IM);
}
#else
#if VECTOR_BYTES == 64
#define HALF(v, n) {v(n), v(n + 1), v(n + 4), v(n + 5), v(n + 8), v(n + 9), v(n + 12), v(n + 13)}
#define EVEN 0, 2, 16, 18, 4, 6, 20, 22, 8, 10, 24, 26, 12, 14, 28, 30
#define ODD 1, 3, 17, 19, 5, 7, 21, 23, 9, 11, 25, 27, 13, 15, 29, 31
#elif VECTOR_BYTES == 32
#define HALF(v, n) {v(n), v(n + 1), v(n + 4), v(n + 5)}
#define EVEN 0, 2, 8, 10, 4, 6, 12, 14
#define ODD 1, 3, 9, 11, 5, 7, 13, 15
#else
#define HALF(v, n) {v(n), v(n + 1)}
#define EVEN 0, 2, 4, 6
#define ODD 1, 3, 5, 7
#endif
INLINE void gather(const struct sample *from, const int *index, vector_real *re, vector_real *im)
{
    typedef double whole __attribute__((may_alias, aligned(sizeof(real))));    /* both parts at once */
    typedef double vector_whole __attribute__((vector_size(VECTOR_BYTES)));
#define WHOLE(n) *(const whole *)(from + index[n])
    vector_real low = (vector_real)(vector_whole)HALF(WHOLE, 0), high = (vector_real)(vector_whole)HALF(WHOLE, 2);
    *re = __builtin_shufflevector(low, high, EVEN);
    *im = __builtin_shufflevector(low, high, ODD);
}
#endif

INLINE vector_real *at(real *values)
{
    return (vector_real *)values;
}

/* The nearest point. */
static void add_nearest(const struct sample *row, struct run *run, real *wr, real *wi, real *re, real *im)
{
    int i = 0;
    for (; i <= run->count - LANES; i += LANES) {
        vector_real x, y, c = *at(wr + i), s = *at(wi + i);
        gather(row, run->point + i, &x, &y);
        *at(re + i) += x * c - y * s;
        *at(im + i) += x * s + y * c;
    }
    for (; i < run->count; i++) {
        struct sample v = row[run->point[i]];
        re[i] += v.re * wr[i] - v.im * wi[i];
        im[i] += v.re * wi[i] + v.im * wr[i];
    }
}

/* Two weights for each phase of the grid. */
static void add_two(const struct bp_table *table, const struct sample *row, struct run *run, real *wr, real *wi,
                    real *re, real *im)
{
    const struct sample *weights = table->weights;      /* {first, second} */
    const int phases = table->phases;
    const double one = 1.0 / phases;
    int phase[RUN];
#pragma omp simd
    for (int i = 0; i < run->count; i++) {
        int sample = (int)((run->point[i] + 0.5) * one);
        phase[i] = run->point[i] - sample * phases;
        run->point[i] = sample;
    }
    int i = 0;
    for (; i <= run->count - LANES; i += LANES) {
        vector_real ax, ay, bx, by, wa, wb, c = *at(wr + i), s = *at(wi + i);
        gather(row, run->point + i, &ax, &ay);
        gather(row + 1, run->point + i, &bx, &by);
        gather(weights, phase + i, &wa, &wb);
        ax = ax * wa + bx * wb;
        ay = ay * wa + by * wb;
        *at(re + i) += ax * c - ay * s;
        *at(im + i) += ax * s + ay * c;
    }
    for (; i < run->count; i++) {
        struct sample a = row[run->point[i]], b = row[run->point[i] + 1], w = weights[phase[i]];
        real x = a.re * w.re + b.re * w.im, y = a.im * w.re + b.im * w.im;
        re[i] += x * wr[i] - y * wi[i];
        im[i] += x * wi[i] + y * wr[i];
    }
}

/* Many weights, from a grid of phases or from cubics in the fraction; the record's parts lie apart. `taps` is a constant
   where this is inlined, so that the loops over it unroll. */
INLINE void add_taps(const struct bp_table *table, int taps, const real *row_re, const real *row_im,
                     const struct run *run, const real *wr, const real *wi, real *re, real *im)
{
    const real *weights = table->weights;
    const int fine = table->phases > 0 ? table->phases : BP_INTERVALS;
    for (int i = 0; i < run->count; i++) {
        const int sample = run->point[i] / fine, phase = run->point[i] % fine;
        const real *x = row_re + sample, *y = row_im + sample;
        real vr = 0, vi = 0;
        if (table->phases > 0) {
            const real *w = weights + (size_t)phase * (size_t)taps;
#pragma omp simd reduction(+ : vr, vi)
            for (int k = 0; k < taps; k++) {
                vr += w[k] * x[k];
                vi += w[k] * y[k];
            }
        } else {
            const real *w = weights + 4 * (size_t)phase * (size_t)taps, u = run->rest[i];
#pragma omp simd reduction(+ : vr, vi)
            for (int k = 0; k < taps; k++) {
                real weight = w[k] + u * (w[taps + k] + u * (w[2 * taps + k] + u * w[3 * taps + k]));
                vr += weight * x[k];
                vi += weight * y[k];
            }
        }
        re[i] += vr * wr[i] - vi * wi[i];
        im[i] += vr * wi[i] + vi * wr[i];
    }
}

static void add_run(const struct bp_table *table, const real *row, int row_length, struct run *run, real *re, real *im)
{
    real wr[RUN], wi[RUN];
#pragma omp simd
    for (int i = 0; i < run->count; i++)
        turn(run->turns[i], &wr[i], &wi[i]);
    if (!bp_table_planar(table)) {
        const struct sample *first = (const struct sample *)row + table->guard + table->first;
        if (table->taps == 1)
            add_nearest(first, run, wr, wi, re, im);
        else
            add_two(table, first, run, wr, wi, re, im);
        return;
    }
    const real *x = row + table->guard + table->first, *y = x + row_length;
    switch (table->taps) {          /* the shipped kernels unroll, any other length works as well */
    case 8: add_taps(table, 8, x, y, run, wr, wi, re, im); break;
    case 16: add_taps(table, 16, x, y, run, wr, wi, re, im); break;
    case 20: add_taps(table, 20, x, y, run, wr, wi, re, im); break;
    default: add_taps(table, table->taps, x, y, run, wr, wi, re, im); break;
    }
}

/* ---- delays ---- */

/* Places (x, r, 0) on a line as a ping sees them: seconds from the transmitter, and the vector to there from where the
   array's origin is by then. */
struct places {
    int count;
    double x[RUN], r[RUN];
    double leg[RUN], bx[RUN], by[RUN], bz[RUN];
    double tau[RUN];                /* s: delay to the receiver seen last */
};

static void legs_out(const struct bp_medium *medium, const struct bp_ping *ping, struct places *places)
{
    const struct vector tx = ping->tx, v = ping->velocity;
    const double one_c = 1 / medium->sound_speed;
#pragma omp simd
    for (int i = 0; i < places->count; i++) {
        double ax = tx.x - places->x[i], ay = tx.y - places->r[i], leg = sqrt(ax * ax + ay * ay + tx.z * tx.z) * one_c;
        places->leg[i] = leg;
        places->bx[i] = v.x * leg - places->x[i];
        places->by[i] = v.y * leg - places->r[i];
        places->bz[i] = v.z * leg;
    }
}

/* The delays to the receiver at rx (delay.h). */
static void legs_back(const struct bp_medium *medium, const struct bp_ping *ping, struct vector rx, struct places *places)
{
    const struct vector v = ping->velocity;
    const double c = medium->sound_speed, speed = sqrt(v.x * v.x + v.y * v.y + v.z * v.z), e = (c - speed) * (c + speed);
    const double one_e = 1 / e;
#pragma omp simd
    for (int i = 0; i < places->count; i++) {
        double x = rx.x + places->bx[i], y = rx.y + places->by[i], z = rx.z + places->bz[i];
        double p = x * v.x + y * v.y + z * v.z;
        places->tau[i] = places->leg[i] + (p + sqrt(p * p + e * (x * x + y * y + z * z))) * one_e;
    }
}

/* What turns a delay into a point of the table's grid, and a point into turns: point = (tau - t0) fs fine + shift,
   turns = point ratio + base. */
struct scale {
    double t0, fs, fine, shift, ratio, base;
};

/* Every delay evaluated. */
static void sum_exact(const struct bp_medium *medium, const struct bp_table *table, const struct bp_ping *ping,
                      const struct pixel_line *line, const struct scale *scale, int begin, int end, real *re, real *im)
{
    struct places places;
    struct run run;
    for (int first = begin; first < end; first += RUN) {
        places.count = run.count = end - first < RUN ? end - first : RUN;
        for (int i = 0; i < places.count; i++) {
            struct vector p = line_pixel(line, first + i);
            places.x[i] = p.x;
            places.r[i] = p.y;
        }
        legs_out(medium, ping, &places);
        for (int m = 0; m < ping->receivers; m++) {
            legs_back(medium, ping, ping->rx[m], &places);
#pragma omp simd
            for (int i = 0; i < run.count; i++) {
                double point = (places.tau[i] - scale->t0) * scale->fs * scale->fine + scale->shift;
                double turns = medium->fc * places.tau[i];
                run.point[i] = (int)point;
                run.rest[i] = (real)(point - run.point[i]);
                run.turns[i] = (real)(turns - floor(turns + 0.5));
            }
            add_run(table, (const real *)ping->rows + 2 * (size_t)m * (size_t)ping->row_length, ping->row_length, &run,
                    re + first, im + first);
        }
    }
}

/* Chebyshev points of a block: its middle -+ these half lengths. */
static const double node[NODES] = {-0.96592582628906829, -0.70710678118654752, -0.25881904510252076,
                                   0.25881904510252076,  0.70710678118654752,  0.96592582628906829};

/* The quintic through the delays at a block's Chebyshev points, as points of the grid against pixels from the block's
   middle: even and odd part are quadratics in the square, by divided differences. */
INLINE void quintic(const double *tau, const struct scale *scale, double half, double *c)
{
    const double ya = node[3] * node[3], yb = 0.5, step = 0.43301270189221932;     /* yb - ya, half of yc - ya */
    double part[2][3];
    for (int odd = 0; odd < 2; odd++) {
        double a = odd ? (tau[3] - tau[2]) * (0.5 / node[3]) : 0.5 * (tau[3] + tau[2]);
        double b = odd ? (tau[4] - tau[1]) * (0.5 / node[4]) : 0.5 * (tau[4] + tau[1]);
        double d = odd ? (tau[5] - tau[0]) * (0.5 / node[5]) : 0.5 * (tau[5] + tau[0]);
        double ab = (b - a) * (1 / step), bd = (d - b) * (1 / step), abd = (bd - ab) * (0.5 / step);
        part[odd][0] = a - ya * ab + ya * yb * abd;
        part[odd][1] = ab - (ya + yb) * abd;
        part[odd][2] = abd;
    }
    double power = scale->fs * scale->fine, one = 1 / half;
    part[0][0] -= scale->t0;
    for (int k = 0; k < NODES; k++) {
        c[k] = part[k % 2][k / 2] * power;
        power *= one;
    }
    c[0] += scale->shift;
}

/* A line reads few values of each record and comes back to the next line much later: have them fetched together. */
INLINE void prefetch(const struct bp_table *table, const struct sample *row, const double *tau, const struct scale *scale)
{
    enum { NEAR = 64 / sizeof(struct sample), MOST = 16 };      /* values of a cache line, cache lines */
    double low = tau[0], high = tau[0];
    for (int k = 1; k < NODES; k++) {
        low = tau[k] < low ? tau[k] : low;
        high = tau[k] > high ? tau[k] : high;
    }
    low = (low - scale->t0) * scale->fs * table->upsample - 1;
    high = (high - scale->t0) * scale->fs * table->upsample + 1;
    if (!bp_table_planar(table) && high - low < MOST * NEAR)
        for (int i = (int)low; i < high + NEAR; i += NEAR)
            __builtin_prefetch(row + i);
}

/* One receiver over one block. */
INLINE void sum_block(const struct bp_table *table, const real *row, int row_length, const struct scale *scale,
                      const struct bp_block *block, const double *tau, real *re, real *im)
{
    struct run run;
    double c[NODES];
    const double half = 0.5 * (block->end - 1 - block->begin), ratio = scale->ratio, base = scale->base;
    const bool cubics = table->taps > 1 && table->phases == 0;
    quintic(tau, scale, half, c);
    const double c0 = c[0], c1 = c[1], c2 = c[2], c3 = c[3], c4 = c[4], c5 = c[5];
    for (int first = block->begin; first < block->end; first += RUN) {
        const int n = block->end - first < RUN ? block->end - first : RUN;
        const double begin = first - (block->begin + half);
#define POINT(i) \
    double u = begin + (i), u2 = u * u, point = (c0 + u * c1) + u2 * ((c2 + u * c3) + u2 * (c4 + u * c5))
#pragma omp simd
        for (int i = 0; i < n; i++) {
            POINT(i);
            double turns = point * ratio + base;
            run.point[i] = (int)point;
            run.turns[i] = (real)(turns - floor(turns + 0.5));
        }
        if (cubics)
#pragma omp simd
            for (int i = 0; i < n; i++) {
                POINT(i);
                run.rest[i] = (real)(point - run.point[i]);
            }
#undef POINT
        run.count = n;
        add_run(table, row, row_length, &run, re + first, im + first);
    }
}

void BP_SUM(const struct bp_medium *medium, const struct bp_table *table, const struct bp_ping *ping,
            const struct pixel_line *line, int block_count, const struct bp_block *blocks, void *re, void *im)
{
    struct places places = {.count = NODES * block_count};
    const double fine = bp_table_fine(table), turns = medium->fc * ping->t0;
    struct scale scale = {.t0 = ping->t0, .fs = medium->fs, .fine = fine, .shift = table->taps == 1 || table->phases > 0 ? 0.5 : 0,
                          .ratio = medium->fc / (medium->fs * fine)};
    scale.base = turns - floor(turns) - scale.shift * scale.ratio;
    for (int b = 0; b < block_count; b++) {
        const double half = 0.5 * (blocks[b].end - 1 - blocks[b].begin), middle = blocks[b].begin + half;
        for (int k = 0; k < NODES; k++) {
            places.x[b * NODES + k] = line->x_first + (middle + half * node[k]) * line->x_step;
            places.r[b * NODES + k] = line->r_first + (middle + half * node[k]) * line->r_step;
        }
    }
    legs_out(medium, ping, &places);
    for (int m = 0; m < ping->receivers; m++) {
        const real *row = (const real *)ping->rows + 2 * (size_t)m * (size_t)ping->row_length;
        legs_back(medium, ping, ping->rx[m], &places);
        for (int b = 0; b < block_count; b++)
            if (!blocks[b].exact) {
                prefetch(table, (const struct sample *)row + table->guard + table->first, places.tau + b * NODES, &scale);
                sum_block(table, row, ping->row_length, &scale, &blocks[b], places.tau + b * NODES, re, im);
            }
    }
    for (int b = 0; b < block_count; b++)
        if (blocks[b].exact)
            sum_exact(medium, table, ping, line, &scale, blocks[b].begin, blocks[b].end, re, im);
}
