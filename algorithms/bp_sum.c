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
    RUN = 512,                      /* pixels at a time: the run's arrays stay in the first-level cache */
    NODES = 6,                      /* of a quintic */
    PARTS = LANES * sizeof(double) / VECTOR_BYTES       /* vectors of doubles to a vector of `real` */
};

typedef double vector_double __attribute__((vector_size(VECTOR_BYTES)));
typedef unsigned long long vector_long __attribute__((vector_size(VECTOR_BYTES)));
typedef float vector_bits __attribute__((vector_size(VECTOR_BYTES)));     /* moved, not computed with */
typedef int vector_int __attribute__((vector_size(LANES * sizeof(int)), aligned(sizeof(int)), may_alias));

TURN(turn_vector, vector_real)

struct sample {
    real re, im;
};

/* Where a run of pixels reads a record. */
struct run {
    int count;
    _Alignas(VECTOR_BYTES) int sample[RUN];     /* of the upsampled record, on from which the taps are counted */
    _Alignas(VECTOR_BYTES) int phase[RUN];      /* row of the table of weights; where one is used */
    _Alignas(VECTOR_BYTES) real rest[RUN];      /* position in the interval of a cubic, or a line's fraction */
    _Alignas(VECTOR_BYTES) real turns[RUN];     /* phase, |turns| <= 1/2 */
};

/* The order of pixels in the parts of a vector, from which one shuffle takes the low halves of all (EVEN) or the high ones
   (ODD) as they come. */
#if REAL_DOUBLE
#if VECTOR_BYTES == 64
#define PART(v, n) {v(0), v(1), v(2), v(3), v(4), v(5), v(6), v(7)}
#define EVEN 0, 2, 4, 6, 8, 10, 12, 14
#elif VECTOR_BYTES == 32
#define PART(v, n) {v(0), v(1), v(2), v(3)}
#define EVEN 0, 2, 4, 6
#else
#define PART(v, n) {v(0), v(1)}
#define EVEN 0, 2
#endif
#else
#if VECTOR_BYTES == 64
#define PART(v, n) {v(n), v(n + 1), v(n + 4), v(n + 5), v(n + 8), v(n + 9), v(n + 12), v(n + 13)}
#define EVEN 0, 2, 16, 18, 4, 6, 20, 22, 8, 10, 24, 26, 12, 14, 28, 30
#define ODD 1, 3, 17, 19, 5, 7, 21, 23, 9, 11, 25, 27, 13, 15, 29, 31
#elif VECTOR_BYTES == 32
#define PART(v, n) {v(n), v(n + 1), v(n + 4), v(n + 5)}
#define EVEN 0, 2, 8, 10, 4, 6, 12, 14
#define ODD 1, 3, 9, 11, 5, 7, 13, 15
#else
#define PART(v, n) {v(n), v(n + 1)}
#define EVEN 0, 2, 4, 6
#define ODD 1, 3, 5, 7
#endif
#endif

/* ---- sums ---- */

/* LANES values, real and imaginary parts apart: copies of whole values, which are faster than gathers. */
INLINE void gather(const struct sample *from, const int *index, vector_real *re, vector_real *im)
{
#if REAL_DOUBLE
#define RE(n) from[index[n]].re
#define IM(n) from[index[n]].im
    *re = (vector_real)PART(RE, 0);
    *im = (vector_real)PART(IM, 0);
#else
    typedef double whole __attribute__((may_alias, aligned(sizeof(real))));    /* both parts at once */
#define WHOLE(n) *(const whole *)(from + index[n])
    vector_real low = (vector_real)(vector_double)PART(WHOLE, 0), high = (vector_real)(vector_double)PART(WHOLE, 2);
    *re = __builtin_shufflevector(low, high, EVEN);
    *im = __builtin_shufflevector(low, high, ODD);
#endif
}

INLINE vector_real *at(const real *values)
{
    return (vector_real *)values;
}

/* Values and those behind them. */
INLINE void gather_two(const struct sample *from, const int *index, vector_real value[2], vector_real next[2])
{
#if REAL_DOUBLE
    gather(from, index, &value[0], &value[1]);
    gather(from + 1, index, &next[0], &next[1]);
#else
    typedef float both __attribute__((vector_size(16), aligned(sizeof(float)), may_alias));
#define BOTH(n) (*(const both *)(from + index[n]))
#if VECTOR_BYTES == 64
#define JOIN(a, b) __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7)
#define BOTHS(n) __builtin_shufflevector(JOIN(BOTH(n), BOTH(n + 4)), JOIN(BOTH(n + 8), BOTH(n + 12)), \
                                         0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#elif VECTOR_BYTES == 32
#define BOTHS(n) __builtin_shufflevector(BOTH(n), BOTH(n + 4), 0, 1, 2, 3, 4, 5, 6, 7)
#else
#define BOTHS(n) BOTH(n)
#endif
    vector_real a = BOTHS(0), b = BOTHS(1), c = BOTHS(2), d = BOTHS(3);
    vector_real re_low = __builtin_shufflevector(a, b, EVEN), re_high = __builtin_shufflevector(c, d, EVEN);
    vector_real im_low = __builtin_shufflevector(a, b, ODD), im_high = __builtin_shufflevector(c, d, ODD);
    value[0] = __builtin_shufflevector(re_low, re_high, EVEN);
    value[1] = __builtin_shufflevector(im_low, im_high, EVEN);
    next[0] = __builtin_shufflevector(re_low, re_high, ODD);
    next[1] = __builtin_shufflevector(im_low, im_high, ODD);
#endif
}

/* What LANES pixels from i on take from a record: the nearest value each, or between two on a line. */
INLINE void take(bool line, const struct sample *row, const struct run *run, int i, vector_real *re, vector_real *im)
{
    vector_real v[2], next[2], c, s;
    turn_vector(*at(run->turns + i), &c, &s);
    if (line) {
        gather_two(row, run->sample + i, v, next);
        v[0] += *at(run->rest + i) * (next[0] - v[0]);
        v[1] += *at(run->rest + i) * (next[1] - v[1]);
    } else {
        gather(row, run->sample + i, &v[0], &v[1]);
    }
    *re = v[0] * c - v[1] * s;
    *im = v[0] * s + v[1] * c;
}

INLINE void add_taken(bool line, const struct sample *row, struct run *run, real *re, real *im)
{
    const int count = run->count;
    vector_real x, y;
    int i = 0;
    for (; i <= count - LANES; i += LANES) {
        take(line, row, run, i, &x, &y);
        *at(re + i) += x;
        *at(im + i) += y;
    }
    if (i == count)
        return;
    for (int k = count; k < i + LANES; k++) {       /* the last vector's other pixels read what may be read */
        run->sample[k] = run->sample[i];
        run->rest[k] = run->turns[k] = 0;
    }
    take(line, row, run, i, &x, &y);
    for (int k = 0; i + k < count; k++) {
        re[i + k] += x[k];
        im[i + k] += y[k];
    }
}

/* Many weights, from a grid of phases or from cubics in the fraction; the record's parts lie apart. `taps` is a constant
   where this is inlined, so that the loops over it unroll. */
INLINE void add_taps(const struct bp_table *table, int taps, const real *row_re, const real *row_im,
                     const struct run *run, real *re, real *im)
{
    const real *weights = table->weights;
    real wr[RUN], wi[RUN];
#pragma omp simd
    for (int i = 0; i < run->count; i++)
        turn(run->turns[i], &wr[i], &wi[i]);
    for (int i = 0; i < run->count; i++) {
        const real *x = row_re + run->sample[i], *y = row_im + run->sample[i];
        real vr = 0, vi = 0;
        if (table->phases > 0) {
            const real *w = weights + (size_t)run->phase[i] * (size_t)taps;
#pragma omp simd reduction(+ : vr, vi)
            for (int k = 0; k < taps; k++) {
                vr += w[k] * x[k];
                vi += w[k] * y[k];
            }
        } else {
            const real *w = weights + 4 * (size_t)run->phase[i] * (size_t)taps, u = run->rest[i];
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
    const real *x = row + table->guard + table->first, *y = x + row_length;
    const struct sample *first = (const struct sample *)row + table->guard + table->first;
    if (!bp_table_planar(table)) {
        if (table->line)
            add_taken(true, first, run, re, im);
        else
            add_taken(false, first, run, re, im);
    } else {
        switch (table->taps) {      /* the shipped kernels unroll, any other length works as well */
        case 8: add_taps(table, 8, x, y, run, re, im); break;
        case 16: add_taps(table, 16, x, y, run, re, im); break;
        case 20: add_taps(table, 20, x, y, run, re, im); break;
        default: add_taps(table, table->taps, x, y, run, re, im); break;
        }
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

/* From a delay to a point, point = (tau - t0) fs fine + shift, whose whole part is a sample or one of a cubic's
   intervals, and from a point to turns, turns = point ratio + base. */
struct scale {
    double t0, fs, fine, shift, ratio, base;
};

/* Every delay evaluated. */
static void sum_exact(const struct bp_medium *medium, const struct bp_table *table, const struct bp_ping *ping,
                      const struct pixel_line *line, const struct scale *scale, int begin, int end, real *re, real *im)
{
    struct places places;
    struct run run;
    const bool cubics = bp_table_cubics(table);
    const double one = cubics ? BP_INTERVALS : table->phases;
    for (int first = begin; first < end; first += RUN) {
        const int count = end - first < RUN ? end - first : RUN;
        places.count = run.count = count;
        for (int i = 0; i < count; i++) {
            struct vector p = line_pixel(line, first + i);
            places.x[i] = p.x;
            places.r[i] = p.y;
        }
        legs_out(medium, ping, &places);
        for (int m = 0; m < ping->receivers; m++) {
            legs_back(medium, ping, ping->rx[m], &places);
#pragma omp simd
            for (int i = 0; i < count; i++) {
                double q = (places.tau[i] - scale->t0) * scale->fs * table->upsample;
                double point = floor(q * one + scale->shift * one), turns = medium->fc * places.tau[i];
                double sample = floor((point + 0.5) / one);
                run.sample[i] = (int)sample;
                run.phase[i] = (int)(point - sample * one);
                run.rest[i] = (real)(cubics ? q * one - point : run.phase[i] / one);
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
   middle: even and odd part are quadratics in the square, by divided differences. Without the scale's shift. */
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
}

/* A line reads few values of each record and comes back to the next line much later: have them fetched together. */
INLINE void prefetch(const struct sample *row, const double *tau, const struct scale *scale, int upsample)
{
    enum { NEAR = 64 / sizeof(struct sample), MOST = 16 };      /* values of a cache line, cache lines */
    double low = tau[0], high = tau[0];
    for (int k = 1; k < NODES; k++) {
        low = tau[k] < low ? tau[k] : low;
        high = tau[k] > high ? tau[k] : high;
    }
    low = (low - scale->t0) * scale->fs * upsample - 1;
    high = (high - scale->t0) * scale->fs * upsample + 1;
    if (high - low < MOST * NEAR)
        for (int i = (int)low; i < high + NEAR; i += NEAR)
            __builtin_prefetch(row + i);
}

/* Points of a run of pixels from `first` pixels past the block's middle on. A double that is brought to a known exponent is
   a fixed-point number in its lower bits: whole points and 19 bits of their fraction, or 32 bits of a fraction of a
   turn, without rounding or conversion. Fills whole vectors, up to LANES - 1 pixels more than `count`. */
INLINE void points(const double *c, const struct scale *scale, double first, const struct bp_table *table, bool cubics,
                   struct run *run)
{
    enum { BITS = 19 };
    const double shift = scale->shift + 0x1.8p33, ratio = scale->ratio;
    const double turns = c[0] * ratio + scale->base, base = scale->base - floor(turns) + 0x1.8p20;
    const real one_phase = 1 / (real)table->phases;
#define LANE(n) n
    vector_double u[2] = {PART(LANE, 0), PART(LANE, 2)};
    u[0] += first;
    u[1] += first;
    for (int i = 0; i < run->count; i += LANES) {
        vector_double point[2], turned[2];
        vector_long whole[2];
        for (int k = 0; k < (int)PARTS; k++) {
            vector_double u2 = u[k] * u[k];
            vector_double p = (c[0] + u[k] * c[1]) + u2 * ((c[2] + u[k] * c[3]) + u2 * (c[4] + u[k] * c[5]));
            turned[k] = p * ratio + base;
            point[k] = p + shift;
            whole[k] = (vector_long)point[k] >> BITS;
            u[k] += LANES;
        }
#define LOW(v) (vector_int)__builtin_shufflevector((vector_bits)v[0], (vector_bits)v[PARTS - 1], EVEN)
        vector_int sample = LOW(whole);
        if (cubics) {
            *(vector_int *)(run->phase + i) = sample & (BP_INTERVALS - 1);
            sample >>= BP_INTERVAL_BITS;
            vector_int rest = LOW(point) & ((1 << BITS) - 1);
            *at(run->rest + i) = __builtin_convertvector(rest, vector_real) * (real)0x1p-19;
        } else if (table->taps > 1) {
            vector_int rest = LOW(point) & ((1 << BITS) - 1), phase = rest * table->phases >> BITS;
            if (table->line)
                *at(run->rest + i) = __builtin_convertvector(phase, vector_real) * one_phase;
            else
                *(vector_int *)(run->phase + i) = phase;
        }
        *(vector_int *)(run->sample + i) = sample;
        *at(run->turns + i) = __builtin_convertvector(LOW(turned), vector_real) * (real)0x1p-32;
    }
}

/* One receiver over one block. */
INLINE void sum_block(const struct bp_table *table, const real *row, int row_length, const struct scale *scale,
                      const struct bp_block *block, const double *tau, real *re, real *im)
{
    struct run run;
    double c[NODES];
    const double half = 0.5 * (block->end - 1 - block->begin), middle = block->begin + half;
    quintic(tau, scale, half, c);
    for (int first = block->begin; first < block->end; first += RUN) {
        run.count = block->end - first < RUN ? block->end - first : RUN;
        if (bp_table_cubics(table))
            points(c, scale, first - middle, table, true, &run);
        else
            points(c, scale, first - middle, table, false, &run);
        add_run(table, row, row_length, &run, re + first, im + first);
    }
}

void BP_SUM(const struct bp_medium *medium, const struct bp_table *table, const struct bp_ping *ping,
            const struct pixel_line *line, int block_count, const struct bp_block *blocks, void *re, void *im)
{
    struct places places = {.count = NODES * block_count};
    const bool cubics = bp_table_cubics(table);
    const double fine = table->upsample * (cubics ? BP_INTERVALS : 1), turns = medium->fc * ping->t0;
    const struct scale scale = {ping->t0, medium->fs, fine, cubics ? 0 : 0.5 / table->phases, medium->fc / (medium->fs * fine),
                                turns - floor(turns)};
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
                if (!bp_table_planar(table))
                    prefetch((const struct sample *)row + table->guard, places.tau + b * NODES, &scale, table->upsample);
                sum_block(table, row, ping->row_length, &scale, &blocks[b], places.tau + b * NODES, re, im);
            }
    }
    for (int b = 0; b < block_count; b++)
        if (blocks[b].exact)
            sum_exact(medium, table, ping, line, &scale, blocks[b].begin, blocks[b].end, re, im);
}
