/* The phases that convert multi-receiver spectra into monostatic ones: for each receiver, range and wavenumber a
   polynomial in frequency, fitted to the method's formula at Chebyshev's nodes. */
#include <string.h>

#include "range_migration/rma_engine.h"

static const double GRAZING = 1.005;    /* cells this near to evanescence (cos theta < 0.1) are left out too */
static const double SAME_CURVE = 1e-10; /* cycles: rounding, not another curvature */

double rma_frequency(const struct rma *rma, const struct rma_swath *swath, int bin)
{
    return rma->setting.fc + (swath->band_first + bin) * rma->fs / swath->length;
}

double rma_offset(const struct rma *rma, double nu)
{
    const struct spectrum_setting *s = &rma->setting;
    const double sine = s->sound_speed * nu / (2 * s->fc);
    return rma->turns_rows ? -s->speed * nu / (s->sound_speed * sqrt((1 - sine) * (1 + sine))) : 0;
}

/* rma_correction with the K of that frequency and wavenumber, which all receivers share. */
static double correction(const struct rma *rma, int receiver, double r, double frequency, double nu, double k)
{
    double phase = rma->method.spectrum(&rma->setting, rma->offset[receiver], r, frequency, nu);
    return -(phase + r * k) / (2 * M_PI) - r * rma_offset(rma, nu);
}

double rma_correction(const struct rma *rma, int receiver, double r, double frequency, double nu)
{
    return correction(rma, receiver, r, frequency, nu, spectrum_monostatic(&rma->monostatic, frequency, nu));
}

struct rma_line rma_line(const struct rma *rma, const struct rma_swath *swath, int q)
{
    const struct spectrum_setting *s = &rma->setting;
    double c = s->sound_speed, beta = s->speed / c, b1 = (1 - beta) * (1 + beta);
    double period_m = swath->period * fabs(rma->spacing);
    struct rma_line line = {.nu = (q - swath->wavenumbers / 2) / period_m, .begin = swath->band};
    /* The end of the exact spectrum; the formulas ignore the speed there, and end at a sine of 1 as well. */
    double edge = line.nu > 0 ? 1 + beta : 1 - beta;
    if (rma->method.spectrum != spectrum_exact)
        edge = fmax(edge, 1);
    line.lowest = fmax(GRAZING * edge * c * fabs(line.nu) / 2, 0.01 * s->fc);
    double first = rma_frequency(rma, swath, 0), last = rma_frequency(rma, swath, swath->band - 1);
    if (!(line.lowest < s->fc && line.lowest < last))
        return line; /* `printed` takes theta at fc, which must exist */
    line.begin = (int)fmax(0, ceil((line.lowest - first) / (rma->fs / swath->length)));
    line.middle = (fmax(first, line.lowest) + last) / 2;
    line.half = fmax(last - line.middle, rma->fs / swath->length);
    double f = line.middle / b1, along = c * line.nu / 2 + f * beta, s2 = (f - along) * (f + along);
    line.slowness = spectrum_slowness(&rma->monostatic, line.middle, line.nu);
    /* Seen by no ping, from no column: its echoes would only fold onto those that are. A pair's wavenumber is that of
       its middle. */
    if (swath->nearest * fabs(along) / sqrt(s2) > rma_focused(rma->problem.acquisition, &rma->bounds, swath->nearest))
        line.begin = swath->band;
    return line;
}

double rma_block_range(const struct rma *rma, int block)
{
    double centre = rma->block_from + block * rma->block_width;
    return rma->options.spacing == RMA_INVERSE ? 1 / centre : centre;
}

static void powers_fill(const struct rma *rma, const double *values, double *polynomial)
{
    for (int power = 0; power <= FIT_DEGREE; power++) {
        polynomial[power] = 0;
        for (int n = 0; n <= FIT_DEGREE; n++)
            polynomial[power] += rma->fit.powers[power][n] * values[n];
    }
}

void rma_polynomial(const struct rma *rma, const struct rma_line *line, int receiver, double r, double *polynomial)
{
    double values[FIT_DEGREE + 1];
    for (int n = 0; n <= FIT_DEGREE; n++)
        values[n] = rma_correction(rma, receiver, r, line->middle + line->half * rma->fit.nodes[n], line->nu);
    powers_fill(rma, values, polynomial);
}

/* The quadratic through the first, the middle and the last receiver of a group, at each node in frequency. The
   formulas of LBF and PCA are quadratic in d; the exact one differs by less than 1e-6 rad over a group. */
void rma_ramps(const struct rma *rma, const struct rma_line *line, double r, double less, struct rma_ramp *ramps)
{
    double frequencies[FIT_DEGREE + 1], k_of[FIT_DEGREE + 1];
    for (int n = 0; n <= FIT_DEGREE; n++) {
        frequencies[n] = line->middle + line->half * rma->fit.nodes[n];
        k_of[n] = spectrum_monostatic(&rma->monostatic, frequencies[n], line->nu);
    }
    for (int begin = 0; begin < rma->receivers; begin += RMA_GROUP, ramps++) {
        int count = rma->receivers - begin < RMA_GROUP ? rma->receivers - begin : RMA_GROUP;
        double values[3][FIT_DEGREE + 1];
        for (int n = 0; n <= FIT_DEGREE; n++) {
            double at[3] = {0, 0, 0};
            int end = count - 1, middle = end / 2, points[3] = {0, end, middle};
            for (int k = 0; k < count && k < 3; k++) {
                at[k] = correction(rma, begin + points[k], r, frequencies[n], line->nu, k_of[n]);
                if (less > 0)
                    at[k] -= correction(rma, begin + points[k], less, frequencies[n], line->nu, k_of[n]);
            }
            double slope = count > 1 ? (at[1] - at[0]) / end : 0;
            double bend = count > 2 ? (slope - (at[2] - at[0]) / middle) / (end - middle) : 0;
            values[0][n] = at[0];
            values[1][n] = slope - bend * (end - 1); /* D(1) - D(0) of a i + bend i^2, a = slope - bend end */
            values[2][n] = 2 * bend;
        }
        double *const polynomials[3] = {ramps->first, ramps->step, ramps->curve};
        bool same = begin > 0;
        ramps->begin = begin;
        ramps->count = count;
        for (int k = 0; k < 3; k++)
            powers_fill(rma, values[k], polynomials[k]);
        for (int power = 0; power <= FIT_DEGREE; power++)
            same = same && fabs(ramps->curve[power] - ramps[-1].curve[power]) < SAME_CURVE;
        if (same || count < 3) /* one or two receivers have no curvature of their own */
            memcpy(ramps->curve, begin > 0 ? ramps[-1].curve : ramps->curve, sizeof ramps->curve);
    }
}
