/* Range migration by Loffeld's bistatic formula, LBF21's own method: the phase of each pair's spectrum is a
   quasi-monostatic term psi and half a bistatic deformation psi_i (LBF21 Eqs. (3) to (5)),

       psi   = -2 pi v nu r/(c cos th) + 4 pi r S/c,    S = sqrt(F^2 - (c nu/2)^2),
       psi_i = -2 pi nu d + (pi/c) (d + 2 r v/(c cos th))^2 S^3/(F^2 r).

   `printed` takes theta at the carrier, sin th = c nu/(2 fc), which causes most of the error that the paper
   reports; `corrected` takes it at F. Error of the corrected phase: below 0.01 rad from 50 m on, falling with r
   (rma_numeric has none); the image's error is then that of stationary phase, 8e-3 at 40 m and 1e-3 from 135 m
   on. */
#include "range_migration/rma.h"

enum variant { PRINTED, CORRECTED };
static const char *const variants[] = {[PRINTED] = "printed", [CORRECTED] = "corrected", NULL};

struct lbf_options {
    struct rma_options shared; /* first: RMA_PARAMS lie in it */
    int variant;               /* enum variant */
};

static const struct param params[] = {
    {PARAM_NAMED(struct lbf_options, variant, variants), .summary = "theta at the carrier, as printed, or at F",
     .initial = CORRECTED, .max = CORRECTED, .sweep = "printed corrected"},
    RMA_PARAMS,
    {.name = NULL},
};

static void choose(const void *options, struct rma_method *method, struct rma_options *shared)
{
    static spectrum_function *const spectra[] = {
        [PRINTED] = spectrum_lbf_printed, [CORRECTED] = spectrum_lbf_corrected};
    const struct lbf_options *lbf = options;
    method->spectrum = spectra[lbf->variant];
    *shared = lbf->shared;
}

static const struct rma_method method = {
    .choose = choose,
    .name = "rma_lbf",
    .law = "lbf_law",
    .error_limit = 0.1,
    .source = "LBF21 Eq. (20)",
    .range = {2, 2},
    .azimuth = {1, 1},
    .products = {2, 2},
    .interpolations = 1,
};

const struct algorithm rma_lbf = {
    .name = "rma_lbf",
    .summary = "range migration by Loffeld's bistatic formula",
    .reference = "LBF21 Eqs. (3) to (5), section IV",
    .options_size = sizeof(struct lbf_options),
    .params = params,
    .method = &method,
    .conditions = rma_method_conditions,
    .promise = rma_promise,
    .forecast = rma_method_forecast,
    .cost = rma_method_cost,
    .plan = rma_method_plan,
    .execute = rma_execute,
    .work = rma_work,
    .destroy = rma_destroy,
};
