/* Nearest-neighbour back projection: s(q) = s[floor(q + 1/2)]  (BP22 Eq. (8) with the midpoint 0.5 (x0 + x1) in place
   of the printed 0.5 (x1 - x0); ZP15's "non-interpolated" method).

   Cost: one complex product and sum a pair. Error: the envelope's phase, at most pi B/(2 fs) at the band edge; relative
   L2 about 0.10 for a point and 0.19 for speckle (0.13 to 0.34 over ten draws) at fs = 2B. */
#include "backprojection/bp.h"

static const struct param params[] = {
    BP_PARAMS,
    {.name = NULL},
};

static enum status make(const struct problem *problem, const void *options, struct interpolator *interpolator)
{
    (void)problem, (void)options;
    *interpolator = (struct interpolator){.upsample = 1, .steps = 1, .taps = 1, .in_papers = true};
    return STATUS_OK;
}

static const struct bp_method method = {make, NULL};

static const struct candidate_family candidates[] = {
    {"", "", ""},
    {.fixed = NULL},
};

static const char *const gated[] = {"engine=general", "engine=general,precision=double", NULL};

const struct algorithm bp_nearest = {
    .name = "bp_nearest",
    .summary = "back projection, nearest sample",
    .reference = "BP22 Eq. (8), ZP15",
    .traits = TRAIT_ANY_TRACK | TRAIT_APERTURE_LIMIT | TRAIT_WINDOW,
    .reading = READING_NEAREST,
    .extreme_error = 0.15,
    .options_size = sizeof(struct bp_options),
    .params = params,
    .gated = gated,
    .candidates = candidates,
    .method = &method,
    BP_CALLBACKS,
};
