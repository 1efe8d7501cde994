/* Paired times of two programs: an interval of their ratio, and the verdict. */
#ifndef SASBENCH_GATE_AB_INTERVAL_H
#define SASBENCH_GATE_AB_INTERVAL_H

#include "gate/diff.h"

/* NEW's time by OLD's. */
struct ab_interval {
    double low, middle, high;
};

/* Effects that matter: a slowdown warns or fails when the whole interval lies beyond. */
#define EFFECT_WARN 0.03
#define EFFECT_FAIL 0.05

enum { AB_BLOCKS = 3 };

/* `ratios` [rounds][AB_BLOCKS]: NEW's time by OLD's in each block, measured side by side, positive; rounds >= 2. Rounds
   count, not blocks: what a process gets with its start (the places of its memory) is common to a round. A round's
   ratio is the median of its blocks, so that a disturbed block does not matter. The middle is the geometric mean of the
   rounds. Its distance from the ends is its standard error times Student's t, of rounds - 1 degrees of freedom, so that
   fewer rounds prove less. `miss`: the probability on each side that the true ratio lies beyond. */
struct ab_interval ab_interval_find(double (*ratios)[AB_BLOCKS], int rounds, double miss);

/* worse: all of it beyond EFFECT_FAIL. warning: beyond EFFECT_WARN. better: as far on the other side. same: a slowdown
   of EFFECT_FAIL is excluded. Else too noisy to tell. */
enum verdict ab_interval_verdict(const struct ab_interval *interval);

#endif
