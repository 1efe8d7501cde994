/* Vector loops of range compression over whole records, between and behind its transforms (traces.h). */
#ifndef SASBENCH_BACKPROJECTION_PLANES_H
#define SASBENCH_BACKPROJECTION_PLANES_H

#include <stdbool.h>
#include <stddef.h>

#include "contract/algorithm.h"

/* All arrays are of the build's precision. */
struct planes {
    /* A spectrum, complex [length], times the filter h, complex [length], in its place. */
    void (*filter)(void *x, const void *h, size_t length);
    /* A spectrum times factors, complex [length/2 + 1] from frequency 0 to fs/2, conjugated at negative frequencies,
       into y. The bin at fs/2 belongs to both ends of the band: it takes the factors' mean. */
    void (*turn)(const void *x, const void *h, size_t length, void *y);
    /* A spectrum times real gains [length] into y; times the imaginary unit as well where they are `imaginary`. */
    void (*weigh)(const void *x, const void *gains, bool imaginary, size_t length, void *y);
    /* Sums of `taps` neighbours, y[k] = sum over t of weights[t] x[k + t], complex [count]; `add`: add to y. */
    void (*convolve)(const void *x, const double *weights, int taps, size_t count, bool add, void *y);
    /* Complex values [count] into a block of `block` real parts and as many imaginary ones; 0 behind the last value. */
    void (*part)(const void *values, size_t count, size_t block, void *to);
    /* The same into `blocks` blocks, each beginning block/2 values after the one before, and stored `step` values
       behind it. */
    void (*part_blocks)(const void *values, size_t count, size_t blocks, size_t block, size_t step, void *to);
};

/* The build for this machine. */
const struct planes *planes_choose(enum precision precision);

extern const struct planes planes_float_baseline, planes_double_baseline;
extern const struct planes planes_float_v3, planes_double_v3;

#endif
