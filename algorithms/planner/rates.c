#include "planner/rates.h"

#include <omp.h>

/* Measured by `plan` on an Intel Xeon with AVX-512 at 2.1 GHz. */
static struct rates rates = {
    .pair = {{[READ_NEAREST] = 4.5e-10, [READ_LINE] = 5.9e-10, [READ_TAPS] = 1.1e-9, [READ_BRANCHES] = 2.4e-10},
             {[READ_NEAREST] = 8.7e-11, [READ_LINE] = 1.75e-10}},
    .value = {{[READ_BRANCHES] = 1.1e-10}, {[READ_TAPS] = 1.69e-10, [READ_BRANCHES] = 1.19e-10}},
    .unit = {{[READ_NEAREST] = 8.0e-8, [READ_LINE] = 8.1e-8, [READ_TAPS] = 1.2e-7, [READ_BRANCHES] = 9.3e-8},
             {[READ_NEAREST] = 3.1e-9, [READ_LINE] = 6.3e-9, [READ_TAPS] = 1.45e-8, [READ_BRANCHES] = 1.35e-8}},
    .compress = 4.7e-11,
    .filter = 6.3e-11,
    .put = {1.9e-9, 4.7e-9},
    .migrate = 1.48e-10,
    .doubled = 1.6,
    .noise = 0.06,
};

/* Taps that are no whole vectors of eight take the invariant engine as long as so many more: measured, 4 to 12. */
enum { PART = 8 };

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

double rates_sums(const struct forecast *f, enum precision precision, double pairs)
{
    const int engine = f->tables, kind = f->kind;
    const int more = engine && kind == READ_TAPS && f->values % 8 > 0 ? PART : 0;
    const double pair = rates.pair[engine][kind] + rates.value[engine][kind] * (f->values + more);
    const double records = f->record_flops * f->slowness * rates.compress + f->kernel_flops * rates.filter
                           + f->record_values * rates.put[engine];
    return START + factor(precision) * (pairs * pair + f->units * rates.unit[engine][kind] + records);
}

double rates_migration(enum precision precision, double flops)
{
    return START + factor(precision) * flops * rates.migrate;
}
