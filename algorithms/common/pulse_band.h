/* The compressed pulse's spectrum, its part of the sampled band, and its weights in images. */
#ifndef SASBENCH_COMMON_PULSE_BAND_H
#define SASBENCH_COMMON_PULSE_BAND_H

#include <complex.h>

#include "contract/algorithm.h"

struct pulse_band {
    double half_hz; /* the band that matters is |f| <= half_hz; at most fs/2 */
    double loss;    /* energy of the compressed pulse outside it, relative */
};

/* Of raw echoes: the replica's band but for 4e-6 of the compressed energy. Of compressed echoes: twice the bandwidth,
   since echoes compressed elsewhere may have flanks, and at least 32 bins of the record, which its ends smear over.
   Errors: STATUS_FAILED without memory. */
enum status pulse_band_find(const struct acquisition *acquisition, int transform_length, struct pulse_band *band);

/* The energy spectrum of the compressed pulse of raw echoes, |replica's spectrum|^4, with the sum of the replica's
   magnitudes scaled to 1: energy[length] in FFTW's order, bin k at k fs/length; length >= pulse_length. The caller
   frees the result; NULL without memory, with STATUS_FAILED's message set. */
double *pulse_energy(const struct acquisition *acquisition, int length);

/* The matched filter of raw echoes for transforms of `length` >= pulse_length: conj(P)/(length sum|p|^2), in FFTW's
   order. Freed by fftw_free; NULL without memory. */
double complex *pulse_filter(const struct acquisition *acquisition, int length);

/* Frequency of its bin k, Hz, -fs/2 to fs/2. */
double pulse_bin_frequency(const struct acquisition *acquisition, int k, int length);

/* The image of a target is wider along the track at longer wavelengths. So images weight each pair's energy at low
   frequencies more, as in the flanks of a pulse with a small number of cycles. */

/* The width of the widest grid where errors count, over that of a target's image at the carrier. */
double image_cells(const struct problem *problem);

/* Energy in an image of `cells` cells at fc + `frequency` Hz over that at fc, of echoes with equal energy at both: as
   |fc / (fc + frequency)|, unless the grid ends first. */
double image_gain(const struct acquisition *acquisition, double cells, double frequency);

#endif
