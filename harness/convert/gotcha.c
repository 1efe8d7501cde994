/* AFRL Gotcha phase history: a struct `data` of one pass of a monostatic radar.

   fp(k, p) = sum_targets a exp(-j 4 pi f_k (R - r0_p)/c), R the target's distance: each pulse is referred to the delay
   of the scene's centre, 2 r0/c. A phase ramp moves that reference to the middle of a record that is one period 1/df
   long. Steps of df are even, or no transform leads to time. */
#include <math.h>
#include <stdlib.h>

#include "convert/band.h"
#include "convert/layout.h"
#include "common/fft_length.h"
#include "echoes/matfile.h"

#define LIGHT_SPEED 299792458.0 /* m/s */
/* Of a step: a frequency that is off by so much turns the record's ends by 3e-3 rad. Frequencies of class single are
   off by less. */
#define UNEVEN_MOST 1e-3

enum { FP, FREQ, X, Y, Z, R0, FIELDS };

static const struct wanted fields[FIELDS] = {
    [FP] = {"data/fp", KIND_COMPLEX, false, "a complex array [K x P] (frequencies x pulses, K >= 2)"},
    [FREQ] = {"data/freq", KIND_REAL, false, "a real vector of K frequencies in Hz"},
    [X] = {"data/x", KIND_REAL, false, "a real vector of P places in m"},
    [Y] = {"data/y", KIND_REAL, false, "a real vector of P places in m"},
    [Z] = {"data/z", KIND_REAL, false, "a real vector of P places in m"},
    [R0] = {"data/r0", KIND_REAL, false, "a real vector of P ranges > 0 to the centre in m"},
};

/* The frequencies of the first file, which all others must have. */
struct steps {
    int count;
    double first_hz, step_hz;
};

static enum status shapes_check(const char *path, const struct variable *v)
{
    const size_t *fp = v[FP].dims;
    if (fp[0] < 2 || fp[0] > INT_MAX / 4 || fp[1] > INT_MAX || !variable_has_shape(&v[FP], fp[0], fp[1], 1))
        return field_refuse(path, &fields[FP], &v[FP], "which is no phase history");
    for (int k = FREQ; k < FIELDS; k++)
        if (!variable_is_vector(&v[k]) || variable_count(&v[k]) != fp[k == FREQ ? 0 : 1]) {
            char why[80];
            snprintf(why, sizeof why, "data/fp [%zu x %zu]", fp[0], fp[1]);
            return field_refuse(path, &fields[k], &v[k], why);
        }
    return STATUS_OK;
}

/* The line through both ends, and whether all lie on it. */
static enum status steps_find(const char *path, const struct variable *freq, struct steps *steps)
{
    const size_t count = variable_count(freq);
    const double first = field_number(freq, 0), step = (field_number(freq, count - 1) - first) / (double)(count - 1);
    *steps = (struct steps){(int)count, first, step};
    if (!(first > 0) || !(step > 0))
        return status_set(STATUS_INVALID,
                          "%s: variable `%s` runs from %.10g to %.10g Hz; rising frequencies above 0 "
                          "are needed",
                          path, fields[FREQ].name, first, field_number(freq, count - 1));
    for (size_t k = 0; k < count; k++) {
        const double off = (field_number(freq, k) - first) / step - (double)k;
        if (!(fabs(off) <= UNEVEN_MOST))
            return status_set(STATUS_INVALID,
                              "%s: variable `%s` at place %zu is %.10g Hz, %.3g steps of %.10g Hz off; "
                              "even steps are needed, to %g of one",
                              path, fields[FREQ].name, k + 1, field_number(freq, k), off, step, UNEVEN_MOST);
    }
    return STATUS_OK;
}

static enum status steps_agree(const char *path, const char *first_path, const struct steps *a, const struct steps *b)
{
    const double last = b->count - 1, off = (b->first_hz - a->first_hz) / a->step_hz;
    if (a->count == b->count && fabs(off) <= UNEVEN_MOST
        && fabs(off + last * (b->step_hz / a->step_hz - 1)) <= UNEVEN_MOST)
        return STATUS_OK;
    return status_set(STATUS_INVALID,
                      "%s: variable `%s` has %d frequencies from %.10g Hz by %.10g Hz, %s %d from "
                      "%.10g Hz by %.10g Hz; the same are needed",
                      path, fields[FREQ].name, b->count, b->first_hz, b->step_hz, first_path, a->count, a->first_hz,
                      a->step_hz);
}

static enum status places_check(const char *path, const struct variable *v, const struct steps *steps)
{
    const double wavelength = LIGHT_SPEED / (steps->first_hz + steps->count / 2 * steps->step_hz);
    enum status status = STATUS_OK;
    for (int k = X; k < FIELDS && status == STATUS_OK; k++)
        status = positions_check(path, fields[k].name, &v[k], wavelength);
    for (size_t p = 0; p < variable_count(&v[R0]) && status == STATUS_OK; p++)
        if (!(field_number(&v[R0], p) > 0))
            status = status_set(STATUS_INVALID, "%s: variable `%s` at place %zu is %g m; %s is needed", path,
                                fields[R0].name, p + 1, field_number(&v[R0], p), fields[R0].accepted);
    return status;
}

/* Read one file, with or without its phase history. */
static enum status file_read(const char *path, bool whole, struct variable *v, struct steps *steps)
{
    static const struct pings none = {0};
    struct wanted wanted[FIELDS];
    for (int k = 0; k < FIELDS; k++)
        wanted[k] = fields[k];
    wanted[FP].pings = whole ? NULL : &none;
    enum status status = fields_read(path, wanted, FIELDS, v);
    if (status != STATUS_OK)
        return status;
    status = shapes_check(path, v);
    if (status == STATUS_OK)
        status = steps_find(path, &v[FREQ], steps);
    if (status == STATUS_OK)
        status = places_check(path, v, steps);
    if (status != STATUS_OK)
        variables_free(v, FIELDS);
    return status;
}

/* The number of pulses of all files, and the frequencies that they share. */
static enum status files_survey(const char *const *paths, int count, struct steps *steps, int *pulses)
{
    size_t sum = 0;
    for (int k = 0; k < count; k++) {
        struct variable v[FIELDS];
        struct steps own;
        enum status status = file_read(paths[k], false, v, &own);
        if (status != STATUS_OK)
            return status;
        variables_free(v, FIELDS);
        if (k == 0)
            *steps = own;
        status = steps_agree(paths[k], paths[0], steps, &own);
        sum += v[FP].dims[1];
        if (status == STATUS_OK && sum > INT_MAX)
            status = status_set(STATUS_INVALID, "%s: %zu pulses with those before; at most %d are accepted", paths[k],
                                sum, INT_MAX);
        if (status != STATUS_OK)
            return status;
    }
    *pulses = (int)sum;
    return STATUS_OK;
}

/* Pulses of a file, from ping `first` on. */
static void pulses_fill(const struct variable *v, const struct steps *steps, const struct band *band, int first,
                        struct acquisition *a, double complex *samples)
{
    for (size_t p = 0; p < v[FP].dims[1]; p++) {
        const size_t ping = (size_t)first + p;
        const double delay = 2 * field_number(&v[R0], p) / a->sound_speed, middle = a->samples / 2;
        const double turns = a->fc * delay;
        a->tx[ping] = (struct vector){field_number(&v[X], p), field_number(&v[Y], p), field_number(&v[Z], p)};
        a->rx[ping] = a->tx[ping];
        a->t0[ping] = delay - middle / a->fs;
        band_samples(band, v[FP].values + p * v[FP].dims[0], -middle,
                     cexp(-2 * M_PI * I * (turns - round(turns))) / steps->count, samples + ping * (size_t)a->samples);
    }
}

static enum status gotcha_fill(const char *const *paths, int count, const struct steps *steps, struct acquisition *a,
                               double complex *samples)
{
    struct band band;
    enum status status = band_open(steps->count, a->samples, &band);
    for (int k = 0, first = 0; k < count && status == STATUS_OK; k++) {
        struct variable v[FIELDS];
        struct steps own;
        status = file_read(paths[k], true, v, &own);
        if (status != STATUS_OK)
            break;
        const size_t pulses = v[FP].dims[1], left = (size_t)(a->pings - first);
        if (own.count != steps->count || (k + 1 < count ? pulses > left : pulses != left))
            status = status_set(STATUS_INVALID, "%s: has been replaced meanwhile", paths[k]);
        else
            pulses_fill(v, steps, &band, first, a, samples);
        first += (int)v[FP].dims[1];
        variables_free(v, FIELDS);
    }
    band_close(&band);
    return status;
}

static enum status gotcha_read(const char *const *paths, int count, struct recording *recording)
{
    struct acquisition *a = &recording->acquisition;
    struct echoes *echoes = &recording->echoes;
    struct steps steps;
    int pulses = 0;
    enum status status = files_survey(paths, count, &steps, &pulses);
    if (status != STATUS_OK)
        return status;
    /* A quarter beyond the band, over which interpolators roll off. */
    *a =
        (struct acquisition){.samples = fft_length(steps.count + steps.count / 4 + 1), .receivers = 1, .pings = pulses};
    a->sound_speed = LIGHT_SPEED;
    a->fc = steps.first_hz + steps.count / 2 * steps.step_hz;
    a->fs = a->samples * steps.step_hz;
    a->bandwidth = steps.count * steps.step_hz;
    a->aperture_limit = INFINITY;
    a->compressed = true;
    status = acquisition_allocate(a);
    if (status == STATUS_OK)
        status = echoes_allocate(a, PRECISION_DOUBLE, echoes);
    return status == STATUS_OK ? gotcha_fill(paths, count, &steps, a, (double complex *)echoes->samples) : status;
}

const struct layout gotcha_layout = {"AFRL Gotcha phase history", fields, FIELDS, true, NULL, gotcha_read};
