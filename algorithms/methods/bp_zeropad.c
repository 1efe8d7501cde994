/* Frequency zero-padding back projection (ZP15): the record's spectrum is padded to `factor` times its length, which
   evaluates the band-limited signal exactly on a grid of 1/(factor fs), and the nearest point of it is taken (ZP15
   Eq. (6), whose T_s belongs inside the rounding and whose shift has the wrong sign).

   Cost: an inverse FFT of factor N a record, then nearest neighbour's. Error: first order in 1/factor, the phase
   pi B/(2 fs factor) at the band edge; 2.8e-3 (factor 8) and 1.0e-3 (32) for a point at fs = 2B. ZP15's rule, a range
   error below lambda/8, asks for factor > 2 fc/fs. */
#include "backprojection/bp.h"

struct options {
    struct bp_options bp;
    int factor;
};

static const struct param params[] = {
    {PARAM(struct options, factor), .summary = "length of the padded spectrum over the record's", .initial = 8,
     .min = 1, .max = 256, .sweep = "1 2 4 8 16 32 64"},
    BP_PARAMS,
    {.name = NULL},
};

static enum status make(const struct problem *problem, const void *options, struct interpolator *interpolator)
{
    const struct options *o = options;
    (void)problem;
    *interpolator = (struct interpolator){.upsample = o->factor, .steps = 1, .taps = 1, .in_papers = true};
    return STATUS_OK;
}

static const struct bp_method method = {make, NULL};

static const struct candidate_family candidates[] = {
    {"", "factor", "2 4 8 16 32 64"},
    {.fixed = NULL},
};

static const char *const gated[] = {"factor=3", "factor=3,engine=general", NULL};

const struct algorithm bp_zeropad = {
    .name = "bp_zeropad",
    .summary = "back projection, zero padding in frequency by a factor, then the nearest",
    .reference = "ZP15 Eqs. (5)-(7)",
    .traits = TRAIT_ANY_TRACK | TRAIT_APERTURE_LIMIT | TRAIT_WINDOW,
    .reading = READING_NEAREST,
    .extreme_error = 0.03,
    .options_size = sizeof(struct options),
    .params = params,
    .gated = gated,
    .candidates = candidates,
    .method = &method,
    BP_CALLBACKS,
};
