#include "common/bessel.h"

#include <math.h>

/* The power series times `first`: all terms are positive, so nothing cancels. */
static double series(double x, double first)
{
    double term = first, sum = first, y = x * x / 4;
    for (int k = 1; term > 1e-17 * sum; k++) {
        term *= y / ((double)k * k);
        sum += term;
    }
    return sum;
}

double bessel_i0(double x)
{
    return series(x, 1);
}

double bessel_i0_scaled(double x)
{
    return series(x, exp(-x));
}

/* By the power series, whose terms fall at once for these x. */
double bessel_spherical(int n, double x)
{
    double term = 1, sum = 0;
    for (int k = 1; k <= n; k++)
        term *= x / (2 * k + 1);
    for (int k = 0; fabs(term) > 1e-17 * fabs(sum); k++) {
        sum += term;
        term *= -x * x / (2 * (k + 1) * (2 * (n + k) + 3));
    }
    return sum;
}
