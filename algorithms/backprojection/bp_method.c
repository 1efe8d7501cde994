/* Between struct algorithm and the engine: the interpolator that a method's options make (bp.h). */
#include <stdalign.h>

#include "backprojection/bp.h"

struct made {
    struct interpolator interpolator;
    alignas(max_align_t) unsigned char bytes[BP_MADE_MOST];
};

/* *handed: what the engine takes for the options. */
static enum status make(const struct problem *problem, const struct bp_method *method, const void *options,
                        struct made *made, const void **handed)
{
    *handed = method->made_size > 0 ? made->bytes : options;
    return method->make(problem, options, &made->interpolator, made->bytes);
}

enum status bp_method_plan(const struct problem *problem, const void *method, const void *options, void **plan)
{
    struct made made;
    const void *handed;
    *plan = NULL;
    const enum status status = make(problem, method, options, &made, &handed);
    return status == STATUS_OK ? bp_plan(problem, &made.interpolator, handed, plan) : status;
}

enum status bp_method_cost(const struct problem *problem, const void *method, const void *options,
                           struct forecast *forecast)
{
    struct made made;
    const void *handed;
    const enum status status = make(problem, method, options, &made, &handed);
    return status == STATUS_OK ? bp_cost(problem, &made.interpolator, handed, forecast) : status;
}

enum status bp_method_forecast(const struct problem *problem, const void *method, const void *options,
                               struct forecast *forecast)
{
    struct made made;
    const void *handed;
    const enum status status = make(problem, method, options, &made, &handed);
    return status == STATUS_OK ? bp_forecast(problem, &made.interpolator, handed, forecast) : status;
}

int bp_method_conditions(const struct problem *problem, const void *method, const void *options, struct condition *list,
                         int room)
{
    (void)method;
    return bp_conditions(problem, options, list, room);
}
