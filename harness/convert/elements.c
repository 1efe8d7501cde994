/* Ultrasound by a probe as echoes (elements.h). */
#include "convert/elements.h"

#include <math.h>
#include <stdio.h>

#include "convert/band.h"

struct vector element_place(const struct elements *elements, size_t element)
{
    double axes[3];
    for (size_t k = 0; k < 3; k++)
        axes[k] = field_number(elements->places, element * elements->place_step + k * elements->axis_step);
    return (struct vector){axes[0], axes[2], -axes[1]};
}

/* The bins of a record's spectrum that are kept of real samples: all that lie even about fc. */
static int middle_bin(const struct elements *elements)
{
    return (int)round(elements->fc / elements->rate * elements->samples);
}

static int half_band(const struct elements *elements)
{
    const int centre = middle_bin(elements), middle = elements->samples / 2;
    return centre < middle - centre ? centre : middle - centre;
}

enum status elements_open(const char *path, const struct elements *elements, struct recording *recording)
{
    struct acquisition *a = &recording->acquisition;
    const double rate = elements->rate, step = rate / elements->samples;
    const bool real = !elements->quadrature;
    if (!(rate > 0) || !(elements->fc > 0) || (real && !(elements->fc < rate / 2 - step && elements->fc > step)))
        return status_set(STATUS_INVALID, "%s: variable `%s` is %g Hz, `%s` %g Hz; %s is needed", path,
                          elements->fc_field->name, elements->fc, elements->rate_field->name, rate,
                          elements->fc_field->accepted);
    if (!(a->sound_speed > 0))
        return status_set(STATUS_INVALID, "%s: the sound speed is %g m/s; a speed > 0 is needed", path, a->sound_speed);
    a->samples = real ? 2 * half_band(elements) : elements->samples;
    a->fs = real ? a->samples * step : rate;
    a->fc = real ? middle_bin(elements) * step : elements->fc;
    a->bandwidth = a->fs;
    a->aperture_limit = INFINITY;
    a->compressed = true;
    snprintf(recording->note, sizeof recording->note, "bandwidth is stated as %.6g Hz, all that the samples hold",
             a->bandwidth);
    enum status status = positions_check(path, elements->places_field->name, elements->places, a->sound_speed / a->fc);
    if (status == STATUS_OK)
        status = acquisition_allocate(a);
    return status == STATUS_OK ? echoes_allocate(a, PRECISION_DOUBLE, &recording->echoes) : status;
}

void elements_ping(const struct elements *elements, int ping, size_t sender, double t0, struct acquisition *a)
{
    a->t0[ping] = t0;
    a->tx[ping] = element_place(elements, sender);
    for (size_t e = 0; e < (size_t)a->receivers; e++)
        a->rx[(size_t)ping * (size_t)a->receivers + e] = element_place(elements, e);
}

/* Lets phases count from the emission. */
static double complex first_phase(const struct elements *elements, const struct acquisition *a, size_t ping)
{
    const double turns = a->fc * (a->t0[ping] - (elements->quadrature ? elements->mixed_since : 0));
    return cexp(-2 * M_PI * I * (turns - round(turns)));
}

enum status elements_fill(const struct elements *elements, struct recording *recording)
{
    const struct acquisition *a = &recording->acquisition;
    double complex *to = (double complex *)recording->echoes.samples;
    struct real_band band = {0};
    enum status status = STATUS_OK;
    if (!elements->quadrature)
        status = real_band_open(elements->samples, middle_bin(elements), half_band(elements), a->samples, &band);
    for (size_t p = 0; p < (size_t)a->pings && status == STATUS_OK; p++) {
        const double complex phase = first_phase(elements, a, p);
        for (size_t e = 0; e < (size_t)a->receivers; e++, to += a->samples) {
            const size_t first = p * elements->ping_step + e * elements->element_step;
            for (size_t n = 0; n < (size_t)elements->samples; n++) {
                const size_t at = first + n * elements->sample_step;
                if (elements->quadrature)
                    to[n] = phase * __builtin_complex(creal(elements->in_phase[at]), creal(elements->quadrature[at]));
                else
                    band.reals[n] = creal(elements->in_phase[at]);
            }
            if (!elements->quadrature)
                real_band_samples(&band, phase, to);
        }
    }
    real_band_close(&band);
    return status;
}
