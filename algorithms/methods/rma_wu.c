/* Range migration after reference range history. The method itself (LBF21 reference [22]) was not available; this
   is a working definition: the broadside delay of each receiver, exact and for each range, less that of the reference
   receiver M/2, corrected together with the PCA phase of the reference receiver (spectrum.h).

   Error: that of PCA, as both assume targets at broadside; less only where d^4/r^3 counts. */
#include "range_migration/rma.h"

static const struct rma_method method = {
    .name = "rma_wu",
    .law = "wu_law",
    .error_limit = 0.25, /* as for rma_pca */
    .spectrum = spectrum_wu,
    .source = "LBF21 Eq. (22)",
    .range = {4, 2},
    .azimuth = {0, 2},
    .products = {2, 2},
    .interpolations = 1,
};

static const struct candidate_family candidates[] = {
    {"", "limit", "0.785 0.1"},
    {.fixed = NULL},
};

static const char *const gated[] = {"blocks=16", NULL};

const struct algorithm rma_wu = {
    .name = "rma_wu",
    .summary = "range migration after reference range history (a working definition of Wu's method)",
    .reference = "LBF21 [22], section IV",
    .options_size = sizeof(struct rma_options),
    .params = rma_params + 1,
    .gated = gated,
    .candidates = candidates,
    .method = &method,
    RMA_CALLBACKS,
};
