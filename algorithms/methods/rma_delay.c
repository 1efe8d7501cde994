/* Range migration after delay compensation: no formula for the bistatic spectrum and no range blocks. Each receiver's
   echo is delayed, by range, to the echo of a monostatic sonar at broadside. The remaining phase has low rank over the
   receivers and is corrected at each azimuth wavenumber (range_migration/delay_compensation.h).

   Cost: 6 + 4 terms FLOPs a receiver, wavenumber and sample, for any depth of the swath. Error: that of the exact
   spectrum and that of the terms, 1e-3 from 57 m on. It grows with (array/range)^2, the square of the beam, and
   B/fc. */
#include "range_migration/rma.h"

static const struct param params[] = {
    RMA_DELAY_PARAMS,
    {PARAM_NAMED(struct rma_options, stolt, rma_stolt_names), .summary = "Kaiser taps of the Stolt interpolation",
     .initial = 2, .max = 4, .terse = true, .hidden = true},
    {.name = NULL},
};

static const struct rma_method method = {
    .name = "rma_delay",
    .law = "delay_law",
    .error_limit = 0.1,
    .spectrum = spectrum_compensated,
};

static const struct candidate_family candidates[] = {
    {"taps=8", "terms", "1 2"},
    {"", "terms", "1 2"},
    {"taps=24", "terms", "2 3"},
    {.fixed = NULL},
};

static const char *const gated[] = {"terms=1", "taps=24,terms=3,stolt=16,precision=double", NULL};

const struct algorithm rma_delay = {
    .name = "rma_delay",
    .summary = "range migration after delays that make the receivers monostatic",
    .reference = "this project; the exact spectrum of LBF21 Eqs. (8) and (9)",
    .options_size = sizeof(struct rma_options),
    .params = params,
    .gated = gated,
    .candidates = candidates,
    .method = &method,
    RMA_CALLBACKS,
};
