/* The error budget of the general engine: all phase errors of a pair on its fast path. Other paths evaluate every
   delay: exact=true, pixels too near the array, blocks that reach out of the record.

   `phase_limit` L (rad, 1e-4 by default) bounds the error by approximated delays. All errors of the fast path:

   share           source and bound of the error                                                used in

   L lowered       A delay may err by a quarter of the finest step between positions at most:   bp.c, choose_engine
                   L/(2 pi fc) s times `finest` steps a second. So L <= (pi/2) fc/finest.

   0.85 L (float)  Quintics in place of delays. Blocks are so short that the sixth derivative   general/general.c
   1.00 L (double) of the path bounds the error by this share. general/blocks.c derives it.

   0.15 L (float)  Bends in float. Cycles of a run that bends little are a straight line,       general/runs.c
                   counted on in fixed point, plus a bend in float. A bend of n cycles errs by
                   about three roundings (coefficient, polynomial, product): 3 n 2^-24 cycles,
                   or 1.1e-6 n rad. n <= 2^17 L makes that 0.144 L. A bend is at most half
                   its second derivative times the square of half a run's length, which gives
                   the longest run. n <= 16 in any case.

   3.0e-6 rad      The sum of line and bend, besides L. It is a float of up to n + 1/2 cycles,  runs.c, points_flat:
   (float)         rounded once: 2^-21 cycles where the sum is below 16, as at the default      `cycle`
                   limit, where n = 13. Above L = 1.2e-4 rad, 6.0e-6.

   2.2e-6 rad      Phase factors in float, besides L. Short polynomials of sine and cosine err  common/phasor.h,
   (float)         by 1.8e-6 (measured over all phases). Phases are floats below 1/2 cycle:     PHASOR_SHORT_SINE;
                   2^-26 cycles, 0.9e-7 rad. The line that is counted on: 32 steps of 2^-32     runs.c, points_flat
                   cycles, 0.5e-7 rad. The product with the sample: some 2e-7.

   1.2e-9 rad      Phases in double, besides L. Short polynomials of sine and cosine err by     common/phasor.h,
   (double)        5e-10 (measured over all phases). Without AVX phases are fixed-point         PHASOR_SHORT_SINE;
                   numbers with 32 bits of a cycle, rounded: 2^-33 cycles, 0.7e-9 rad.          runs.c, FRACTIONS

   0.035 L         A kernel's weights as branches, relative to its peak; at most 3.5e-6. In      bp.c, kernel_make
   (double)        float 3.5e-6, as much as phases are rounded.

   In all, in float: 0.994 L + 5.2e-6 rad at the default limit, that is, L + 4.6e-6 rad. In double: L + 1.2e-9 rad.

   Two errors of positions come on top of L/(2 pi fc) s. They do not change phases. Near a tie of two samples, or of two
   steps of a table, they decide which one a position takes:

   2^-17 sample    Runs that bend little, in float. Their positions are floats that count from  runs.c, points_flat:
   (float)         the run's middle. Half of 256 pixels with less than 1/4 sample each are      `point`
                   some 32 samples, where a float's last bit is 2^-19 to 2^-18. A few roundings
                   of half a bit stay below 2^-17.

   2^-19 sample    All other runs, and so all in double. Points are fixed-point numbers with    runs.c, points:
                   19 bits of fraction (POINT_BITS). Nearest samples have 32 bits, in double    `point`
                   with AVX all; the points of cubics are 1/256 sample.

   Polynomials (bp_farrow) have no ties. They err by the signal's slope times the error of the position:

   2^-33 sample    Without AVX: fixed-point numbers with 32 bits of fraction (FIXED_32).        runs.c, points:
   (double)                                                                                     DISTANCES

   6e-7 sample     Runs that bend little, in float: fixed-point numbers with 23 bits of         runs.c, ladder_make
   (float)         fraction along the line, plus the bend in float, 3 n 2^-24 cycles times
                   fs/fc.

   The invariant engine replaces a row's delays by polynomials (invariant/pieces.c) and takes much less of L: longer
   polynomials cost nothing, and its image is the exact path's but for rounding.

   1e-4 L (float)  Phases, and positions in cycles of fs: 1e-8 rad and 2e-9 samples at the        invariant_plan.c,
   2e-7 L (double) default limit in float, below what their rounding adds.                       pieces_plan

   harness/tests/algorithms/test_budget.c measures the phases, in all and of float alone; test_bp_general.c the
   positions (near_ties). */
#ifndef SASBENCH_BACKPROJECTION_BUDGET_H
#define SASBENCH_BACKPROJECTION_BUDGET_H

#include <math.h>

#include "contract/algorithm.h"

/* rad: `phase_limit`, lowered where positions lie `finest_hz` steps a second apart. */
static inline double budget_limit(double phase_limit, double fc_hz, double finest_hz)
{
    return fmin(phase_limit, 1.57 * fc_hz / finest_hz);
}

/* What a kernel's weights may err by as branches. */
static inline double budget_kernel(double phase_limit, enum precision precision)
{
    const double most = 3.5e-6;
    return precision == PRECISION_FLOAT ? most : fmin(0.035 * phase_limit, most);
}

/* rad: the share of the quintics. */
static inline double budget_quintics(double phase_limit, enum precision precision)
{
    return (precision == PRECISION_FLOAT ? 0.85 : 1) * phase_limit;
}

/* rad: error of the phase, and of a position in cycles of fs, by the polynomials of the invariant engine. */
static inline double budget_pieces(double phase_limit, enum precision precision)
{
    return (precision == PRECISION_FLOAT ? 1e-4 : 2e-7) * fmin(phase_limit, 1e-4);
}

/* cycles: the most that a run in float may bend. */
static inline double budget_bend(double phase_limit)
{
    return fmin(16, 0x1p17 * phase_limit);
}

#endif
