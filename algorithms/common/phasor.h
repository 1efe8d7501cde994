/* The phasor exp(j 2 pi f), as its cosine and sine, for a fraction of a cycle |f| <= 1/2 in the file's `real`: short
   polynomials that vectorise. */
#ifndef SASBENCH_COMMON_PHASOR_H
#define SASBENCH_COMMON_PHASOR_H

#include <math.h>

#include "common/real.h"

/* The same for an angle |x| <= pi/4, an eighth of a cycle, in radians, by Taylor polynomials. */
static inline void phasor_eighth(real x, real *c, real *s)
{
    real y = x * x;
#if REAL_DOUBLE
    *s = x
         + x * y
               * (-1.6666666666666666e-01
                  + y
                        * (8.3333333333333332e-03
                           + y
                                 * (-1.9841269841269841e-04
                                    + y
                                          * (2.7557319223985893e-06
                                             + y
                                                   * (-2.5052108385441720e-08
                                                      + y * (1.6059043836821613e-10 + y * -7.6471637318198164e-13))))));
    *c = 1
         + y
               * (-0.5
                  + y
                        * (4.1666666666666664e-02
                           + y
                                 * (-1.3888888888888889e-03
                                    + y
                                          * (2.4801587301587302e-05
                                             + y
                                                   * (-2.7557319223985888e-07
                                                      + y
                                                            * (2.0876756987868100e-09
                                                               + y
                                                                     * (-1.1470745597729725e-11
                                                                        + y * 4.7794773323873853e-14)))))));
#else
    *s = x + x * y * (-1.6666667e-01f + y * (8.3333333e-03f + y * (-1.9841270e-04f + y * 2.7557319e-06f)));
    *c = 1 + y * (-0.5f + y * (4.1666668e-02f + y * (-1.3888889e-03f + y * (2.4801587e-05f + y * -2.7557319e-07f))));
#endif
}

/* From the half angle's S = sqrt(2) sin(pi f) and C = sqrt(2) cos(pi f), by minimax polynomials: cos = 1 - S^2 and sin
   = S C, without a choice of quadrant, in short chains of products. For `real` and vectors of it. */
#if REAL_DOUBLE
#define PHASOR_SINE(z, z2)                                                                                             \
    ((4.4428829381583661 + z * -7.308249499995437) + z2 * (3.6064765714705578 + z * -0.84748802480989638)              \
     + z2 * z2                                                                                                         \
           * ((0.11617182685703353 + z * -0.010423362571554722)                                                        \
              + z2 * ((0.00065944661738638643 + z * -3.0974149455374744e-05) + z2 * 1.0866855346742344e-06)))
#define PHASOR_COSINE(z, z2)                                                                                           \
    ((1.4142135623730951 + z * -6.9788641996388758) + z2 * (5.7398857349463546 + z * -1.8883467170302786)              \
     + z2 * z2                                                                                                         \
           * ((0.33280776877138168 + z * -0.03649645205784869)                                                         \
              + z2 * ((0.0027288046656343086 + z * -0.00014787947669331688) + z2 * 5.8684089145498459e-06)))
#else
#define PHASOR_SINE(z, z2)                                                                                             \
    ((4.44288283f + z * -7.30824118f) + z2 * (3.60628933f + z * -0.845765404f + z2 * 0.109208753f))
#define PHASOR_COSINE(z, z2)                                                                                           \
    ((1.41421350f + z * -6.97885099f) + z2 * (5.73946117f + z * -1.88356299f + z2 * 0.310698194f))
#endif
/* Fewer instructions: within 1.8e-6 in float, -115 dB, and 5e-10 in double (measured over all f). */
#if REAL_DOUBLE
#define PHASOR_SHORT_SINE(z, z2)                                                                                       \
    ((4.4428829376733888 + z * -7.308249445345825) + z2 * (3.6064748155229045 + z * -0.84746384795739734)              \
     + z2 * z2 * (0.11600982887842832 + z * -0.009900409216767792))
#define PHASOR_SHORT_COSINE(z, z2)                                                                                     \
    ((1.4142135620628904 + z * -6.9788641100960288) + z2 * (5.7398815459394311 + z * -1.8882749991636677)              \
     + z2 * z2 * (0.33225188210826727 + z * -0.034502167403942936))
#else
#define PHASOR_SHORT_SINE(z, z2) (4.44285705f + z * (-7.30718432f + z * (3.59301926f + z * -0.780718886f)))
#define PHASOR_SHORT_COSINE(z, z2)                                                                                     \
    (1.41422033f + z * (-6.97910828f + z * (5.74248479f + z * (-1.89762169f + z * 0.33330754f))))
#endif
#define PHASOR(name, type, SINE, COSINE)                                                                               \
    static inline __attribute__((always_inline)) void name(type f, type *c, type *s)                                   \
    {                                                                                                                  \
        type z = f * f, z2 = z * z, sine = f * SINE(z, z2);                                                            \
        *c = 1 - sine * sine;                                                                                          \
        *s = sine * COSINE(z, z2);                                                                                     \
        (void)z2;                                                                                                      \
    }

PHASOR(phasor, real, PHASOR_SINE, PHASOR_COSINE)

#endif
