/* Truncated-sinc back projection, BP22's "traditional BP" (kernel length 8, rectangular) and ZP15's "truncated
   interpolation":  s(q) = sum of s[floor(q) + k] sinc(q - floor(q) - k) w(.),  k = -taps/2+1 .. taps/2.

   Cost: 4 taps + 8 FLOPs a pair. Error at fs = 2B, 8 taps: 2.4e-3 for a point, 0.04 for speckle (median of ten draws;
   the rectangular kernel's ripple); a Kaiser window (beta = 5) on the same taps is 40 to 50 times more accurate for a
   point with a flat spectrum. kaiser_band sets beta = (pi/2) taps (1 - B/fs): the kernel rolls off between the band's
   edge and its image, with an error of about exp(-beta)/4 for a flat band. */
#include <math.h>

#include "backprojection/bp.h"
#include "backprojection/law_spectrum.h"

enum window { WINDOW_NONE, WINDOW_KAISER, WINDOW_KAISER_BAND };

struct options {
    struct bp_options bp;
    int taps, window;
};

static const char *const windows[] = {"none", "kaiser", "kaiser_band", NULL};

static const struct param params[] = {
    {PARAM(struct options, taps), .summary = "kernel length in samples, even", .initial = 8, .min = 2, .max = 64,
     .sweep = "4 6 8 10 12 16 32"},
    {PARAM_NAMED(struct options, window, windows),
     .summary = "taper of the kernel: none (the papers'), Kaiser with beta = 5, or with (pi/2) taps (1 - B/fs)",
     .initial = WINDOW_NONE, .max = WINDOW_KAISER_BAND, .sweep = "none kaiser"},
    BP_PARAMS,
    {.name = NULL},
};

static void weights(const struct interpolator *in, double fraction, double *w)
{
    sinc_weights(in->taps, in->kernel.beta, fraction, w);
}

static enum status make(const struct problem *problem, const void *options, struct interpolator *interpolator)
{
    const struct acquisition *a = problem->acquisition;
    const struct options *o = options;
    if (o->taps % 2)
        return status_set(STATUS_UNSUPPORTED, "bp_sinc: taps is %d, must be even", o->taps);
    const double band = o->window == WINDOW_KAISER_BAND ? law_band_fitted(a) : a->bandwidth;
    const double betas[] = {0, 5, 0.5 * M_PI * o->taps * (1 - fmin(band / a->fs, 1))};
    *interpolator = (struct interpolator){.upsample = 1,
                                          .taps = o->taps,
                                          .first = 1 - o->taps / 2,
                                          .weights = weights,
                                          .kernel.beta = betas[o->window],
                                          .in_papers = true};
    return isnan(band) ? STATUS_FAILED : STATUS_OK;
}

static const struct bp_method method = {make, NULL};

static const struct candidate_family candidates[] = {
    {"window=none", "taps", "4 8 16"},
    {"window=kaiser", "taps", "4 8 16 32"},
    {"window=kaiser_band", "taps", "4 6 8 10 12 16 32"},
    {"window=kaiser_band,engine=general", "taps", "4 6 8"},
    {.fixed = NULL},
};

static const char *const gated[] = {"taps=4,engine=general",
                                    "taps=16,window=kaiser",
                                    "taps=16,window=kaiser,precision=double",
                                    "taps=16,window=kaiser,engine=general",
                                    "taps=16,window=kaiser,engine=general,precision=double",
                                    NULL};

const struct algorithm bp_sinc = {
    .name = "bp_sinc",
    .summary = "back projection, truncated sinc kernel",
    .reference = "BP22 section 4 (traditional BP), ZP15",
    .traits = TRAIT_ANY_TRACK | TRAIT_APERTURE_LIMIT | TRAIT_WINDOW,
    .reading = READING_SINC,
    .extreme_error = 0.06,
    .options_size = sizeof(struct options),
    .params = params,
    .gated = gated,
    .candidates = candidates,
    .method = &method,
    BP_CALLBACKS,
};
