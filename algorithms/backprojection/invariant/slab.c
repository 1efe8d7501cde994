/* A tile of compressed pings into the slab (slab.h): squares of as many values as a vector has lanes are
   transposed in registers. This file is compiled once for each precision and instruction set (BP_ISA names it). */
#include "backprojection/invariant/slab.h"

#include "common/lanes.h"

#define INLINE     static inline __attribute__((always_inline))
#define BP_SCATTER REAL_ISA_NAME(bp_scatter)

/* LOWS, HIGHS: values of two vectors by turns, of their first and of their second halves. */
#if VECTOR_BYTES / (4 + 4 * REAL_DOUBLE) == 16
#define LOWS  0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23
#define HIGHS 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31
#elif VECTOR_BYTES / (4 + 4 * REAL_DOUBLE) == 8
#define LOWS  0, 8, 1, 9, 2, 10, 3, 11
#define HIGHS 4, 12, 5, 13, 6, 14, 7, 15
#elif VECTOR_BYTES / (4 + 4 * REAL_DOUBLE) == 4
#define LOWS  0, 4, 1, 5
#define HIGHS 2, 6, 3, 7
#else
#define LOWS  0, 2
#define HIGHS 1, 3
#endif

/* Each round takes vectors k and k + LANES/2 by turns: after as many rounds as LANES has bits the square is
   transposed. */
INLINE void transpose(vector_real *v)
{
    vector_real w[LANES];
    for (int round = 1; round < LANES; round *= 2) {
        for (int k = 0; k < LANES / 2; k++) {
            w[2 * k] = __builtin_shufflevector(v[k], v[k + LANES / 2], LOWS);
            w[2 * k + 1] = __builtin_shufflevector(v[k], v[k + LANES / 2], HIGHS);
        }
        for (int k = 0; k < LANES; k++)
            v[k] = w[k];
    }
}

/* Samples [i, i + LANES/2) of pings [ping, ping + LANES), of which there are `count`; the others become 0. */
INLINE void scatter_square(const struct bp_scattering *s, const real *from, size_t i, int ping, int count)
{
    vector_real v[LANES];
    real *re = (real *)s->re + i * s->step + (size_t)ping, *im = (real *)s->im + i * s->step + (size_t)ping;
    for (int k = 0; k < LANES; k++)
        v[k] = ping + k < count ? *(const vector_real *)(from + 2 * ((size_t)(ping + k) * s->pitch + i))
                                : (vector_real){0};
    transpose(v);
    for (int k = 0; k < LANES / 2; k++) {
        *(vector_real *)(re + (size_t)k * s->step) = v[2 * k];
        *(vector_real *)(im + (size_t)k * s->step) = v[2 * k + 1];
    }
}

void BP_SCATTER(const struct bp_scattering *s, const void *tile, int count)
{
    const size_t whole = s->samples / (LANES / 2) * (LANES / 2);
    const real *from = tile;
    for (size_t i = 0; i < whole; i += LANES / 2)
        for (int ping = 0; ping < count; ping += LANES)
            scatter_square(s, from, i, ping, count);
    for (size_t i = whole; i < s->samples; i++)
        for (int ping = 0; ping < count; ping++) {
            const real *value = from + 2 * ((size_t)ping * s->pitch + i);
            ((real *)s->re)[i * s->step + (size_t)ping] = value[0];
            ((real *)s->im)[i * s->step + (size_t)ping] = value[1];
        }
}
