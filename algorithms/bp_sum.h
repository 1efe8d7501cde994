/* The inner sums of back projection, built for each precision and instruction set; chosen at run time by bp.c. */
#ifndef SASBENCH_BP_SUM_H
#define SASBENCH_BP_SUM_H

#include "algorithm.h"

/* How values are read between samples (struct interpolator with its weights tabulated). */
struct bp_table {
    int upsample, phases, taps, first, guard;
    /* phases > 0: [phases][taps]. phases == 0: a cubic in the fraction's position inside each of BP_INTERVALS intervals,
       [BP_INTERVALS][4][taps], lowest power first. Of the plan's precision; NULL when taps == 1. */
    const void *weights;
};
enum { BP_INTERVALS = 256 };

/* One pair's record and geometry. */
struct bp_pair {
    struct vector tx, rx, velocity;
    double t0;
    const void *row;                /* complex, as records_fill leaves it */
};

struct bp_medium {
    double sound_speed, fc, fs;
    int samples;
};

/* Add one pair's contributions to pixels (x, r_first + i r_step), i in [begin, end): re[i], im[i] += value times
   exp(+j 2 pi fc tau) where tau lies inside the record. */
typedef void bp_sum_function(const struct bp_medium *medium, const struct bp_table *table, const struct bp_pair *pair,
                             double x, double r_first, double r_step, int begin, int end, void *re, void *im);

bp_sum_function bp_sum_float_baseline, bp_sum_double_baseline;
bp_sum_function bp_sum_float_v3, bp_sum_double_v3;  /* x86-64-v3: AVX2, FMA */
bp_sum_function bp_sum_float_v4, bp_sum_double_v4;  /* x86-64-v4: AVX-512 */

#endif
