/* Seconds of the work that a forecast counts (contract/forecast.h). */
#ifndef SASBENCH_CONTRACT_FORECAST_TIME_H
#define SASBENCH_CONTRACT_FORECAST_TIME_H

#include "contract/algorithm.h"

/* Columns from ping to ping of the images that `pair` and `value` of the invariant engine are measured on: more make
   pairs no faster. */
enum { RATES_COLUMNS = 8 };

/* Seconds of one thread, in float; [general and invariant engine]. A pair takes `pair`, and `value` for each value that
   it reads. */
struct rates {
    double pair[2][READ_KINDS], value[2][READ_KINDS];
    double unit[2][READ_KINDS], unit_value[2][READ_KINDS]; /* alike: a block of pixels; an entry of the tables */
    /* What a pair of the general engine takes more if its pixel loads its own samples: by itself, and for each
       value. */
    double apart[READ_KINDS], apart_value[READ_KINDS];
    double compress;            /* a FLOP of range compression's transforms */
    double filter;              /* a FLOP of branches that stand for taps */
    double image;               /* what images of subapertures cost for one pair */
    double put[2];              /* a value of a record, put where pairs read it */
    double migrate[MIGRATIONS]; /* a FLOP or a value of range migration's parts */
    double doubled;             /* factor for double, the same for all, so that both precisions choose alike */
    double noise;               /* relative: by how much the same time differed when it was measured again */
};

/* Of the machine that the program was written on. */
extern const struct rates rates_built_in;

/* Seconds of one thread: of a forecast's sums of `pairs` pairs; of its range migration. */
double rates_sums(const struct rates *rates, const struct forecast *forecast, enum precision precision, double pairs);
double rates_migration(const struct rates *rates, const struct forecast *forecast, enum precision precision);

#endif
