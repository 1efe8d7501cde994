/* Range migration with the exact spectrum: the chain of rma_lbf, but the phase of each pair is found numerically, by
   Newton's method on the exact delay (LBF21 Eqs. (8) and (9), which uses bisection):

       phi = -2 pi (F tau(u) + nu u),   F tau'(u) = -nu

   Error: none of its own; what is left comes from the method of stationary phase and from the width of the blocks. */
#include "range_migration/rma_conditions.h"

static const struct param params[] = {
    RMA_PARAMS,
    {.name = NULL},
};

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

static int conditions(const struct problem *problem, const void *options, struct condition *list, int room)
{
    (void)options;
    return rma_conditions(problem, &method, list, room);
}

static enum status forecast(const struct problem *problem, const void *options, struct forecast *forecast)
{
    return rma_forecast(problem, &method, options, forecast);
}

static enum status cost(const struct problem *problem, const void *options, struct forecast *forecast)
{
    return rma_cost(problem, &method, options, forecast);
}

static enum status plan(const struct problem *problem, const void *options, void **plan)
{
    return rma_plan(problem, &method, options, plan);
}

const struct algorithm rma_numeric = {
    .name = "rma_numeric",
    .summary = "range migration with the exact spectrum, found numerically",
    .reference = "LBF21 Eqs. (8) and (9), section IV",
    .options_size = sizeof(struct rma_options),
    .params = params,
    .conditions = conditions,
    .forecast = forecast,
    .cost = cost,
    .plan = plan,
    .execute = rma_execute,
    .work = rma_work,
    .destroy = rma_destroy,
};
