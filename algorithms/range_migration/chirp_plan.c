/* Focusing by chirp transforms (rma_engine.h): the straight line that K follows over the band, the terms of what it
   leaves, and the rows that share them. */
#include <string.h>

#include "common/fft_length.h"
#include "range_migration/rma_engine.h"

/* Chebyshev: exp(j x) = J_0(X) + 2 sum over n >= 1 of j^n J_n(X) T_n(x/X) for |x| <= X. What `terms` terms leave: */
static double left(int terms, double phase)
{
    double sum = 0;
    for (int n = terms; n < terms + 8; n++)
        sum += 2 * fabs(jn(n, phase));
    return sum;
}

void chirp_phases(struct rma *rma)
{
    for (int terms = 1; rma->method.chirps && terms <= CHIRP_TERMS; terms++) {
        double low = 0, high = terms; /* J_n(x) rises up to x = n and beyond */
        for (int k = 0; k < 50; k++) {
            const double middle = (low + high) / 2;
            *(left(terms, middle) <= rma->options.limit ? &low : &high) = middle;
        }
        rma->chirp_phases[terms] = low;
    }
}

/* The sum above in powers of x/X. */
static void factors_fill(double phase, int terms, double complex *factors)
{
    double last[CHIRP_TERMS] = {0}, chebyshev[CHIRP_TERMS] = {1}; /* T_(n - 1), T_n: lowest power first */
    const double complex turns[] = {1, I, -1, -I};
    for (int n = 0; n < terms; n++) {
        double next[CHIRP_TERMS] = {0};
        for (int power = 0; power < terms; power++) {
            factors[power] =
                (n > 0 ? factors[power] : 0) + (n > 0 ? 2 : 1) * turns[n % 4] * jn(n, phase) * chebyshev[power];
            next[power] = (n > 0 ? 2 : 1) * (power > 0 ? chebyshev[power - 1] : 0) - last[power];
        }
        memcpy(last, chebyshev, sizeof last);
        memcpy(chebyshev, next, sizeof next);
    }
}

/* From a piece's first row to the one that its terms count from, m. */
static double reach_of(const struct rma_patch *patch)
{
    return patch->sums ? 0 : (patch->piece - 1) / 2.0 * patch->step;
}

/* The bins of a wavenumber, the line, and the extreme of what it leaves. False if there are none. */
static bool line_fit(const struct rma *rma, const struct rma_swath *swath, const struct rma_line *line,
                     struct chirp *chirp)
{
    enum { CHECKS = 8 };
    const double fc = rma->setting.fc, bin = rma->fs / swath->length;
    const double lowest = fmax(swath->band_first - RMA_GUARD, -(swath->length / 2)) * bin;
    const double highest = fmin(swath->band_first + swath->band - 1 + RMA_GUARD, (swath->length - 1) / 2) * bin;
    double k[CHECKS + 1];
    chirp->bin = rma->fs / swath->stolt_length;
    chirp->first = (int)fmax(ceil(fmax(lowest, line->lowest - fc) / chirp->bin), -(swath->stolt_length / 2));
    chirp->count = (int)fmin(floor(highest / chirp->bin), (swath->stolt_length - 1) / 2) - chirp->first + 1;
    if (line->begin >= swath->band || chirp->count <= 0)
        return false;
    const double way = chirp->count - 1;
    for (int n = 0; n <= CHECKS; n++)
        k[n] = spectrum_monostatic(&rma->monostatic, fc + (chirp->first + way * n / CHECKS) * chirp->bin, line->nu);
    chirp->slope = way > 0 ? (k[CHECKS] - k[0]) / way : 0;
    chirp->start = k[0] + (k[CHECKS / 2] - (k[0] + k[CHECKS]) / 2) / 2;
    chirp->extreme = 0;
    for (int n = 0; n <= CHECKS; n++)
        chirp->extreme = fmax(chirp->extreme, fabs(k[n] - chirp->start - chirp->slope * way * n / CHECKS));
    return true;
}

static int terms_of(const struct rma *rma, double phase)
{
    int terms = 1;
    while (terms < CHIRP_TERMS && phase > rma->chirp_phases[terms])
        terms++;
    return terms;
}

bool chirp_find(const struct rma *rma, const struct rma_swath *swath, const struct rma_patch *patch,
                const struct rma_line *line, struct chirp *chirp)
{
    if (!line_fit(rma, swath, line, chirp))
        return false;
    chirp->reach = reach_of(patch);
    chirp->terms = terms_of(rma, chirp->extreme * chirp->reach);
    factors_fill(chirp->extreme * chirp->reach, chirp->terms, chirp->factors);
    return true;
}

/* Bins of the widest band. */
static int bins_most(const struct rma_swath *swath)
{
    const double bins = (swath->band + 2.0 * RMA_GUARD) * swath->stolt_length / swath->length;
    return (int)fmin(ceil(bins) + 1, swath->stolt_length);
}

/* FLOPs of a wavenumber, the mean of some, and *phase, the largest that the terms approximate. */
static double line_flops(const struct rma *rma, const struct rma_swath *swath, const struct rma_patch *patch,
                         double *phase)
{
    enum { LOOKED_AT = 64 };
    const int step = swath->wavenumbers / LOOKED_AT + 1, rows = patch->grid.r_count;
    const double transform = fft_flops(patch->length), reach = reach_of(patch),
                 pieces = ceil((double)rows / patch->piece);
    double flops = 0, count = 0;
    *phase = 0;
    for (int q = 0; q < swath->wavenumbers; q += step, count++) {
        const struct rma_line line = rma_line(rma, swath, q);
        struct chirp chirp;
        if (!line_fit(rma, swath, &line, &chirp))
            continue;
        const double terms = terms_of(rma, chirp.extreme * reach), bins = chirp.count;
        *phase = fmax(*phase, chirp.extreme * reach);
        if (patch->sums)
            flops += 6 * pieces * bins + 8 * rows * bins;
        else
            flops += transform + pieces * (12 * bins + terms * (2 * transform + 2 * bins + 6.0 * patch->length))
                     + rows * (12 + 9 * terms);
    }
    return flops / count;
}

double chirp_flops(const struct rma *rma, const struct rma_swath *swath, const struct rma_patch *patch)
{
    double phase;
    return line_flops(rma, swath, patch, &phase);
}

void chirp_lay(const struct rma *rma, const struct rma_swath *swath, struct rma_patch *patch)
{
    const int rows = patch->grid.r_count;
    struct rma_patch next = *patch;
    double phase;
    next.sums = true; /* where rows are few */
    next.piece = rows < CHIRP_ROWS ? rows : CHIRP_ROWS;
    next.length = 1;
    double least = line_flops(rma, swath, &next, &phase);
    *patch = next;
    next.sums = false;
    for (int pieces = 1; pieces < rows; pieces += 1 + pieces / 8) {
        const int piece = (rows + pieces - 1) / pieces;
        if (piece == next.piece)
            continue;
        next.piece = piece;
        next.length = fft_length_quick((long long)piece + bins_most(swath));
        const double flops = line_flops(rma, swath, &next, &phase);
        if (phase > rma->chirp_phases[CHIRP_TERMS])
            continue;
        if (flops < least) {
            least = flops;
            *patch = next;
        }
        if (flops > 2 * least)
            break;
    }
}
