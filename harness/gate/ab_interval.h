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

/* Bootstrap interval of the ratio of the medians of times that were measured side by side: `ratios`, [rounds][blocks],
   NEW by OLD of each block, positive; rounds >= 2. Since each time is taken by the speed of its own block (the
   geometric mean of both), the ratio of the medians is the median of the ratios. Rounds are drawn, not blocks: what a
   process happens to get with its start (the places of its memory) is common to a round. `miss`: the probability on
   each side that the true ratio lies beyond. The drawn medians give the interval of 95 %, its wider side standing for
   both; Student's t (of rounds - 1 degrees of freedom, so that fewer rounds prove less) widens it to `miss`. Always the
   same for the same ratios.
   Errors: STATUS_FAILED without memory. */
enum status ab_interval_find(const double *ratios, int rounds, int blocks, double miss, struct ab_interval *interval);

/* worse: all of it beyond EFFECT_FAIL. warning: beyond EFFECT_WARN. better: as far on the other side. same: a slowdown
   of EFFECT_FAIL is excluded. Else too noisy to tell. */
enum verdict ab_interval_verdict(const struct ab_interval *interval);

#endif
