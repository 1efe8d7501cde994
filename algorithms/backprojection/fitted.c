/* Least-squares taps (fitted.h). Made while planning: taps^3/3 multiplications and taps^2 for each term. */
#include "backprojection/fitted.h"

#include <math.h>

#include "common/bessel.h"

enum { MOST = FITTED_TAPS_MOST };

static const double RIDGE = 1e-12;

/* sin(pi x)/(pi x) */
static double sinc(double x)
{
    return fabs(x) < 1e-9 ? 1 : sin(M_PI * x) / (M_PI * x);
}

/* The lower factor L of R = L L^T, by Cholesky. */
static void factor(int taps, double band, double lower[MOST][MOST])
{
    for (int i = 0; i < taps; i++)
        for (int j = 0; j <= i; j++) {
            double left = sinc(band * (i - j)) + (i == j ? RIDGE : 0);
            for (int k = 0; k < j; k++)
                left -= lower[i][k] * lower[j][k];
            lower[i][j] = i == j ? sqrt(left) : left / lower[j][j];
        }
}

/* x with R x = right, in its place. */
static void solve(int taps, double lower[MOST][MOST], double right[MOST])
{
    for (int i = 0; i < taps; i++) {
        for (int k = 0; k < i; k++)
            right[i] -= lower[i][k] * right[k];
        right[i] /= lower[i][i];
    }
    for (int i = taps - 1; i >= 0; i--) {
        for (int k = i + 1; k < taps; k++)
            right[i] -= lower[k][i] * right[k];
        right[i] /= lower[i][i];
    }
}

void fitted_make(int taps, double band, struct fitted *fitted)
{
    /* Fejer's quadrature over half the band: at Chebyshev points, exact to rounding for so few cycles. */
    enum { POINTS = 48 };
    double lower[MOST][MOST];
    *fitted = (struct fitted){.taps = taps};
    for (int m = 0; m < POINTS; m++) {
        const double angle = M_PI * (m + 0.5) / POINTS, nu = band / 4 * (1 + cos(angle));
        double weight = 1;
        for (int j = 1; j <= POINTS / 2; j++)
            weight -= 2 * cos(2 * j * angle) / (4.0 * j * j - 1);
        weight /= POINTS;
        for (int n = 0; n < FITTED_TERMS; n++) {
            const double value = weight * (n / 2 % 2 ? -1 : 1) * (2 * n + 1) * bessel_spherical(n, M_PI * nu);
            for (int k = 0; k < taps; k++) {
                const double cycles = nu * (k - 0.5 * (taps - 1));
                fitted->terms[n][k] += value * (n % 2 ? sin(2 * M_PI * cycles) : cos(2 * M_PI * cycles));
            }
        }
    }
    factor(taps, band, lower);
    for (int n = 0; n < FITTED_TERMS; n++)
        solve(taps, lower, fitted->terms[n]);
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
