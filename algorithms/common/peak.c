#include "common/peak.h"

#include <math.h>

#include "common/isa.h"

static peak_function *const functions[][2] = {
    [ISA_BASELINE] = {peak_float_baseline, peak_double_baseline},
#ifdef SASBENCH_X86_64
    [ISA_V3] = {peak_float_v3, peak_double_v3},
    [ISA_V4] = {peak_float_v4, peak_double_v4},
#endif
};

double peak_flops(enum precision precision, int threads)
{
    enum { ROUNDS = 5000000, TRIES = 7 };
    peak_function *work = functions[isa_choose()][precision];
    double best = 0;
    for (int n = 0; n < TRIES; n++) {
        double flops = 0, begin = seconds_now();
#pragma omp parallel num_threads(threads) reduction(+ : flops)
        {
            volatile double sink;
            flops += work(ROUNDS, &sink);
        }
        best = fmax(best, flops / (seconds_now() - begin));
    }
    return best;
}
