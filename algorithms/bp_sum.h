/* The inner sums of the general engine: one line of pixels over one ping, built for each precision and instruction set;
   chosen at run time by bp_general.c. */
#ifndef SASBENCH_BP_SUM_H
#define SASBENCH_BP_SUM_H

#include "bp_blocks.h"

/* How values are read between samples (struct interpolator with its weights tabulated). */
struct bp_table {
    int upsample, phases, taps, first, guard;
    /* phases > 0: [phases][taps]. phases == 0: a cubic in the fraction's position inside each of BP_INTERVALS intervals,
       [BP_INTERVALS][4][taps], lowest power first. Of the plan's precision; NULL when taps == 1. */
    const void *weights;
    bool line;                      /* two weights, 1 - f and f of the rounded fraction f: needs no table */
};
enum { BP_INTERVAL_BITS = 8, BP_INTERVALS = 1 << BP_INTERVAL_BITS };

/* Are the weights cubics in the fraction of a sample? Else they are for whole phases, one phase if there is one tap. */
static inline bool bp_table_cubics(const struct bp_table *table)
{
    return table->taps > 1 && table->phases == 0;
}

/* Records whose real and imaginary parts the general engine keeps apart: many taps add up along each. */
static inline bool bp_table_planar(const struct bp_table *table)
{
    return table->taps > 1 && !table->line;
}

struct bp_medium {
    double sound_speed, fc, fs;
    int samples;
};

/* Receivers of one ping, with their records. */
struct bp_ping {
    struct vector tx, velocity;
    double t0;
    int receivers;
    const struct vector *rx;        /* [receivers] at emission */
    const void *rows;               /* [receivers][2 row_length]: complex, or re and then im if bp_table_planar */
    int row_length;
};

/* Add the receivers' contributions to the pixels of some blocks of a line, where all delays lie inside the record:
   re[i], im[i] += value times exp(+j 2 pi fc tau) for pixel i. */
typedef void bp_sum_function(const struct bp_medium *medium, const struct bp_table *table, const struct bp_ping *ping,
                             const struct pixel_line *line, int block_count, const struct bp_block *blocks,
                             void *re, void *im);

bp_sum_function bp_sum_float_baseline, bp_sum_double_baseline;
bp_sum_function bp_sum_float_v3, bp_sum_double_v3;  /* x86-64-v3: AVX2, FMA */
bp_sum_function bp_sum_float_v4, bp_sum_double_v4;  /* x86-64-v4: AVX-512 */

#endif
