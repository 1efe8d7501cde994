/* Range migration without interpolation: the conversion of rma_delay, then phases and Fourier transforms alone, where
   the other methods interpolate the spectrum (Stolt). Over the band, the range wavenumber K follows a straight line,
   K = K_0 + n K_1 + q_n for bin n, up to a bend q_n that grows with the square of the angle:

       sum over n of  Z_n exp(j r K_n) = exp(j r K_0) sum over n of  [Z_n exp(j r_0 q_n)] exp(j (r - r_0) q_n)
                                         exp(j r n K_1)

   The line alone is a chirp z transform, onto rows of any spacing. As exp(j (r - r_0) q_n) is a short sum of powers of
   (r - r_0) q_n, the bend is a few more of them. This does what nonlinear chirp scaling does, for any pulse, to any
   accuracy.

   Cost: three transforms of rows and bins together for the first term of a wavenumber, two for each further one; a row
   costs 8 FLOPs a bin where there are few. Error: that of rma_delay, with `limit` at most in place of Stolt's
   interpolation. */
#include "range_migration/rma.h"

static const struct param params[] = {
    RMA_DELAY_PARAMS,
    {PARAM(struct rma_options, limit), .summary = "largest error of a phasor by the chirp transforms", .initial = 1e-3,
     .min = 1e-12, .max = 0.1, .sweep = "1e-2 1e-3 1e-4"},
    {.name = NULL},
};

static const struct rma_method method = {
    .name = "rma_chirp",
    .law = "delay_law",
    .error_limit = 0.1,
    .spectrum = spectrum_compensated,
    .chirps = true,
};

static const struct candidate_family candidates[] = {
    {"limit=1e-4", "terms", "2"},
    {.fixed = NULL},
};

static const char *const gated[] = {"terms=1,limit=1e-2", "taps=24,terms=3,limit=1e-7,precision=double", NULL};

const struct algorithm rma_chirp = {
    .name = "rma_chirp",
    .summary = "range migration by chirp transforms, without interpolation",
    .reference = "this project; conversion as rma_delay",
    .options_size = sizeof(struct rma_options),
    .params = params,
    .gated = gated,
    .candidates = candidates,
    .method = &method,
    RMA_CALLBACKS,
};
