/* Range migration with the exact spectrum: the chain of rma_lbf, but the phase of each pair is found numerically, by
   Newton's method on the exact delay (LBF21 Eqs. (8) and (9), which uses bisection):

       phi = -2 pi (F tau(u) + nu u),   F tau'(u) = -nu

   Error: none of its own; only that of stationary phase and of the width of the blocks. */
#include "range_migration/rma.h"

static const struct rma_method method = {
    .name = "rma_numeric",
    .law = "phase",
    .error_limit = 0.1,
    .spectrum = spectrum_exact,
    .source = "LBF21 Eq. (20)",
    .range = {2, 2},
    .azimuth = {1, 1},
    .products = {2, 2},
    .interpolations = 1,
};

static const struct candidate_family candidates[] = {
    {"", "limit", "0.785 0.1 0.01"},
    {.fixed = NULL},
};

static const char *const gated[] = {"blocks=16,stolt=16", "blocks=16,stolt=16,precision=double", NULL};

const struct algorithm rma_numeric = {
    .name = "rma_numeric",
    .summary = "range migration with the exact spectrum, found numerically",
    .reference = "LBF21 Eqs. (8) and (9), section IV",
    .options_size = sizeof(struct rma_options),
    .params = rma_params + 1,
    .gated = gated,
    .candidates = candidates,
    .method = &method,
    RMA_CALLBACKS,
};
