#include "common/peak.h"

#include <math.h>

double peak_flops(enum precision precision, int threads)
{
    enum { ROUNDS = 5000000, TRIES = 7 };
    peak_function *work = ISA_CHOOSE(peak, precision);
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
