/* Multiply-adds without memory (peak.h): enough independent chains to hide their latency, but not more than the
   registers. */
#include "common/lanes.h"
#include "common/peak.h"

/* Separate variables: the compiler keeps an array in memory. */
#define CHAINS(each) each(0) each(1) each(2) each(3) each(4) each(5) each(6) each(7) each(8) each(9) each(10) each(11)
enum { COUNT = 12 };

double REAL_ISA_NAME(peak)(long long rounds, volatile double *sink)
{
    vector_real all = {0}, factor, step;
    for (int l = 0; l < LANES; l++) {
        factor[l] = (real)0.5;
        step[l] = (real)(1 + l);
    }
#define BEGIN(k) vector_real sum##k = step * (real)k;
#define ROUND(k) sum##k = sum##k * factor + step;
#define KEEP(k)  __asm__ volatile("" : "+x"(sum##k));
#define END(k)   all += sum##k;
    CHAINS(BEGIN)
    for (long long n = 0; n < rounds; n++) {
        CHAINS(ROUND)
        CHAINS(KEEP) /* the compiler may neither merge rounds nor move them out of the loop */
    }
    CHAINS(END)
    double total = 0;
    for (int l = 0; l < LANES; l++)
        total += all[l];
    *sink = total;
    return 2.0 * COUNT * LANES * (double)rounds;
}
