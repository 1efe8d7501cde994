/* The control: the plainest possible back projection, timed in every run so that machines and noise divide out. */
#ifndef SASBENCH_MEASURE_SCALAR_LOOP_H
#define SASBENCH_MEASURE_SCALAR_LOOP_H

#include "algorithm.h"

/* Seconds that one pixel-pulse pair takes the scalar reference loop: nearest neighbour, one pair at a time, delay by
   double square roots, phase by libm's sin and cos, float sums, one thread, compiled with -O2 and without
   vectorisation. Timed over a million pairs (some 30 ms) that are spread evenly over the problem and whose delay lies
   in the record: what is skipped costs less and is no pair. NAN when there are none, or no memory. `echoes`: float
   samples, read as they are. */
double control_seconds_per_pair(const struct problem *problem, const struct echoes *echoes);

#endif
