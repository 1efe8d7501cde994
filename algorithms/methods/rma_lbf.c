/* Range migration by Loffeld's bistatic formula, LBF21's own method: the phase of each pair's spectrum is a
   quasi-monostatic term psi and half a bistatic deformation psi_i (LBF21 Eqs. (3) to (5)),

       psi   = -2 pi v nu r/(c cos th) + 4 pi r S/c,    S = sqrt(F^2 - (c nu/2)^2),
       psi_i = -2 pi nu d + (pi/c) (d + 2 r v/(c cos th))^2 S^3/(F^2 r).

   `printed` takes theta at the carrier, sin th = c nu/(2 fc), which causes most of the error that the paper
   reports, and the paper's Eqs. (11) to (17) one by one; `corrected` takes theta at F, and psi into the conversion.
   Error of the corrected phase: below 0.01 rad from 50 m on, falling with r (rma_numeric has none); the error of the
   image is then that of stationary phase, 8e-3 at 40 m and 1e-3 from 135 m on. */
#include "range_migration/rma.h"

static const struct rma_method method = {
    .name = "rma_lbf",
    .law = "lbf_law",
    .error_limit = 0.1,
    .spectrum = spectrum_lbf_corrected,
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

static const char *const gated[] = {"variant=printed",     "blocks=16", "blocks=16,spacing=uniform",
                                    "blocks=16,blend=off", "stolt=4",   NULL};

const struct algorithm rma_lbf = {
    .name = "rma_lbf",
    .summary = "range migration by Loffeld's bistatic formula",
    .reference = "LBF21 Eqs. (3) to (5), section IV",
    .options_size = sizeof(struct rma_options),
    .params = rma_params,
    .gated = gated,
    .candidates = candidates,
    .method = &method,
    RMA_CALLBACKS,
};
