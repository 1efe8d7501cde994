/* Tables of a swath's map (delay_compensation.h), compiled once for each precision. */
#include <assert.h>
#include <limits.h>
#include <string.h>

#include "common/real.h"
#include "range_migration/rma_engine.h"

enum { NODES = 4, LANES = RMA_ALIGNMENT / sizeof(real) }; /* of a cubic over a run */
static const double nodes[NODES] = {0, 5, 10, 15};        /* samples */

/* The delays of a run's samples (s), beyond those of d = 0: exact at the nodes. */
static void run_delays(const struct rma *rma, const struct rma_swath *swath, int receiver, int run,
                       double delays[RMA_RUN])
{
    const double c = rma->setting.sound_speed, beta = rma->setting.speed / c;
    const double to_range = c / 2 * sqrt((1 - beta) * (1 + beta));
    double values[NODES];
    for (int k = 0; k < NODES; k++) {
        double tau = swath->t_first + (run * RMA_RUN + nodes[k]) / rma->fs;
        values[k] =
            spectrum_abeam(&rma->setting, rma->offset[receiver], fmax(tau * to_range, DELAY_NEAREST * swath->nearest));
    }
    for (int n = 0; n < RMA_RUN; n++) {
        delays[n] = 0;
        for (int k = 0; k < NODES; k++) {
            double weight = values[k];
            for (int i = 0; i < NODES; i++)
                if (i != k)
                    weight *= (n - nodes[i]) / (nodes[k] - nodes[i]);
            delays[n] += weight;
        }
    }
}

/* The taper at a cut's ends, and zero outside of it. */
static double fade(const struct rma *rma, const struct rma_swath *swath, int sample)
{
    const real *tapers = rma->tapers;
    double weight = sample >= swath->begin && sample < swath->end;
    if ((swath->begin > 0 || rma->early > 0) && sample >= swath->begin && sample - swath->begin < rma->taper)
        weight *= tapers[sample - swath->begin];
    if (swath->end < rma->samples && sample < swath->end && swath->end - 1 - sample < rma->taper)
        weight *= tapers[swath->end - 1 - sample];
    return weight;
}

static void run_fill(const struct rma *rma, const struct rma_swath *swath, int receiver, int run)
{
    const struct rma_map *map = &swath->map;
    const size_t at = (size_t)receiver * (size_t)map->runs + (size_t)run;
    const int taps = rma->delay->taps.taps, from = swath->first + run * RMA_RUN;
    double delays[RMA_RUN], weights[DELAY_TAPS], slopes[DELAY_TAPS];
    run_delays(rma, swath, receiver, run, delays);
    const double middle = (delays[RMA_RUN / 2 - 1] + delays[RMA_RUN / 2]) / 2 * rma->fs, whole = floor(middle);
    const double step = (delays[RMA_RUN - 1] - delays[0]) * rma->fs / (RMA_RUN - 1); /* samples a sample */
    const double first = from + whole + 1 - taps / 2;
    const double place = first - rma->from;
    bool inside = place >= -rma->delay->guard && place + RMA_RUN + taps <= rma->held + rma->delay->guard;
    /* The stored part of the record reaches as far as the taps, or to the record's own end. */
    assert(swath->end == swath->begin || rma->from == 0 || place >= 0);
    assert(swath->end == swath->begin || rma->from + rma->held == rma->samples || place + RMA_RUN + taps <= rma->held);
    map->first[at] = inside ? (int)place + rma->delay->guard : INT_MIN;
    delay_taps_weights(&rma->delay->taps, middle - whole, weights, slopes);
    for (int k = 0; k < taps; k++) {
        ((real *)map->weights)[at * (size_t)taps + (size_t)k] = (real)weights[k];
        ((real *)map->slopes)[at * (size_t)taps + (size_t)k] = (real)(step * slopes[k]);
    }
    complex_real *phases = (complex_real *)map->phases + at * RMA_RUN;
    for (int n = 0; n < RMA_RUN; n++) {
        double cycles = rma->setting.fc * delays[n], angle = 2 * M_PI * (cycles - floor(cycles + 0.5));
        double weight = fade(rma, swath, from + n);
        phases[n] = (real)(weight * cos(angle)) + (real)(weight * sin(angle)) * (complex_real)I;
    }
}

/* U at the edges of the row's vectors, at the arrival of the echo of range r for each angle of the table. */
static void edges_fill(const struct rma *rma, const struct rma_swath *swath)
{
    const struct delay_terms *terms = &rma->delay->terms;
    const double c = rma->setting.sound_speed, beta = rma->setting.speed / c;
    complex_real *edges = swath->map.edges;
    for (int a = 0; a < terms->angles; a++) {
        double walk = spectrum_walk(&rma->setting, delay_terms_wavenumber(terms, &rma->setting, a));
        double to_range = c / 2 * sqrt((1 - beta) * (1 + beta)) / walk;
        for (int q = 0; q < terms->terms; q++)
            for (int sample = 0; sample <= swath->row; sample += LANES) {
                double tau = swath->t_first + sample / rma->fs;
                *edges++ =
                    (complex_real)delay_terms_value(terms, a, q, fmax(tau * to_range, DELAY_NEAREST * swath->nearest));
            }
    }
}

void REAL_NAME(rma_map_plan)(struct rma *rma, struct rma_swath *swath)
{
    struct rma_map *map = &swath->map;
    map->runs = (swath->held + RMA_RUN - 1) / RMA_RUN;
    const size_t runs = (size_t)map->runs * (size_t)rma->receivers, taps = (size_t)rma->delay->taps.taps;
    map->first = store_take(&rma->store, runs, sizeof *map->first, 1);
    map->weights = store_take(&rma->store, runs * taps, sizeof(real), 1);
    map->slopes = store_take(&rma->store, runs * taps, sizeof(real), 1);
    map->phases = store_take(&rma->store, runs * RMA_RUN, sizeof(complex_real), 1);
    map->edges = store_take(&rma->store, (size_t)(rma->delay->terms.angles * rma->delay->terms.terms),
                            ((size_t)swath->row / LANES + 1) * sizeof(complex_real), 1);
    if (rma->store.failed)
        return;
    edges_fill(rma, swath);
    for (int m = 0; m < rma->receivers; m++)
        for (int run = 0; run < map->runs; run++)
            run_fill(rma, swath, m, run);
}
