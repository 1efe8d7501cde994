/* The inner sums of the general engine: one line of pixels over one ping, built for each precision and instruction set;
   chosen at run time by bp_general.c. */
#ifndef SASBENCH_BACKPROJECTION_GENERAL_SUM_H
#define SASBENCH_BACKPROJECTION_GENERAL_SUM_H

#include "backprojection/general/blocks.h"

/* Of the speed of sound, the receivers' below which the delay's root (q + s)/e loses less than a bit where it cancels
   (delay.h): the division of the other form is spared. */
#define BP_SLOW 0.125

/* How a value between samples is read. */
enum bp_reading {
    BP_NEAREST, /* the nearest value: one tap */
    BP_LINE,    /* two weights, 1 - f and f of the fraction f rounded to a phase: no table is read */
    BP_PHASES,  /* weights [phases][taps] of the fraction rounded to a phase */
    BP_CUBICS   /* weights that are cubics in the fraction's position inside each of BP_INTERVALS
                                       intervals, [BP_INTERVALS][4][taps], lowest power first */
};
enum { BP_INTERVAL_BITS = 8, BP_INTERVALS = 1 << BP_INTERVAL_BITS };

/* struct interpolator with its weights tabulated. */
struct bp_table {
    enum bp_reading reading;
    int upsample, phases, taps, first, guard;
    const void *weights; /* of the plan's precision; NULL if BP_NEAREST */
};

struct bp_medium {
    double sound_speed, fc, fs;
    int samples;
    double phase_limit; /* rad: that the general engine's sums may err by; 0: every delay is evaluated */
};

/* Receivers of one ping, with their records. */
struct bp_ping {
    struct vector tx, velocity;
    double t0;
    int receivers;
    const struct vector *rx; /* [receivers] at emission */
    const void *rows;        /* [receivers][2 row_length] real: re, then im; one value behind the last may be read */
    int row_length;
};

/* Add the receivers' contributions to the pixels of some blocks of a line, where all delays lie inside the record:
   re[i], im[i] += value times exp(+j 2 pi fc tau) for pixel i. */
typedef void bp_sum_function(const struct bp_medium *medium, const struct bp_table *table, const struct bp_ping *ping,
                             const struct pixel_line *line, int block_count, const struct bp_block *blocks, void *re,
                             void *im);

bp_sum_function bp_sum_float_baseline, bp_sum_double_baseline;
bp_sum_function bp_sum_float_v3, bp_sum_double_v3; /* x86-64-v3: AVX2, FMA */
bp_sum_function bp_sum_float_v4, bp_sum_double_v4; /* x86-64-v4: AVX-512 */

#endif
