/* The interval of a ratio of times (ab_interval.h). */
#include "gate/ab_interval.h"

#include <math.h>
#include <string.h>

#include "measure/timing.h"

/* Student's t of this many degrees of freedom that is exceeded with probability `miss` (Abramowitz and Stegun
   26.7.5). */
static double student(double miss, int degrees)
{
    double low = 0, high = 40, n = degrees;
    for (int k = 0; k < 60; k++) {
        double middle = (low + high) / 2;
        if (0.5 * erfc(middle * M_SQRT1_2) > miss)
            low = middle;
        else
            high = middle;
    }
    double z = low, z2 = z * z;
    return z + z * (z2 + 1) / (4 * n) + z * ((5 * z2 + 16) * z2 + 3) / (96 * n * n)
           + z * (((3 * z2 + 19) * z2 + 17) * z2 - 15) / (384 * n * n * n);
}

struct ab_interval ab_interval_find(double (*ratios)[AB_BLOCKS], int rounds, double miss)
{
    double sum = 0, squares = 0;
    for (int k = 0; k < rounds; k++) {
        double blocks[AB_BLOCKS];
        memcpy(blocks, ratios[k], sizeof blocks);
        const double ratio = log(median(blocks, AB_BLOCKS));
        sum += ratio;
        squares += ratio * ratio;
    }
    const double middle = sum / rounds, variance = fmax(0, squares / rounds - middle * middle) / (rounds - 1);
    const double side = student(miss, rounds - 1) * sqrt(variance);
    return (struct ab_interval){exp(middle - side), exp(middle), exp(middle + side)};
}

enum verdict ab_interval_verdict(const struct ab_interval *interval)
{
    if (interval->low > 1 + EFFECT_FAIL)
        return VERDICT_WORSE;
    if (interval->low > 1 + EFFECT_WARN)
        return VERDICT_WARNING;
    if (interval->high < 1 / (1 + EFFECT_WARN))
        return VERDICT_BETTER;
    return interval->high < 1 + EFFECT_FAIL ? VERDICT_SAME : VERDICT_NOISY;
}
