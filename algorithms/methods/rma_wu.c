/* Range migration after reference range history. The method itself (LBF21 reference [22]) was not available; this
   is a working definition: the broadside delay of each receiver, exact and for each range, less that of the reference
   receiver M/2, corrected together with the PCA phase of the reference receiver (spectrum.h).

   Error: that of PCA, as both take targets to be broadside; less only where d^4/r^3 counts. */
#include "range_migration/rma_conditions.h"

static const struct param params[] = {
    RMA_PARAMS,
    {.name = NULL},
};

static const struct rma_method method = {
    .name = "rma_wu",
    .law = "wu_law",
    .error_limit = 0.12, /* as for rma_pca */
    .spectrum = spectrum_wu,
    .source = "LBF21 Eq. (22)",
    .range = {4, 2},
    .azimuth = {0, 2},
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

const struct algorithm rma_wu = {
    .name = "rma_wu",
    .summary = "range migration after reference range history (a working definition of Wu's method)",
    .reference = "LBF21 [22], section IV",
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
