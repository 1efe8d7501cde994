/* Products of spectra, and complex values split into real and imaginary parts (planes.h). This file is compiled once
   for each precision and instruction set (BP_ISA names it). */
#include "backprojection/planes.h"

#include "common/lanes.h"

#define INLINE static inline __attribute__((always_inline))

enum { NUMBERS = LANES / 2 /* complex, of a vector */, WIDEST = 4 /* vectors of sums that stay in registers */ };

/* Of a vector of complex numbers: the real parts, the imaginary parts, each twice; both exchanged; the numbers in
   reverse. Of two vectors: the real parts, the imaginary parts. Of a vector of reals: each half, each value twice. */
#if VECTOR_BYTES / (4 + 4 * REAL_DOUBLE) == 8
#define REALS       0, 0, 2, 2, 4, 4, 6, 6
#define IMAGINARIES 1, 1, 3, 3, 5, 5, 7, 7
#define EXCHANGED   1, 0, 3, 2, 5, 4, 7, 6
#define REVERSED    6, 7, 4, 5, 2, 3, 0, 1
#define PART_REAL   0, 2, 4, 6, 8, 10, 12, 14
#define PART_IMAG   1, 3, 5, 7, 9, 11, 13, 15
#define FIRST_HALF  0, 0, 1, 1, 2, 2, 3, 3
#define SECOND_HALF 4, 4, 5, 5, 6, 6, 7, 7
#define BY_TURNS    -1, 1, -1, 1, -1, 1, -1, 1
#elif VECTOR_BYTES / (4 + 4 * REAL_DOUBLE) == 4
#define REALS       0, 0, 2, 2
#define IMAGINARIES 1, 1, 3, 3
#define EXCHANGED   1, 0, 3, 2
#define REVERSED    2, 3, 0, 1
#define PART_REAL   0, 2, 4, 6
#define PART_IMAG   1, 3, 5, 7
#define FIRST_HALF  0, 0, 1, 1
#define SECOND_HALF 2, 2, 3, 3
#define BY_TURNS    -1, 1, -1, 1
#else
#define REALS       0, 0
#define IMAGINARIES 1, 1
#define EXCHANGED   1, 0
#define REVERSED    0, 1
#define PART_REAL   0, 2
#define PART_IMAG   1, 3
#define FIRST_HALF  0, 0
#define SECOND_HALF 1, 1
#define BY_TURNS    -1, 1
#endif
#define SHUFFLE(v, ...) __builtin_shufflevector(v, v, __VA_ARGS__)

INLINE vector_real *at(const real *values)
{
    return (vector_real *)values;
}

/* x h, or x conj(h): `turns` is by_turns, or its negative. */
static const vector_real by_turns = {BY_TURNS};
INLINE vector_real product(vector_real x, vector_real h, vector_real turns)
{
    return x * SHUFFLE(h, REALS) + SHUFFLE(x, EXCHANGED) * SHUFFLE(h, IMAGINARIES) * turns;
}

/* The same of one number; `sign` of the imaginary part of h. */
INLINE void product_one(const real *x, const real *h, real sign, real *y)
{
    const real re = x[0] * h[0] - x[1] * (sign * h[1]);
    y[1] = x[0] * (sign * h[1]) + x[1] * h[0];
    y[0] = re;
}

/* The first `count` numbers. */
INLINE void products(const real *x, const real *h, size_t count, real *y)
{
    size_t k = 0;
    for (; k + NUMBERS <= count; k += NUMBERS)
        *at(y + 2 * k) = product(*at(x + 2 * k), *at(h + 2 * k), by_turns);
    for (; k < count; k++)
        product_one(x + 2 * k, h + 2 * k, 1, y + 2 * k);
}

static void filter(void *x, const void *h, size_t length)
{
    products(x, h, length, x);
}

static void turn(const void *spectrum, const void *factors, size_t length, void *values)
{
    const real *x = spectrum, *h = factors;
    real *y = values;
    const size_t below = (length + 1) / 2; /* bins from 0 to below fs/2 */
    size_t k = 1;
    products(x, h, below, y);
    for (; k + NUMBERS <= below; k += NUMBERS) {
        const size_t last = 2 * (length - k - NUMBERS + 1);
        *at(y + last) = product(*at(x + last), SHUFFLE(*at(h + 2 * k), REVERSED), -by_turns);
    }
    for (; k < below; k++)
        product_one(x + 2 * (length - k), h + 2 * k, -1, y + 2 * (length - k));
    if (length % 2 == 0) {
        y[length] = x[length] * h[length];
        y[length + 1] = x[length + 1] * h[length];
    }
}

static void weigh(const void *spectrum, const void *gains, bool imaginary, size_t length, void *values)
{
    const real *x = spectrum, *g = gains;
    real *y = values;
    size_t k = 0;
    for (; k + LANES <= length; k += LANES) {
        const vector_real gain = *at(g + k);
        vector_real low = *at(x + 2 * k), high = *at(x + 2 * k + LANES);
        if (imaginary) {
            low = SHUFFLE(low, EXCHANGED) * by_turns;
            high = SHUFFLE(high, EXCHANGED) * by_turns;
        }
        *at(y + 2 * k) = low * SHUFFLE(gain, FIRST_HALF);
        *at(y + 2 * k + LANES) = high * SHUFFLE(gain, SECOND_HALF);
    }
    for (; k < length; k++) {
        const real re = x[2 * k] * g[k], im = x[2 * k + 1] * g[k];
        y[2 * k] = imaginary ? -im : re;
        y[2 * k + 1] = imaginary ? re : im;
    }
}

/* `width` vectors of sums. */
INLINE void convolve_vectors(int width, const real *x, const double *weights, int taps, bool add, real *y)
{
    vector_real sums[WIDEST];
    for (int v = 0; v < width; v++)
        sums[v] = add ? *at(y + v * LANES) : (vector_real){0};
    for (int t = 0; t < taps; t++)
        for (int v = 0; v < width; v++)
            sums[v] += (real)weights[t] * *at(x + 2 * t + v * LANES);
    for (int v = 0; v < width; v++)
        *at(y + v * LANES) = sums[v];
}

static void convolve(const void *values, const double *weights, int taps, size_t count, bool add, void *sums)
{
    const real *x = values;
    real *y = sums;
    size_t k = 0;
    for (; k + WIDEST * LANES <= 2 * count; k += WIDEST * LANES)
        convolve_vectors(WIDEST, x + k, weights, taps, add, y + k);
    for (; k + LANES <= 2 * count; k += LANES)
        convolve_vectors(1, x + k, weights, taps, add, y + k);
    for (; k < 2 * count; k++) {
        y[k] = add ? y[k] : 0;
        for (int t = 0; t < taps; t++)
            y[k] += (real)weights[t] * x[k + 2 * (size_t)t];
    }
}

static void part(const void *values, size_t count, size_t block, void *parts)
{
    const real *from = values;
    real *to = parts;
    const size_t filled = count < block ? count : block;
    size_t i = 0;
    for (; i + LANES <= filled; i += LANES) {
        const vector_real a = *at(from + 2 * i), b = *at(from + 2 * i + LANES);
        *at(to + i) = __builtin_shufflevector(a, b, PART_REAL);
        *at(to + block + i) = __builtin_shufflevector(a, b, PART_IMAG);
    }
    for (; i < filled; i++) {
        to[i] = from[2 * i];
        to[block + i] = from[2 * i + 1];
    }
    for (; i < block; i++)
        to[i] = to[block + i] = 0;
}

static void part_blocks(const void *values, size_t count, size_t blocks, size_t block, size_t step, void *to)
{
    const size_t advance = block / 2;
    for (size_t k = 0; k < blocks; k++) {
        const size_t first = k * advance < count ? k * advance : count;
        part((const real *)values + 2 * first, count - first, block, (real *)to + k * step);
    }
}

const struct planes REAL_ISA_NAME(planes) = {filter, turn, weigh, convolve, part, part_blocks};
