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
