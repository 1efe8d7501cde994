/* The terms over records and wavenumbers, and what they leave (monostatic_plan.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/cubic.h"
#include "common/fft_length.h"
#include "wavenumber/monostatic_plan.h"

enum {
    EVERY = 4, /* of the table's angles and ranges is used to find the terms */
    SAMPLES = ((MONOSTATIC_ANGLES - 1) / EVERY + 1) * ((MONOSTATIC_RANGES - 1) / EVERY + 1),
    RECORDS = 256, /* at most so many of them, spread over all, stand for them */
    ROUNDS = 40    /* of the subspace iteration */
};
static const double WIDEST = 1.4;      /* rad */
static const double EDGE_ZONES = 3;    /* of Fresnel's */
static const double NEGLIGIBLE = 1e-3; /* of the image: of which the taps leave as much */

/* Seconds by which a record is wrong in an echo from a range, `angle` off broadside. */
static double delay_left(const struct monostatic *m, int row, double range, double angle)
{
    const struct centre *centre = &m->centres[row];
    const double c = m->acquisition->sound_speed;
    const double own = 2 * range * (c - m->speed * sin(angle)) / ((c - m->speed) * (c + m->speed));
    return monostatic_pair_delay(m, centre, range, angle) - monostatic_delay(m, centre, own);
}

static double complex phasor_left(const struct monostatic *m, int row, double range, double angle, double frequency)
{
    const double phase = 2 * M_PI * frequency * delay_left(m, row, range, angle);
    return cos(phase) + I * sin(phase);
}

static double table_angle(const struct monostatic *m, double n)
{
    return m->angle_first + n * m->angle_step;
}

static double table_range(const struct monostatic *m, double n)
{
    return 1 / (m->inverse_first + n * m->inverse_step);
}

/* What an image extends over, as its track sees it. */
struct sight {
    double nearest, width; /* m: of the rows from the track; along it */
    double ends[2];        /* rad: the angles within the beam */
};

/* Energy, over the image's, of what the raster's spacing d cannot tell apart: an aperture's hard end has the spectrum
   1/(2 pi (nu - nu_end)) over that of its length, goes on beyond the raster's wavenumbers; and an echo from an angle
   makes a ghost where a pixel is seen at nu + 1/d, which may lie in the image. */
static double energy_aliased(const struct monostatic *m, const struct sight *sight)
{
    const struct acquisition *a = m->acquisition;
    const struct spectrum_setting s = monostatic_setting(m);
    const double across = 1 / fabs(m->spacing), length = sight->nearest * (tan(sight->ends[1]) - tan(sight->ends[0]));
    double energy = 0;
    for (int k = 0; k < 2; k++) {
        const double end = sight->ends[k], nu = spectrum_wavenumber(&s, end), sign = k ? -1 : 1;
        const double within = across / 2 - fabs(nu - spectrum_wavenumber(&s, m->squint));
        const double seen = -sight->nearest * tan(m->squint + 0.999 * (end - m->squint));
        const double amplitude = condition_amplitude(a, sight->nearest, seen);
        const double ghost = spectrum_angle(&s, nu + sign * across);
        const double aside = sight->nearest * fabs(tan(ghost) - tan(end));
        energy += fmin(amplitude * amplitude / (4 * M_PI * M_PI * fmax(within, 0) * length), 1);
        if (fabs(sin(ghost - m->squint)) <= a->aperture_limit && fabs(ghost) < M_PI / 2)
            energy += fmax(1 - aside / sight->width, 0);
    }
    return energy;
}

/* Relative L2 error: a record's phase that changes over the wavenumbers is a displacement along the raster, by which
   what lies 1/d beyond its wavenumber is turned by 2 pi displacement/d too much. */
static double aliased_left(const struct monostatic *m, const struct sight *sight)
{
    const struct spectrum_setting s = monostatic_setting(m);
    const double band = spectrum_wavenumber(&s, sight->ends[1]) - spectrum_wavenumber(&s, sight->ends[0]);
    double turned = 0;
    for (int row = 0; row < m->rows; row++) {
        const double change = delay_left(m, row, sight->nearest / cos(sight->ends[1]), sight->ends[1])
                              - delay_left(m, row, sight->nearest / cos(sight->ends[0]), sight->ends[0]);
        const double turn = 2 * sin(M_PI * m->acquisition->fc * change / band / m->spacing);
        turned += turn * turn / m->rows;
    }
    return turned > 0 ? sqrt(energy_aliased(m, sight) * turned) : 0;
}

/* Angles within the beam at which the track's ends see the image's corners, and its ranges. False where rows lie on the
   track, or on both sides of a crooked one. */
static bool extent(struct monostatic *m, const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    const double half = asin(fmin(condition_cut_sine(a), 0.98));
    const double last = m->first + (a->pings * a->receivers - 1) * m->spacing;
    double nearest = INFINITY, farthest = 0, low = INFINITY, high = -INFINITY, first = INFINITY, end = -INFINITY;
    bool sided[2] = {false, false};
    for (int k = 0; k < 4 * problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k / 4];
        const struct vector corner = grid_point(g, k & 1 ? g->r_count - 1 : 0, k & 2 ? g->x_count - 1 : 0);
        nearest = fmin(nearest, fabs(corner.y));
        farthest = fmax(farthest, fabs(corner.y));
        sided[corner.y < 0] = true;
        first = fmin(first, corner.x);
        end = fmax(end, corner.x);
        for (int side = 0; side < 2; side++) {
            const double angle = atan2(corner.x - (side ? last : m->first), fabs(corner.y));
            low = fmin(low, angle);
            high = fmax(high, angle);
        }
    }
    m->side = sided[1] && !sided[0] ? -1 : 1;
    low = fmax(fmax(low, m->squint - half), -WIDEST);
    high = fmin(fmin(high, m->squint + half), WIDEST);
    if (!(low < high)) /* nothing is seen within the beam */
        low = m->squint - half, high = m->squint + half;
    m->left = aliased_left(m, &(struct sight){nearest, end - first, {low, high}});
    /* An aperture's hard end is seen beyond it. */
    const double beyond = EDGE_ZONES * sqrt(a->sound_speed / a->fc / (2 * nearest));
    low = fmax(low - beyond, -WIDEST);
    high = fmin(high + beyond, WIDEST);
    m->angle_first = low;
    m->angle_step = (high - low) / (MONOSTATIC_ANGLES - 1);
    m->inverse_first = fmin(cos(low), cos(high)) / farthest;
    m->inverse_step = (1 / nearest - m->inverse_first) / (MONOSTATIC_RANGES - 1);
    return nearest > 0 && (m->straight || sided[0] != sided[1]);
}

/* The table's angle and range of a sample that the terms are found by. */
static void sample_place(const struct monostatic *m, int sample, double *range, double *angle)
{
    const int angles = (MONOSTATIC_ANGLES - 1) / EVERY + 1;
    *angle = table_angle(m, sample % angles * EVERY);
    *range = table_range(m, sample / angles * EVERY);
}

static void sampled(const struct monostatic *m, int row, double complex values[SAMPLES])
{
    for (int s = 0; s < SAMPLES; s++) {
        double range, angle;
        sample_place(m, s, &range, &angle);
        values[s] = phasor_left(m, row, range, angle, m->acquisition->fc);
    }
}

/* ---- principal vectors over the samples ---- */

static double complex product(const double complex *a, const double complex *b)
{
    double complex sum = 0;
    for (int s = 0; s < SAMPLES; s++)
        sum += conj(a[s]) * b[s];
    return sum;
}

/* Each orthogonal to those before it and of length 1, or zero. */
static void orthonormalise(int terms, double complex (*vectors)[SAMPLES])
{
    for (int q = 0; q < terms; q++) {
        const double before = creal(product(vectors[q], vectors[q]));
        for (int twice = 0; twice < 2; twice++)
            for (int p = 0; p < q; p++) {
                const double complex part = product(vectors[p], vectors[q]);
                for (int s = 0; s < SAMPLES; s++)
                    vectors[q][s] -= part * vectors[p][s];
            }
        const double norm = creal(product(vectors[q], vectors[q]));
        const double scale = norm > 1e-20 * before && norm > 0 ? 1 / sqrt(norm) : 0;
        for (int s = 0; s < SAMPLES; s++)
            vectors[q][s] *= scale;
    }
}

/* The first of the matrix's eigenvectors, by subspace iteration from waves over the samples. */
static void principal(const double complex (*matrix)[SAMPLES], int terms, double complex (*vectors)[SAMPLES])
{
    double complex next[MONOSTATIC_TERMS][SAMPLES];
    for (int q = 0; q < terms; q++)
        for (int s = 0; s < SAMPLES; s++)
            vectors[q][s] = cos(M_PI * q * (s + 0.5) / SAMPLES);
    orthonormalise(terms, vectors);
    for (int round = 0; round < ROUNDS; round++) {
        for (int q = 0; q < terms; q++)
            for (int s = 0; s < SAMPLES; s++)
                next[q][s] = product(matrix[s], vectors[q]);
        memcpy(vectors, next, (size_t)terms * sizeof *vectors);
        orthonormalise(terms, vectors);
    }
}

/* ---- the terms ---- */

struct finding {
    int step, records;                       /* every step-th row stands for all */
    double complex matrix[SAMPLES][SAMPLES]; /* mean of conj(a_s) a_t: row s is column s, conjugate */
    double complex vectors[MONOSTATIC_TERMS][SAMPLES];
};

static void matrix_fill(const struct monostatic *m, struct finding *f)
{
    double complex values[SAMPLES];
    for (int n = 0; n < f->records; n++) {
        sampled(m, n * f->step, values);
        for (int s = 0; s < SAMPLES; s++)
            for (int t = 0; t < SAMPLES; t++)
                f->matrix[s][t] += conj(values[s]) * values[t] / f->records;
    }
}

/* V of all records: along each vector, of root mean square 1. */
static void basis_fill(struct monostatic *m, const struct finding *f, int terms)
{
    double power[MONOSTATIC_TERMS] = {0};
    for (int row = 0; row < m->rows; row++) {
        double complex values[SAMPLES];
        sampled(m, row, values);
        for (int q = 0; q < terms; q++)
            m->basis[(size_t)q * (size_t)m->rows + (size_t)row] = product(f->vectors[q], values);
    }
    for (int q = 0; q < terms; q++) {
        double complex *basis = m->basis + (size_t)q * (size_t)m->rows;
        for (int n = 0; n < f->records; n++)
            power[q] += creal(basis[n * f->step] * conj(basis[n * f->step])) / f->records;
        const double scale = power[q] > 1e-16 * power[0] ? 1 / sqrt(power[q]) : 0; /* beyond: rounding */
        for (int row = 0; row < m->rows; row++)
            basis[row] *= scale;
    }
}

static void coefficients_fill(struct monostatic *m, const struct finding *f, int terms)
{
    for (int k = 0; k < MONOSTATIC_RANGES * MONOSTATIC_ANGLES; k++) {
        const double range = table_range(m, k / MONOSTATIC_ANGLES), angle = table_angle(m, k % MONOSTATIC_ANGLES);
        double complex sums[MONOSTATIC_TERMS] = {0};
        for (int n = 0; n < f->records; n++) {
            const double complex phasor = phasor_left(m, n * f->step, range, angle, m->acquisition->fc);
            for (int q = 0; q < terms; q++)
                sums[q] += phasor * conj(m->basis[(size_t)q * (size_t)m->rows + (size_t)(n * f->step)]);
        }
        for (int q = 0; q < terms; q++)
            m->coefficients[q * MONOSTATIC_RANGES * MONOSTATIC_ANGLES + k] = sums[q] / f->records;
    }
}

double complex monostatic_value(const struct monostatic *m, int term, int range, double nu)
{
    const struct spectrum_setting s = monostatic_setting(m);
    const double complex *u = m->coefficients + (term * MONOSTATIC_RANGES + range) * MONOSTATIC_ANGLES;
    double weights[4];
    u += cubic_weights((spectrum_angle(&s, nu) - m->angle_first) / m->angle_step, MONOSTATIC_ANGLES, weights);
    return weights[0] * u[0] + weights[1] * u[1] + weights[2] * u[2] + weights[3] * u[3];
}

/* Relative L2 error by the first q terms, q = 0 (a phasor of 1) to `terms`: over records, angles, ranges, and the band,
   whose frequencies see an angle at other wavenumbers. */
static void errors_left(const struct monostatic *m, const struct finding *f, int terms, double left[])
{
    const struct acquisition *a = m->acquisition;
    struct spectrum_setting at = monostatic_setting(m);
    double worst[MONOSTATIC_TERMS + 1] = {0};
    for (int range = 0; range < MONOSTATIC_RANGES; range += MONOSTATIC_RANGES / 2) {
        double sums[MONOSTATIC_TERMS + 1] = {0};
        int count = 0;
        for (int angle = 0; angle < MONOSTATIC_ANGLES; angle += EVERY)
            for (int side = -1; side <= 1; side += 2) {
                const double theta = table_angle(m, angle);
                at.fc = a->fc + side * a->bandwidth / sqrt(12);
                double complex u[MONOSTATIC_TERMS];
                for (int q = 0; q < terms; q++)
                    u[q] = monostatic_value(m, q, range, spectrum_wavenumber(&at, theta));
                for (int n = 0; n < f->records; n++, count++) {
                    const int row = n * f->step;
                    const double complex phasor = phasor_left(m, row, table_range(m, range), theta, at.fc);
                    double complex sum = 1;
                    for (int q = 0; q <= terms; q++) {
                        sums[q] += creal((phasor - sum) * conj(phasor - sum));
                        if (q < terms)
                            sum = (q > 0 ? sum : 0) + m->basis[(size_t)q * (size_t)m->rows + (size_t)row] * u[q];
                    }
                }
            }
        for (int q = 0; q <= terms; q++)
            worst[q] = condition_worse(worst[q], sqrt(sums[q] / count));
    }
    memcpy(left, worst, sizeof worst);
}

static void terms_find(struct monostatic *m, struct finding *f)
{
    const int most = MONOSTATIC_TERMS;
    double left[MONOSTATIC_TERMS + 1];
    f->step = (m->rows - 1) / RECORDS + 1;
    while (f->step > 1 && common_divisor(f->step, m->acquisition->receivers) > 1) /* it would miss receivers */
        f->step++;
    f->records = (m->rows - 1) / f->step + 1;
    matrix_fill(m, f);
    principal((const double complex(*)[SAMPLES])f->matrix, most, f->vectors);
    basis_fill(m, f, most);
    coefficients_fill(m, f, most);
    errors_left(m, f, most, left);
    double least = left[0];
    for (int q = 1; q <= most; q++)
        least = fmin(least, left[q]);
    while (m->terms < most && left[m->terms] > fmax(1.05 * least, NEGLIGIBLE))
        m->terms++;
    m->left = hypot(m->left, left[m->terms]);
}

void monostatic_terms(struct monostatic *m, const struct problem *problem)
{
    struct finding *finding = calloc(1, sizeof *finding);
    const size_t table = (size_t)MONOSTATIC_RANGES * MONOSTATIC_ANGLES;
    m->basis = store_take(&m->store, (size_t)MONOSTATIC_TERMS * (size_t)m->rows, sizeof *m->basis, 1);
    m->coefficients = store_take(&m->store, (size_t)MONOSTATIC_TERMS * table, sizeof *m->coefficients, 1);
    m->store.failed = m->store.failed || !finding;
    if (!m->store.failed && extent(m, problem))
        terms_find(m, finding);
    else
        m->left = INFINITY;
    free(finding);
}
