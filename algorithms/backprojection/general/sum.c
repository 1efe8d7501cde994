/* The inner loops of the general engine: delays of a line of pixels, exactly or from a block's quintic, as runs of pixels for
   general/gather.c. Delay and phase are double, reduced to a fraction of a cycle before they become `real`; where lines bend
   little, only their straight part is. Short loops over arrays in the first-level cache, so that many pixels are in flight
   at once. This file is compiled once for each precision and instruction set (BP_ISA names it). */
#include "backprojection/general/sum.h"

#include <math.h>
#include <string.h>

#include "backprojection/general/run.h"
#include "common/delay.h"

#define BP_SUM REAL_ISA_NAME(bp_sum)

/* Vectors of float rounded to whole ones, and to the nearest integers; whole ones as integers. Whatever the rounding mode. */
#if WINDOWS
#include <immintrin.h>
#if VECTOR_BYTES == 64
#define ROUND(values)                                                                                                  \
    (vector_real) _mm512_roundscale_ps((__m512)(values), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)
#define FLOOR(values) (vector_real) _mm512_roundscale_ps((__m512)(values), _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC)
#define NEAREST(values)                                                                                                \
    (vector_int) _mm512_cvt_roundps_epi32((__m512)(values), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)
#define WHOLE(values) (vector_int) _mm512_cvtps_epi32((__m512)(values))
#else
#define ROUND(values)   (vector_real) _mm256_round_ps((__m256)(values), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)
#define FLOOR(values)   (vector_real) _mm256_round_ps((__m256)(values), _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC)
#define NEAREST(values) WHOLE(ROUND(values))
#define WHOLE(values)   (vector_int) _mm256_cvtps_epi32((__m256)(values))
#endif
#endif

enum {
    NODES = 6,                  /* of a quintic */
    DELAYS = NODES * BP_BLOCKS, /* that are evaluated together, to each receiver of a group */
    BITS = 19,                  /* of a point's fraction */
    SPAN = 4000,                /* whole points that fit beside them in 32 bits, with a sign */
    FLAT_LEAST = 64             /* pixels of a run below which single precision does not pay */
};
#define RATIO_LEAST 0x1p-40 /* cycles to a point below which single precision could not hold the inverse of a bend */

typedef unsigned long long vector_long __attribute__((vector_size(VECTOR_BYTES)));
typedef unsigned vector_unsigned __attribute__((vector_size(LANES * sizeof(int)), aligned(sizeof(int)), may_alias));

/* Places (x, r, 0) on a line as a ping sees them: seconds from the transmitter, and the vector to there from where the
   array's origin is by then. */
struct places {
    int count;
    double x[RUN], r[RUN];
    double leg[RUN], bx[RUN], by[RUN], bz[RUN];
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

/* A ping's velocity; c^2 - |v|^2 and its inverse; so slow that the delay's root may be taken in one form. */
struct motion {
    struct vector v;
    double e, one_e;
    bool slow;
};

static struct motion motion_make(const struct bp_medium *medium, const struct bp_ping *ping)
{
    const struct vector v = ping->velocity;
    const double c = medium->sound_speed, e = delay_margin(v, c);
    return (struct motion){v, e, 1 / e, v.x * v.x + v.y * v.y + v.z * v.z <= BP_SLOW * c * (BP_SLOW * c)};
}

/* The delay (delay.h), in seconds, to the receiver that is (x, y, z) from the place when the echo leaves it, after `leg`. */
INLINE double leg_back(bool slow, const struct motion *motion, double leg, double x, double y, double z)
{
    double p = x * motion->v.x + y * motion->v.y + z * motion->v.z, n = x * x + y * y + z * z;
    double s = sqrt(p * p + motion->e * n);
    return leg + (slow || p >= 0 ? (p + s) * motion->one_e : n / (s - p));
}

/* The delays of all places to one receiver; `slow` is a constant where this is inlined. */
INLINE void legs_back(bool slow, const struct motion *motion, const struct places *places, struct vector rx,
                      double *tau)
{
#pragma omp simd
    for (int i = 0; i < places->count; i++)
        tau[i] =
            leg_back(slow, motion, places->leg[i], rx.x + places->bx[i], rx.y + places->by[i], rx.z + places->bz[i]);
}

/* The same to a group of receivers. */
INLINE void group_back(bool slow, const struct motion *motion, const struct places *places, const double *x,
                       const double *y, const double *z, double (*tau)[GROUP])
{
    for (int i = 0; i < places->count; i++) {
        const double leg = places->leg[i], bx = places->bx[i], by = places->by[i], bz = places->bz[i];
#pragma omp simd
        for (int g = 0; g < GROUP; g++)
            tau[i][g] = leg_back(slow, motion, leg, x[g] + bx, y[g] + by, z[g] + bz);
    }
}

/* From a delay to a point, point = (tau - t0) fs fine + shift, whose whole part is a sample or one of a cubic's
   intervals, and from a point to cycles, cycles = point ratio + base. */
struct scale {
    double t0, fs, fine, shift, ratio, base;
};

/* Every delay evaluated. */
static void sum_exact(const struct bp_medium *medium, const struct bp_table *table, const struct bp_ping *ping,
                      const struct pixel_line *line, const struct scale *scale, int begin, int end, real *re, real *im)
{
    struct places places;
    struct run run;
    double tau[RUN];
    const struct motion motion = motion_make(medium, ping);
    const bool cubics = table->reading == BP_CUBICS;
    const double one = cubics ? BP_INTERVALS : table->steps, last = (medium->samples - 1.0) * table->upsample;
    run.base = 0;
    for (int first = begin; first < end; first += RUN) {
        const int count = end - first < RUN ? end - first : RUN;
        places.count = count;
        for (int i = 0; i < count; i++) {
            struct vector p = line_pixel(line, first + i);
            places.x[i] = p.x;
            places.r[i] = p.y;
        }
        legs_out(medium, ping, &places);
        for (int m = 0; m < ping->receivers; m++) {
            const struct vector rx = ping->rx[m];
            if (motion.slow)
                legs_back(true, &motion, &places, rx, tau);
            else
                legs_back(false, &motion, &places, rx, tau);
#pragma omp simd
            for (int i = 0; i < count; i++) {
                double q = (tau[i] - scale->t0) * scale->fs * table->upsample;
                q = q > 0 ? q : 0; /* the record's ends, but for rounding; nothing else becomes an index */
                q = q < last ? q : last;
                double point = floor(q * one + scale->shift * one), cycles = medium->fc * tau[i];
                double sample = floor((point + 0.5) / one);
                run.sample[i] = (int)sample;
                run.step[i] = (int)(point - sample * one);
                run.rest[i] = (real)(cubics ? q * one - point : run.step[i] / one);
                run.cycles[i] = (real)(cycles - floor(cycles + 0.5));
            }
            BP_TAKE(table, APART, 1, (const real *)ping->rows + 2 * (size_t)m * (size_t)ping->row_length,
                    ping->row_length, count, &run, re + first, im + first);
        }
    }
}

/* Chebyshev points of a block: its middle -+ these half lengths. */
static const double node[NODES] = {-0.96592582628906829, -0.70710678118654752, -0.25881904510252076,
                                   0.25881904510252076,  0.70710678118654752,  0.96592582628906829};

/* The quintics of a group of receivers through their delays at a block's Chebyshev points, [node][receiver]: points of the
   grid against pixels from the block's middle, c [power][receiver]; even and odd part are quadratics in the square, by
   divided differences. Without the scale's shift. *slope, *bend: bounds on their first and second derivatives. */
INLINE void quintics(double (*tau)[GROUP], const struct scale *scale, double half, double (*c)[GROUP], double *slope,
                     double *bend)
{
    const double ya = node[3] * node[3], yb = 0.5, step = 0.43301270189221932; /* yb - ya, half of yc - ya */
    const double one = 1 / half;
    double first[GROUP], second[GROUP];
#pragma omp simd
    for (int g = 0; g < GROUP; g++) {
        double power = scale->fs * scale->fine;
        for (int odd = 0; odd < 2; odd++) {
            double a = odd ? (tau[3][g] - tau[2][g]) * (0.5 / node[3]) : 0.5 * (tau[3][g] + tau[2][g]);
            double b = odd ? (tau[4][g] - tau[1][g]) * (0.5 / node[4]) : 0.5 * (tau[4][g] + tau[1][g]);
            double d = odd ? (tau[5][g] - tau[0][g]) * (0.5 / node[5]) : 0.5 * (tau[5][g] + tau[0][g]);
            double ab = (b - a) * (1 / step), bd = (d - b) * (1 / step), abd = (bd - ab) * (0.5 / step);
            c[odd][g] = a - ya * ab + ya * yb * abd - (odd ? 0 : scale->t0);
            c[2 + odd][g] = ab - (ya + yb) * abd;
            c[4 + odd][g] = abd;
        }
        for (int k = 0; k < NODES; k++) {
            c[k][g] *= power;
            power *= one;
        }
        first[g] = second[g] = 0;
        for (int k = NODES - 1; k > 0; k--) {
            first[g] = k * fabs(c[k][g]) + half * first[g];
            if (k > 1)
                second[g] = k * (k - 1) * fabs(c[k][g]) + half * second[g];
        }
    }
    *slope = *bend = 0;
    for (int g = 0; g < GROUP; g++) {
        *slope = first[g] > *slope ? first[g] : *slope;
        *bend = second[g] > *bend ? second[g] : *bend;
    }
}

/* A line reads few values of each record and comes back to the next line much later: have them fetched together. False where
   a delay is not one of the record, which ends at `last`: then no quintic through it may become an index. */
INLINE bool prefetch(const real *row, int row_length, int group, double (*tau)[GROUP], const struct scale *scale,
                     int upsample, double last)
{
    enum { NEAR = 64 / sizeof(real), MOST = 16 }; /* values of a cache line, cache lines */
    double low[GROUP], high[GROUP];
#pragma omp simd
    for (int g = 0; g < GROUP; g++) {
        double least = tau[0][g], most = tau[0][g];
        for (int k = 1; k < NODES; k++) {
            least = tau[k][g] < least ? tau[k][g] : least;
            most = tau[k][g] > most ? tau[k][g] : most;
        }
        low[g] = (least - scale->t0) * scale->fs * upsample - 1;
        high[g] = (most - scale->t0) * scale->fs * upsample + 1;
    }
    for (int g = 0; g < group; g++)
        if (!(low[g] >= -2 && high[g] <= last + 2))
            return false;
    for (int g = 0; g < group; g++, row += 2 * (size_t)row_length)
        for (int i = (int)low[g]; high[g] - low[g] < MOST * NEAR && i < high[g] + NEAR; i += NEAR) {
            __builtin_prefetch(row + i);
            __builtin_prefetch(row + row_length + i);
        }
    return true;
}

/* Points of a run of pixels from `first` pixels past the block's middle on. A double that is brought to a known exponent is
   a fixed-point number in its lower bits: whole points in its high word; whole points and 19 bits of their fraction, 32 bits
   in all but for cubics, so that the run must stay within SPAN points of its first; 32 bits of a fraction of a cycle. Bits
   are cut off, which is floor: rounding, and with it the rounding mode, decides on the last of them only. Fills whole
   vectors, up to LANES - 1 pixels more than `count`. `reading` is a constant where this is inlined. */
#define LANE(n) n
#define LOW(v)  (vector_int) __builtin_shufflevector((vector_bits)v[0], (vector_bits)v[PARTS - 1], EVEN)
#define HIGH(v) (vector_int) __builtin_shufflevector((vector_bits)v[0], (vector_bits)v[PARTS - 1], ODD)
INLINE void points(double (*quintic)[GROUP], int g, const struct scale *scale, double first, int count,
                   enum bp_reading reading, int steps, struct run *run)
{
    const bool nearest = reading == BP_NEAREST, cubics = reading == BP_CUBICS;
    double c[NODES], begin = 0;
    for (int k = NODES - 1; k >= 0; k--) {
        c[k] = quintic[k][g];
        begin = begin * first + c[k];
    }
    run->base = cubics ? 0 : (int)begin;
    const double shift = scale->shift - run->base + (nearest ? 0x1.8p20 : 0x1.8p33), ratio = scale->ratio;
    const double cycles = c[0] * ratio + scale->base, base = scale->base - floor(cycles) + 0x1.8p20;
    const real one_step = 1 / (real)steps;
    vector_double u[2] = {PART(LANE, 0), PART(LANE, 2)};
    u[0] += first;
    u[1] += first;
    for (int i = 0; i < count; i += LANES) {
        vector_double point[2], fixed[2];
        vector_long whole[2];
        for (int k = 0; k < (int)PARTS; k++) {
            vector_double p = c[0] + u[k] * (c[1] + u[k] * (c[2] + u[k] * (c[3] + u[k] * (c[4] + u[k] * c[5]))));
            point[k] = p + shift;
            whole[k] = (vector_long)point[k] >> BITS;
            fixed[k] = p * ratio + base;
            u[k] += LANES;
        }
        vector_int sample = LOW(point), rest = sample & ((1 << BITS) - 1);
        if (nearest) {
            sample = HIGH(point) - 0x41380000; /* the high word of 0x1.8p20 */
        } else if (cubics) {
            sample = LOW(whole);
            *(vector_int *)(run->step + i) = sample & (BP_INTERVALS - 1);
            sample >>= BP_INTERVAL_BITS;
            *at(run->rest + i) = __builtin_convertvector(rest, vector_real) * (real)0x1p-19;
        } else {
            vector_int step = rest * steps >> BITS;
            sample >>= BITS;
            if (reading == BP_LINE)
                *at(run->rest + i) = __builtin_convertvector(step, vector_real) * one_step;
            else
                *(vector_int *)(run->step + i) = step;
        }
        *(vector_int *)(run->sample + i) = sample;
        *at(run->cycles + i) = __builtin_convertvector(LOW(fixed), vector_real) * (real)0x1p-32;
    }
}

#if WINDOWS
/* A group's quintics about a run's middle, [power][receiver]: points and cycles along a line, and their bend away from it in
   cycles. */
struct flat {
    double point[2][GROUP], cycles[2][GROUP];
    real bend[NODES - 2][GROUP];
};

INLINE void flatten(double (*quintic)[GROUP], const struct scale *scale, double middle, struct flat *flat)
{
    double c[NODES][GROUP];
    memcpy(c, quintic, sizeof c);
    for (int n = 0; n < NODES - 1; n++)
        for (int k = NODES - 2; k >= n; k--)
            for (int g = 0; g < GROUP; g++)
                c[k][g] += middle * c[k + 1][g];
    for (int g = 0; g < GROUP; g++) {
        for (int k = 0; k < 2; k++) {
            flat->point[k][g] = c[k][g];
            flat->cycles[k][g] = c[k][g] * scale->ratio + (k == 0 ? scale->base : 0);
        }
        for (int k = 2; k < NODES; k++)
            flat->bend[k - 2][g] = (real)(c[k][g] * scale->ratio);
    }
}

/* The same as points() for a run that bends little: the line's cycles are a fixed-point number that is counted on, the bend is a
   float. Points are floats that are counted from the run's middle. */
INLINE void points_flat(const struct flat *flat, int g, const struct scale *scale, int count, bool line, int steps,
                        struct run *run)
{
    const double begin = -0.5 * (count - 1), slope = flat->cycles[1][g], step = LANES * slope;
    const double base = flat->cycles[0][g] - floor(flat->cycles[0][g] + begin * slope) + 0x1.8p20;
    vector_double fixed[2] = {PART(LANE, 0), PART(LANE, 2)};
    for (int k = 0; k < (int)PARTS; k++)
        fixed[k] = (fixed[k] + begin) * slope + base;
    vector_unsigned cycles = (vector_unsigned)LOW(fixed);
    const unsigned cycles_step = (unsigned)(long long)((step - floor(step)) * 0x1p32);
    const double middle = floor(flat->point[0][g]);
    const real first = (real)(flat->point[0][g] - middle + (line ? scale->shift : 0)), second = (real)flat->point[1][g];
    const real c2 = flat->bend[0][g], c3 = flat->bend[1][g], c4 = flat->bend[2][g], c5 = flat->bend[3][g];
    const real points_a_cycle = (real)(1 / scale->ratio), one_step = 1 / (real)steps;
    vector_real u = ALL(LANE);
    u += (real)begin;
    run->base = (int)middle;
    for (int i = 0; i < count; i += LANES) {
        vector_real bend = u * u * (c2 + u * (c3 + u * (c4 + u * c5)));
        vector_real cycle = __builtin_convertvector((vector_int)cycles, vector_real) * (real)0x1p-32 + bend;
        vector_real point = first + u * second + bend * points_a_cycle;
        if (line) {
            vector_real whole = FLOOR(point);
            *(vector_int *)(run->sample + i) = WHOLE(whole);
            *at(run->rest + i) = FLOOR((point - whole) * (real)steps) * one_step;
        } else
            *(vector_int *)(run->sample + i) = NEAREST(point);
        *at(run->cycles + i) = cycle - ROUND(cycle);
        cycles += cycles_step;
        u += LANES;
    }
}
#endif

/* A group of receivers over one block; tau: its delays, [node][receiver]. */
INLINE void sum_block(const struct bp_table *table, int group, const real *row, int row_length,
                      const struct scale *scale, double phase_limit, const struct bp_block *block, double (*tau)[GROUP],
                      real *re, real *im)
{
    struct run runs[GROUP];
    _Alignas(64) double c[NODES][GROUP];
    const double half = 0.5 * (block->end - 1 - block->begin), middle = block->begin + half;
    double slope, bend;
    quintics(tau, scale, half, c, &slope, &bend);
    const double slack = 0.01; /* for rounding */
    const enum loading loading = !WINDOWS || slope > 0.5 - slack ? APART
                                 : slope > 2.0 / LANES - slack   ? FOURS
                                                                 : TOGETHER;
    int longest = slope * RUN > SPAN ? (int)fmax(1, SPAN / slope) : RUN;
#if WINDOWS
    /* A bend of n cycles errs by at most 1.1e-6 n rad: 0.15 of the limit (error budget: sum.h). */
    const double cycles = fmin(16, phase_limit * 0x1p17), half_run = sqrt(2 * cycles / (bend * scale->ratio));
    const int flat_longest = 2 * half_run < RUN ? (int)(2 * half_run) / LANES * LANES : RUN;
    const bool flat = loading == TOGETHER && flat_longest >= FLAT_LEAST && scale->ratio > RATIO_LEAST
                      && (table->reading == BP_NEAREST || table->reading == BP_LINE);
    if (flat)
        longest = flat_longest;
#else
    (void)phase_limit;
#endif
    for (int first = block->begin, count; first < block->end; first += count) {
        count = block->end - first < longest ? block->end - first : longest;
#if WINDOWS
        if (flat) {
            struct flat lines;
            flatten(c, scale, first - middle + 0.5 * (count - 1), &lines);
            for (int g = 0; g < group; g++)
                if (table->reading == BP_LINE)
                    points_flat(&lines, g, scale, count, true, table->steps, &runs[g]);
                else
                    points_flat(&lines, g, scale, count, false, 1, &runs[g]);
        } else
#endif
            for (int g = 0; g < group; g++) {
                switch (table->reading) {
                case BP_NEAREST: points(c, g, scale, first - middle, count, BP_NEAREST, 1, &runs[g]); break;
                case BP_LINE: points(c, g, scale, first - middle, count, BP_LINE, table->steps, &runs[g]); break;
                case BP_STEPS: points(c, g, scale, first - middle, count, BP_STEPS, table->steps, &runs[g]); break;
                case BP_CUBICS: points(c, g, scale, first - middle, count, BP_CUBICS, 1, &runs[g]); break;
                }
            }
        BP_TAKE(table, loading, group, row, row_length, count, runs, re + first, im + first);
    }
}

void BP_SUM(const struct bp_medium *medium, const struct bp_table *table, const struct bp_ping *ping,
            const struct pixel_line *line, int block_count, const struct bp_block *blocks, void *re, void *im)
{
    struct places places; /* not cleared: it is large */
    _Alignas(64) double tau[DELAYS][GROUP];
    const struct motion motion = motion_make(medium, ping);
    const bool cubics = table->reading == BP_CUBICS;
    const double fine = table->upsample * (cubics ? BP_INTERVALS : 1), cycles = medium->fc * ping->t0;
    const struct scale scale = {ping->t0,
                                medium->fs,
                                fine,
                                cubics ? 0 : 0.5 / table->steps,
                                medium->fc / (medium->fs * fine),
                                cycles - floor(cycles)};
    places.count = NODES * block_count;
    for (int b = 0; b < block_count; b++) {
        const double half = 0.5 * (blocks[b].end - 1 - blocks[b].begin), middle = blocks[b].begin + half;
        for (int k = 0; k < NODES; k++) {
            places.x[b * NODES + k] = line->x_first + (middle + half * node[k]) * line->x_step;
            places.r[b * NODES + k] = line->r_first + (middle + half * node[k]) * line->r_step;
        }
    }
    legs_out(medium, ping, &places);
    for (int m = 0; m < ping->receivers; m += GROUP) {
        const int group = ping->receivers - m < GROUP ? ping->receivers - m : GROUP;
        const real *row = (const real *)ping->rows + 2 * (size_t)m * (size_t)ping->row_length;
        double x[GROUP], y[GROUP], z[GROUP];
        for (int g = 0; g < GROUP; g++) { /* those that there are not repeat the last one */
            const struct vector rx = ping->rx[m + (g < group ? g : group - 1)];
            x[g] = rx.x;
            y[g] = rx.y;
            z[g] = rx.z;
        }
        if (motion.slow)
            group_back(true, &motion, &places, x, y, z, tau);
        else
            group_back(false, &motion, &places, x, y, z, tau);
        bool readable[BP_BLOCKS];
        for (int b = 0; b < block_count; b++)
            readable[b] = !blocks[b].exact
                          && prefetch(row + table->guard, ping->row_length, group, tau + b * NODES, &scale,
                                      table->upsample, (medium->samples - 1.0) * table->upsample);
        for (int b = 0; b < block_count; b++)
            if (readable[b]) {
                sum_block(table, group, row, ping->row_length, &scale, medium->phase_limit, &blocks[b], tau + b * NODES,
                          re, im);
            } else if (!blocks[b].exact) {
                struct bp_ping some = *ping;
                some.receivers = group;
                some.rx += m;
                some.rows = row;
                sum_exact(medium, table, &some, line, &scale, blocks[b].begin, blocks[b].end, re, im);
            }
    }
    for (int b = 0; b < block_count; b++)
        if (blocks[b].exact)
            sum_exact(medium, table, ping, line, &scale, blocks[b].begin, blocks[b].end, re, im);
}
