/* Multiply-adds without memory (peak.h): enough independent chains to hide their latency, few enough for the registers. */
#include "lanes.h"
#include "peak.h"

enum { CHAINS = 12 };

double REAL_ISA_NAME(peak)(long long rounds, volatile double *sink)
{
    vector_real sum[CHAINS], factor, step;
    for (int l = 0; l < LANES; l++) {
        factor[l] = (real)0.5;
        step[l] = (real)(1 + l);
    }
    for (int k = 0; k < CHAINS; k++)
        sum[k] = step * (real)k;
    for (long long n = 0; n < rounds; n++) {
        for (int k = 0; k < CHAINS; k++)
            sum[k] = sum[k] * factor + step;
        /* The compiler may neither merge rounds nor move them out of the loop. */
        for (int k = 0; k < CHAINS; k++)
            __asm__ volatile("" : "+x"(sum[k]));
    }
    double total = 0;
    for (int k = 0; k < CHAINS; k++)
        for (int l = 0; l < LANES; l++)
            total += sum[k][l];
    *sink = total;
    return 2.0 * CHAINS * LANES * (double)rounds;
}
