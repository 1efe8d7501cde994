/* Range migration after delay compensation: no formula for the bistatic spectrum and no range blocks. Each receiver's
   echo is delayed, by range, to what a monostatic sonar would have recorded broadside; what is left is of low rank over
   the receivers and undone at each azimuth wavenumber (range_migration/delay_compensation.h).

   Cost: a receiver, wavenumber and sample 6 + 4 terms FLOPs, whatever the depth of the swath. Error: the exact
   spectrum's own, and what the terms leave: 1e-3 from 57 m on. It grows with (array/range)^2, the square of the beam,
   and B/fc. */
#include "range_migration/rma.h"

struct delay_options {
    int taps, terms, stolt; /* taps and stolt: indices into their choices */
};

static const char *const tap_names[] = {"8", "12", "16", "24", NULL};
static const int tap_counts[] = {8, 12, 16, 24};

static const struct param params[] = {
    {PARAM_NAMED(struct delay_options, taps, tap_names), .summary = "taps of the receivers' delays", .initial = 2,
     .max = 3, .sweep = "8 12 16 24"},
    {PARAM(struct delay_options, terms), .summary = "terms over the receivers for what the delays leave", .initial = 2,
     .min = 1, .max = 3, .sweep = "1 2 3"},
    {PARAM_NAMED(struct delay_options, stolt, rma_stolt_names),
     .summary = "Kaiser taps of the Stolt interpolation, or a direct sum", .initial = 3, .max = 5, .terse = true,
     .hidden = true},
    {.name = NULL},
};

static void choose(const void *options, struct rma_method *method, struct rma_options *shared)
{
    const struct delay_options *delay = options;
    method->terms = delay->terms;
    method->taps = tap_counts[delay->taps];
    *shared = (struct rma_options){.blocks = 1, .stolt = delay->stolt};
}

static const struct rma_method method = {
    .choose = choose,
    .name = "rma_delay",
    .law = "delay_law",
    .error_limit = 0.1,
    .spectrum = spectrum_compensated,
};

const struct algorithm rma_delay = {
    .name = "rma_delay",
    .summary = "range migration after delays that make the receivers monostatic",
    .reference = "this project; the exact spectrum of LBF21 Eqs. (8) and (9)",
    .options_size = sizeof(struct delay_options),
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
