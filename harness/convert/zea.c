/* Ultrasound of zea (HDF5), transmissions by one element each: that element is the transmitter, all are receivers.

   Their delay and ours differ by the time of the first sample: its initial time, less the delay of the element and the
   peak of the waveform. I and Q turn with the time since the first sample, real samples with the time itself. Their
   (x, y, z), z into depth, is our (x, -z, y). Frames follow one another as pings. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "convert/band.h"
#include "convert/layout.h"
#include "echoes/matfile.h"

enum { RAW, PROBE, FS, FC, DEMODULATION, SPEED, FIRST, DELAYS, WEIGHTS, PEAK, FIELDS };

#define RAW_SHAPE                                                                                                      \
    "frames x transmissions x samples x elements x channels in HDF5's order; 1 channel of real samples or 2"
#define OF_ELEMENTS "in HDF5's order a real array [transmissions x elements]"
static const struct wanted fields[FIELDS] = {
    [RAW] = {"data/raw_data", KIND_REAL, false, RAW_SHAPE},
    [PROBE] = {"scan/probe_geometry", KIND_REAL, false, "in HDF5's order a real array [elements x 3] in m"},
    [FS] = {"scan/sampling_frequency", KIND_SCALAR, false, "a scalar > 0 in Hz"},
    [FC] = {"scan/center_frequency", KIND_SCALAR, false, "a scalar > 0 in Hz, below half the sampling rate"},
    [DEMODULATION] = {"scan/demodulation_frequency", KIND_SCALAR, true, "a scalar > 0 in Hz"},
    [SPEED] = {"scan/sound_speed", KIND_SCALAR, false, "a scalar in m/s"},
    [FIRST] = {"scan/initial_times", KIND_REAL, false, "a real vector, one of each transmission, in s"},
    [DELAYS] = {"scan/t0_delays", KIND_REAL, false, OF_ELEMENTS " in s"},
    [WEIGHTS] = {"scan/tx_apodizations", KIND_REAL, false, OF_ELEMENTS},
    [PEAK] = {"scan/t_peak", KIND_REAL, true, "a real vector, one of each transmission, or of all, in s"},
};

/* Its dimensions in MATLAB's order, the reverse of HDF5's. */
enum { CHANNEL, ELEMENT, SAMPLE, TRANSMISSION, FRAME };

static enum status shapes_check(const char *path, const struct variable *v)
{
    const size_t *raw = v[RAW].dims, elements = raw[ELEMENT], sent = raw[TRANSMISSION];
    const size_t pings = size_product(sent, raw[FRAME], 1, 1);
    if (raw[CHANNEL] > 2 || raw[SAMPLE] < 2 || raw[SAMPLE] > INT_MAX / 4 || elements > INT_MAX || pings > INT_MAX)
        return field_refuse(path, &fields[RAW], &v[RAW], "in MATLAB's order");
    const struct {
        int field;
        bool fits;
    } shapes[] = {{PROBE, variable_has_shape(&v[PROBE], 3, elements, 1)},
                  {FIRST, variable_is_vector(&v[FIRST]) && variable_count(&v[FIRST]) == sent},
                  {DELAYS, variable_has_shape(&v[DELAYS], elements, sent, 1)},
                  {WEIGHTS, variable_has_shape(&v[WEIGHTS], elements, sent, 1)},
                  {PEAK, !v[PEAK].values
                             || (variable_is_vector(&v[PEAK])
                                 && (variable_count(&v[PEAK]) == sent || variable_count(&v[PEAK]) == 1))}};
    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++)
        if (!shapes[k].fits) {
            char why[100];
            snprintf(why, sizeof why, "of %zu elements and %zu transmissions", elements, sent);
            return field_refuse(path, &fields[shapes[k].field], &v[shapes[k].field], why);
        }
    return STATUS_OK;
}

/* The element that sends, or a refusal of a plane or focused wave. */
static enum status sender_find(const char *path, const struct variable *v, size_t sent, size_t *sender)
{
    const size_t elements = v[RAW].dims[ELEMENT];
    size_t count = 0;
    for (size_t e = 0; e < elements; e++)
        if (field_number(&v[WEIGHTS], sent * elements + e) != 0) {
            *sender = e;
            count++;
        }
    return count == 1 ? STATUS_OK
                      : status_set(STATUS_INVALID,
                                   "%s: variable `%s` of transmission %zu has %zu elements that send, as plane and "
                                   "focused waves have; one is needed",
                                   path, fields[WEIGHTS].name, sent + 1, count);
}

static enum status geometry_fill(const char *path, const struct variable *v, struct acquisition *a)
{
    const size_t elements = v[RAW].dims[ELEMENT], sent = v[RAW].dims[TRANSMISSION];
    for (size_t p = 0; p < (size_t)a->pings; p++) {
        const size_t t = p % sent;
        size_t sender = 0;
        const enum status status = sender_find(path, v, t, &sender);
        if (status != STATUS_OK)
            return status;
        a->t0[p] = field_number(&v[FIRST], t) - field_number(&v[DELAYS], t * elements + sender);
        if (v[PEAK].values)
            a->t0[p] -= field_number(&v[PEAK], variable_count(&v[PEAK]) == 1 ? 0 : t);
        for (size_t e = 0; e < elements; e++) {
            const struct vector place = variable_vector(&v[PROBE], e);
            a->rx[p * elements + e] = (struct vector){place.x, place.z, -place.y};
        }
        a->tx[p] = a->rx[p * elements + sender];
    }
    return STATUS_OK;
}

static double complex first_phase(const struct acquisition *a, size_t ping)
{
    const double turns = a->fc * a->t0[ping];
    return cexp(-2 * M_PI * I * (turns - round(turns)));
}

/* Number of raw_data of a record's sample. */
static size_t raw_index(const struct variable *raw, size_t ping, size_t element, size_t sample)
{
    const size_t *dims = raw->dims;
    return dims[CHANNEL] * (element + dims[ELEMENT] * (sample + dims[SAMPLE] * ping));
}

static void pairs_fill(const struct variable *raw, const struct acquisition *a, double complex *samples)
{
    for (size_t p = 0; p < (size_t)a->pings; p++)
        for (size_t e = 0; e < (size_t)a->receivers; e++)
            for (size_t n = 0; n < (size_t)a->samples; n++) {
                const size_t at = raw_index(raw, p, e, n);
                const double complex pair = __builtin_complex(field_number(raw, at), field_number(raw, at + 1));
                samples[(p * (size_t)a->receivers + e) * (size_t)a->samples + n] = pair * first_phase(a, p);
            }
}

/* Real samples to their band, `half` bins to either side of bin `centre`. */
static enum status reals_fill(const struct variable *raw, const struct acquisition *a, int centre, int half,
                              double complex *samples)
{
    struct real_band band;
    enum status status = real_band_open((int)raw->dims[SAMPLE], centre, half, a->samples, &band);
    for (size_t p = 0; p < (size_t)a->pings && status == STATUS_OK; p++)
        for (size_t e = 0; e < (size_t)a->receivers; e++) {
            for (size_t n = 0; n < raw->dims[SAMPLE]; n++)
                band.reals[n] = field_number(raw, raw_index(raw, p, e, n));
            real_band_samples(&band, first_phase(a, p), samples + (p * (size_t)a->receivers + e) * (size_t)a->samples);
        }
    real_band_close(&band);
    return status;
}

static enum status recording_fill(const char *path, const struct variable *v, struct recording *recording)
{
    struct acquisition *a = &recording->acquisition;
    const bool real = v[RAW].dims[CHANNEL] == 1;
    const int fc = !real && v[DEMODULATION].values ? DEMODULATION : FC;
    const double rate = field_number(&v[FS], 0), step = rate / (double)v[RAW].dims[SAMPLE];
    a->fc = field_number(&v[fc], 0);
    if (!(rate > 0) || !(a->fc > 0) || (real && !(a->fc < rate / 2 - step && a->fc > step)))
        return status_set(STATUS_INVALID, "%s: variable `%s` is %g Hz, `%s` %g Hz; %s is needed", path, fields[fc].name,
                          a->fc, fields[FS].name, rate, fields[fc].accepted);
    const int centre = (int)round(a->fc / step), middle = (int)(v[RAW].dims[SAMPLE] / 2);
    const int half = centre < middle - centre ? centre : middle - centre; /* all that lies even about it */
    a->samples = real ? 2 * half : (int)v[RAW].dims[SAMPLE];
    a->fs = real ? a->samples * step : rate;
    a->fc = real ? centre * step : a->fc;
    a->bandwidth = a->fs;
    a->sound_speed = field_number(&v[SPEED], 0);
    a->receivers = (int)v[RAW].dims[ELEMENT];
    a->pings = (int)(v[RAW].dims[TRANSMISSION] * v[RAW].dims[FRAME]);
    a->aperture_limit = INFINITY;
    a->compressed = true;
    enum status status = positions_check(path, fields[PROBE].name, &v[PROBE], a->sound_speed / a->fc);
    if (status == STATUS_OK)
        status = acquisition_allocate(a);
    if (status == STATUS_OK)
        status = geometry_fill(path, v, a);
    if (status == STATUS_OK)
        status = echoes_allocate(a, PRECISION_DOUBLE, &recording->echoes);
    if (status != STATUS_OK)
        return status;
    snprintf(recording->note, sizeof recording->note,
             "bandwidth is not in this layout: %.6g Hz, all that the samples hold, is stated", a->bandwidth);
    double complex *samples = (double complex *)recording->echoes.samples;
    if (real)
        return reals_fill(&v[RAW], a, centre, half, samples);
    pairs_fill(&v[RAW], a, samples);
    return STATUS_OK;
}

static enum status zea_read(const char *const *paths, int count, struct recording *recording)
{
    struct variable v[FIELDS];
    (void)count;
    enum status status = fields_read(paths[0], fields, FIELDS, v);
    if (status != STATUS_OK)
        return status;
    status = shapes_check(paths[0], v);
    if (status == STATUS_OK)
        status = recording_fill(paths[0], v, recording);
    variables_free(v, FIELDS);
    return status;
}

const struct layout zea_layout = {"zea ultrasound", fields, FIELDS, false, zea_read};
