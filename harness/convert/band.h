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

/* The same of real passband samples: `count` of them, whose bins centre - half .. centre + half - 1 are the band, all
   in 0 .. count/2. Same ownership and errors. */
struct real_band {
    int count, first;
    struct fftw_plan_s *plan;
    double *reals;            /* [count] what is transformed */
    double complex *spectrum; /* [count/2 + 1] */
    struct band band;
};

enum status real_band_open(int count, int centre, int half, int length, struct real_band *band);
void real_band_close(struct real_band *band);
/* Of the real samples at hand, times `factor`: exp(-j 2 pi fc t0) lets phases count from the emission. */
void real_band_samples(const struct real_band *band, double complex factor, double complex *samples);

#endif
