/* The sum over evenly spaced receivers by two steps, as in a fast Fourier transform (delay_compensation.h). */
#include <math.h>

#include "range_migration/rma_engine.h"

static const double EVEN = 1e-10; /* wavelengths: tolerance of even places */

/* Is every receiver a whole multiple of 2 |spacing|/periods ahead of the first? */
static bool even(const struct rma *rma, double pitch)
{
    const double wavelength = rma->setting.sound_speed / rma->setting.fc;
    for (int m = 0; m < rma->receivers; m++)
        if (!(fabs(rma->offset[m] - rma->offset[0] - m * pitch) <= EVEN * wavelength))
            return false;
    return true;
}

/* FLOPs of a sample, of all wavenumbers that read the same spectra. */
static double fold_flops(const struct rma *rma, int fold, int stride)
{
    const double receivers = rma->receivers, terms = rma->delay->terms.terms, even = fold % 2 == 0;
    const double sums = even ? fold / 2.0 : fold;
    return fmin(stride, receivers) * (receivers * (6 + 4 * terms) + even * 2 * fold * terms)
           + receivers * ((sums - 1) * 8 + 12) * terms;
}

double rma_fold_flops(const struct rma *rma)
{
    return fold_flops(rma, rma->delay->fold, rma->delay->stride);
}

void rma_fold(struct rma *rma)
{
    struct rma_delay *delay = rma->delay;
    const double spacing = fabs(rma->spacing);
    const double pitch = rma->receivers > 1 ? rma->offset[1] - rma->offset[0] : 0;
    /* of wavenumbers, until phasors repeat */
    const double periods = pitch != 0 ? floor(2 * spacing / fabs(pitch) + 0.5) : 0;
    delay->fold = 1;
    delay->stride = rma->receivers;
    delay->turn = delay->step = 0;
    if (!(periods >= 1 && periods <= 4.0 * rma->receivers) || !even(rma, copysign(2 * spacing / periods, pitch)))
        return;
    for (int fold = 2; fold <= RMA_FOLD; fold++)
        if ((int)periods % fold == 0
            && fold_flops(rma, fold, (int)periods / fold) < fold_flops(rma, delay->fold, delay->stride)) {
            delay->fold = fold;
            delay->stride = (int)periods / fold;
        }
    if (delay->fold > 1) {
        delay->turn = -delay->stride * rma->offset[0] / (2 * spacing);
        delay->step = -copysign(1.0 / delay->fold, pitch);
    }
}
