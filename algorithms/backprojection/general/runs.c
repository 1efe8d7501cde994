/* The quintics of a block of pixels, and from them its runs (run.h): positions in the records and phases, for gather.c.
   Delay and phase are double, reduced to a fraction of a cycle before they become `real`. In runs that bend little only
   the straight part is double. This file is compiled once for each precision and instruction set (BP_ISA names it). */
#include <limits.h>
#include <math.h>
#include <string.h>

#include "backprojection/budget.h"
#include "backprojection/general/run.h"

/* Vectors less the nearest whole numbers, and these as integers; of float also rounded down, and whole ones as
   integers. Whatever the rounding mode. */
#ifdef __AVX__
#include <immintrin.h>
#define TO_NEAREST (_MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)
#define DOWN       (_MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC)
#if VECTOR_BYTES == 64 && REAL_DOUBLE
#define FRACTION(values) (vector_real) _mm512_reduce_pd((__m512d)(values), TO_NEAREST)
#define NEAREST(values)  (vector_int) _mm512_cvt_roundpd_epi32((__m512d)(values), TO_NEAREST)
#elif VECTOR_BYTES == 64
#define FRACTION(values) (vector_real) _mm512_reduce_ps((__m512)(values), TO_NEAREST)
#define NEAREST(values)  (vector_int) _mm512_cvt_roundps_epi32((__m512)(values), TO_NEAREST)
#define FLOOR(values)    (vector_real) _mm512_roundscale_ps((__m512)(values), DOWN)
#define WHOLE(values)    (vector_int) _mm512_cvtps_epi32((__m512)(values))
#else
#if REAL_DOUBLE
#define ROUND(values) (vector_real) _mm256_round_pd((__m256d)(values), TO_NEAREST)
#define WHOLE(values) (vector_int) _mm256_cvtpd_epi32((__m256d)(values))
#else
#define ROUND(values) (vector_real) _mm256_round_ps((__m256)(values), TO_NEAREST)
#define FLOOR(values) (vector_real) _mm256_round_ps((__m256)(values), DOWN)
#define WHOLE(values) (vector_int) _mm256_cvtps_epi32((__m256)(values))
#endif
#define FRACTION(values) ((values)-ROUND(values))
#define NEAREST(values)  WHOLE(ROUND(values))
#endif
#endif

enum { FLAT_LEAST = 64 };   /* fewest pixels of a run where single precision pays */
#define RATIO_LEAST 0x1p-40 /* least cycles a point: below, the inverse of a bend overflows single precision */

typedef unsigned long long vector_long __attribute__((vector_size(VECTOR_BYTES)));
typedef unsigned vector_unsigned __attribute__((vector_size(LANES * sizeof(int)), aligned(sizeof(int)), may_alias));

/* The quintics of a group of receivers through their delays at a block's Chebyshev points, [node][receiver]: points of
   the grid against pixels from the block's middle, c [power][receiver]; even and odd part are quadratics in the square,
   by divided differences. Without the scale's shift. *slope, *bend: bounds on their first and second derivatives. */
INLINE void quintics(double (*tau)[GROUP_RECEIVERS], const struct scale *scale, double half,
                     double (*c)[GROUP_RECEIVERS], double *slope, double *bend)
{
    const double ya = node[3] * node[3], yb = 0.5, step = 0.43301270189221932; /* yb - ya, half of yc - ya */
    const double one = 1 / half;
    double first[GROUP_RECEIVERS], second[GROUP_RECEIVERS];
#pragma omp simd
    for (int g = 0; g < GROUP_RECEIVERS; g++) {
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
    for (int g = 0; g < GROUP_RECEIVERS; g++) {
        *slope = first[g] > *slope ? first[g] : *slope;
        *bend = second[g] > *bend ? second[g] : *bend;
    }
}

#define LOW(v)  (vector_int) __builtin_shufflevector((vector_bits)v[0], (vector_bits)v[PARTS - 1], EVEN)
#define HIGH(v) (vector_int) __builtin_shufflevector((vector_bits)v[0], (vector_bits)v[PARTS - 1], ODD)
/* The nearest samples, the distances from them, and phases as fractions of a cycle: of fixed-point numbers, or where
   an instruction rounds vectors of double. */
#if defined __AVX__ && REAL_DOUBLE
#define POINT_ADDEND (-0.5)
#define CYCLE_ADDEND 0
#define SAMPLES(v)   NEAREST(v[0])
#define DISTANCES(v) FRACTION(v[0])
#define FRACTIONS(v) FRACTION(v[0])
#else
#define POINT_ADDEND FIXED_32
#define CYCLE_ADDEND FIXED_32
#define SAMPLES(v)   (HIGH(v) - FIXED_32_HIGH)
#define DISTANCES(v) (__builtin_convertvector(LOW(v) ^ INT_MIN, vector_real) * LAST_32)
#define FRACTIONS(v) (__builtin_convertvector(LOW(v), vector_real) * LAST_32)
#endif

/* Points of a run of pixels from `first` pixels past the block's middle on, as fixed-point numbers (run.h). Bits are
   cut off, which is floor: the rounding mode affects only the last bit. Fills whole vectors, up to LANES - 1 pixels
   more than `count`. `reading` is a constant where this is inlined. */
INLINE void points(double (*quintic)[GROUP_RECEIVERS], int g, const struct scale *scale, double first, int count,
                   enum bp_reading reading, int steps, struct run *run)
{
    const bool nearest = reading == BP_NEAREST || reading == BP_BRANCHES, cubics = reading == BP_CUBICS;
    double c[NODES], begin = 0;
    for (int k = NODES - 1; k >= 0; k--) {
        c[k] = quintic[k][g];
        begin = begin * first + c[k];
    }
    run->base = cubics ? 0 : (int)begin;
    const double shift = scale->shift - run->base + (nearest ? POINT_ADDEND : FIXED_19);
    const double ratio = scale->ratio, cycles = c[0] * ratio + scale->base;
    const double base = scale->base - floor(cycles) + CYCLE_ADDEND;
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
            whole[k] = (vector_long)point[k] >> POINT_BITS;
            fixed[k] = p * ratio + base;
            u[k] += LANES;
        }
        vector_int sample = LOW(point), rest = sample & ((1 << POINT_BITS) - 1);
        if (nearest) {
            if (reading == BP_BRANCHES)
                *at(run->rest + i) = DISTANCES(point);
            sample = SAMPLES(point);
        } else if (cubics) {
            sample = LOW(whole);
            *(vector_int *)(run->step + i) = sample & (BP_INTERVALS - 1);
            sample >>= BP_INTERVAL_BITS;
            *at(run->rest + i) = __builtin_convertvector(rest, vector_real) * LAST_19;
        } else {
            vector_int step = rest * steps >> POINT_BITS;
            sample >>= POINT_BITS;
            if (reading == BP_LINE)
                *at(run->rest + i) = __builtin_convertvector(step, vector_real) * one_step;
            else
                *(vector_int *)(run->step + i) = step;
        }
        *(vector_int *)(run->sample + i) = sample;
        *at(run->cycles + i) = FRACTIONS(fixed);
    }
}

#if WINDOWS
/* A group's quintics about a run's middle, [power][receiver]: points and cycles along a line, and their bend away from
   it in cycles. */
struct flat {
    double point[2][GROUP_RECEIVERS], cycles[2][GROUP_RECEIVERS];
    real bend[NODES - 2][GROUP_RECEIVERS];
};

INLINE void flatten(double (*quintic)[GROUP_RECEIVERS], const struct scale *scale, double middle, struct flat *flat)
{
    double c[NODES][GROUP_RECEIVERS];
    memcpy(c, quintic, sizeof c);
    for (int n = 0; n < NODES - 1; n++)
        for (int k = NODES - 2; k >= n; k--)
            for (int g = 0; g < GROUP_RECEIVERS; g++)
                c[k][g] += middle * c[k + 1][g];
    for (int g = 0; g < GROUP_RECEIVERS; g++) {
        for (int k = 0; k < 2; k++) {
            flat->point[k][g] = c[k][g];
            flat->cycles[k][g] = c[k][g] * scale->ratio + (k == 0 ? scale->base : 0);
        }
        for (int k = 2; k < NODES; k++)
            flat->bend[k - 2][g] = (real)(c[k][g] * scale->ratio);
    }
}

/* Points of a run that bends little for BP_BRANCHES: fixed-point numbers of 23 bits of fraction along the line, which
   are counted on, plus the bend and the step's rounding in float. */
struct ladder {
    vector_unsigned point;
    unsigned step;                    /* of a vector */
    real points_a_cycle, points_left; /* 2^-23: bend of a cycle, and the step's rounding for each pixel */
};

INLINE struct ladder ladder_make(const struct flat *flat, int g, const struct scale *scale, double begin, double middle)
{
    const double exact = LANES * flat->point[1][g] * 0x1p23, step = floor(exact + 0.5);
    const double slope = step * (0x1p-23 / LANES);
    vector_double fixed[2] = {PART(LANE, 0), PART(LANE, 2)};
    for (int k = 0; k < (int)PARTS; k++)
        fixed[k] = (fixed[k] + begin) * slope + (flat->point[0][g] + scale->shift - middle + FIXED_23);
    return (struct ladder){(vector_unsigned)LOW(fixed), (unsigned)(int)step, (real)(0x1p23 / scale->ratio),
                           (real)((exact - step) / LANES)};
}

/* The same as points() for a run that bends little: the line's cycles are a fixed-point number that is counted on,
   the bend is a float. Points are floats that are counted from the run's middle; those of branches are ladders. */
INLINE void points_flat(const struct flat *flat, int g, const struct scale *scale, int count, enum bp_reading reading,
                        int steps, struct run *run)
{
    const bool line = reading == BP_LINE, branches = reading == BP_BRANCHES;
    const double begin = -0.5 * (count - 1), slope = flat->cycles[1][g], step = LANES * slope;
    const double base = flat->cycles[0][g] - floor(flat->cycles[0][g] + begin * slope) + FIXED_32;
    vector_double fixed[2] = {PART(LANE, 0), PART(LANE, 2)};
    for (int k = 0; k < (int)PARTS; k++)
        fixed[k] = (fixed[k] + begin) * slope + base;
    vector_unsigned cycles = (vector_unsigned)LOW(fixed);
    const unsigned cycles_step = (unsigned)(long long)((step - floor(step)) * 0x1p32);
    const double middle = floor(flat->point[0][g] + (branches ? scale->shift : 0));
    const real first = (real)(flat->point[0][g] - middle + (line ? scale->shift : 0)), second = (real)flat->point[1][g];
    const real c2 = flat->bend[0][g], c3 = flat->bend[1][g], c4 = flat->bend[2][g], c5 = flat->bend[3][g];
    const real points_a_cycle = (real)(1 / scale->ratio), one_step = 1 / (real)steps;
    vector_real u = ALL(LANE);
    u += (real)begin;
    run->base = (int)middle;
    struct ladder ladder = ladder_make(flat, g, scale, begin, middle);
    for (int i = 0; i < count; i += LANES) {
        vector_real bend = u * u * (c2 + u * (c3 + u * (c4 + u * c5)));
        vector_real cycle = __builtin_convertvector((vector_int)cycles, vector_real) * LAST_32 + bend;
        vector_real point = first + u * second + bend * points_a_cycle;
        if (branches) {
            const vector_real more = u * ladder.points_left + bend * ladder.points_a_cycle;
            const vector_int fixed_point = (vector_int)(ladder.point + (vector_unsigned)NEAREST(more));
            *(vector_int *)(run->sample + i) = fixed_point >> 23;
            /* the fraction as the mantissa of a float from 1 to 2 */
            *at(run->rest + i) = (vector_real)((fixed_point & ((1 << 23) - 1)) | 0x3f800000) - (real)1.5;
            ladder.point += ladder.step;
        } else if (line) {
            vector_real whole = FLOOR(point);
            *(vector_int *)(run->sample + i) = WHOLE(whole);
            *at(run->rest + i) = FLOOR((point - whole) * (real)steps) * one_step;
        } else
            *(vector_int *)(run->sample + i) = NEAREST(point);
        *at(run->cycles + i) = FRACTION(cycle);
        cycles += cycles_step;
        u += LANES;
    }
}
#endif

/* How the samples of neighbouring pixels are loaded, `slope` points apart at the most. Branches: by windows (run.h). */
INLINE enum loading loading_choose(enum bp_reading reading, double slope)
{
    const double slack = 0.01; /* for rounding */
    if (reading == BP_BRANCHES && !BLOCKS)
        return PERMUTES && slope < 1 - 2.0 / LANES - slack ? TOGETHER : APART;
    if (reading == BP_BRANCHES)
        return slope > 1 - slack ? APART : slope > 0.5 - slack ? FOURS : TOGETHER;
    return !WINDOWS || slope > 0.5 - slack ? APART : slope > 2.0 / LANES - slack ? FOURS : TOGETHER;
}

#if WINDOWS
/* The most pixels of a run in single precision, whose bend is a float; 0 where none is. `bend`: in points. */
INLINE int flat_longest(const struct receiver_group *group, enum loading loading, double bend)
{
    const enum bp_reading reading = group->table->reading;
    const double ratio = group->scale->ratio, half_run = sqrt(2 * budget_bend(group->phase_limit) / (bend * ratio));
    const int longest = 2 * half_run < RUN_PIXELS ? (int)(2 * half_run) / LANES * LANES : RUN_PIXELS;
    const bool near = reading == BP_BRANCHES ? loading != APART
                                             : loading == TOGETHER && (reading == BP_NEAREST || reading == BP_LINE);
    const bool flat = near && longest >= FLAT_LEAST && ratio > RATIO_LEAST;
    return flat ? longest : 0;
}

INLINE void runs_flat(const struct receiver_group *group, double (*quintic)[GROUP_RECEIVERS], double middle, int count,
                      struct run *runs)
{
    const struct bp_table *table = group->table;
    struct flat lines;
    flatten(quintic, group->scale, middle, &lines);
    for (int g = 0; g < group->receivers; g++)
        switch (table->reading) {
        case BP_LINE: points_flat(&lines, g, group->scale, count, BP_LINE, table->steps, &runs[g]); break;
        case BP_BRANCHES: points_flat(&lines, g, group->scale, count, BP_BRANCHES, 1, &runs[g]); break;
        default: points_flat(&lines, g, group->scale, count, BP_NEAREST, 1, &runs[g]); break;
        }
}
#endif

INLINE void runs_fixed(const struct receiver_group *group, double (*quintic)[GROUP_RECEIVERS], double first, int count,
                       struct run *runs)
{
    const struct scale *scale = group->scale;
    const int steps = group->table->steps > 1 ? group->table->steps : 1; /* cubics have 0: divisions may be hoisted */
    for (int g = 0; g < group->receivers; g++) {
        switch (group->table->reading) {
        case BP_NEAREST: points(quintic, g, scale, first, count, BP_NEAREST, 1, &runs[g]); break;
        case BP_LINE: points(quintic, g, scale, first, count, BP_LINE, steps, &runs[g]); break;
        case BP_STEPS: points(quintic, g, scale, first, count, BP_STEPS, steps, &runs[g]); break;
        case BP_CUBICS: points(quintic, g, scale, first, count, BP_CUBICS, 1, &runs[g]); break;
        case BP_BRANCHES: points(quintic, g, scale, first, count, BP_BRANCHES, 1, &runs[g]); break;
        }
    }
}

/* The most points between neighbouring pixels of a block, or of the records' own pixels in it: as delays are convex
   along a line, at one of either end. */
INLINE double slope_most(const struct receiver_group *group, const struct bp_block *block, bool own, double middle,
                         double (*c)[GROUP_RECEIVERS])
{
    double slope = 0;
    for (int end = 0; end < 2; end++) {
        double u[GROUP_RECEIVERS], slopes[GROUP_RECEIVERS];
        for (int g = 0; g < GROUP_RECEIVERS; g++) {
            int pixel = end ? block->end - 1 : block->begin;
            if (own && g < group->receivers) {
                const struct pair_span within = group->within[g];
                pixel = pixel > within.begin ? pixel : within.begin;
                pixel = pixel < within.end ? pixel : within.end - 1;
            }
            u[g] = pixel - middle;
        }
#pragma omp simd
        for (int g = 0; g < GROUP_RECEIVERS; g++)
            slopes[g] =
                fabs(c[1][g] + u[g] * (2 * c[2][g] + u[g] * (3 * c[3][g] + u[g] * (4 * c[4][g] + u[g] * 5 * c[5][g]))));
        for (int g = 0; g < group->receivers; g++)
            slope = slopes[g] > slope ? slopes[g] : slope;
    }
    return slope;
}

void BP_RUNS(const struct receiver_group *group, const struct bp_block *block, double (*tau)[GROUP_RECEIVERS])
{
    struct run runs[GROUP_RECEIVERS];
    _Alignas(64) double c[NODES][GROUP_RECEIVERS];
    const double half = 0.5 * (block->end - 1 - block->begin), middle = block->begin + half;
    double slope, bend;
    quintics(tau, group->scale, half, c, &slope, &bend);
    const enum bp_reading reading = group->table->reading;
    enum loading loading = loading_choose(reading, slope_most(group, block, false, middle, c));
    if (loading == FOURS && group->within) /* pixels that are not all records' take FOURS nevertheless */
        loading = loading_choose(reading, slope_most(group, block, true, middle, c));
    /* Cubics have 32 bits for the whole part of a point. */
    const bool fits = reading == BP_CUBICS || slope * RUN_PIXELS <= POINTS_MOST;
    int longest = fits ? RUN_PIXELS : (int)fmax(1, POINTS_MOST / slope);
#if WINDOWS
    const int flat = flat_longest(group, loading, bend);
    longest = flat ? flat : longest;
#endif
    for (int first = block->begin, count; first < block->end; first += count) {
        count = block->end - first < longest ? block->end - first : longest;
        if (first >= block->shown.end || first + count <= block->shown.begin)
            continue;
#if WINDOWS
        if (flat)
            runs_flat(group, c, first - middle + 0.5 * (count - 1), count, runs);
        else
#endif
            runs_fixed(group, c, first - middle, count, runs);
        BP_GATHER(group, loading, first, count, runs);
    }
}
