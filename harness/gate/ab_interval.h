/* What paired times say of two programs: an interval of their ratio, and what may be concluded from it. */
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

/* `ratios` [rounds][AB_BLOCKS]: times that were measured side by side, NEW by OLD of each block, positive; rounds >= 2.
   Rounds count, not blocks: what a process happens to get with its start (the places of its memory) is common to a
   round. Each is the median of its blocks, so that a block that was disturbed does not matter; the middle is the
   geometric mean of the rounds, and Student's t (of rounds - 1 degrees of freedom, so that fewer rounds prove less)
   times its standard error the distance of the ends. `miss`: the probability on each side that the true ratio lies
   beyond. */
struct ab_interval ab_interval_find(double (*ratios)[AB_BLOCKS], int rounds, double miss);

/* worse: all of it beyond EFFECT_FAIL. warning: beyond EFFECT_WARN. better: as far on the other side. same: a slowdown
   of EFFECT_FAIL is excluded. Else too noisy to tell. */
enum verdict ab_interval_verdict(const struct ab_interval *interval);

#endif
