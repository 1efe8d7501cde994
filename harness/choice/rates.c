#include "choice/rates.h"

#include <math.h>
#include <omp.h>

static struct rates set;
static const struct rates *rates = &rates_built_in;

const struct rates *rates_get(void)
{
    return rates;
}

void rates_set(const struct rates *measured)
{
    set = *measured;
    rates = &set;
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

double rates_run(double alone)
{
    static const double START = 1e-5; /* s: of any run, also where no pixel meets a record */
    return START + alone / omp_get_max_threads();
}
