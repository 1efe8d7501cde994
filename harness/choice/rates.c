#include "choice/rates.h"

#include <math.h>
#include <omp.h>

/* Measured by `plan` on an AMD EPYC (Zen 5) with AVX-512. */
static struct rates rates = {
    .pair = {{[READ_NEAREST] = 2e-10, [READ_LINE] = 2.5e-10, [READ_TAPS] = 4.8e-10, [READ_BRANCHES] = 8.6e-11},
             {[READ_NEAREST] = 3.3e-11, [READ_LINE] = 5e-11, [READ_TAPS] = 6.4e-11, [READ_BRANCHES] = 4.8e-11}},
    .value = {{[READ_BRANCHES] = 4.9e-11}, {[READ_TAPS] = 1.7e-11, [READ_BRANCHES] = 1.7e-11}},
    .unit = {{[READ_NEAREST] = 5.1e-8, [READ_LINE] = 5.4e-8, [READ_TAPS] = 5.3e-8, [READ_BRANCHES] = 4.7e-8},
             {[READ_NEAREST] = 1.5e-9, [READ_LINE] = 3.7e-9, [READ_TAPS] = 1.9e-9, [READ_BRANCHES] = 1.2e-9}},
    .unit_value = {{[READ_BRANCHES] = 8.7e-10}, {[READ_TAPS] = 5.1e-10, [READ_BRANCHES] = 3.7e-10}},
    .apart = {[READ_NEAREST] = 6.7e-10, [READ_LINE] = 7.4e-10, [READ_BRANCHES] = 1.7e-9},
    .apart_value = {[READ_BRANCHES] = 5.7e-10},
    .compress = 1.6e-11,
    .filter = 1.3e-11,
    .image = 3.8e-10,
    .put = {1.2e-9, 8.3e-10},
    .migrate = {[MIGRATION_RECORDS] = 2.2e-11,
                [MIGRATION_SPREAD] = 2e-9,
                [MIGRATION_BLOCKS] = 3.1e-11,
                [MIGRATION_TERMS] = 1e-11,
                [MIGRATION_FOCUS] = 2e-9},
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

static const double START = 1e-5; /* s: of any run, also where no pixel meets a record */

const struct rates *rates_get(void)
{
    return &rates;
}

void rates_set(const struct rates *measured)
{
    rates = *measured;
}

/* s of one FLOP, value or pair, on any machine. */
static bool takes_time(double seconds)
{
    return seconds >= 1e-14 && seconds < 1e-3;
}

bool rates_plausible(const struct rates *r)
{
    const double parts[] = {r->compress, r->filter, r->put[0], r->put[1]};
    double least = INFINITY, sum = 0;
    bool good = takes_time(r->image) && r->doubled > 0.1 && r->doubled < 100 && r->noise >= 0 && r->noise < 100;
    for (int k = 0; k < 2 * READ_KINDS; k++) {
        const int engine = k / READ_KINDS, kind = k % READ_KINDS;
        const double pair = r->pair[engine][kind], value = r->value[engine][kind];
        const double unit = r->unit[engine][kind], unit_value = r->unit_value[engine][kind];
        good = good && takes_time(pair + value) && unit + unit_value < 1e-3;
        const double apart = r->apart[kind], apart_value = r->apart_value[kind];
        good = good && apart + apart_value < 1e-3;
        least = fmin(fmin(least, fmin(pair, value)), fmin(unit, unit_value)); /* either of two may be 0 */
        least = fmin(least, fmin(apart, apart_value));
    }
    for (int k = 0; k < MIGRATIONS; k++)
        good = good && takes_time(r->migrate[k]);
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
        least = fmin(least, parts[k]);
        sum += parts[k];
    }
    return good && least >= 0 && takes_time(sum);
}

static double factor(enum precision precision)
{
    return (precision == PRECISION_DOUBLE ? rates.doubled : 1) / omp_get_max_threads();
}

double rates_sums(const struct forecast *f, enum precision precision, double pairs)
{
    const int engine = f->tables, kind = f->kind;
    const int more = engine && kind == READ_TAPS && f->values > VECTOR && f->values % VECTOR > 0 ? PART : 0;
    const double pair = alone(f) * (rates.pair[engine][kind] + rates.value[engine][kind] * (f->values + more))
                        + f->apart * (rates.apart[kind] + rates.apart_value[kind] * f->values);
    const double unit = rates.unit[engine][kind] + rates.unit_value[engine][kind] * (f->values + more);
    const double records = f->record_flops * f->slowness * rates.compress + f->kernel_flops * rates.filter
                           + f->record_values * rates.put[engine];
    const double sums = spread(f) * (pairs * pair + f->units * unit) + f->image_cost * rates.image;
    return START + factor(precision) * (sums + records);
}

double rates_migration(const struct forecast *f, enum precision precision)
{
    double seconds = 0;
    for (int k = 0; k < MIGRATIONS; k++)
        seconds += f->migration[k] * rates.migrate[k];
    return START + factor(precision) * seconds;
}
