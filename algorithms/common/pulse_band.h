/* The compressed pulse's spectrum, which part of the sampled band holds it, and what images show of it. */
#ifndef SASBENCH_COMMON_PULSE_BAND_H
#define SASBENCH_COMMON_PULSE_BAND_H

#include <complex.h>

#include "contract/algorithm.h"

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

/* The matched filter of raw echoes for transforms of `length` >= pulse_length: conj(P)/(length sum|p|^2), in FFTW's
   order. To be given to fftw_free; NULL without memory. */
double complex *pulse_filter(const struct acquisition *acquisition, int length);

/* Hz, -fs/2 to fs/2: of its bin k. */
double pulse_bin_frequency(const struct acquisition *acquisition, int k, int length);

/* The image of a target is as wide along the track as its wavelength makes it: of each pair's energy at low
   frequencies, which a pulse of few cycles has in its flanks, images show more. */

/* The width of the grids where errors count, the widest of them, over that of a target's image at the carrier. */
double image_cells(const struct problem *problem);

/* Energy in an image of that many cells at fc + `frequency` Hz over that at fc, of echoes that have the same at both:
   as |fc / (fc + frequency)|, unless the grid ends first. */
double image_gain(const struct acquisition *acquisition, double cells, double frequency);

#endif
