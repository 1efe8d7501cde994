/* The range blocks of the conversion (rma_engine.h): their number, their places, and those that a swath needs. */
#include <math.h>

#include "range_migration/rma_engine.h"

static const double EVEN = 1e-10;       /* cycles: from block to block */
static const double WIDEST_SINE = 0.95; /* of the aperture where neither sampling nor element length bounds it */

static double block_place(const struct rma *rma, double r)
{
    return ((rma->options.spacing == RMA_INVERSE ? 1 / r : r) - rma->block_from) / rma->block_width;
}

/* Centres of blocks that blend reach from the first row to the last, so that no row lies outside them; of other blocks,
   the edges do. */
static void blocks_place(struct rma *rma, int count)
{
    bool inverse = rma->options.spacing == RMA_INVERSE, blend = rma->options.blend && count > 1;
    double from = inverse ? 1 / rma->nearest : rma->nearest, to = inverse ? 1 / rma->farthest : rma->farthest;
    rma->block_count = count;
    rma->block_width = (to - from) / (blend ? count - 1 : count);
    rma->block_from = from + (blend ? 0 : rma->block_width / 2);
    if (from == to)
        rma->block_width = from; /* of a single row: any value but 0, as places are divided by it */
}

/* The widest wavenumber of the beam and the sampling, cycles/m. */
static double widest_wavenumber(const struct rma *rma)
{
    const struct acquisition *a = rma->problem.acquisition;
    double nu = rma->receivers / (2 * fabs(rma->spacing));
    double beta = fabs(rma->setting.speed) / a->sound_speed;
    nu = fmin(nu, 2 * WIDEST_SINE * (a->fc - a->bandwidth / 2) / a->sound_speed / (1 + beta));
    if (a->tx_length > 0)
        nu = fmin(nu, fmax(1 / a->tx_length,
                           a->echo_tapers ? 0 : 2 * (a->fc + a->bandwidth / 2) / a->sound_speed * a->echo_sine));
    return nu;
}

/* Is the error at the blocks' ends, by conversion at their centres, below the limit (LBF21 Eq. (13))? */
static bool blocks_suffice(struct rma *rma, int count)
{
    blocks_place(rma, count);
    const struct acquisition *a = rma->problem.acquisition;
    const double nu = widest_wavenumber(rma);
    for (int n = 0; n < count; n++)
        for (int end = -1; end <= 1; end += 2) {
            double edge = rma->block_from + (n + end * 0.5) * rma->block_width;
            double r0 = rma_block_range(rma, n), r1 = edge;
            if (rma->options.spacing == RMA_INVERSE)
                r1 = edge > 0 ? 1 / edge : rma->farthest;
            r1 = fmin(fmax(r1, rma->nearest), rma->farthest);
            for (int k = 0; k < 18; k++) { /* 2 receivers, 3 frequencies, 3 wavenumbers */
                double frequency = a->fc + (k / 2 % 3 - 1) * a->bandwidth / 2, at = (k / 6 - 1) * nu;
                double error = rma_correction(rma, rma->extremes[k % 2], r1, frequency, at)
                               - rma_correction(rma, rma->extremes[k % 2], r0, frequency, at);
                if (!(2 * M_PI * fabs(error) <= rma->options.limit))
                    return false;
            }
        }
    return true;
}

/* A single block has none to blend with: root mean square phase error over the beam, at the farther end, by conversion
   at its centre. */
static double lone_block_error(struct rma *rma)
{
    enum { PLACES = 16, FREQUENCIES = 3 };
    const struct acquisition *a = rma->problem.acquisition;
    blocks_place(rma, 1);
    double worst = 0, r0 = rma_block_range(rma, 0),
           reach = rma_reach(rma->problem.acquisition, &rma->bounds, rma->nearest);
    for (int end = 0; end < 2; end++) {
        double sum = 0, r = end ? rma->farthest : rma->nearest;
        for (int m = 0; m < 2; m++)
            for (int k = 0; k < PLACES * FREQUENCIES; k++) {
                double u = (2 * (k / FREQUENCIES + 0.5) / PLACES - 1) * reach;
                double frequency = a->fc + (k % FREQUENCIES - 1) * a->bandwidth / 2;
                double nu = -frequency * spectrum_slope(&rma->setting, rma->offset[rma->extremes[m]], r, u);
                double error = rma_correction(rma, rma->extremes[m], r, frequency, nu)
                               - rma_correction(rma, rma->extremes[m], r0, frequency, nu);
                sum += isnan(error) ? 0 : 4 * M_PI * M_PI * error * error;
            }
        worst = fmax(worst, sqrt(sum / (2 * PLACES * FREQUENCIES)));
    }
    return worst;
}

enum status rma_blocks_lay(struct rma *rma)
{
    int count = rma->options.blocks;
    if (!(rma->farthest > rma->nearest) || !rma->converts)
        count = 1;
    if (count == 0) {
        int too_few = 0;
        for (count = 1; !blocks_suffice(rma, count); count *= 2) {
            too_few = count;
            if (count >= 4096)
                return status_set(STATUS_UNSUPPORTED,
                                  "%s: 4096 range blocks leave a phase error above limit = %g "
                                  "rad",
                                  rma->method.name, rma->options.limit);
        }
        while (count - too_few > 1) {
            int middle = (count + too_few) / 2;
            *(blocks_suffice(rma, middle) ? &count : &too_few) = middle;
        }
        if (count == 1 && !(lone_block_error(rma) <= rma->options.limit / (4 * M_PI)))
            count = RMA_NODES;
    }
    blocks_place(rma, count);
    return STATUS_OK;
}

/* The first of the blocks that make up the rows at a place. */
static int block_first(const struct rma *rma, double place)
{
    double last = rma->block_count - 1;
    if (!rma->options.blend)
        return (int)fmin(fmax(floor(place + 0.5), 0), last);
    return (int)fmin(fmax(floor(place) - 1, 0), rma->block_count - rma_nodes_blended(rma));
}

/* LBF's corrections are linear in 1/r, but for a part that all receivers share. */
static bool blocks_even(const struct rma *rma, const struct rma_swath *swath)
{
    const struct acquisition *a = rma->problem.acquisition;
    const double nu = widest_wavenumber(rma);
    for (int k = 0; k < 18; k++) { /* 2 receivers, 3 frequencies, 3 wavenumbers */
        const double frequency = a->fc + (k / 2 % 3 - 1) * a->bandwidth / 2, at = (k / 6 - 1) * nu;
        double first = 0, each = 0;
        for (int n = 0; n < swath->needed; n++) {
            const double r = rma_block_range(rma, swath->blocks[n]);
            const double own =
                rma_correction(rma, rma->extremes[k % 2], r, frequency, at) - rma_correction(rma, 0, r, frequency, at);
            first = n == 0 ? own : first;
            each = n == 1 ? own - first : each;
            if (swath->blocks[n] != swath->blocks[0] + n || !(fabs(own - first - n * each) <= EVEN))
                return false;
        }
    }
    return true;
}

/* The blocks that make up a swath's rows. */
void rma_blocks_choose(const struct rma *rma, struct rma_swath *swath, int *list)
{
    const int nodes = rma->options.blend ? rma_nodes_blended(rma) : 1;
    swath->blocks = list;
    for (int n = 0; n < rma->block_count; n++) {
        bool wanted = rma->block_count == 1;
        for (int k = 0; k < swath->patch_count && !wanted; k++) {
            const struct grid *g = &swath->patches[k].grid;
            int begin = block_first(rma, block_place(rma, g->r_first)),
                end = block_first(rma, block_place(rma, rma_last_row(g)));
            wanted = n >= (begin < end ? begin : end) && n < (begin < end ? end : begin) + nodes;
        }
        if (wanted)
            list[swath->needed++] = n;
    }
    swath->reference = swath->needed / 2;
    swath->even = rma->recurs && swath->needed > 2 && blocks_even(rma, swath);
}
