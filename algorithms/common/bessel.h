/* The modified Bessel function I0, for Kaiser windows; spherical Bessel functions, for expansions of exponentials. */
#ifndef SASBENCH_COMMON_BESSEL_H
#define SASBENCH_COMMON_BESSEL_H

double bessel_i0(double x);
double bessel_i0_scaled(double x); /* I0(x) exp(-x), which does not overflow */
/* The spherical Bessel function j_n(x), n >= 0, |x| <= pi/2; within some roundings, even of tiny values. */
double bessel_spherical(int n, double x);

#endif
