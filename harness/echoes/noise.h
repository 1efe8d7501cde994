/* How much of the compressed echoes' energy is white noise: what acquisition.noise holds. */
#ifndef SASBENCH_ECHOES_NOISE_H
#define SASBENCH_ECHOES_NOISE_H

#include "contract/algorithm.h"

/* Of a scene that is simulated: noise of this standard deviation beside all of its targets' echoes. */
double noise_of_targets(const struct acquisition *a, int target_count, const struct target *targets, double noise_std);

/* Measured, of echoes in double: the energy beyond the bandwidth, in some of the records, tapered so that their ends do
   not count, over what white noise would have there; of raw echoes, but for what the pulse has there, and of what
   compression keeps. 0 where the band or the records leave nothing to measure. *share is written. Errors:
   STATUS_FAILED without memory. */
enum status noise_measure(const struct echoes *echoes, double *share);

/* Set read[pings] of those that it is measured on. */
void noise_pings(const struct acquisition *acquisition, bool *read);

#endif
