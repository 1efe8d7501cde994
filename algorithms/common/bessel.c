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
