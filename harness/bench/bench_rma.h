/* Range migration's part of the command `bench`. */
#ifndef SASBENCH_BENCH_BENCH_RMA_H
#define SASBENCH_BENCH_BENCH_RMA_H

#include "bench/bench_goals.h"

/* Measure range migration at the size of LBF21's real data into DIRECTORY/bench_rma.csv and on standard output: the
   phase stage against libm (the same formula with sines and cosines for each cell, and those sines and cosines alone),
   the stages after it, and the whole against FFTW's 2-D transforms of the same size. About a minute, half of it the
   stage with libm. Errors: what scene_load, scene_simulate, plan or execute return; STATUS_INVALID where the file
   cannot be written. */
enum status bench_rma(const char *directory, struct bench_goals *goals);

#endif
