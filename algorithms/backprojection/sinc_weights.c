/* Weights of a truncated, optionally Kaiser-windowed sinc kernel (bp.h). */
#include <math.h>

#include "backprojection/bp.h"

/* The modified Bessel function I0 by its power series: all terms are positive, so nothing cancels. */
static double bessel_i0(double x)
{
    double term = 1, sum = 1, y = x * x / 4;
    for (int k = 1; term > 1e-17 * sum; k++) {
        term *= y / ((double)k * k);
        sum += term;
    }
    return sum;
}

void sinc_weights(int taps, double beta, double fraction, double *w)
{
    const double pi = 3.14159265358979323846;
    double sine = sin(pi * fraction);
    for (int k = 0; k < taps; k++) {
        int n = k + 1 - taps / 2;
        double z = fraction - n, edge = 1 - 4 * z * z / ((double)taps * taps);
        /* sin(pi (fraction - n)) = (-1)^n sin(pi fraction): exact zeros at whole samples, no large arguments */
        double value = fabs(z) < 1e-9 ? 1 : (n % 2 ? -sine : sine) / (pi * z);
        w[k] = value * bessel_i0(beta * sqrt(edge > 0 ? edge : 0)) / bessel_i0(beta);
    }
}
