/* Complex numbers in the vectors of lanes.h, real and imaginary parts in turn. */
#ifndef SASBENCH_WAVENUMBER_COMPLEX_LANES_H
#define SASBENCH_WAVENUMBER_COMPLEX_LANES_H

#include "common/lanes.h"

#define COMPLEX_LANES (VECTOR_BYTES / (REAL_DOUBLE ? 16 : 8))

/* Of two vectors: their even and their odd complex numbers. Of one vector of reals: its first and its second half, each
   number twice. */
#if COMPLEX_LANES == 8
#define COMPLEX_EVEN(a, b) __builtin_shufflevector(a, b, 0, 1, 4, 5, 8, 9, 12, 13, 16, 17, 20, 21, 24, 25, 28, 29)
#define COMPLEX_ODD(a, b)  __builtin_shufflevector(a, b, 2, 3, 6, 7, 10, 11, 14, 15, 18, 19, 22, 23, 26, 27, 30, 31)
#define TWICE_FIRST(a)     __builtin_shufflevector(a, a, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7)
#define TWICE_SECOND(a)    __builtin_shufflevector(a, a, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13, 14, 14, 15, 15)
#elif COMPLEX_LANES == 4
#define COMPLEX_EVEN(a, b) __builtin_shufflevector(a, b, 0, 1, 4, 5, 8, 9, 12, 13)
#define COMPLEX_ODD(a, b)  __builtin_shufflevector(a, b, 2, 3, 6, 7, 10, 11, 14, 15)
#define TWICE_FIRST(a)     __builtin_shufflevector(a, a, 0, 0, 1, 1, 2, 2, 3, 3)
#define TWICE_SECOND(a)    __builtin_shufflevector(a, a, 4, 4, 5, 5, 6, 6, 7, 7)
#elif COMPLEX_LANES == 2
#define COMPLEX_EVEN(a, b) __builtin_shufflevector(a, b, 0, 1, 4, 5)
#define COMPLEX_ODD(a, b)  __builtin_shufflevector(a, b, 2, 3, 6, 7)
#define TWICE_FIRST(a)     __builtin_shufflevector(a, a, 0, 0, 1, 1)
#define TWICE_SECOND(a)    __builtin_shufflevector(a, a, 2, 2, 3, 3)
#else /* one: there is nothing to part */
#define COMPLEX_EVEN(a, b) (a)
#define COMPLEX_ODD(a, b)  (b)
#define TWICE_FIRST(a)     __builtin_shufflevector(a, a, 0, 0)
#define TWICE_SECOND(a)    __builtin_shufflevector(a, a, 1, 1)
#endif

static inline vector_real lanes_load(const real *from)
{
    return *(const vector_real *)from;
}

static inline void lanes_store(real *to, vector_real value)
{
    *(vector_real *)to = value;
}

#endif
