/* The plain inner loops: delay, phase and sample coordinate in double for a run of range rows, then the sums. This file
   is compiled once for each precision and instruction set (BP_ISA names it). */
#include "bp_sum.h"

#include <math.h>

#include "real.h"
#include "turn.h"

#define BP_SUM REAL_ISA_NAME(bp_sum)

enum { RUN = 256 };                 /* range rows at a time: the run's arrays stay in the first-level cache */

/* Sample coordinate q and phase (turns, |f| <= 1/2) of n range rows. */
static void delays(const struct bp_medium *medium, const struct bp_pair *pair, double x, double r, double r_step, int n,
                   double *restrict q, double *restrict f)
{
    const double c = medium->sound_speed, fc = medium->fc, fs = medium->fs, t0 = pair->t0;
    const struct vector v = pair->velocity;
    const double speed = sqrt(v.x * v.x + v.y * v.y + v.z * v.z), e = (c - speed) * (c + speed), one_e = 1 / e;
    const double ax = pair->tx.x - x, ay0 = pair->tx.y - r, a_xz = ax * ax + pair->tx.z * pair->tx.z;
    const double bx0 = pair->rx.x - x, by0 = pair->rx.y - r, bz0 = pair->rx.z;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        double dr = i * r_step, ay = ay0 - dr;
        double t = sqrt(a_xz + ay * ay) / c;
        double bx = bx0 + v.x * t, by = by0 - dr + v.y * t, bz = bz0 + v.z * t;
        double p = bx * v.x + by * v.y + bz * v.z;
        double tau = t + (p + sqrt(p * p + e * (bx * bx + by * by + bz * bz))) * one_e;
        double cycles = fc * tau;
        q[i] = (tau - t0) * fs;
        f[i] = cycles - floor(cycles + 0.5);
    }
}

/* Values of one weight each: the nearest sample, of the record or of its upsampled form. */
static void add_nearest(const struct bp_table *table, const real *row, int n, const double *restrict q,
                        const real *restrict wr, const real *restrict wi, real *restrict re, real *restrict im)
{
    int index[RUN];
    double scale = table->upsample;
#pragma omp simd
    for (int i = 0; i < n; i++)
        index[i] = (int)(q[i] * scale + 0.5);       /* q >= 0: the cast is floor */
    const real *first = row + 2 * (table->guard + table->first);
    for (int i = 0; i < n; i++) {
        real xr = first[2 * index[i]], xi = first[2 * index[i] + 1];
        re[i] += xr * wr[i] - xi * wi[i];
        im[i] += xr * wi[i] + xi * wr[i];
    }
}

/* Several weights a value, from a grid of phases or from cubics in the fraction. `taps` is a constant where this is
   inlined, so that the loops over it unroll. */
static inline __attribute__((always_inline)) void add_taps(const struct bp_table *table, int taps, const real *row, int n,
    const double *restrict q, const real *restrict wr, const real *restrict wi, real *restrict re, real *restrict im)
{
    const real *weights = table->weights, *first = row + 2 * (table->guard + table->first);
    double scale = table->upsample;
    int phases = table->phases;
    for (int i = 0; i < n; i++) {
        double position = q[i] * scale;
        real vr = 0, vi = 0;
        if (phases > 0) {
            long long point = (long long)(position * phases + 0.5);
            const real *w = weights + (point % phases) * taps, *s = first + 2 * (point / phases);
            for (int k = 0; k < taps; k++) {
                vr += w[k] * s[2 * k];
                vi += w[k] * s[2 * k + 1];
            }
        } else {
            int sample = (int)position;
            double interval = (position - sample) * BP_INTERVALS;
            const real *w = weights + (size_t)(int)interval * 4 * (size_t)taps, *s = first + 2 * sample;
            real u = (real)(interval - (int)interval);
            for (int k = 0; k < taps; k++) {
                real weight = w[k] + u * (w[taps + k] + u * (w[2 * taps + k] + u * w[3 * taps + k]));
                vr += weight * s[2 * k];
                vi += weight * s[2 * k + 1];
            }
        }
        re[i] += vr * wr[i] - vi * wi[i];
        im[i] += vr * wi[i] + vi * wr[i];
    }
}

/* Rows whose delays all lie inside the record. */
static void add_run(const struct bp_table *table, const real *row, int n, const double *restrict q,
                    const double *restrict f, real *restrict re, real *restrict im)
{
    real wr[RUN], wi[RUN];
#pragma omp simd
    for (int i = 0; i < n; i++)
        turn(f[i], &wr[i], &wi[i]);
    switch (table->taps) {          /* the shipped kernels unroll, any other length works as well */
    case 1: add_nearest(table, row, n, q, wr, wi, re, im); break;
    case 2: add_taps(table, 2, row, n, q, wr, wi, re, im); break;
    case 8: add_taps(table, 8, row, n, q, wr, wi, re, im); break;
    case 20: add_taps(table, 20, row, n, q, wr, wi, re, im); break;
    default: add_taps(table, table->taps, row, n, q, wr, wi, re, im); break;
    }
}

void BP_SUM(const struct bp_medium *medium, const struct bp_table *table, const struct bp_pair *pair, double x,
            double r_first, double r_step, int begin, int end, void *re_, void *im_)
{
    real *re = re_, *im = im_;
    const real *row = pair->row;
    const double last = medium->samples - 1;
    double q[RUN], f[RUN];
    for (int i0 = begin; i0 < end; i0 += RUN) {
        int n = end - i0 < RUN ? end - i0 : RUN;
        delays(medium, pair, x, r_first + i0 * r_step, r_step, n, q, f);
        for (int i = 0; i < n;) {   /* stretches inside the record; nearly always the whole run */
            while (i < n && !(q[i] >= 0 && q[i] <= last))
                i++;
            int start = i;
            while (i < n && q[i] >= 0 && q[i] <= last)
                i++;
            if (i > start)
                add_run(table, row, i - start, q + start, f + start, re + i0 + start, im + i0 + start);
        }
    }
}
