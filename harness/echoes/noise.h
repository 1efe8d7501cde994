/* The share of white noise in the energy of the compressed echoes: acquisition.noise. */
#ifndef SASBENCH_ECHOES_NOISE_H
#define SASBENCH_ECHOES_NOISE_H

#include "contract/algorithm.h"

/* Of a simulated scene: noise of this standard deviation beside all of its targets' echoes. */
double noise_of_targets(const struct acquisition *a, int target_count, const struct target *targets, double noise_std);

/* Measured in some of the records, of echoes in double: the energy beyond the bandwidth, over that of white noise
   there. Tapers keep the records' ends from counting. Of raw echoes, the pulse's own energy there is taken off, and
   only what compression keeps counts. *share is written: 0 where the band or the records leave nothing to measure.
   Errors: STATUS_FAILED without memory. */
enum status noise_measure(const struct echoes *echoes, double *share);

/* Set read[pings] of the pings, some 16, that it is measured on. */
void noise_pings(const struct acquisition *acquisition, bool *read);

#endif
