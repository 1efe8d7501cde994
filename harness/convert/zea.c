/* Ultrasound of zea (HDF5), transmissions by one element each: that element is the transmitter, all are receivers.

   Their delay and ours differ by the time of the first sample: its initial time, less the delay of the element and the
   peak of the waveform. I and Q turn with the time since the first sample, real samples with the time itself. Their
   (x, y, z), z into depth, is our (x, -z, y). Frames follow one another as pings. */
#include <stdio.h>

#include "convert/elements.h"
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

/* Transmission after transmission, frame after frame. */
static enum status pings_fill(const char *path, const struct variable *v, const struct elements *elements,
                              struct acquisition *a)
{
    const size_t count = v[RAW].dims[ELEMENT], sent = v[RAW].dims[TRANSMISSION];
    for (int p = 0; p < a->pings; p++) {
        const size_t t = (size_t)p % sent;
        size_t sender = 0;
        const enum status status = sender_find(path, v, t, &sender);
        if (status != STATUS_OK)
            return status;
        double t0 = field_number(&v[FIRST], t) - field_number(&v[DELAYS], t * count + sender);
        if (v[PEAK].values)
            t0 -= field_number(&v[PEAK], variable_count(&v[PEAK]) == 1 ? 0 : t);
        elements_ping(elements, p, sender, t0, a);
    }
    return STATUS_OK;
}

static enum status recording_fill(const char *path, const struct variable *v, struct recording *recording)
{
    struct acquisition *a = &recording->acquisition;
    const size_t *dims = v[RAW].dims, record = dims[CHANNEL] * dims[ELEMENT];
    const bool real = dims[CHANNEL] == 1;
    const int fc = !real && v[DEMODULATION].values ? DEMODULATION : FC;
    const struct elements elements = {.places = &v[PROBE],
                                      .place_step = 3,
                                      .axis_step = 1,
                                      .in_phase = v[RAW].values,
                                      .quadrature = real ? NULL : v[RAW].values + 1,
                                      .sample_step = record,
                                      .element_step = dims[CHANNEL],
                                      .ping_step = record * dims[SAMPLE],
                                      .samples = (int)dims[SAMPLE],
                                      .rate = field_number(&v[FS], 0),
                                      .fc = field_number(&v[fc], 0),
                                      .places_field = &fields[PROBE],
                                      .rate_field = &fields[FS],
                                      .fc_field = &fields[fc]};
    a->sound_speed = field_number(&v[SPEED], 0);
    a->receivers = (int)dims[ELEMENT];
    a->pings = (int)(dims[TRANSMISSION] * dims[FRAME]);
    enum status status = elements_open(path, &elements, recording);
    if (status == STATUS_OK)
        status = pings_fill(path, v, &elements, a);
    return status == STATUS_OK ? elements_fill(&elements, recording) : status;
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

const struct layout zea_layout = {"zea ultrasound", fields, FIELDS, false, NULL, zea_read};
