/* Fitted taps of polar grids (factorised/taps.h). */
#include "backprojection/factorised/taps.h"

#include <math.h>
#include <stdlib.h>

enum { TAPS_MOST = 12, FRACTIONS = 16, STEPS = 40 };
/* With steps of FINEST, relative, rounding has no effect that matters. */
static const double OVERSAMPLING_MOST = 6, FINEST = 1e-12;

static void weights(const struct interpolator *in, double fraction, double *w)
{
    fitted_weights(&in->kernel.fitted, fraction, w);
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

/* Cost of samples and taps together: a sample costs as much as seven taps. */
static double cost_of(int taps, double oversampling)
{
    return oversampling * (7 + taps);
}

/* The least oversampling from `least` on with the error: by false position, as the error is nearly exponential; an end
   that stays twice counts half (Dowell, Jarratt, BIT 11, 1971). INFINITY if none has it, or none that costs less than
   `cheapest`. */
static double oversampling_of(int taps, double error, double least, double cheapest)
{
    struct fitted fitted;
    double low = least, high = OVERSAMPLING_MOST;
    if (!(low < high && cost_of(taps, low) < cheapest))
        return INFINITY;
    double above = log(error_of(taps, low, &fitted) / error), below = log(error_of(taps, high, &fitted) / error);
    if (!(below <= 0))
        return INFINITY;
    if (above <= 0)
        return low;
    for (int n = 0, moved = 0; n < STEPS && high - low > FINEST * high && cost_of(taps, low) < cheapest; n++) {
        const double middle = (low * below - high * above) / (below - above);
        const double value = log(error_of(taps, middle, &fitted) / error);
        if (!(middle > low && middle < high))
            break;
        if (value <= 0) {
            high = middle;
            below = value;
            above /= moved > 0 ? 2 : 1;
            moved = 1;
        } else {
            low = middle;
            above = value;
            below /= moved < 0 ? 2 : 1;
            moved = -1;
        }
    }
    return high;
}

enum status polar_taps_choose(double error, double least, struct polar_taps *chosen)
{
    double cheapest = INFINITY;
    for (int taps = 2; taps <= TAPS_MOST; taps += 2) {
        const double oversampling = oversampling_of(taps, error, least, cheapest);
        if (cost_of(taps, oversampling) < cheapest) {
            cheapest = cost_of(taps, oversampling);
            chosen->taps = taps;
            chosen->oversampling = oversampling;
        }
    }
    if (cheapest == INFINITY)
        return status_set(STATUS_UNSUPPORTED, "no taps interpolate polar grids with an error of %g", error);
    struct interpolator in = {.upsample = 1, .taps = chosen->taps, .first = 1 - chosen->taps / 2, .weights = weights};
    chosen->error = error_of(chosen->taps, chosen->oversampling, &in.kernel.fitted);
    chosen->branches = kernel_branches(&in, 0.1 * chosen->error, chosen->coefficients);
    return chosen->branches > 0 ? STATUS_OK : status_set(STATUS_FAILED, "no memory for interpolation weights");
}
