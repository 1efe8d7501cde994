/* The processor's own limit, the reference for fractions of peak. */
#ifndef SASBENCH_COMMON_PEAK_H
#define SASBENCH_COMMON_PEAK_H

#include "contract/algorithm.h"
#include "common/isa.h"

/* FLOP/s of independent multiply-adds in registers (2 FLOPs a lane), on `threads` threads, with the instruction set
   that the engines use; the best of several measurements of some 20 ms. On a machine without fused multiply-adds: of
   separate ones. */
double peak_flops(enum precision precision, int threads);

/* One chunk of work for each instruction set: returns FLOPs done; *sink keeps the compiler honest. */
typedef double peak_function(long long rounds, volatile double *sink);
ISA_DECLARE(peak_function, peak);

#endif
