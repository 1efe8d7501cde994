/* A band of a spectrum as samples of complex baseband. */
#ifndef SASBENCH_CONVERT_BAND_H
#define SASBENCH_CONVERT_BAND_H

#include <complex.h>

#include "contract/status.h"

/* `count` frequencies (count - 1) step apart, of which number count/2 becomes the carrier, and one period 1/step of
   time, `length` >= count samples at fs = length step. */
struct band {
    int count, length;
    struct fftw_plan_s *plan;
    double complex *line; /* [length] */
};

/* Freed with band_close, also after a failure; it accepts a zeroed struct. Errors: STATUS_FAILED without memory. */
enum status band_open(int count, int length, struct band *band);
void band_close(struct band *band);
/* samples[n] = factor sum_k spectrum[k] exp(j 2 pi (k - count/2) (n + shift)/length), n = 0 .. length - 1. */
void band_samples(const struct band *band, const double complex *spectrum, double shift, double complex factor,
                  double complex *samples);

#endif
