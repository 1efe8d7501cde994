/* Whole numbers. */
#ifndef SASBENCH_COMMON_COMMON_DIVISOR_H
#define SASBENCH_COMMON_COMMON_DIVISOR_H

/* The greatest one of a >= 1 and b >= 0. */
static inline int common_divisor(int a, int b)
{
    while (b > 0) {
        const int rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

#endif
