/* The terms over the receivers: principal vectors of the residual's phasors, and their coefficients
   (delay_compensation.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/cubic.h"
#include "range_migration/delay_compensation.h"

enum {
    ANGLES = 65, /* of the table; the residual is smooth: cubics between them leave 1e-6 rad */
    RANGES = 33,
    EVERY = 4,   /* of them is used to find the principal vectors */
    OFFSETS = 9, /* at which the residual is computed; a polynomial between them */
    ROUNDS = 30  /* of the subspace iteration */
};
static const double WIDEST = 1.4; /* rad */

/* Residual phases at one angle and range: at OFFSETS offsets, then interpolated to all receivers. */
struct offsets {
    int count, receivers;
    double at[OFFSETS];
    double *weights; /* [receivers][count]: Lagrange's */
};

static bool offsets_make(const struct rma_view *view, struct offsets *offsets)
{
    const struct acquisition *a = view->problem->acquisition;
    double low = INFINITY, high = -INFINITY;
    offsets->receivers = a->receivers;
    offsets->count = a->receivers < OFFSETS ? a->receivers : OFFSETS;
    offsets->weights = calloc((size_t)a->receivers * (size_t)offsets->count, sizeof *offsets->weights);
    if (!offsets->weights)
        return false;
    for (int m = 0; m < a->receivers; m++) {
        double d = a->rx[m].x - a->tx[0].x;
        low = fmin(low, d);
        high = fmax(high, d);
        if (a->receivers <= OFFSETS) {
            offsets->at[m] = d;
            offsets->weights[m * offsets->count + m] = 1;
        }
    }
    if (a->receivers <= OFFSETS)
        return true;
    if (!(high > low)) {
        offsets->count = 1;
        high = low + 1;
    }
    for (int k = 0; k < offsets->count; k++)
        offsets->at[k] =
            offsets->count > 1 ? (low + high) / 2 - (high - low) / 2 * cos(M_PI * (k + 0.5) / offsets->count) : low;
    for (int m = 0; m < a->receivers; m++)
        for (int k = 0; k < offsets->count; k++) {
            double *weight = &offsets->weights[m * offsets->count + k];
            *weight = 1;
            for (int n = 0; n < offsets->count; n++)
                if (n != k)
                    *weight *= (a->rx[m].x - a->tx[0].x - offsets->at[n]) / (offsets->at[k] - offsets->at[n]);
        }
    return true;
}

/* exp(j rho) of all receivers. */
static void phasors(const struct rma_view *view, const struct offsets *offsets, double r, double nu,
                    double complex *values)
{
    double phase[OFFSETS];
    for (int k = 0; k < offsets->count; k++) {
        phase[k] = spectrum_residual(&view->setting, offsets->at[k], r, nu);
        if (isnan(phase[k]))
            phase[k] = 0; /* no echo comes from there */
    }
    for (int m = 0; m < offsets->receivers; m++) {
        double sum = 0;
        for (int k = 0; k < offsets->count; k++)
            sum += offsets->weights[m * offsets->count + k] * phase[k];
        values[m] = cos(sum) + I * sin(sum);
    }
}

/* Rows, and the angles that are focused: rma_line leaves out others. */
static void extent(const struct rma_view *view, struct delay_terms *terms)
{
    const struct problem *problem = view->problem;
    const struct acquisition *a = problem->acquisition;
    double nearest = INFINITY, farthest = 0;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        nearest = fmin(nearest, g->r_first);
        farthest = fmax(farthest, g->r_first + (g->r_count - 1) * g->r_step);
    }
    double reach = rma_reach(a, &view->bounds, nearest) + view->bounds.aside;
    double widest = fmin(atan(reach / nearest) * 1.05, WIDEST), full = a->receivers / (2 * view->spacing);
    double from = fmax(-widest, spectrum_angle(&view->setting, -full)),
           to = fmin(widest, spectrum_angle(&view->setting, full));
    terms->angle_first = from;
    terms->angle_step = (to - from) / (ANGLES - 1);
    /* The echo of a row at the widest angle arrives like that of a farther row at broadside. */
    double walk = fmax(spectrum_walk(&view->setting, spectrum_wavenumber(&view->setting, from)),
                       spectrum_walk(&view->setting, spectrum_wavenumber(&view->setting, to)));
    terms->inverse_first = 1 / (1.05 * farthest * walk);
    terms->inverse_step = (1 / (0.9 * nearest) - terms->inverse_first) / (RANGES - 1);
}

static double table_range(const struct delay_terms *terms, int n)
{
    return 1 / (terms->inverse_first + n * terms->inverse_step);
}

/* ---- principal vectors ---- */

/* Each orthogonal to those before it, and of length 1, or zero. */
static void orthonormalise(double *basis, int terms, int receivers)
{
    for (int q = 0; q < terms; q++) {
        double *v = basis + (size_t)q * (size_t)receivers, before = 0, norm = 0;
        for (int m = 0; m < receivers; m++)
            before += v[m] * v[m];
        for (int twice = 0; twice < 2; twice++)
            for (int p = 0; p < q; p++) {
                const double *u = basis + (size_t)p * (size_t)receivers;
                double product = 0;
                for (int m = 0; m < receivers; m++)
                    product += u[m] * v[m];
                for (int m = 0; m < receivers; m++)
                    v[m] -= product * u[m];
            }
        for (int m = 0; m < receivers; m++)
            norm += v[m] * v[m];
        double scale = norm > 1e-20 * before ? 1 / sqrt(norm) : 0;
        for (int m = 0; m < receivers; m++)
            v[m] *= scale;
    }
}

/* The part of a sample along each vector. */
static void project(const struct delay_terms *terms, const double complex *sample, double complex *parts)
{
    for (int q = 0; q < terms->terms; q++) {
        const double *v = terms->basis + (size_t)q * (size_t)terms->receivers;
        double re = 0, im = 0;
        for (int m = 0; m < terms->receivers; m++) {
            re += v[m] * creal(sample[m]);
            im += v[m] * cimag(sample[m]);
        }
        parts[q] = re + I * im;
    }
}

/* Subspace iteration with Re(sum of a a^H), from powers of the offset. */
static void principal(struct delay_terms *terms, const double complex *samples, int count, double *next)
{
    const size_t receivers = (size_t)terms->receivers, size = (size_t)terms->terms * receivers;
    double complex parts[DELAY_TERMS];
    orthonormalise(terms->basis, terms->terms, terms->receivers);
    for (int round = 0; round < ROUNDS; round++) {
        memset(next, 0, size * sizeof *next);
        for (int s = 0; s < count; s++) {
            const double complex *a = samples + (size_t)s * receivers;
            project(terms, a, parts);
            for (int q = 0; q < terms->terms; q++)
                for (size_t m = 0; m < receivers; m++)
                    next[(size_t)q * receivers + m] += creal(a[m]) * creal(parts[q]) + cimag(a[m]) * cimag(parts[q]);
        }
        memcpy(terms->basis, next, size * sizeof *next);
        orthonormalise(terms->basis, terms->terms, terms->receivers);
    }
    double kept = 0;
    for (int s = 0; s < count; s++) {
        project(terms, samples + (size_t)s * receivers, parts);
        for (int q = 0; q < terms->terms; q++)
            kept += creal(parts[q] * conj(parts[q]));
    }
    terms->left = sqrt(fmax(1 - kept / ((double)count * (double)receivers), 0));
}

static bool basis_make(const struct rma_view *view, const struct offsets *offsets, struct delay_terms *terms)
{
    const size_t receivers = (size_t)terms->receivers;
    const int most = (ANGLES / EVERY + 1) * (RANGES / EVERY + 1);
    double complex *samples = malloc((size_t)most * receivers * sizeof *samples);
    double *next = malloc((size_t)terms->terms * receivers * sizeof *next);
    int count = 0;
    for (int pass = 0; samples && next && count == 0 && pass < 2; pass++) /* all angles where none is in the beam */
        for (int a = 0; a < ANGLES; a += EVERY) {
            double angle = terms->angle_first + a * terms->angle_step;
            if (pass == 0 && fabs(sin(angle)) > view->beam_sine)
                continue;
            for (int n = 0; n < RANGES; n += EVERY, count++)
                phasors(view, offsets, table_range(terms, n), spectrum_wavenumber(&view->setting, angle),
                        samples + (size_t)count * receivers);
        }
    if (count > 0) {
        const struct acquisition *a = view->problem->acquisition;
        const double most_offset = view->bounds.aside;
        for (size_t m = 0; m < receivers; m++)
            for (int q = 0; q < terms->terms; q++) {
                double d = most_offset > 0 ? (a->rx[m].x - a->tx[0].x) / most_offset : 0;
                terms->basis[(size_t)q * receivers + m] = q == 0 ? 1 : q == 1 ? d * d : d;
            }
        principal(terms, samples, count, next);
    }
    free(samples);
    free(next);
    return count > 0;
}

/* Extent and basis. False without memory; free offsets->weights and the terms in any case. */
static bool terms_begin(const struct rma_view *view, int count, struct delay_terms *terms, struct offsets *offsets)
{
    const int receivers = view->problem->acquisition->receivers;
    *offsets = (struct offsets){0};
    *terms = (struct delay_terms){
        .terms = count < receivers ? count : receivers, .receivers = receivers, .angles = ANGLES, .ranges = RANGES};
    extent(view, terms);
    terms->basis = calloc((size_t)terms->terms * (size_t)receivers, sizeof *terms->basis);
    return terms->basis && offsets_make(view, offsets) && basis_make(view, offsets, terms);
}

double delay_terms_left(const struct rma_view *view, int count)
{
    struct offsets offsets;
    struct delay_terms terms;
    const double left = terms_begin(view, count, &terms, &offsets) ? terms.left : NAN;
    free(offsets.weights);
    delay_terms_free(&terms);
    return left;
}

bool delay_terms_make(const struct rma_view *view, int count, struct delay_terms *terms)
{
    struct offsets offsets;
    bool made = terms_begin(view, count, terms, &offsets);
    const size_t receivers = (size_t)terms->receivers, all = (size_t)terms->terms;
    double complex *sample = malloc(receivers * sizeof *sample);
    terms->coefficients = calloc(ANGLES * all * RANGES, sizeof *terms->coefficients);
    terms->bytes =
        (double)(all * receivers * sizeof *terms->basis + ANGLES * all * RANGES * sizeof *terms->coefficients);
    made = made && terms->coefficients && sample;
    for (int a = 0; made && a < ANGLES; a++)
        for (int n = 0; n < RANGES; n++) {
            double complex parts[DELAY_TERMS];
            phasors(view, &offsets, table_range(terms, n),
                    spectrum_wavenumber(&view->setting, terms->angle_first + a * terms->angle_step), sample);
            project(terms, sample, parts);
            for (size_t q = 0; q < all; q++)
                terms->coefficients[((size_t)a * all + q) * RANGES + (size_t)n] = parts[q];
        }
    free(sample);
    free(offsets.weights);
    return made;
}

void delay_terms_free(struct delay_terms *terms)
{
    free(terms->basis);
    free(terms->coefficients);
    *terms = (struct delay_terms){0};
}

/* ---- the table ---- */

int delay_terms_place(const struct delay_terms *terms, const struct spectrum_setting *setting, double nu,
                      double weights[4])
{
    double place = terms->angle_step > 0 ? (spectrum_angle(setting, nu) - terms->angle_first) / terms->angle_step : 0;
    return cubic_weights(place, terms->angles, weights);
}

double delay_terms_wavenumber(const struct delay_terms *terms, const struct spectrum_setting *setting, int angle)
{
    return spectrum_wavenumber(setting, terms->angle_first + angle * terms->angle_step);
}

double complex delay_terms_value(const struct delay_terms *terms, int angle, int q, double r)
{
    double weights[4];
    const double complex *from =
        terms->coefficients + ((size_t)angle * (size_t)terms->terms + (size_t)q) * (size_t)terms->ranges
        + cubic_weights((1 / r - terms->inverse_first) / terms->inverse_step, terms->ranges, weights);
    return weights[0] * from[0] + weights[1] * from[1] + weights[2] * from[2] + weights[3] * from[3];
}
