/* The control: the plainest possible back projection, timed in every run so that machines and noise divide out. */
#ifndef SASBENCH_MEASURE_SCALAR_LOOP_H
#define SASBENCH_MEASURE_SCALAR_LOOP_H

#include "contract/algorithm.h"

/* The scalar reference loop: nearest neighbour, one pair at a time, delay by double square roots, phase by libm's
   sin and cos, float sums, one thread, compiled with -O2 and without vectorisation. It is timed over a quarter of a
   million pairs (some 8 ms), spread evenly over the problem. Only pairs whose delay lies in the record count:
   skipped ones cost less. */
struct scalar_loop {
    const struct acquisition *acquisition;
    const struct grid *grid;
    const float *samples;
    struct scalar_pair *pairs; /* [count]; NULL without pairs or memory */
    int count;
};

/* Choose the pairs, freed with scalar_loop_free. The problem and its echoes (float, read as they are) are borrowed;
   its grids must not be turned. */
struct scalar_loop scalar_loop_choose(const struct problem *problem, const struct echoes *echoes);
void scalar_loop_free(struct scalar_loop *loop);
/* Seconds that one pixel-record pair takes; NAN without pairs. */
double scalar_loop_seconds(const struct scalar_loop *loop);

#endif
