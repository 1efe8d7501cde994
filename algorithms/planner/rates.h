/* How fast this machine does what a plan counts. */
#ifndef SASBENCH_PLANNER_RATES_H
#define SASBENCH_PLANNER_RATES_H

#include "algorithm.h"

/* Seconds of one thread, in float. A pair takes `pair`, and `value` for each value that it reads. */
struct rates {
    double pair[2][READ_KINDS], value[2][READ_KINDS]; /* general and invariant engine, how values are read */
    double entry[READ_KINDS];                         /* of the invariant engine's tables */
    double compress, migrate;                         /* a FLOP of range compression, of range migration */
    double doubled; /* factor for double, the same for all, so that both precisions choose alike */
    double noise;   /* relative: by how much the same time was off when it was measured again */
};

/* Those in use: of the machine that the program was written on, until others are set, so that choices are the same
   everywhere. rates_set is called before any plan is made, by one thread. */
const struct rates *rates_get(void);
void rates_set(const struct rates *rates);

/* With all threads that OpenMP has: the seconds that a forecast's sums take of `pairs` pairs, from tables of `entries`
   entries; those of a range migration of `flops`. */
double rates_sums(const struct forecast *forecast, enum precision precision, double pairs, double entries);
double rates_migration(enum precision precision, double flops);

#endif
