/* The frequency responses of Farrow branches and their error (farrow.h). */
#include "backprojection/farrow.h"

#include <math.h>

#include "common/bessel.h"
#include "common/pulse_band.h"

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

/* Mean square over u of the terms cut off at nu. */
static double left_out(int degree, double nu)
{
    enum { TERMS = 12 };
    double sum = 0;
    for (int n = degree + 1; n <= degree + TERMS; n++) {
        const double value = bessel_spherical(n, M_PI * nu);
        sum += (2 * n + 1) * value * value;
    }
    return sum;
}

double farrow_error(int degree, double band)
{
    enum { MEANS = 64 };
    double sum = 0;
    for (int k = 0; k < MEANS; k++)
        sum += left_out(degree, band / 2 * (k + 0.5) / MEANS);
    return sqrt(sum / MEANS);
}

static double error_of(int degree, const struct law_spectrum *spectrum, int upsample)
{
    double sum = 0;
    for (int n = 0; n < spectrum->count; n++)
        sum += spectrum->weight[n] * left_out(degree, spectrum->nu[n] / upsample);
    return sqrt(sum);
}

int farrow_degree(double error, const struct law_spectrum *spectrum, int upsample)
{
    int degree = FARROW_LEAST;
    while (degree < FARROW_MOST && !(error_of(degree, spectrum, upsample) <= error))
        degree++;
    return degree;
}

/* Small images, and raw echoes cut by the record's ends, have more energy at the band's edges than in the law: the
   error is up to 1.5 times as large. */
static const double SHARE = 0.7;

int farrow_degree_choose(double error, const struct problem *problem, int upsample)
{
    struct law_spectrum spectrum;
    return law_spectrum(problem->acquisition, image_cells(problem), &spectrum)
               ? farrow_degree(SHARE * error, &spectrum, upsample)
               : 0;
}

int farrow_reach(int degree, int upsample, enum precision precision)
{
    if (precision == PRECISION_DOUBLE)
        return FARROW_REACH_MOST;
    return upsample > 1 ? (degree + 5) / 2 : degree > 4 ? degree : 4;
}

enum { FREQUENCIES = 256, COLUMNS = 2 * FARROW_REACH_MOST + 1 };

/* a = q r, by Gram and Schmidt, each column made orthogonal twice; q takes a's place. */
static void orthogonalise(int columns, double (*a)[FREQUENCIES], double (*r)[COLUMNS])
{
    for (int c = 0; c < columns; c++) {
        double square = 0;
        for (int k = 0; k < 2 * c; k++) {
            double dot = 0;
            for (int n = 0; n < FREQUENCIES; n++)
                dot += a[k % c][n] * a[c][n];
            for (int n = 0; n < FREQUENCIES; n++)
                a[c][n] -= dot * a[k % c][n];
            r[k % c][c] += dot;
        }
        for (int n = 0; n < FREQUENCIES; n++)
            square += a[c][n] * a[c][n];
        r[c][c] = sqrt(square);
        for (int n = 0; n < FREQUENCIES; n++)
            a[c][n] /= r[c][c];
    }
}

/* x of least squares |q r x - b|. */
static void least_squares(int columns, double (*q)[FREQUENCIES], double (*r)[COLUMNS], const double *b, double *x)
{
    for (int c = columns - 1; c >= 0; c--) {
        x[c] = 0;
        for (int n = 0; n < FREQUENCIES; n++)
            x[c] += q[c][n] * b[n];
        for (int k = c + 1; k < columns; k++)
            x[c] -= r[c][k] * x[k];
        x[c] /= r[c][c];
    }
}

/* Taps of branch m. */
static void branch_fit(int m, int columns, double (*q)[FREQUENCIES], double (*r)[COLUMNS],
                       double (*gains)[FARROW_MOST + 1], const double *weight, struct farrow_taps *taps)
{
    const int reach = columns / 2;
    double b[FREQUENCIES], x[COLUMNS];
    for (int n = 0; n < FREQUENCIES; n++)
        b[n] = weight[n] * gains[n][m];
    least_squares(columns, q, r, b, x);
    taps->own[m][reach] = x[0];
    for (int k = 1; k <= reach; k++) {
        taps->own[m][reach - k] = taps->own[m][reach + k] = x[k];
        taps->other[m][reach + k] = x[reach + k];
        taps->other[m][reach - k] = -x[reach + k];
    }
}

/* Taps are fitted over an upsampled record's frequencies, each weighted by the error of the cut. The smallest errors
   are raised to one value: weights of all magnitudes make large taps. */
void farrow_taps_make(int degree, int upsample, double band, int reach, struct farrow_taps *taps)
{
    const double law = farrow_error(degree, band / upsample) + 1e-12;
    const int columns = 2 * reach + 1;
    double gains[FREQUENCIES][FARROW_MOST + 1], weight[FREQUENCIES], nu[FREQUENCIES];
    *taps = (struct farrow_taps){.reach = reach};
    for (int n = 0; n < FREQUENCIES; n++) {
        nu[n] = (n + 0.5) / (2 * FREQUENCIES * upsample);
        weight[n] = 1 / (sqrt(left_out(degree, nu[n])) + law);
        farrow_gains(degree, nu[n], gains[n]);
    }
    for (int odd = 0; odd < 2; odd++) { /* all even branches are made of the same columns, and all odd ones */
        double a[COLUMNS][FREQUENCIES], r[COLUMNS][COLUMNS] = {{0}};
        for (int n = 0; n < FREQUENCIES; n++) {
            const double own = weight[n] * gains[n][odd], other = weight[n] * gains[n][1 - odd];
            a[0][n] = own;
            for (int k = 1; k <= reach; k++) {
                a[k][n] = 2 * own * cos(2 * M_PI * k * nu[n]);
                a[reach + k][n] = (odd ? 2 : -2) * other * sin(2 * M_PI * k * nu[n]);
            }
        }
        orthogonalise(columns, a, r);
        for (int m = 2 + odd; m <= degree; m += 2)
            branch_fit(m, columns, a, r, gains, weight, taps);
    }
}
