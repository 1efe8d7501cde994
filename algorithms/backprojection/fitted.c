/* Least-squares taps (fitted.h). Made while planning: taps^3/3 multiplications and taps^2 for each term. */
#include "backprojection/fitted.h"

#include <math.h>

#include "common/bessel.h"
#include "common/cholesky.h"
#include "contract/condition.h"

static const double RIDGE = 1e-12;

void fitted_make(int taps, double band, struct fitted *fitted)
{
    /* Fejer's quadrature over half the band: at Chebyshev points, exact to rounding for this number of cycles. */
    enum { POINTS = 48 };
    double wave[2][FITTED_TAPS_MOST], row[FITTED_TAPS_MOST], lower[FITTED_TAPS_MOST * FITTED_TAPS_MOST];
    *fitted = (struct fitted){.taps = taps};
    for (int m = 0; m < POINTS; m++) {
        const double angle = M_PI * (m + 0.5) / POINTS, nu = band / 4 * (1 + cos(angle));
        double weight = 1;
        for (int j = 1; j <= POINTS / 2; j++)
            weight -= 2 * cos(2 * j * angle) / (4.0 * j * j - 1);
        weight /= POINTS;
        for (int k = 0; k < taps; k++) {
            const double cycles = nu * (k - 0.5 * (taps - 1));
            wave[0][k] = cos(2 * M_PI * cycles);
            wave[1][k] = sin(2 * M_PI * cycles);
        }
        for (int n = 0; n < FITTED_TERMS; n++) {
            const double value = weight * (n / 2 % 2 ? -1 : 1) * (2 * n + 1) * bessel_spherical(n, M_PI * nu);
            for (int k = 0; k < taps; k++)
                fitted->terms[n][k] += value * wave[n % 2][k];
        }
    }
    for (int k = 0; k < taps; k++)
        row[k] = condition_sinc(band * k) + (k == 0 ? RIDGE : 0);
    cholesky_toeplitz(taps, row, lower);
    for (int n = 0; n < FITTED_TERMS; n++)
        cholesky_solve(taps, lower, fitted->terms[n]);
}

void fitted_weights(const struct fitted *fitted, double fraction, double *w)
{
    const double z = 2 * fraction - 1;
    double before = 0, now = 1; /* P_(n-1)(z) and P_n(z) */
    for (int k = 0; k < fitted->taps; k++)
        w[k] = 0;
    for (int n = 0; n < FITTED_TERMS; n++) {
        for (int k = 0; k < fitted->taps; k++)
            w[k] += fitted->terms[n][k] * now;
        const double next = ((2 * n + 1) * z * now - n * before) / (n + 1);
        before = now;
        now = next;
    }
}
