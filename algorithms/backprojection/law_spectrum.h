/* The frequencies that error laws sum over. */
#ifndef SASBENCH_BACKPROJECTION_LAW_SPECTRUM_H
#define SASBENCH_BACKPROJECTION_LAW_SPECTRUM_H

#include "contract/algorithm.h"

enum { LAW_NODES = 48 };

/* Positive frequencies and their share of the image (common/pulse_band.h): of compressed echoes, flat over the
   bandwidth, or, of raw ones, the replica's own, which has flanks beyond it and may lie off the carrier; and of their
   noise, which is white in compressed echoes. The means of both signs of a frequency are the same but for the sign of
   their imaginary parts. */
struct law_spectrum {
    int count;
    double nu[LAW_NODES];           /* cycles a sample, 0 to 1/2 */
    double weight[LAW_NODES];       /* of the image's energy; their sum is 1 */
    double scattered[LAW_NODES];    /* of the echoes' energy where the image has no focus, in the same unit */
    double amplitude[LAW_NODES][2]; /* of a pulse without noise, at nu and at -nu; their sum is 1 */
    double reach;                   /* samples from a pulse's middle within which its sum over these frequencies is
                                       valid */
};
/* `cells` is image_cells of the problem. False without memory, with a message. */
bool law_spectrum(const struct acquisition *acquisition, double cells, struct law_spectrum *spectrum);

/* Hz: the width of the band about the carrier with all of the image's energy but a share of `outside`; at least the
   bandwidth. */
double law_band(const struct law_spectrum *spectrum, const struct acquisition *acquisition, double outside);
/* Hz: the width of the band about the carrier that kernels are fitted to: the bandwidth, and more of raw echoes whose
   pulse lies off the carrier. NAN without memory, with a message. */
double law_band_fitted(const struct acquisition *acquisition);

#endif
