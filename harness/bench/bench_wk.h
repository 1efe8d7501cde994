/* Omega-k in `bench`: at 3840 x 4096 broadside against FFTW's own transforms, and the ways to image a squint side by
   side. */
#ifndef SASBENCH_BENCH_BENCH_WK_H
#define SASBENCH_BENCH_BENCH_WK_H

#include "bench/bench_goals.h"

/* Prints, and writes bench_wk.csv into the folder. Errors: STATUS_FAILED. */
enum status bench_wk(const char *directory, struct bench_goals *goals);

#endif
