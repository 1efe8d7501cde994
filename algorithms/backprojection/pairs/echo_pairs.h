/* The pairs of a ping and a receiver that hold a target's echo, and those that a pixel sums: what error laws carry out
   for known targets. */
#ifndef SASBENCH_BACKPROJECTION_PAIRS_ECHO_PAIRS_H
#define SASBENCH_BACKPROJECTION_PAIRS_ECHO_PAIRS_H

#include "contract/algorithm.h"

struct echo_pair {
    double delay;     /* s */
    double amplitude; /* 1; 0: the beam does not meet the target */
};

/* Is it known where the echoes come from: from within a known beam, or from known targets, without noise? */
bool echoes_known(const struct problem *problem);

/* Of a target at this place: pairs [pings][receivers]. */
void echo_pairs_fill(const struct acquisition *acquisition, struct vector target, struct echo_pair *pairs);

/* Calls `visit` for each pair with an echo that a pixel sums: with the pixel's own delay (s), which lies at sample q of
   the record. */
typedef void echo_pair_visit(void *context, const struct echo_pair *pair, double delay, double q);
void echo_pairs_visit(const struct acquisition *acquisition, const struct echo_pair *pairs, struct vector pixel,
                      echo_pair_visit *visit, void *context);

#endif
