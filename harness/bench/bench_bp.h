/* Back projection's part of the command `bench`. */
#ifndef SASBENCH_BENCH_BENCH_BP_H
#define SASBENCH_BENCH_BENCH_BP_H

#include "bench/bench_goals.h"

/* Both engines at BP22's full size with every interpolator, in both precisions, on one thread and on all, and on lower
   instruction sets: rates against the processor's multiply-add peak and the scalar reference loop, into
   DIRECTORY/bench.csv with a picture. Adds their goals. Errors: what scene_load, scene_simulate, plan or execute
   return; STATUS_INVALID where a file cannot be written. */
enum status bench_bp(const char *directory, struct bench_goals *goals);

#endif
