/* Linearly upsampled back projection: beta points are inserted between samples by linear interpolation, then the
   nearest is taken (BP22 Eqs. (6)-(8)):  Q = floor(q (beta+1) + 1/2),  s(q) = (1-f) s[i] + f s[i+1],
   i + f = Q/(beta+1). The grid is absolute, t = n/(fs (beta+1)).

   Cost: the upsampled record is never stored; the rounded fraction selects one of beta+1 pairs of weights. Error: the
   grid's phase pi B/(2 fs (beta+1)) falls with beta, linear interpolation's own loss at high frequencies does not: a
   floor at beta about 4, about 0.07 (point) and 0.09 (speckle, median of ten draws) at fs = 2B, falling as (B/fs)^2.

   preemphasis=on divides the spectrum by the mean loss of linear interpolation, sinc^2(f/fs), inside the compression
   filter (one pair of FFTs a record where echoes are compressed already). The error for a flat narrow band is 0.165
   (B/fs)^2 in place of 0.40 (B/fs)^2; with fs = 2B half of that without. The papers do not have it. */
#include "backprojection/bp.h"

struct options {
    struct bp_options bp;
    int beta, preemphasis;
};

static const char *const switches[] = {"off", "on", NULL};

static const struct param params[] = {
    {PARAM(struct options, beta), .summary = "points inserted between two samples", .initial = 8, .min = 0, .max = 1024,
     .sweep = "0 1 2 4 8 16 32"},
    {PARAM_NAMED(struct options, preemphasis, switches),
     .summary = "on: the compression filter makes up for what linear interpolation loses at high frequencies", .max = 1,
     .terse = true},
    BP_PARAMS,
    {.name = NULL},
};

static void weights(const struct interpolator *in, double fraction, double *w)
{
    (void)in;
    w[0] = 1 - fraction;
    w[1] = fraction;
}

static enum status make(const struct problem *problem, const void *options, struct interpolator *interpolator)
{
    const struct options *o = options;
    (void)problem;
    *interpolator = (struct interpolator){.upsample = 1,
                                          .steps = o->beta + 1,
                                          .taps = 2,
                                          .preemphasis = o->preemphasis != 0,
                                          .weights = weights,
                                          .in_papers = !o->preemphasis};
    return STATUS_OK;
}

static const struct bp_method method = {make, NULL};

static const struct candidate_family candidates[] = {
    {"", "beta", "1 2 4 8 16 32"},
    {"preemphasis=on", "beta", "2 4 8 16 32"},
    {"engine=general", "beta", "2 8"},
    {.fixed = NULL},
};

static const char *const gated[] = {"beta=2", "preemphasis=on", "engine=general", "engine=general,precision=double",
                                    NULL};

const struct algorithm bp_linear = {
    .name = "bp_linear",
    .summary = "back projection, linear upsampling by beta, then the nearest",
    .reference = "BP22 Eqs. (6)-(8)",
    .traits = TRAIT_ANY_TRACK | TRAIT_APERTURE_LIMIT | TRAIT_WINDOW,
    .reading = READING_LINEAR,
    .extreme_error = 0.12,
    .options_size = sizeof(struct options),
    .params = params,
    .gated = gated,
    .candidates = candidates,
    .method = &method,
    BP_CALLBACKS,
};
