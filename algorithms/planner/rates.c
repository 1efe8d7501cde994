#include "planner/rates.h"

#include <omp.h>

/* Measured by `plan` on an Intel Xeon with AVX-512 at 2.1 GHz. */
static struct rates rates = {
    .pair = {{[READ_NEAREST] = 4.1e-10, [READ_LINE] = 5.2e-10, [READ_TAPS] = 8.6e-10, [READ_BRANCHES] = 4.5e-10},
             {[READ_NEAREST] = 3.5e-11, [READ_LINE] = 6e-11, [READ_TAPS] = 1.8e-10, [READ_BRANCHES] = 1.6e-10}},
    .value = {{[READ_BRANCHES] = 5.5e-11}, {[READ_TAPS] = 2.4e-11, [READ_BRANCHES] = 5e-11}},
    .unit = {{[READ_NEAREST] = 8.6e-8, [READ_LINE] = 9.3e-8, [READ_TAPS] = 1.2e-7, [READ_BRANCHES] = 7.6e-8},
             {[READ_NEAREST] = 2.6e-9, [READ_LINE] = 6.3e-9, [READ_TAPS] = 2.9e-9, [READ_BRANCHES] = 1.6e-9}},
    .unit_value = {{[READ_BRANCHES] = 5.5e-9}, {[READ_TAPS] = 1.0e-9, [READ_BRANCHES] = 7.7e-10}},
    .compress = 2.3e-11,
    .filter = 2.3e-11,
    .image = 1.8e-9,
    .put = {2.1e-9, 1.6e-9},
    .migrate = {[MIGRATION_RECORDS] = 8.6e-11,
                [MIGRATION_SPREAD] = 2.1e-9,
                [MIGRATION_BLOCKS] = 4.0e-11,
                [MIGRATION_TERMS] = 2.1e-11,
                [MIGRATION_FOCUS] = 1.02e-8},
    .doubled = 1.7,
    .noise = 0.06,
};

/* Taps beyond eight that are no whole vectors of eight take the invariant engine as long as so many more: measured,
   4 to 5. */
enum { VECTOR = 8, PART = 5 };

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
    const int more = engine && kind == READ_TAPS && f->values > VECTOR && f->values % VECTOR > 0 ? PART : 0;
    const double pair = rates.pair[engine][kind] + rates.value[engine][kind] * (f->values + more);
    const double unit = rates.unit[engine][kind] + rates.unit_value[engine][kind] * (f->values + more);
    const double records = f->record_flops * f->slowness * rates.compress + f->kernel_flops * rates.filter
                           + f->record_values * rates.put[engine];
    const double sums = f->image_cost > 0 ? f->image_cost * rates.image : pairs * pair + f->units * unit;
    return START + factor(precision) * (sums + records);
}

double rates_migration(const struct forecast *f, enum precision precision)
{
    double seconds = 0;
    for (int k = 0; k < MIGRATIONS; k++)
        seconds += f->migration[k] * rates.migrate[k];
    return START + factor(precision) * seconds;
}
