/* Range migration after phase-centre approximation (LBF21 Eq. (6)): each pair is replaced by a monostatic sonar
   half-way between its transmitter at emission and its receiver at reception, corrected by the delay of the target at
   broadside:

       -phi = 2 pi nu (-d/2 - r v/c) + 4 pi r S/c + pi F (d + 2 v r/c)^2/(2 c r)

   It uses the sonar's way during propagation, 2 v r/c, as if every target were at broadside. Error: grows with range
   and with the beam, 0.14 rad at 300 m and 7 degrees to either side, 1 rad at twice that beam (LBF21 Figs 4, 5, 7 and
   9). */
#include "range_migration/rma.h"

static const struct rma_method method = {
    .name = "rma_pca",
    .law = "pca_law",
    .error_limit = 0.25, /* LBF21 Table IV has 0.112, and 0.185 if the beam ends at lambda/(2 D) */
    .spectrum = spectrum_pca,
    .source = "LBF21 Eq. (21)",
    .range = {2, 2},
    .azimuth = {1, 1},
    .products = {1, 2},
    .interpolations = 2,
};

static const struct candidate_family candidates[] = {
    {"", "limit", "0.785 0.1"},
    {.fixed = NULL},
};

static const char *const gated[] = {"blocks=16", NULL};

const struct algorithm rma_pca = {
    .name = "rma_pca",
    .summary = "range migration after phase-centre approximation",
    .reference = "LBF21 Eq. (6), section IV",
    .options_size = sizeof(struct rma_options),
    .params = rma_params + 1,
    .gated = gated,
    .candidates = candidates,
    .method = &method,
    RMA_CALLBACKS,
};
