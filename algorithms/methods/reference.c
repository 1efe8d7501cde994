/* The exact image, the reference of all errors: the band-limited record evaluated at the exact delay. The record is
   upsampled 4 times by zero padding (exact), then summed over 20 taps of a sinc under a Kaiser window. The signal fills
   at most a quarter of the fine band, so the kernel may roll off over three quarters of it: with beta = 21 both its
   ripple and the images lie below 1e-10 of the signal. Slow on purpose: nothing here is traded for speed. */
#include "backprojection/bp.h"

enum { UPSAMPLE = 4, TAPS = 20 };

static void weights(const struct interpolator *in, double fraction, double *w)
{
    (void)in;
    sinc_weights(TAPS, 21, fraction, w);
}

static enum status make(const struct problem *problem, const void *options, struct interpolator *interpolator)
{
    (void)problem, (void)options;
    *interpolator = (struct interpolator){
        .upsample = UPSAMPLE, .taps = TAPS, .first = 1 - TAPS / 2, .weights = weights, .in_papers = true};
    return STATUS_OK;
}

static const struct bp_options exact = {.engine = BP_ENGINE_GENERAL, .exact = 1};
static const struct bp_method method = {make, &exact};

const struct algorithm reference = {
    .name = "reference",
    .summary = "exact band-limited back projection, slow; what errors are measured against",
    .reference = "BP22 Eqs. (1), (5); LBF21 Eq. (1)",
    .traits = TRAIT_EXACT | TRAIT_ANY_TRACK | TRAIT_APERTURE_LIMIT | TRAIT_WINDOW,
    .reading = READING_BAND,
    .extreme_error = 1e-9,
    .method = &method,
    .plan = bp_method_plan,
    .execute = bp_execute,
    .reads = bp_reads,
    .work = bp_work,
    .destroy = bp_destroy,
};
