/* A band of a spectrum as samples of complex baseband (band.h). */
#include "convert/band.h"

#include <fftw3.h>
#include <math.h>
#include <string.h>

static double complex turn(double cycles)
{
    return cexp(2 * M_PI * I * (cycles - round(cycles)));
}

enum status band_open(int count, int length, struct band *band)
{
    *band = (struct band){count, length, NULL, fftw_malloc((size_t)length * sizeof *band->line)};
    if (band->line)
        band->plan = fftw_plan_dft_1d(length, band->line, band->line, FFTW_BACKWARD, FFTW_ESTIMATE);
    return band->plan ? STATUS_OK : status_set(STATUS_FAILED, "out of memory for a transform of %d samples", length);
}

void band_close(struct band *band)
{
    if (band->plan)
        fftw_destroy_plan(band->plan);
    fftw_free(band->line);
    *band = (struct band){0};
}

void band_samples(const struct band *band, const double complex *spectrum, double shift, double complex factor,
                  double complex *samples)
{
    memset(band->line, 0, (size_t)band->length * sizeof *band->line);
    for (int k = 0; k < band->count; k++) {
        const int bin = k - band->count / 2;
        band->line[bin < 0 ? bin + band->length : bin] = factor * spectrum[k] * turn(bin * shift / band->length);
    }
    fftw_execute(band->plan);
    memcpy(samples, band->line, (size_t)band->length * sizeof *samples);
}

enum status real_band_open(int count, int centre, int half, int length, struct real_band *band)
{
    *band = (struct real_band){.count = count, .first = centre - half};
    band->reals = fftw_malloc((size_t)count * sizeof *band->reals);
    band->spectrum = fftw_malloc((size_t)(count / 2 + 1) * sizeof *band->spectrum);
    if (band->reals && band->spectrum)
        band->plan = fftw_plan_dft_r2c_1d(count, band->reals, band->spectrum, FFTW_ESTIMATE);
    return band->plan ? band_open(2 * half, length, &band->band)
                      : status_set(STATUS_FAILED, "out of memory for a transform of %d samples", count);
}

void real_band_close(struct real_band *band)
{
    band_close(&band->band);
    if (band->plan)
        fftw_destroy_plan(band->plan);
    fftw_free(band->spectrum);
    fftw_free(band->reals);
    *band = (struct real_band){0};
}

void real_band_samples(const struct real_band *band, double complex factor, double complex *samples)
{
    fftw_execute(band->plan);
    band_samples(&band->band, band->spectrum + band->first, 0, 2 * factor / band->count, samples);
}
