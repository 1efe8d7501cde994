/* The frequency responses of Farrow branches and their error (farrow.h). */
#include "backprojection/farrow.h"

#include <math.h>

#include "common/bessel.h"

void farrow_gains(int degree, double nu, double *gains)
{
    double before[FARROW_MOST + 1] = {0}, now[FARROW_MOST + 1] = {1}; /* powers of u in P_(n-1)(2u) and P_n(2u) */
    for (int m = 0; m <= degree; m++)
        gains[m] = 0;
    for (int n = 0; n <= degree; n++) {
        const double weight = (n / 2 % 2 ? -1 : 1) * (2 * n + 1) * bessel_spherical(n, M_PI * nu);
        for (int m = n % 2; m <= n; m += 2)
            gains[m] += weight * now[m];
        for (int m = degree; m >= 0; m--) { /* (n + 1) P_(n+1)(z) = (2n + 1) z P_n(z) - n P_(n-1)(z) */
            const double next = ((2 * n + 1) * 2 * (m > 0 ? now[m - 1] : 0) - n * before[m]) / (n + 1);
            before[m] = now[m];
            now[m] = next;
        }
    }
}

double farrow_error(int degree, double band)
{
    enum { FREQUENCIES = 64, TERMS = 12 };
    double sum = 0;
    for (int k = 0; k < FREQUENCIES; k++)
        for (int n = degree + 1; n <= degree + TERMS; n++) {
            const double value = bessel_spherical(n, M_PI * band / 2 * (k + 0.5) / FREQUENCIES);
            sum += (2 * n + 1) * value * value;
        }
    return sqrt(sum / FREQUENCIES);
}

int farrow_degree(double error, double band)
{
    int degree = FARROW_LEAST;
    while (degree < FARROW_MOST && !(farrow_error(degree, band) <= error))
        degree++;
    return degree;
}
