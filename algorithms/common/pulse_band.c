#include "common/pulse_band.h"

#include <fftw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contract/condition.h"

#define BAND_LOSS 4e-6 /* of the compressed pulse's energy may lie outside the band */

/* The replica's spectrum, to be given to fftw_free; NULL without memory. */
static double complex *spectrum_make(const struct acquisition *a, int length)
{
    double complex *work = length > 0 ? fftw_malloc((size_t)length * sizeof *work) : NULL;
    if (!work)
        return NULL;
    memset(work, 0, (size_t)length * sizeof *work);
    memcpy(work, a->pulse, (size_t)a->pulse_length * sizeof *work);
    fftw_plan forward = fftw_plan_dft_1d(length, work, work, FFTW_FORWARD, FFTW_ESTIMATE);
    fftw_execute(forward);
    fftw_destroy_plan(forward);
    return work;
}

double complex *pulse_filter(const struct acquisition *a, int length)
{
    double complex *filter = spectrum_make(a, length);
    double energy = 0;
    for (int k = 0; k < a->pulse_length; k++)
        energy += creal(a->pulse[k]) * creal(a->pulse[k]) + cimag(a->pulse[k]) * cimag(a->pulse[k]);
    for (int k = 0; filter && k < length; k++)
        filter[k] = conj(filter[k]) / (energy * length);
    return filter;
}

double *pulse_energy(const struct acquisition *a, int length)
{
    double *energy = length > 0 ? malloc((size_t)length * sizeof *energy) : NULL;
    double complex *spectrum = spectrum_make(a, length);
    double magnitudes = 0; /* at least those of the spectrum: no power overflows */
    for (int k = 0; k < a->pulse_length; k++)
        magnitudes += cabs(a->pulse[k]);
    for (int k = 0; energy && spectrum && k < length; k++) {
        const double share = cabs(spectrum[k]) / magnitudes, power = share * share;
        energy[k] = power * power;
    }
    if (!energy || !spectrum) {
        status_set(STATUS_FAILED, "no memory for the replica's spectrum");
        free(energy);
        energy = NULL;
    }
    fftw_free(spectrum);
    return energy;
}

double pulse_bin_frequency(const struct acquisition *a, int k, int length)
{
    return (2 * k > length ? k - length : k) * a->fs / length;
}

enum status pulse_band_find(const struct acquisition *a, int length, struct pulse_band *band)
{
    *band = (struct pulse_band){fmin(a->fs / 2, fmax(a->bandwidth, 32 * a->fs / a->samples)), 0};
    if (a->compressed)
        return STATUS_OK;
    double *energy = pulse_energy(a, length);
    if (!energy)
        return STATUS_FAILED;
    double total = 0, outside = 0;
    for (int k = 0; k < length; k++)
        total += energy[k];
    int half = (length - 1) / 2;
    for (; half > a->bandwidth / 2 / a->fs * length; half--) {
        double edge = energy[half] + energy[length - half];
        if (outside + edge > BAND_LOSS * total)
            break;
        outside += edge;
    }
    free(energy);
    *band = (struct pulse_band){half * a->fs / length, outside / total};
    return STATUS_OK;
}

double image_cells(const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    const double cell = a->sound_speed / (4 * a->fc * fmin(condition_cut_sine(a), 1));
    double width = 0;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        width = fmax(width, fabs(g->x_count * g->x_step * cos(g->angle_rad))
                                + fabs(g->r_count * g->r_step * sin(g->angle_rad)));
    }
    return width / cell;
}

double image_gain(const struct acquisition *a, double cells, double frequency)
{
    return cells > 0 ? fmin(fabs(a->fc / (a->fc + frequency)), cells) / fmin(1, cells) : 1;
}
