/* Complex numbers in double: turns, products and squares. */
#ifndef SASBENCH_COMMON_TURNS_H
#define SASBENCH_COMMON_TURNS_H

#include <complex.h>
#include <math.h>

/* exp(+j 2 pi cycles) */
static inline double complex turns(double cycles)
{
    const double angle = 2 * M_PI * (cycles - floor(cycles));
    return cos(angle) + I * sin(angle);
}

/* Without C's own care for infinities. */
static inline double complex product(double complex a, double complex b)
{
    return creal(a) * creal(b) - cimag(a) * cimag(b) + I * (creal(a) * cimag(b) + cimag(a) * creal(b));
}

/* |a|^2 */
static inline double square(double complex a)
{
    return creal(a) * creal(a) + cimag(a) * cimag(a);
}

/* sqrt(1 - |both|^2/power): the relative difference of two signals after one best gain. Values below 0 by rounding give
   0; NaN stays (fmax would make it 0). */
static inline double unlike(double complex both, double power)
{
    const double left = 1 - square(both) / power;
    return left < 0 ? 0 : sqrt(left);
}

#endif
