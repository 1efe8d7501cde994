/* The inner sums of the general engine: one line of pixels over one ping. sum.c and gather.c are built for each
   precision and instruction set; general.c chooses one at run time. run.h has the drawing of a run of pixels.

   THE ERROR BUDGET. `phase_limit` L (rad, 1e-4 by default) bounds what the fast path changes the phase of a pair by.
   Other paths evaluate every delay: exact=true, pixels too near the array, blocks that reach out of the record. All
   errors of the fast path:

   share           what errs, and why by no more                                                used in

   L lowered       A delay may err by a quarter of the finest step between positions at most:   bp.c, choose_engine:
                   L/(2 pi fc) s times `finest` steps a second. So L <= (pi/2) fc/finest.       1.57 fc/finest

   0.85 L (float)  Quintics in place of delays. Blocks are so short that the sixth derivative   general.c, general_plan:
   1.00 L (double) of the path bounds the error by this share. blocks.c has the derivation.     `quintics`

   0.15 L (float)  Bends in float. Cycles of a run that bends little are a straight line,       sum.c, sum_block:
                   counted on in fixed point, plus a bend in float. A bend of n cycles errs by  `cycles`, from which
                   about three roundings (coefficient, polynomial, product): 3 n 2^-24 cycles,  half_run follows
                   or 1.1e-6 n rad. n <= 2^17 L makes that 0.144 L. A bend is at most half
                   its second derivative times the square of half a run's length, which gives
                   the longest run. n <= 16 in any case. The sum of line and bend is rounded
                   once more: at the default limit, n = 13, by up to 2^-21 cycles, 3e-6 rad.
                   No share counts this; the test below measures that all errors together
                   stay below L + 2.5e-6.

   2.5e-6 rad      Phase factors in float, besides L. Short polynomials of sine and cosine err  common/phasor.h,
   (float)         by 1.8e-6 (measured over all phases). Phases are floats below 1/2 cycle:     PHASOR_SHORT_SINE;
                   2^-26 cycles, 0.9e-7 rad. The line that is counted on: 32 steps of 2^-32     sum.c, points_flat
                   cycles, 0.5e-7 rad. The product with the sample: some 2e-7.

   1e-9 rad        Phases in double, besides L. They are fixed-point numbers with 32 bits of    sum.c, points:
   (double)        a cycle, rounded: 2^-33 cycles, 0.7e-9 rad.                                  `fixed`

   Two errors of positions come on top of L/(2 pi fc) s. They do not change phases. They decide which of two samples, or
   of two steps of a table, a position takes that is as near to a tie between them:

   2^-17 sample    Runs that bend little, in float. Their positions are floats that count from  sum.c, points_flat:
   (float)         the run's middle. Half of 256 pixels with less than 1/4 sample each are      `point`
                   some 32 samples, where a float's last bit is 2^-19 to 2^-18. A few roundings
                   of half a bit stay below 2^-17.

   2^-19 sample    All other runs, and so all in double. Points are fixed-point numbers with    sum.c, points:
                   19 bits of fraction (BITS). Nearest samples have 32 bits; the points of      `point`
                   cubics are 1/256 sample.

   harness/tests/algorithms/test_bp_general.c measures all of it: phase_below_limit the phases, near_ties the positions. */
#ifndef SASBENCH_BACKPROJECTION_GENERAL_SUM_H
#define SASBENCH_BACKPROJECTION_GENERAL_SUM_H

#include "backprojection/general/blocks.h"
#include "backprojection/reading.h"

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
