/* The forecast of range migration (rma_forecast in conditions.h): the errors that its conditions predict, and those of
   blocks and Stolt interpolation. */
#include <math.h>
#include <string.h>

#include "range_migration/conditions.h"

static const int stolt_taps[] = {0, 4, 6, 8, 12, 16}; /* of rma_stolt_names; 0: a direct sum */
/* Samples fill two thirds of the transform that is interpolated (RMA_OVERSAMPLING), after Kaiser's weight is taken off:
   exp(-pi taps sqrt(1 - 2/3)), as of any such kernel, times what is measured. */
static const double STOLT_SHARE = 4, STOLT_SLOPE = 0.57735;
/* rad, root mean square over a block, for each rad at its ends: a lone block is taken up to 1/(4 pi), several that
   blend leave less (docs/range_migration.md). */
static const double BLOCK_SHARE = 0.08;
/* Rounding, relative L2: of the transforms. */
static const double ROUNDING[] = {1e-6, 1e-13};

/* The value of a condition by name; 0 where the list has none. */
static double value_of(const char *name, const struct condition *list, int count)
{
    for (int k = 0; k < count; k++)
        if (strcmp(list[k].name, name) == 0)
            return list[k].value;
    return 0;
}

enum status rma_forecast(const struct problem *problem, const struct rma_method *method,
                         const struct rma_options *options, struct forecast *forecast)
{
    struct condition list[CONDITIONS_MAX];
    const int count = rma_conditions(problem, method, list, CONDITIONS_MAX);
    enum status status = rma_conditions_check(method, list, count);
    if (status != STATUS_OK)
        return status;
    const double terms = value_of("delay_terms", list, count), taps = value_of("delay_taps", list, count);
    *forecast = (struct forecast){.sums_pairs = false};
    forecast->error[CAUSE_SPECTRUM] = value_of("predicted_error", list, count);
    forecast->error[CAUSE_DELAYS] = taps;
    if (!(problem->acquisition->bandwidth < problem->acquisition->fs))
        forecast->error[CAUSE_SPECTRUM] = INFINITY; /* the bin at fs/2 stands for both ends of the band: no law */
    /* Blocks that are asked for by number, or have hard edges, have no law. */
    const bool lawless = options->blocks || !options->blend;
    forecast->error[CAUSE_BLOCKS] = method->terms > 0 ? terms : lawless ? INFINITY : BLOCK_SHARE * options->limit;
    if (stolt_taps[options->stolt] > 0)
        forecast->error[CAUSE_STOLT] = STOLT_SHARE * exp(-M_PI * STOLT_SLOPE * stolt_taps[options->stolt]);
    forecast->error[CAUSE_FLOAT] = ROUNDING[problem->precision];
    return STATUS_OK;
}
