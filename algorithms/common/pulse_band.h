/* The compressed pulse's spectrum, and which part of the sampled band holds it. */
#ifndef SASBENCH_COMMON_PULSE_BAND_H
#define SASBENCH_COMMON_PULSE_BAND_H

#include <complex.h>

#include "contract/acquisition.h"

struct pulse_band {
    double half_hz; /* the band that matters is |f| <= half_hz; at most fs/2 */
    double loss;    /* energy of the compressed pulse outside it, relative */
};

/* Of raw echoes: the replica's band but for 4e-6 of the compressed energy. Of compressed echoes: twice the bandwidth,
   since what was compressed elsewhere may have flanks, and at least 32 bins of the record, whose own ends are in it.
   Errors: STATUS_FAILED without memory. */
enum status pulse_band_find(const struct acquisition *acquisition, int transform_length, struct pulse_band *band);

/* The energy spectrum of the compressed pulse of raw echoes, |replica's spectrum|^4, as if the replica's magnitudes
   added up to 1: energy[length] in FFTW's order, bin k at k fs/length; length >= pulse_length. Returned memory is the
   caller's to free; NULL without memory, with STATUS_FAILED's message set. */
double *pulse_energy(const struct acquisition *acquisition, int length);

/* The matched filter of raw echoes for transforms of `length`: conj(P)/sum|p|^2 and the inverse transform's 1/length, in
   FFTW's order; length >= pulse_length. To be given to fftw_free; NULL without memory. */
double complex *pulse_filter(const struct acquisition *acquisition, int length);

/* Hz, -fs/2 to fs/2: of its bin k. */
double pulse_bin_frequency(const struct acquisition *acquisition, int k, int length);

#endif
