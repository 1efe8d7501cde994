/* Seeded random numbers that any implementation can repeat: splitmix64 and Box-Muller. */
#ifndef SASBENCH_SCENE_RANDOM_H
#define SASBENCH_SCENE_RANDOM_H

#include <complex.h>
#include <stdint.h>

struct random {
    uint64_t state;
};

/* Stream `stream` of a seed: independent of every other stream, so that pairs can be drawn in any order. */
struct random random_seed(uint64_t seed, uint64_t stream);
/* Uniform in [0, 1): the upper 53 bits of the next splitmix64 output. */
double random_uniform(struct random *random);
/* Complex normal with E|z|^2 = 1: sqrt(-log(1 - u1)) exp(j 2 pi u2). */
double complex random_normal(struct random *random);

#endif
