/* The bootstrap interval of a ratio of times (ab_interval.h). */
#include "gate/ab_interval.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/random.h"

enum { DRAWS = 4000 };

struct value {
    double ratio;
    int round;
};

static int value_order(const void *a, const void *b)
{
    double x = ((const struct value *)a)->ratio, y = ((const struct value *)b)->ratio;
    return (x > y) - (x < y);
}

static int number_order(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Median of sorted values, each of which counts as often as its round was drawn. */
static double weighted_median(const struct value *values, int count, const int *drawn)
{
    int passed = 0, k = 0;
    while (2 * (passed + drawn[values[k].round]) < count)
        passed += drawn[values[k++].round];
    int next = k;
    if (2 * (passed + drawn[values[k].round]) == count) /* between this one and the next that counts */
        do
            next++;
        while (drawn[values[next].round] == 0);
    return sqrt(values[k].ratio * values[next].ratio);
}

/* How far out Student's t of this many degrees of freedom lies that is exceeded with probability `miss`, by how far
   the normal one lies that is exceeded with probability 1/40 (Abramowitz and Stegun 26.7.5). */
static double reach(double miss, int degrees)
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
    return (z + z * (z2 + 1) / (4 * n) + z * ((5 * z2 + 16) * z2 + 3) / (96 * n * n)
            + z * (((3 * z2 + 19) * z2 + 17) * z2 - 15) / (384 * n * n * n))
           / 1.959964;
}

enum status ab_interval_find(const double *ratios, int rounds, int blocks, double miss, struct ab_interval *interval)
{
    int count = rounds * blocks;
    struct value *values = calloc((size_t)count, sizeof *values);
    double *medians = calloc(DRAWS, sizeof *medians);
    int *drawn = calloc((size_t)rounds, sizeof *drawn);
    enum status status = STATUS_OK;
    if (values && medians && drawn) {
        struct random random = random_seed(1, 0);
        for (int k = 0; k < count; k++)
            values[k] = (struct value){ratios[k], k / blocks};
        qsort(values, (size_t)count, sizeof *values, value_order);
        for (int k = 0; k < rounds; k++)
            drawn[k] = 1;
        interval->middle = weighted_median(values, count, drawn);
        for (int n = 0; n < DRAWS; n++) {
            memset(drawn, 0, (size_t)rounds * sizeof *drawn);
            for (int k = 0; k < rounds; k++)
                drawn[(int)(rounds * random_uniform(&random))]++;
            medians[n] = weighted_median(values, count, drawn);
        }
        qsort(medians, DRAWS, sizeof *medians, number_order);
        double wider = reach(miss, rounds - 1) * sqrt(rounds / (rounds - 1.0));
        double side = fmax(medians[DRAWS - 1 - DRAWS / 40] / interval->middle, interval->middle / medians[DRAWS / 40]);
        interval->low = interval->middle / pow(side, wider);
        interval->high = interval->middle * pow(side, wider);
    } else {
        status = status_set(STATUS_FAILED, "no memory for %d ratios of times", count);
    }
    free(values);
    free(medians);
    free(drawn);
    return status;
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
