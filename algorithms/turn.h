/* cos and sin of 2 pi f for |f| <= 1/2 in the file's `real`, by Taylor polynomials of the quarter turn's remainder:
   within 2 units in the last place of libm, and it vectorises. */
#ifndef SASBENCH_TURN_H
#define SASBENCH_TURN_H

#include <math.h>

#include "real.h"

/* The same for an angle |x| <= pi/4 in radians. */
static inline void turn_eighth(real x, real *c, real *s)
{
    real y = x * x;
#if REAL_DOUBLE
    *s = x + x * y * (-1.6666666666666666e-01 + y * (8.3333333333333332e-03 + y * (-1.9841269841269841e-04
                + y * (2.7557319223985893e-06 + y * (-2.5052108385441720e-08 + y * (1.6059043836821613e-10
                + y * -7.6471637318198164e-13))))));
    *c = 1 + y * (-0.5 + y * (4.1666666666666664e-02 + y * (-1.3888888888888889e-03
                  + y * (2.4801587301587302e-05 + y * (-2.7557319223985888e-07 + y * (2.0876756987868100e-09
                  + y * (-1.1470745597729725e-11 + y * 4.7794773323873853e-14)))))));
#else
    *s = x + x * y * (-1.6666667e-01f + y * (8.3333333e-03f + y * (-1.9841270e-04f + y * 2.7557319e-06f)));
    *c = 1 + y * (-0.5f + y * (4.1666668e-02f + y * (-1.3888889e-03f + y * (2.4801587e-05f
                  + y * -2.7557319e-07f))));
#endif
}

static inline void turn(double f, real *c, real *s)
{
    double quarter = floor(4 * f + 0.5);
    real sine, cosine;
    turn_eighth((real)(4 * f - quarter) * (real)1.57079632679489661923, &cosine, &sine);
    int k = (int)quarter;
    real swapped_c = k & 1 ? sine : cosine, swapped_s = k & 1 ? cosine : sine;
    *c = (k + 1) & 2 ? -swapped_c : swapped_c;
    *s = k & 2 ? -swapped_s : swapped_s;
}

#endif
