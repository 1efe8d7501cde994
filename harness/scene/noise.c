#include "scene/noise.h"

#include <fftw3.h>
#include <math.h>

enum { RECORDS_MOST = 64 };
static const double BINS_LEAST = 4;  /* beyond the band, to either side */
static const double TAPER = 3.0 / 8; /* of white noise's energy, what a raised cosine leaves */

/* The mean energy of a unit echo over some of the pings: those that do not see the target have none. */
static double seen_of(const struct acquisition *a, const struct target *target)
{
    enum { PINGS = 64 };
    const int step = (a->pings + PINGS - 1) / PINGS;
    double sum = 0;
    int count = 0;
    for (int p = step / 2; p < a->pings; p += step, count++) {
        const double r = hypot(target->r - a->tx[p].y, a->tx[p].z), u = a->tx[p].x - target->x;
        const double d = a->rx[(size_t)p * (size_t)a->receivers].x - a->tx[p].x;
        sum += pow(condition_pair_amplitude(a, r, u, d), 2);
    }
    return sum / count;
}

double noise_of_scene(const struct scene *scene)
{
    const struct acquisition *a = &scene->acquisition;
    double most = scene->noise_std, echoes = 0, pulse = a->compressed ? 1 : 0;
    if (!(scene->noise_std > 0))
        return 0;
    for (int k = 0; k < scene->target_count; k++)
        most = fmax(most, cabs(scene->targets[k].amplitude)); /* squares of the ratios fit */
    for (int k = 0; k < scene->target_count; k++)
        echoes += pow(cabs(scene->targets[k].amplitude) / most, 2) * seen_of(a, &scene->targets[k]);
    for (int k = 0; k < a->pulse_length; k++)
        pulse += creal(a->pulse[k] * conj(a->pulse[k]));
    const double noise = a->samples * pow(scene->noise_std / most, 2) / pulse;
    return noise / (noise + echoes * a->fs / a->bandwidth);
}

/* Energy beyond the band. */
static double outside_of(const fftw_complex *spectrum, int samples, int first)
{
    double outside = 0;
    for (int k = first; k <= samples - first; k++)
        outside += creal(spectrum[k] * conj(spectrum[k]));
    return outside;
}

enum status noise_measure(const struct echoes *echoes, double *share)
{
    const struct acquisition *a = echoes->acquisition;
    const size_t records = (size_t)a->pings * (size_t)a->receivers, samples = (size_t)a->samples;
    const double beyond = ceil(a->bandwidth / a->fs / 2 * a->samples) + 2; /* the taper's own width */
    const size_t step = (records + RECORDS_MOST - 1) / RECORDS_MOST;
    *share = 0;
    if (!a->compressed || !(a->samples / 2.0 - beyond >= BINS_LEAST))
        return STATUS_OK;
    fftw_complex *record = fftw_malloc(samples * sizeof *record);
    fftw_plan plan = record ? fftw_plan_dft_1d(a->samples, record, record, FFTW_FORWARD, FFTW_ESTIMATE) : NULL;
    double outside = 0, all = 0, most = 0;
    const double complex *values = echoes->samples;
    for (size_t i = 0; i < records * samples; i++)
        most = fmax(most, fmax(fabs(creal(values[i])), fabs(cimag(values[i]))));
    for (size_t n = step / 2; n < records && plan && most > 0; n += step) {
        for (size_t i = 0; i < samples; i++) {
            const double complex value = values[n * samples + i] / most;
            all += creal(value * conj(value)) * a->samples;
            record[i] = value * (0.5 - 0.5 * cos(2 * M_PI * ((double)i + 0.5) / a->samples));
        }
        fftw_execute(plan);
        outside += outside_of(record, a->samples, (int)beyond) / TAPER;
    }
    const enum status status = plan ? STATUS_OK : status_set(STATUS_FAILED, "no memory to measure the echoes' noise");
    if (plan)
        fftw_destroy_plan(plan);
    fftw_free(record);
    if (all > 0)
        *share = fmin(outside / all * a->samples / (a->samples - 2 * beyond + 1), 1);
    return status;
}
