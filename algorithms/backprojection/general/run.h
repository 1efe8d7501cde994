/* What the general engine's two inner files share: runs of pixels. sum.c fills them in, gather.c adds what they take
   from the records to the sums. sum.h has the error budget.

   A RUN OF PIXELS. A line of pixels is cut into blocks (blocks.c). In each block the delay to a receiver is a quintic
   through six exact delays at Chebyshev points (x). A block is cut into runs of at most RUN pixels. A run is worked on
   by vectors of LANES pixels, for GROUP receivers at a time:

       pixels      begin                             middle                              end
       block       |x---------x---------------x-----------------x---------------x---------x|
       runs        |-------- run --------|-------- run --------|-------- run --------|-run-|
       vectors     |0..7|8..15|...

   A run holds for each of its pixels i: the place in the record, base + sample[i]; the row of the table of weights,
   step[i], or the fraction, rest[i]; and the phase in cycles, cycles[i]. The record's value at this place, times
   exp(j 2 pi cycles[i]), is added to the pixel.

   ITS GATHER (one tap, or two on a line; more taps are loaded pixel by pixel). Loads are the limit. Neighbouring pixels
   mostly read the same samples. In float with AVX, one load of four samples, a window, serves a whole vector (TOGETHER)
   or four pixels (FOURS). An example of eight pixels, 0.24 samples apart. m = sample[3] is the sample of the middle
   pixel, LANES/2 - 1:

       pixel        0     1     2     3     4     5     6     7
       position   m-.42 m-.18 m+.06 m+.30 m+.54 m+.78 m+1.02 m+1.26
       sample      m-1   m-1    m     m     m     m    m+1   m+1
       place        0     0     1     1     1     1     2     2      sample + 1 - m: index into the window

       window     [ m-1,  m,  m+1,  m+2 ]       value = window[place]; on a line also next = window[place + 1]

   A pixel is at most LANES/2 pixels from the middle one. A slope below 2/LANES samples a pixel keeps its sample within
   one of m. A slope below 1/2 does so for four pixels. sum_block chooses by the slope, with a slack of 0.01 for
   rounding. On steeper slopes, in double and without AVX each pixel loads its own samples (APART).

   PART, EVEN, ODD: an example of 8 lanes (float, AVX2). Positions are double, so that 8 pixels are two vectors of 4
   doubles. The cheapest shuffle works inside each 128 bits, and takes two words of either operand there. PART orders
   the pixels so that one such shuffle brings them in order. With l the low and h the high word of a pixel's double:

       before     PART(v, 0)   pixels 0 1 4 5     words  l0 h0 l1 h1 | l4 h4 l5 h5     indices 0 to 7
                  PART(v, 2)   pixels 2 3 6 7     words  l2 h2 l3 h3 | l6 h6 l7 h7     indices 8 to 15
       after      EVEN   indices 0 2  8 10 4 6 12 14     l0 l1 l2 l3 | l4 l5 l6 l7     pixels 0 to 7
                  ODD    indices 1 3  9 11 5 7 13 15     h0 h1 h2 h3 | h4 h5 h6 h7

   gather_two (gather.c) uses the same order for two neighbouring floats that it moves as one double. EVEN then gives
   the values, ODD the next ones.

   FIXED-POINT NUMBERS IN DOUBLES (points and points_flat in sum.c). A double has 1 bit of sign, 11 of exponent and 52
   of mantissa. Its high word holds sign, exponent and 20 bits of the mantissa, its low word the other 32. To a number
   of magnitude below 2^(n-1), add 1.5 times 2^n: the exponent becomes n, whatever the number's sign. The last bit is
   then worth 2^(n-52), and the mantissa's lower bits are the number in two's complement. n = 52 rounds to a whole
   number:

       added      last bit   high word, 20 bits        low word, 32 bits
       0x1.8p52   1          -                         whole number                             (not used here)
       0x1.8p33   2^-19      more of the whole part    13 bits of whole part, sign included; 19 of fraction (BITS)
       0x1.8p20   2^-32      whole part                32 bits of fraction

   Where the index comes from, by the way of reading (enum bp_reading):

       BP_NEAREST             0x1.8p20   sample = high word - 0x41380000, which is the high word of 0x1.8p20
       BP_LINE, BP_STEPS     0x1.8p33   sample = low word >> 19; step = fraction x steps >> 19 (steps <= 2^12)
       BP_CUBICS              0x1.8p33   all 64 bits >> 19 leave 32 bits of whole part: interval = its lowest 8 bits
                                         (BP_INTERVAL_BITS), sample = the others; rest = fraction 2^-19
       phase in cycles        0x1.8p20   low word as a signed number, times 2^-32: -1/2 to 1/2, whole cycles drop out

   13 bits are -4096 to 4095 points: run.base is taken off, and a run spans at most SPAN = 4000 points. Half a step is
   added before (scale.shift) where positions are rounded to the nearest step, as cutting bits off is floor. */
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
    int base;                                /* sample of the upsampled record from which the others are counted */
    _Alignas(VECTOR_BYTES) int sample[RUN];  /* on from which the taps are counted */
    _Alignas(VECTOR_BYTES) int step[RUN];    /* row of the table of weights; where one is used */
    _Alignas(VECTOR_BYTES) real rest[RUN];   /* position in the interval of a cubic, or a line's fraction */
    _Alignas(VECTOR_BYTES) real cycles[RUN]; /* phase, |cycles| <= 1/2 */
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
