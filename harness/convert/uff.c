/* USTB's ultrasound file format (UFF, HDF5), waves from one element each: that element is the transmitter.

   Their time zero is when the wave passes the origin. So a wave leaves its source that much earlier or later, and its
   `delay` moves its records further. I and Q turn with `initial_time` and what follows, without the wave's delay; real
   samples with the time itself. Frames follow one another as pings. */
#include <math.h>
#include <stdio.h>

#include "convert/elements.h"
#include "echoes/matfile.h"

/* m: sources above it are behind the array for USTB, whose waves pass the origin after they left. */
#define BEHIND     (-1e-3)
#define SPEED_MOST 1e-6 /* relative: two sound speeds of class single are the same */

enum { REAL, IMAG, PROBE, FS, FIRST, SPEED, MODULATION, PULSE, FIELDS };

#define DATA_SHAPE "in MATLAB's order a real array [samples x elements x waves x frames], at least 2 samples"
static const struct wanted fields[FIELDS] = {
    [REAL] = {"channel_data/data/real", KIND_REAL, true, DATA_SHAPE},
    [IMAG] = {"channel_data/data/imag", KIND_REAL, true, "an array as in `channel_data/data/real`"},
    [PROBE] = {"channel_data/probe/geometry", KIND_REAL, false,
               "in MATLAB's order a real array [elements x 7], x, y, z in m first"},
    [FS] = {"channel_data/sampling_frequency", KIND_SCALAR, false, "a scalar > 0 in Hz"},
    [FIRST] = {"channel_data/initial_time", KIND_SCALAR, false, "a scalar in s"},
    [SPEED] = {"channel_data/sound_speed", KIND_SCALAR, false, "a scalar in m/s"},
    [MODULATION] = {"channel_data/modulation_frequency", KIND_SCALAR, true,
                    "a scalar > 0 in Hz of complex data, 0 of real data"},
    [PULSE] = {"channel_data/pulse/center_frequency", KIND_SCALAR, true,
               "a scalar > 0 in Hz, below half the sampling rate"},
};
/* In the place of REAL and IMAG. */
static const struct wanted real_data = {"channel_data/data", KIND_REAL, false,
                                        DATA_SHAPE ", or two of them in a group, `real` and `imag`"};

/* Of a wave. */
enum { DISTANCE, AZIMUTH, ELEVATION, WAVEFRONT, DELAY, WAVE_SPEED, WAVE_FIELDS };

struct wave {
    char names[WAVE_FIELDS][80];
    struct wanted fields[WAVE_FIELDS];
    struct variable v[WAVE_FIELDS];
};

/* Data sets of wave number `index` from 0: sequences of more than one have a group for each. */
static enum status wave_read(const char *path, size_t index, size_t count, bool is_optional, struct wave *wave)
{
    static const struct wanted any[WAVE_FIELDS] = {{"source/distance", KIND_SCALAR, false, "a scalar in m"},
                                                   {"source/azimuth", KIND_SCALAR, false, "a scalar in rad"},
                                                   {"source/elevation", KIND_SCALAR, false, "a scalar in rad"},
                                                   {"wavefront", KIND_SCALAR, true, "a scalar"},
                                                   {"delay", KIND_SCALAR, true, "a scalar in s"},
                                                   {"sound_speed", KIND_SCALAR, true, "a scalar in m/s"}};
    char group[40] = "";
    if (count > 1)
        snprintf(group, sizeof group, "sequence_%04zu/", index + 1);
    for (int k = 0; k < WAVE_FIELDS; k++) {
        snprintf(wave->names[k], sizeof *wave->names, "channel_data/sequence/%s%s", group, any[k].name);
        wave->fields[k] = any[k];
        wave->fields[k].name = wave->names[k];
        wave->fields[k].is_optional |= is_optional;
    }
    return variables_read(path, wave->fields, WAVE_FIELDS, wave->v);
}

static double wave_number(const struct wave *wave, int field, double otherwise)
{
    return wave->v[field].values ? field_number(&wave->v[field], 0) : otherwise;
}

/* No wave from a point, or one at another speed. */
static enum status wave_check(const char *path, const struct wave *wave, double speed)
{
    static const char *const kinds[] = {"a plane wave", "", "a photoacoustic one"};
    const double kind = wave_number(wave, WAVEFRONT, 1);
    if (kind != 1)
        return status_set(STATUS_INVALID, "%s: variable `%s` is %g, %s; 1 is needed, a spherical wave", path,
                          wave->names[WAVEFRONT], kind, kind == 0 || kind == 2 ? kinds[(int)kind] : "unknown");
    if (isinf(wave_number(wave, DISTANCE, 0)))
        return status_set(STATUS_INVALID,
                          "%s: variable `%s` is %g m, of a plane wave; a source at an element is needed", path,
                          wave->names[DISTANCE], wave_number(wave, DISTANCE, 0));
    const enum status status = fields_check(path, wave->fields, WAVE_FIELDS, wave->v);
    const double own = wave_number(wave, WAVE_SPEED, speed);
    if (status == STATUS_OK && !(fabs(own / speed - 1) <= SPEED_MOST))
        return status_set(STATUS_INVALID, "%s: variable `%s` is %.10g m/s, `%s` %.10g m/s; one speed is needed", path,
                          wave->names[WAVE_SPEED], own, fields[SPEED].name, speed);
    return status;
}

/* The element that the wave comes from, and the time of the first sample after it left, less `initial_time`. */
static enum status wave_place(const char *path, const struct wave *wave, const struct elements *elements,
                              const struct acquisition *a, size_t *sender, double *after)
{
    const double distance = wave_number(wave, DISTANCE, 0), wavelength = a->sound_speed / a->fc;
    const double azimuth = wave_number(wave, AZIMUTH, 0), elevation = wave_number(wave, ELEVATION, 0);
    const struct vector source = {distance * sin(azimuth) * cos(elevation), distance * cos(azimuth) * cos(elevation),
                                  -distance * sin(elevation)};
    double nearest = INFINITY;
    for (size_t e = 0; e < (size_t)a->receivers; e++) {
        const double off = vector_norm(vector_difference(source, element_place(elements, e)));
        if (off < nearest) {
            nearest = off;
            *sender = e;
        }
    }
    *after = wave_number(wave, DELAY, 0) + (source.y < BEHIND ? 1 : -1) * vector_norm(source) / a->sound_speed;
    if (nearest <= ACQUISITION_UNEVEN_MOST * wavelength)
        return STATUS_OK;
    return status_set(STATUS_INVALID,
                      "%s: variable `%s` and its angles put the source at (%g, %g, %g) m, %.3g wavelengths from the "
                      "nearest element, as diverging and focused waves have it; a source at an element is needed",
                      path, wave->names[DISTANCE], source.x, -source.z, source.y, nearest / wavelength);
}

/* Wave after wave, frame after frame. */
static enum status pings_fill(const char *path, const struct elements *elements, size_t waves, double initial_time,
                              struct acquisition *a)
{
    for (size_t w = 0; w <= waves; w++) {
        struct wave wave;
        double after = 0;
        size_t sender = 0;
        enum status status = wave_read(path, w, waves, w == waves, &wave);
        if (status != STATUS_OK)
            return status;
        if (w == waves && wave.v[DISTANCE].values && waves > 1)
            status = status_set(STATUS_INVALID,
                                "%s: variable `%s` is of wave %zu, but the data have %zu waves; as many "
                                "waves are needed as the data have",
                                path, wave.names[DISTANCE], w + 1, waves);
        if (w < waves)
            status = wave_check(path, &wave, a->sound_speed);
        if (status == STATUS_OK && w < waves)
            status = wave_place(path, &wave, elements, a, &sender, &after);
        variables_free(wave.v, WAVE_FIELDS);
        if (status != STATUS_OK)
            return status;
        for (size_t p = w; w < waves && p < (size_t)a->pings; p += waves)
            elements_ping(elements, (int)p, sender, initial_time + after, a);
    }
    return STATUS_OK;
}

static enum status shapes_check(const char *path, const struct variable *v)
{
    const struct wanted *data = v[IMAG].values ? &fields[REAL] : &real_data;
    const size_t *dims = v[REAL].dims;
    char why[100];
    if (dims[0] < 2 || dims[0] > INT_MAX / 4 || dims[1] > INT_MAX || size_product(dims[2], dims[3], 1, 1) > INT_MAX
        || dims[4] != 1)
        return field_refuse(path, data, &v[REAL], "which are no records");
    snprintf(why, sizeof why, "%s [%zu x %zu x %zu x %zu]", data->name, dims[0], dims[1], dims[2], dims[3]);
    for (int k = 0; k < DIMENSIONS_MOST && v[IMAG].values; k++)
        if (v[IMAG].dims[k] != dims[k])
            return field_refuse(path, &fields[IMAG], &v[IMAG], why);
    if (!variable_has_shape(&v[PROBE], dims[1], v[PROBE].dims[1], 1) || v[PROBE].dims[1] < 3)
        return field_refuse(path, &fields[PROBE], &v[PROBE], why);
    const double modulation = v[MODULATION].values ? field_number(&v[MODULATION], 0) : 0;
    if ((modulation != 0) != (v[IMAG].values != NULL))
        return status_set(STATUS_INVALID, "%s: variable `%s` is %g Hz of %s data; %s is needed", path,
                          fields[MODULATION].name, modulation, v[IMAG].values ? "complex" : "real",
                          fields[MODULATION].accepted);
    return STATUS_OK;
}

static enum status recording_fill(const char *path, const struct variable *v, struct recording *recording)
{
    struct acquisition *a = &recording->acquisition;
    const size_t *dims = v[REAL].dims;
    const int fc = v[IMAG].values ? MODULATION : PULSE;
    const double rate = field_number(&v[FS], 0), initial_time = field_number(&v[FIRST], 0);
    const struct elements elements = {.places = &v[PROBE],
                                      .place_step = 1,
                                      .axis_step = dims[1],
                                      .in_phase = v[REAL].values,
                                      .quadrature = v[IMAG].values,
                                      .sample_step = 1,
                                      .element_step = dims[0],
                                      .ping_step = dims[0] * dims[1],
                                      .samples = (int)dims[0],
                                      .rate = rate,
                                      .fc = v[fc].values ? field_number(&v[fc], 0) : rate / 4,
                                      .mixed_since = initial_time,
                                      .places_field = &fields[PROBE],
                                      .rate_field = &fields[FS],
                                      .fc_field = &fields[fc]};
    a->sound_speed = field_number(&v[SPEED], 0);
    a->receivers = (int)dims[1];
    a->pings = (int)(dims[2] * dims[3]);
    enum status status = elements_open(path, &elements, recording);
    if (status == STATUS_OK)
        status = pings_fill(path, &elements, dims[2], initial_time, a);
    return status == STATUS_OK ? elements_fill(&elements, recording) : status;
}

static enum status uff_read(const char *const *paths, int count, struct recording *recording)
{
    struct variable v[FIELDS];
    (void)count;
    enum status status = fields_read(paths[0], fields, FIELDS, v);
    if (status != STATUS_OK)
        return status;
    if (v[REAL].values && !v[IMAG].values)
        status = status_set(STATUS_INVALID, "%s: variable `%s` is missing; %s is needed", paths[0], fields[IMAG].name,
                            fields[IMAG].accepted);
    else if (!v[REAL].values) {
        status = fields_read(paths[0], &real_data, 1, &v[REAL]);
        if (status != STATUS_OK)
            v[REAL].values = NULL; /* freed already */
    }
    if (status == STATUS_OK)
        status = shapes_check(paths[0], v);
    if (status == STATUS_OK)
        status = recording_fill(paths[0], v, recording);
    variables_free(v, FIELDS);
    return status;
}

const struct layout uff_layout = {"USTB ultrasound (UFF)", fields, FIELDS, false, NULL, uff_read};
