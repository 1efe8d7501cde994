#include "planner/rates.h"

#include <omp.h>

/* Measured by `plan` on an Intel Xeon with AVX-512 at 2.1 GHz. */
static struct rates rates = {
    .pair = {{[READ_NEAREST] = 8.7e-10, [READ_LINE] = 1.04e-9, [READ_TAPS] = 1.69e-9, [READ_BRANCHES] = 6.9e-10},
             {[READ_NEAREST] = 9.0e-11, [READ_LINE] = 1.89e-10}},
    .value = {{[READ_BRANCHES] = 1.23e-10}, {[READ_TAPS] = 1.7e-10, [READ_BRANCHES] = 1.8e-10}},
    .entry = {[READ_NEAREST] = 3.3e-9, [READ_LINE] = 6.8e-9, [READ_TAPS] = 1.36e-8, [READ_BRANCHES] = 1.46e-8},
    .compress = 1.4e-10,
    .migrate = 1.5e-10,
    .doubled = 1.6,
    .noise = 0.01,
};

static const double START = 1e-5; /* s: of any run, also where no pixel meets a record */

const struct rates *rates_get(void)
{
    return &rates;
}

void rates_set(const struct rates *measured)
{
    rates = *measured;
}

static double factor(enum precision precision)
{
    return (precision == PRECISION_DOUBLE ? rates.doubled : 1) / omp_get_max_threads();
}

double rates_sums(const struct forecast *forecast, enum precision precision, double pairs, double entries)
{
    const int engine = forecast->tables, kind = forecast->kind;
    const double pair = rates.pair[engine][kind] + rates.value[engine][kind] * forecast->values;
    return START
           + factor(precision)
                 * (pairs * pair + (engine ? entries * rates.entry[kind] : 0)
                    + forecast->record_flops * rates.compress);
}

double rates_migration(enum precision precision, double flops)
{
    return START + factor(precision) * flops * rates.migrate;
}
