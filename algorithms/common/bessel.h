/* The modified Bessel function I0: Kaiser windows are made of it. */
#ifndef SASBENCH_COMMON_BESSEL_H
#define SASBENCH_COMMON_BESSEL_H

double bessel_i0(double x);
double bessel_i0_scaled(double x); /* I0(x) exp(-x), which does not overflow */

#endif
