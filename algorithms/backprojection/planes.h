/* What range compression does with whole records between its transforms and behind them (traces.h), in vectors. */
#ifndef SASBENCH_BACKPROJECTION_PLANES_H
#define SASBENCH_BACKPROJECTION_PLANES_H

#include <stdbool.h>
#include <stddef.h>

/* All arrays are of the build's precision. */
struct planes {
    /* x[k] h[k] into x, complex [length]. */
    void (*filter)(void *x, const void *h, size_t length);
    /* A spectrum times factors of which those of negative frequencies are the conjugates, complex [length/2 + 1] from
       frequency 0 to fs/2, into y. The bin at fs/2 takes the mean of both, half of it at either end of the band. */
    void (*turn)(const void *x, const void *h, size_t length, void *y);
    /* A spectrum times real gains [length], times the imaginary unit as well where they are `imaginary`, into y. */
    void (*weigh)(const void *x, const void *gains, bool imaginary, size_t length, void *y);
    /* Complex values [count] into `count` real parts every `apart` and as many imaginary parts `block` behind: blocks
       of `block` values, each `step` behind the last one's beginning. What the last one does not fill becomes 0. */
    void (*part)(const void *values, size_t count, size_t block, size_t step, void *to);
};

extern const struct planes planes_float_baseline, planes_double_baseline;
extern const struct planes planes_float_v3, planes_double_v3;
extern const struct planes planes_float_v4, planes_double_v4;

#endif
