#include "contract/forecast_time.h"

#include <math.h>

/* Measured by `plan` on an AMD EPYC (Zen 5) with AVX-512. */
const struct rates rates_built_in = {
    .pair = {{[READ_NEAREST] = 2.4e-10, [READ_LINE] = 3e-10, [READ_TAPS] = 5.7e-10, [READ_BRANCHES] = 1.4e-10},
             {[READ_NEAREST] = 3.7e-11, [READ_LINE] = 5.8e-11, [READ_TAPS] = 7.4e-11, [READ_BRANCHES] = 3.8e-11}},
    .value = {{[READ_BRANCHES] = 5.5e-11}, {[READ_TAPS] = 2.1e-11, [READ_BRANCHES] = 2.5e-11}},
    .unit = {{[READ_NEAREST] = 5.9e-8, [READ_LINE] = 6.5e-8, [READ_TAPS] = 6.4e-8, [READ_BRANCHES] = 5e-8},
             {[READ_NEAREST] = 1.9e-9, [READ_LINE] = 4.4e-9, [READ_TAPS] = 2.7e-9, [READ_BRANCHES] = 2.1e-9}},
    .unit_value = {{[READ_BRANCHES] = 1.7e-9}, {[READ_TAPS] = 5.6e-10, [READ_BRANCHES] = 3.7e-10}},
    .apart = {[READ_NEAREST] = 4e-10, [READ_LINE] = 3.8e-10, [READ_BRANCHES] = 1.1e-9},
    .apart_value = {[READ_BRANCHES] = 3.7e-10},
    .compress = 2e-11,
    .filter = 1.5e-11,
    .image = 3.8e-10,
    .put = {1.8e-9, 9.8e-10},
    .migrate = {[MIGRATION_RECORDS] = 2.7e-11,
                [MIGRATION_SPREAD] = 1.5e-9,
                [MIGRATION_BLOCKS] = 3.7e-11,
                [MIGRATION_TERMS] = 1.3e-11,
                [MIGRATION_FOCUS] = 2.5e-9},
    .doubled = 1.9,
    .noise = 0.02,
};

/* Above eight, a number of taps that is no multiple of eight takes the invariant engine as long as so many more:
   measured, 4 to 5. */
enum { VECTOR = 8, PART = 5 };

/* In the invariant engine a pair takes longer where fewer columns lie from ping to ping, whose neighbours share loads
   of the same sample: 1 + ALONE/columns. Measured on one column and on RATES_COLUMNS. */
static const double ALONE[READ_KINDS] = {
    [READ_NEAREST] = 0.8, [READ_LINE] = 0.8, [READ_TAPS] = 0.5, [READ_BRANCHES] = 4.4};

static double alone(const struct forecast *f)
{
    const double most = RATES_COLUMNS;
    return f->tables ? (1 + ALONE[f->kind] / fmin(f->residues, most)) / (1 + ALONE[f->kind] / most) : 1;
}

/* On padded records neighbours no longer share loads, and a row's samples outgrow the caches. Nearest's sums take 1 +
   GROWTH (factor - 1)^POWER times as long; those of branches in tables, 1.2 to 1.6 with a factor of 2. Measured on
   images of 5e8 to 5e10 pairs. [general and invariant engine] */
static const double GROWTH[2] = {0.7, 0.35}, POWER[2] = {0.25, 0.72};

static double spread(const struct forecast *f)
{
    const bool grows = f->kind == READ_NEAREST || (f->kind == READ_BRANCHES && f->tables);
    return grows && f->finer > 1 ? 1 + GROWTH[f->tables] * pow(f->finer - 1, POWER[f->tables]) : 1;
}

static double factor(const struct rates *rates, enum precision precision)
{
    return precision == PRECISION_DOUBLE ? rates->doubled : 1;
}

double rates_sums(const struct rates *rates, const struct forecast *f, enum precision precision, double pairs)
{
    const int engine = f->tables, kind = f->kind;
    const int more = engine && kind == READ_TAPS && f->values > VECTOR && f->values % VECTOR > 0 ? PART : 0;
    const double pair = alone(f) * (rates->pair[engine][kind] + rates->value[engine][kind] * (f->values + more))
                        + f->apart * (rates->apart[kind] + rates->apart_value[kind] * f->values);
    const double unit = rates->unit[engine][kind] + rates->unit_value[engine][kind] * (f->values + more);
    const double records = f->record_flops * f->slowness * rates->compress + f->kernel_flops * rates->filter
                           + f->record_values * rates->put[engine];
    const double sums = spread(f) * (pairs * pair + f->units * unit) + f->image_cost * rates->image;
    return factor(rates, precision) * (sums + records);
}

double rates_migration(const struct rates *rates, const struct forecast *f, enum precision precision)
{
    double seconds = 0;
    for (int k = 0; k < MIGRATIONS; k++)
        seconds += f->migration[k] * rates->migrate[k];
    return factor(rates, precision) * seconds;
}
