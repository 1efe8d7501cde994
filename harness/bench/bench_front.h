/* What accuracy costs, in the command `bench`. */
#ifndef SASBENCH_BENCH_BENCH_FRONT_H
#define SASBENCH_BENCH_BENCH_FRONT_H

#include "bench/bench_goals.h"

/* The general engine on one thread, in float: polynomials of degree 3 to 5 beside the nearest sample, in turn, on two
   scenes of `sweep`, with their errors against `reference`; nearest's rate with one and two receivers a ping beside
   that with all, on rows of BP22's full size; and on all threads factorised back projection beside the nearest sample,
   for an aperture of 2048 pings. Into DIRECTORY/bench_front.csv and on standard output; adds the goals.
   Errors: what scene_load, scene_simulate, plan or execute return; STATUS_INVALID where the file cannot be written. */
enum status bench_front(const char *directory, struct bench_goals *goals);

#endif
