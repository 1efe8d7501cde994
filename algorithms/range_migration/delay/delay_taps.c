/* Fractional delays by taps of least squares (delay_compensation.h): the weights with the least error over the
   compressed pulse's own energy spectrum. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/cholesky.h"
#include "common/fft_length.h"
#include "common/pulse_band.h"
#include "range_migration/delay_compensation.h"

static const double FLOOR = 1e-7; /* of the energy, spread evenly over all frequencies: weights stay small everywhere */

enum { BINS = 512, RECEIVERS = 32 /* whose delays are tested, at most */ };

static double frequency_of(int bin)
{
    return (bin + 0.5) / BINS - 0.5;
}

/* The compressed pulse's energy by frequency, bin k about frequency_of(k) of `share` of the sampling rate; their sum
   is 1. */
static enum status spectrum_fill(const struct acquisition *a, double share, double energy[BINS])
{
    const double half = a->bandwidth / 2 / (share * a->fs);
    double sum = 0;
    memset(energy, 0, BINS * sizeof *energy);
    if (a->compressed) {
        for (int k = 0; k < BINS; k++) {
            double low = (double)k / BINS - 0.5, high = low + 1.0 / BINS;
            energy[k] = fmax(fmin(high, half) - fmax(low, -half), 0);
        }
    } else {
        int length = fft_length_fast(fmax(2.0 * a->pulse_length, 2.0 * BINS));
        double *bins = pulse_energy(a, length);
        if (!bins)
            return STATUS_FAILED;
        for (int k = 0; k < length; k++) {
            const double place = ((k < length - length / 2 ? k : k - length) + 0.5) / (share * length) + 0.5;
            if (place >= 0 && place < 1)
                energy[(int)(place * BINS)] += bins[k];
        }
        free(bins);
    }
    for (int k = 0; k < BINS; k++)
        sum += energy[k];
    for (int k = 0; k < BINS; k++)
        energy[k] = (1 - FLOOR) * energy[k] / sum + FLOOR / BINS;
    return STATUS_OK;
}

/* Real part of the mean of exp(j 2 pi f x) over the energy, and its slope over x. The pulse's spectrum is assumed
   even. */
static double correlation(const double energy[BINS], double x, double *slope)
{
    double value = 0;
    *slope = 0;
    for (int k = 0; k < BINS; k++) {
        double w = 2 * M_PI * frequency_of(k);
        value += energy[k] * cos(w * x);
        *slope -= energy[k] * w * sin(w * x);
    }
    return value;
}

/* The taps' correlations with each other, as Cholesky's factor. */
struct normal {
    int taps;
    double energy[BINS], lower[DELAY_TAPS * DELAY_TAPS];
};

static enum status normal_make(const struct acquisition *acquisition, double share, int taps, struct normal *normal)
{
    double between[DELAY_TAPS], unused;
    normal->taps = taps;
    enum status status = spectrum_fill(acquisition, share, normal->energy);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < taps; k++)
        between[k] = correlation(normal->energy, k, &unused);
    cholesky_toeplitz(taps, between, normal->lower);
    return STATUS_OK;
}

/* Weights for a fraction of a sample and their slopes over it. */
static void weights_solve(const struct normal *normal, double fraction, double weights[DELAY_TAPS],
                          double slopes[DELAY_TAPS])
{
    const int taps = normal->taps;
    for (int k = 0; k < taps; k++)
        weights[k] = correlation(normal->energy, fraction - (k + 1 - taps / 2), &slopes[k]);
    cholesky_solve(taps, normal->lower, weights);
    cholesky_solve(taps, normal->lower, slopes);
}

/* The error half-way between two samples, over the frequencies kept: without the floor and the cut flanks. The weights
   are even about the middle. */
static double middle_error(const struct normal *normal, double half, const double weights[DELAY_TAPS])
{
    double left = 0;
    for (int n = 0; n < BINS / 2; n++) {
        const double nu = frequency_of(n + BINS / 2),
                     energy = normal->energy[BINS / 2 + n] + normal->energy[BINS / 2 - 1 - n];
        double off = -1;
        for (int k = 0; k < normal->taps; k++)
            off += weights[k] * cos(2 * M_PI * nu * (k + 0.5 - normal->taps / 2));
        left += nu < half ? fmax(energy - 2 * FLOOR / BINS, 0) * off * off : 0;
    }
    return sqrt(left);
}

double delay_taps_error(const struct acquisition *acquisition, double share, int taps, double half)
{
    struct normal normal;
    double weights[DELAY_TAPS], slopes[DELAY_TAPS];
    if (normal_make(acquisition, share, taps, &normal) != STATUS_OK)
        return NAN;
    weights_solve(&normal, 0.5, weights, slopes);
    return middle_error(&normal, half / share, weights);
}

double delay_taps_expected(const struct rma_view *view, double share, int taps, double half)
{
    const struct problem *problem = view->problem;
    const struct acquisition *a = problem->acquisition;
    const int every = (a->receivers + RECEIVERS - 1) / RECEIVERS;
    struct normal normal;
    double weights[DELAY_TAPS], slopes[DELAY_TAPS], sum = 0, count = 0;
    if (normal_make(a, share, taps, &normal) != STATUS_OK)
        return NAN;
    weights_solve(&normal, 0.5, weights, slopes);
    for (int k = 0; k < 2 * problem->patch_count; k++)
        for (int m = 0; m < a->receivers; m += every, count++) {
            const struct grid *g = &problem->patches[k / 2];
            const double r = g->r_first + k % 2 * (g->r_count - 1) * g->r_step;
            sum += pow(sin(M_PI * share * a->fs * spectrum_abeam(&view->setting, a->rx[m].x - a->tx[0].x, r)), 2);
        }
    return middle_error(&normal, half / share, weights) * sqrt(sum / count);
}

enum status delay_taps_make(const struct acquisition *acquisition, double share, int taps, struct delay_taps *made)
{
    struct normal normal;
    enum status status = normal_make(acquisition, share, taps, &normal);
    if (status != STATUS_OK)
        return status;
    made->taps = taps;
#pragma omp parallel for
    for (int i = 0; i <= DELAY_INTERVALS; i++)
        weights_solve(&normal, (double)i / DELAY_INTERVALS, made->weights[i], made->slopes[i]);
    return STATUS_OK;
}

void delay_taps_weights(const struct delay_taps *taps, double fraction, double *weights, double *slopes)
{
    double place = fraction * DELAY_INTERVALS;
    int i = (int)fmin(place, DELAY_INTERVALS - 1);
    for (int k = 0; k < taps->taps; k++) {
        weights[k] = taps->weights[i][k] + (place - i) * (taps->weights[i + 1][k] - taps->weights[i][k]);
        slopes[k] = taps->slopes[i][k] + (place - i) * (taps->slopes[i + 1][k] - taps->slopes[i][k]);
    }
}
