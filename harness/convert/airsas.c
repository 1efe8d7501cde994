/* AirSAS (Penn State's synthetic aperture sonar in air): HDF5 with real passband samples, and two tables beside it.

   Sample n of a ping lies at (n - group delay)/fs. Its spectrum about the chirp's middle becomes baseband; the chirp
   becomes the pulse. The sound speed follows the temperature of each ping; where it varies, echoes are compressed and
   move to the mean (speeds.h). */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "convert/band.h"
#include "convert/layout.h"
#include "common/fft_length.h"
#include "echoes/matfile.h"
#include "echoes/speeds.h"
#include "files/csv.h"

#define IMAGE_PLANE 0.6032 /* m: z of the plane that their own images lie in; ours lies at 0 */

enum { CHANNELS = 4, POSITION = CHANNELS, TEMPERATURE, FIELDS };

#define SAMPLES "a real array [N x P] (samples x pings, N >= 2), as in the other channels"
static const struct wanted fields[FIELDS] = {
    {"ch1/ts", KIND_REAL, true, SAMPLES},
    {"ch2/ts", KIND_REAL, true, SAMPLES},
    {"ch3/ts", KIND_REAL, true, SAMPLES},
    {"ch4/ts", KIND_REAL, true, SAMPLES},
    [POSITION] = {"na/position", KIND_REAL, false, "a real vector of P places along the track in m"},
    [TEMPERATURE] = {"na/temperature", KIND_REAL, false,
                     "a real array [P x 1] or [P x 2] of temperatures within +-100 degrees Celsius"},
};

/* Of acquistionParams.csv (spelled so). */
struct chirp {
    double fs, delay_samples, start_hz, stop_hz, duration_s, taper;
};

/* A table in the folder of the recording, or in the neighbour that the published set has it in. */
static enum status table_open(const char *path, const char *name, struct csv *csv)
{
    static const char *const folders[] = {"", "../characterization data/"};
    const char *slash = strrchr(path, '/');
    char place[PATH_MAX];
    for (size_t k = 0; k < sizeof folders / sizeof *folders; k++) {
        const int length =
            snprintf(place, sizeof place, "%.*s%s%s", slash ? (int)(slash - path) + 1 : 0, path, folders[k], name);
        if (length < (int)sizeof place && access(place, F_OK) == 0)
            return csv_read(place, CSV_TAIL_KEEP, csv);
    }
    return status_set(STATUS_INVALID, "%s: %s is missing; it is needed beside this file or in %s", path, name,
                      folders[1]);
}

/* The number in a row and a column, both from 1; a first line with a number in column 2 is no header. */
static enum status table_number(const struct csv *csv, int row, int column, const char *what, double *value)
{
    double first;
    const bool headed = csv->column_count < 2 || !csv_number(csv->columns[1], &first) || isnan(first);
    const int at = row - 1 - !headed;
    const char *cell = "";
    if (column <= csv->column_count && at < csv->row_count)
        cell = at < 0 ? csv->columns[column - 1] : csv_cell(csv, at, column - 1);
    if (csv_number(cell, value) && isfinite(*value))
        return STATUS_OK;
    return status_set(STATUS_INVALID, "%s: row %d, column %d is '%.40s'; a finite number is needed, %s", csv->path, row,
                      column, cell, what);
}

static enum status chirp_check(const char *path, const struct chirp *chirp)
{
    const double low = fmin(chirp->start_hz, chirp->stop_hz), high = fmax(chirp->start_hz, chirp->stop_hz);
    if (!(chirp->fs > 0) || !(low > 0) || !(high > low) || !(high < chirp->fs / 2))
        return status_set(STATUS_INVALID,
                          "%s: the chirp runs from %.10g to %.10g Hz (rows 8, 9), sampled at %.10g Hz (row 1); two "
                          "frequencies between 0 and half the sampling rate are needed",
                          path, chirp->start_hz, chirp->stop_hz, chirp->fs);
    if (!(chirp->duration_s * chirp->fs >= 2) || !(chirp->duration_s * chirp->fs < INT_MAX / 2))
        return status_set(STATUS_INVALID, "%s: the chirp's length is %g s (row 10); two samples at least are needed",
                          path, chirp->duration_s);
    if (!(chirp->taper >= 0 && chirp->taper <= 1))
        return status_set(STATUS_INVALID, "%s: the Tukey window's shape is %g (row 13); 0 to 1 is accepted", path,
                          chirp->taper);
    return STATUS_OK;
}

static enum status chirp_read(const char *path, struct chirp *chirp)
{
    const struct {
        int row;
        const char *what;
        double *value;
    } rows[] = {{1, "the sampling rate in Hz", &chirp->fs},
                {2, "the group delay in samples", &chirp->delay_samples},
                {8, "the chirp's first frequency in Hz", &chirp->start_hz},
                {9, "the chirp's last frequency in Hz", &chirp->stop_hz},
                {10, "the chirp's length in s", &chirp->duration_s},
                {13, "the shape of the chirp's Tukey window", &chirp->taper}};
    struct csv csv = {0};
    enum status status = table_open(path, "acquistionParams.csv", &csv);
    for (size_t k = 0; k < sizeof rows / sizeof *rows && status == STATUS_OK; k++)
        status = table_number(&csv, rows[k].row, 2, rows[k].what, rows[k].value);
    if (status == STATUS_OK)
        status = chirp_check(csv.path, chirp);
    csv_free(&csv);
    return status;
}

/* The loudspeaker's place, then those of the microphones, on the array. */
static enum status sensors_read(const char *path, const struct variable *v, struct vector sensors[1 + CHANNELS])
{
    struct csv csv = {0};
    enum status status = table_open(path, "sensorCoordinates.csv", &csv);
    for (int k = 0; k <= CHANNELS; k++) {
        double *const places[] = {&sensors[k].x, &sensors[k].y, &sensors[k].z};
        const bool needed = k == 0 || v[k - 1].values;
        for (int i = 0; i < 3 && needed && status == STATUS_OK; i++)
            status = table_number(&csv, 1 + k, 2 + i, k ? "a place of a microphone in m" : "the loudspeaker's in m",
                                  places[i]);
        sensors[k].z -= IMAGE_PLANE;
    }
    csv_free(&csv);
    return status;
}

static enum status shapes_check(const char *path, const struct variable *v, int *first)
{
    *first = 0;
    while (*first < CHANNELS && !v[*first].values)
        ++*first;
    if (*first == CHANNELS)
        return status_set(STATUS_INVALID, "%s: variable `ch1/ts` is missing, and so are ch2 to ch4; %s is needed", path,
                          fields[0].accepted);
    const size_t *dims = v[*first].dims;
    char why[80];
    snprintf(why, sizeof why, "%s [%zu x %zu x %zu]", fields[*first].name, dims[0], dims[1], dims[2]);
    for (int k = *first; k < FIELDS; k++) {
        bool fits = !v[k].values || (variable_has_shape(&v[k], dims[0], dims[1], 1) && dims[0] >= 2);
        if (k == POSITION)
            fits = variable_is_vector(&v[k]) && variable_count(&v[k]) == dims[1];
        else if (k == TEMPERATURE)
            fits = variable_has_shape(&v[k], dims[1], 1, 1) || variable_has_shape(&v[k], dims[1], 2, 1);
        if (!fits || dims[0] > INT_MAX / 4 || dims[1] > INT_MAX)
            return field_refuse(path, &fields[k], &v[k], why);
    }
    return STATUS_OK;
}

/* The pings' own, free(). */
static enum status sound_speeds_find(const char *path, const struct variable *temperature, double **speeds)
{
    const size_t pings = temperature->dims[0], sensors = temperature->dims[1];
    *speeds = calloc(pings, sizeof **speeds);
    if (!*speeds)
        return status_set(STATUS_FAILED, "%s: no memory for its sound speeds", path);
    for (size_t p = 0; p < pings; p++) {
        const double celsius =
            (field_number(temperature, p) + field_number(temperature, p + (sensors - 1) * pings)) / 2;
        (*speeds)[p] = 331.6 + 0.61 * celsius;
        if (!(fabs(celsius) <= 100))
            return status_set(STATUS_INVALID, "%s: variable `%s` of ping %zu is %g; %s is needed", path,
                              fields[TEMPERATURE].name, p + 1, celsius, fields[TEMPERATURE].accepted);
    }
    return STATUS_OK;
}

/* Compressed echoes of their mean, where they differ (speeds.h). */
static enum status sound_speeds_unite(const char *path, const double *speeds, struct recording *recording)
{
    struct acquisition *a = &recording->acquisition;
    const int length = a->pulse_length;
    double complex *pulse = calloc((size_t)length + 1, sizeof *pulse);
    if (!pulse)
        return status_set(STATUS_FAILED, "%s: no memory for its pulse", path);
    memcpy(pulse, a->pulse, (size_t)length * sizeof *pulse);
    enum status status = speeds_unite(path, speeds, a);
    if (status == STATUS_OK)
        status = speeds_move(a, speeds, length, pulse, NULL, PRECISION_DOUBLE, (void *)recording->echoes.samples);
    if (status == STATUS_OK && a->compressed)
        snprintf(recording->note, sizeof recording->note,
                 "echoes are compressed, and moved from the sound speeds of the pings to their mean, %.6g m/s",
                 a->sound_speed);
    free(pulse);
    return status;
}

/* Their replica's complex form, sin(x) = Re exp(j (x - pi/2)), under MATLAB's tukeywin. */
static void pulse_fill(const struct chirp *chirp, struct acquisition *a)
{
    const double rate = (chirp->stop_hz - chirp->start_hz) / chirp->duration_s;
    const double last = chirp->duration_s - 1 / chirp->fs; /* of the window */
    for (int n = 0; n < a->pulse_length; n++) {
        const double t = n / a->fs, edge = fmin(t, last - t) / last;
        const double window = edge < 0                  ? 0
                              : edge < chirp->taper / 2 ? (1 - cos(2 * M_PI * edge / chirp->taper)) / 2
                                                        : 1;
        a->pulse[n] = window * cexp(I * (2 * M_PI * (chirp->start_hz - a->fc + rate / 2 * t) * t - M_PI / 2));
    }
}

/* All channels and pings, real samples to their band about bin `centre`. */
static enum status samples_fill(const struct variable *v, const struct variable *first, const struct acquisition *a,
                                int centre, int half, double complex *samples)
{
    const size_t length = first->dims[0], receivers = (size_t)a->receivers;
    const double turns = a->fc * a->t0[0];
    struct real_band band;
    enum status status = real_band_open((int)length, centre, half, a->samples, &band);
    for (size_t p = 0; p < (size_t)a->pings && status == STATUS_OK; p++)
        for (size_t k = 0, m = 0; k < CHANNELS; k++) {
            if (!v[k].values)
                continue;
            for (size_t n = 0; n < length; n++)
                band.reals[n] = field_number(&v[k], p * length + n);
            real_band_samples(&band, cexp(-2 * M_PI * I * (turns - round(turns))),
                              samples + (p * receivers + m++) * (size_t)a->samples);
        }
    real_band_close(&band);
    return status;
}

static void geometry_fill(const struct variable *v, const struct vector *sensors, double t0, struct acquisition *a)
{
    for (size_t p = 0; p < (size_t)a->pings; p++) {
        const double along = field_number(&v[POSITION], p);
        a->t0[p] = t0;
        a->tx[p] = (struct vector){sensors[0].x + along, sensors[0].y, sensors[0].z};
        for (int k = 0, m = 0; k < CHANNELS; k++)
            if (v[k].values)
                a->rx[p * (size_t)a->receivers + (size_t)m++] =
                    (struct vector){sensors[1 + k].x + along, sensors[1 + k].y, sensors[1 + k].z};
    }
}

static enum status recording_fill(const char *path, const struct variable *v, int first, const struct chirp *chirp,
                                  const struct vector *sensors, struct recording *recording)
{
    struct acquisition *a = &recording->acquisition;
    const double step = chirp->fs / (double)v[first].dims[0], band = fabs(chirp->stop_hz - chirp->start_hz);
    const int centre = (int)round((chirp->start_hz + chirp->stop_hz) / 2 / step);
    /* As much again on both sides as the band has, for the spectrum of a short chirp is wider. */
    const int half = (int)fmin(ceil(band / step), fmin(centre, (double)(v[first].dims[0] / 2) - centre));
    a->samples = fft_length((long long)fmax(2 * half, ceil(1.25 * band / step)));
    a->fc = centre * step;
    a->fs = a->samples * step;
    a->bandwidth = band;
    a->pings = (int)v[first].dims[1];
    for (int k = 0; k < CHANNELS; k++)
        a->receivers += v[k].values != NULL;
    a->aperture_limit = INFINITY;
    a->pulse_length = (int)(chirp->duration_s * a->fs) + 1;
    enum status status = half > 0 ? acquisition_allocate(a) : STATUS_OK;
    if (half < 1 || a->pulse_length > a->samples)
        status = status_set(STATUS_INVALID, "%s: the chirp of %g s is longer than the record of %g s", path,
                            chirp->duration_s, 1 / step);
    if (status == STATUS_OK)
        status = echoes_allocate(a, PRECISION_DOUBLE, &recording->echoes);
    if (status != STATUS_OK)
        return status;
    geometry_fill(v, sensors, -chirp->delay_samples / chirp->fs, a);
    pulse_fill(chirp, a);
    return samples_fill(v, &v[first], a, centre, half, (double complex *)recording->echoes.samples);
}

static enum status airsas_read(const char *const *paths, int count, struct recording *recording)
{
    struct variable v[FIELDS];
    struct vector sensors[1 + CHANNELS] = {{0}};
    struct chirp chirp = {0};
    double *speeds = NULL;
    int first = 0;
    (void)count;
    enum status status = fields_read(paths[0], fields, FIELDS, v);
    if (status != STATUS_OK)
        return status;
    status = shapes_check(paths[0], v, &first);
    if (status == STATUS_OK)
        status = positions_check(paths[0], fields[POSITION].name, &v[POSITION], 0.02);
    if (status == STATUS_OK)
        status = sound_speeds_find(paths[0], &v[TEMPERATURE], &speeds);
    if (status == STATUS_OK)
        status = chirp_read(paths[0], &chirp);
    if (status == STATUS_OK)
        status = sensors_read(paths[0], v, sensors);
    if (status == STATUS_OK)
        status = recording_fill(paths[0], v, first, &chirp, sensors, recording);
    if (status == STATUS_OK)
        status = sound_speeds_unite(paths[0], speeds, recording);
    variables_free(v, FIELDS);
    free(speeds);
    return status;
}

const struct layout airsas_layout = {"AirSAS", fields, FIELDS, false, NULL, airsas_read};
