/* Between struct algorithm and the engine: a method and its options, as they choose (rma.h). */
#include "range_migration/rma_conditions.h"

struct chosen {
    struct rma_method method;
    struct rma_options options;
};

static struct chosen chosen_of(const void *method, const void *options)
{
    struct chosen chosen = {.method = *(const struct rma_method *)method};
    if (chosen.method.choose)
        chosen.method.choose(options, &chosen.method, &chosen.options);
    else
        chosen.options = *(const struct rma_options *)options;
    return chosen;
}

int rma_method_conditions(const struct problem *problem, const void *method, const void *options,
                          struct condition *list, int room)
{
    const struct chosen chosen = chosen_of(method, options);
    return rma_conditions(problem, &chosen.method, list, room);
}

enum status rma_method_forecast(const struct problem *problem, const void *method, const void *options,
                                struct forecast *forecast)
{
    const struct chosen chosen = chosen_of(method, options);
    return rma_forecast(problem, &chosen.method, &chosen.options, forecast);
}

enum status rma_method_cost(const struct problem *problem, const void *method, const void *options,
                            struct forecast *forecast)
{
    const struct chosen chosen = chosen_of(method, options);
    return rma_cost(problem, &chosen.method, &chosen.options, forecast);
}

enum status rma_method_plan(const struct problem *problem, const void *method, const void *options, void **plan)
{
    const struct chosen chosen = chosen_of(method, options);
    return rma_plan(problem, &chosen.method, &chosen.options, plan);
}
