/* What the general engine's two inner files share: runs of pixels. bp_sum.c fills them in, bp_take.c adds what they take
   from the records to the sums. */
#ifndef SASBENCH_BACKPROJECTION_GENERAL_RUN_H
#define SASBENCH_BACKPROJECTION_GENERAL_RUN_H

#include "backprojection/general/sum.h"
#include "common/lanes.h"

/* Are there vectors of float with instructions that no compiler makes of portable code: windows of four values are permuted as
   one, vectors rounded as one? */
#if defined __AVX__ && !REAL_DOUBLE
#define WINDOWS 1
#else
#define WINDOWS 0
#endif

#define INLINE static inline __attribute__((always_inline))

enum {
    RUN = 256, /* pixels at a time: a group's runs stay in the first-level cache */
    GROUP = 4, /* receivers that are summed together: sums are loaded and stored once for all */
    PARTS = LANES * sizeof(double) / VECTOR_BYTES /* vectors of doubles to a vector of `real` */
};

typedef double vector_double __attribute__((vector_size(VECTOR_BYTES)));
typedef int vector_int __attribute__((vector_size(LANES * sizeof(int)), aligned(sizeof(int)), may_alias));
typedef float vector_bits __attribute__((vector_size(VECTOR_BYTES))); /* moved, not computed with */

/* How the samples of neighbouring pixels are loaded. */
enum loading {
    APART,   /* each by itself */
    FOURS,   /* those of four pixels at once: at most half a sample from pixel to pixel */
    TOGETHER /* those of a vector at once: at most 2/LANES */
};

/* Where a run of pixels reads a record. */
struct run {
    int base;                               /* sample of the upsampled record from which the others are counted */
    _Alignas(VECTOR_BYTES) int sample[RUN]; /* on from which the taps are counted */
    _Alignas(VECTOR_BYTES) int phase[RUN];  /* row of the table of weights; where one is used */
    _Alignas(VECTOR_BYTES) real rest[RUN];  /* position in the interval of a cubic, or a line's fraction */
    _Alignas(VECTOR_BYTES) real turns[RUN]; /* phase, |turns| <= 1/2 */
};

/* Add one run of each of `group` <= GROUP records, whose rows follow one another from `row` on (struct bp_ping), to
   `count` pixels. Changes what the runs hold behind them. */
#define BP_TAKE REAL_ISA_NAME(bp_take)
void BP_TAKE(const struct bp_table *table, enum loading loading, int group, const void *row, int row_length, int count,
             struct run *runs, void *re, void *im);

INLINE vector_real *at(const real *values)
{
    return (vector_real *)values;
}

/* PART: the order of pixels in the parts of a vector, from which one shuffle takes the low halves of all (EVEN) or the high
   ones (ODD) as they come. ALL: all pixels in order. */
#if REAL_DOUBLE
#define ALL(v) PART(v, 0)
#if VECTOR_BYTES == 64
#define PART(v, n)                                                                                                     \
    {                                                                                                                  \
        v(0), v(1), v(2), v(3), v(4), v(5), v(6), v(7)                                                                 \
    }
#define EVEN 0, 2, 4, 6, 8, 10, 12, 14
#define ODD  1, 3, 5, 7, 9, 11, 13, 15
#elif VECTOR_BYTES == 32
#define PART(v, n)                                                                                                     \
    {                                                                                                                  \
        v(0), v(1), v(2), v(3)                                                                                         \
    }
#define EVEN 0, 2, 4, 6
#define ODD  1, 3, 5, 7
#else
#define PART(v, n)                                                                                                     \
    {                                                                                                                  \
        v(0), v(1)                                                                                                     \
    }
#define EVEN 0, 2
#define ODD  1, 3
#endif
#else
#if VECTOR_BYTES == 64
#define PART(v, n)                                                                                                     \
    {                                                                                                                  \
        v(n), v(n + 1), v(n + 4), v(n + 5), v(n + 8), v(n + 9), v(n + 12), v(n + 13)                                   \
    }
#define EVEN 0, 2, 16, 18, 4, 6, 20, 22, 8, 10, 24, 26, 12, 14, 28, 30
#define ODD  1, 3, 17, 19, 5, 7, 21, 23, 9, 11, 25, 27, 13, 15, 29, 31
#define ALL(v)                                                                                                         \
    {                                                                                                                  \
        v(0), v(1), v(2), v(3), v(4), v(5), v(6), v(7), v(8), v(9), v(10), v(11), v(12), v(13), v(14), v(15)           \
    }
#elif VECTOR_BYTES == 32
#define PART(v, n)                                                                                                     \
    {                                                                                                                  \
        v(n), v(n + 1), v(n + 4), v(n + 5)                                                                             \
    }
#define EVEN 0, 2, 8, 10, 4, 6, 12, 14
#define ODD  1, 3, 9, 11, 5, 7, 13, 15
#define ALL(v)                                                                                                         \
    {                                                                                                                  \
        v(0), v(1), v(2), v(3), v(4), v(5), v(6), v(7)                                                                 \
    }
#else
#define PART(v, n)                                                                                                     \
    {                                                                                                                  \
        v(n), v(n + 1)                                                                                                 \
    }
#define EVEN 0, 2, 4, 6
#define ODD  1, 3, 5, 7
#define ALL(v)                                                                                                         \
    {                                                                                                                  \
        v(0), v(1), v(2), v(3)                                                                                         \
    }
#endif
#endif

#endif
