/* A sinc kernel's weights (bp.h); Chebyshev series of any kernel's (kernel.h). */
#include "backprojection/kernel.h"

#include <math.h>
#include <stdlib.h>

#include "common/bessel.h"

enum { MOST = KERNEL_BRANCHES_MOST, BRANCHES_LEAST = 2 /* a single one would be read as nearest samples */ };

void sinc_weights(int taps, double beta, double fraction, double *w)
{
    const double sine = sin(M_PI * fraction), whole = bessel_i0(beta);
    for (int k = 0; k < taps; k++) {
        int n = k + 1 - taps / 2;
        double z = fraction - n, edge = 1 - 4 * z * z / ((double)taps * taps);
        /* sin(pi (fraction - n)) = (-1)^n sin(pi fraction): exact zeros at whole samples, no large arguments */
        double value = fabs(z) < 1e-9 ? 1 : (n % 2 ? -sine : sine) / (M_PI * z);
        w[k] = value * bessel_i0(beta * sqrt(edge > 0 ? edge : 0)) / whole;
    }
}

/* Coefficients of z^m in the Chebyshev polynomials T_n(z). */
static void chebyshev(double powers[MOST][MOST])
{
    for (int n = 0; n < MOST; n++)
        for (int m = 0; m < MOST; m++) {
            const double above = n > 1 && m > 0 ? 2 * powers[n - 1][m - 1] : 0;
            powers[n][m] = n < 2 ? m == n : above - powers[n - 2][m];
        }
}

int kernel_branches(const struct interpolator *interpolator, double tolerance, double *coefficients)
{
    const int taps = interpolator->taps;
    double powers[MOST][MOST], left = 0, *values = malloc(2 * MOST * (size_t)taps * sizeof *values);
    if (!values)
        return -1;
    double *series = values + MOST * taps;
    for (int k = 0; k < MOST; k++)
        interpolator->weights(interpolator, 0.5 + 0.5 * cos(M_PI * (k + 0.5) / MOST), values + k * taps);
    for (int n = 0; n < MOST; n++)
        for (int t = 0; t < taps; t++) {
            double sum = 0;
            for (int k = 0; k < MOST; k++)
                sum += values[k * taps + t] * cos(M_PI * n * (k + 0.5) / MOST);
            series[n * taps + t] = sum * (n == 0 ? 1 : 2) / MOST;
        }
    int count = MOST;
    for (; count > BRANCHES_LEAST; count--) { /* the terms cut off add up */
        double largest = 0;
        for (int t = 0; t < taps; t++)
            largest = fmax(largest, fabs(series[(count - 1) * taps + t]));
        left += largest;
        if (!(left <= tolerance))
            break;
    }
    chebyshev(powers);
    for (int m = 0; m < count; m++)
        for (int t = 0; t < taps; t++) {
            double sum = 0;
            for (int n = m; n < count; n++)
                sum += series[n * taps + t] * powers[n][m];
            coefficients[m * taps + t] = ldexp(sum, m); /* z = 2 u */
        }
    free(values);
    return count < MOST ? count : 0; /* the last term shows that the series has ended */
}
