/* Fitted taps of polar grids (factorised/taps.h). */
#include "backprojection/factorised/taps.h"

#include <math.h>
#include <stdlib.h>

enum { TAPS_MOST = 12, FRACTIONS = 16, HALVINGS = 40 }; /* as fine, rounding moves no place that matters */
static const double OVERSAMPLING_MOST = 6;

static void weights(const void *fitted, double fraction, double *w)
{
    fitted_weights(fitted, fraction, w);
}

/* Root mean square over fractions of |H - 1| over a flat band: 1 - 2 w.s + w.R w with fitted.h's sinc functions. */
static double error_of(int taps, double oversampling, struct fitted *fitted)
{
    const double band = 1 / oversampling;
    double sum = 0, w[FITTED_TAPS_MOST], r[TAPS_MOST];
    fitted_make(taps, band, fitted);
    for (int k = 0; k < taps; k++)
        r[k] = condition_sinc(band * k);
    for (int k = 0; k < FRACTIONS; k++) {
        const double u = (k + 0.5) / FRACTIONS - 0.5;
        fitted_weights(fitted, u + 0.5, w);
        double square = 1;
        for (int i = 0; i < taps; i++) {
            square -= 2 * w[i] * condition_sinc(band * (i - 0.5 * (taps - 1) - u));
            for (int j = 0; j < taps; j++)
                square += w[i] * w[j] * r[abs(i - j)];
        }
        sum += fmax(square, 0);
    }
    return sqrt(sum / FRACTIONS);
}

/* What samples and taps cost together: a sample costs as much as seven taps, whatever is done with it. */
static double cost_of(int taps, double oversampling)
{
    return oversampling * (7 + taps);
}

enum status polar_taps_choose(double error, double least, struct polar_taps *chosen)
{
    double cheapest = INFINITY;
    struct fitted fitted;
    for (int taps = 2; taps <= TAPS_MOST; taps += 2) {
        double low = least, high = OVERSAMPLING_MOST;
        if (!(low < high && cost_of(taps, low) < cheapest) || !(error_of(taps, high, &fitted) <= error))
            continue;
        if (error_of(taps, low, &fitted) <= error)
            high = low;
        for (int n = 0; n < HALVINGS && high > low && cost_of(taps, low) < cheapest; n++) {
            const double middle = 0.5 * (low + high);
            if (error_of(taps, middle, &fitted) <= error)
                high = middle;
            else
                low = middle;
        }
        if (cost_of(taps, high) < cheapest) {
            cheapest = cost_of(taps, high);
            chosen->taps = taps;
            chosen->oversampling = high;
        }
    }
    if (cheapest == INFINITY)
        return status_set(STATUS_UNSUPPORTED, "no taps interpolate polar grids with an error of %g", error);
    chosen->error = error_of(chosen->taps, chosen->oversampling, &fitted);
    const struct interpolator in = {
        .upsample = 1, .taps = chosen->taps, .first = 1 - chosen->taps / 2, .weights = weights};
    chosen->branches = kernel_branches(&in, &fitted, 0.1 * chosen->error, chosen->coefficients);
    return chosen->branches > 0 ? STATUS_OK : status_set(STATUS_FAILED, "no memory for interpolation weights");
}
