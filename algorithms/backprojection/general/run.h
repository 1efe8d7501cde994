/* Runs of pixels, for the general engine's inner files. runs.c makes them from a block's delays; gather.c reads the
   records and adds to the sums. budget.h has the error budget.

   A RUN OF PIXELS. A line of pixels is cut into blocks (blocks.c). In each block the delay to a receiver is a quintic
   through six exact delays at Chebyshev points (x). A block is cut into runs of at most RUN_PIXELS pixels. A run is
   worked on by vectors of LANES pixels, for GROUP_RECEIVERS receivers at a time:

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
   one of m. A slope below 1/2 does so for four pixels. loading_choose does so by the slope, with a slack of 0.01 for
   rounding. On steeper slopes, in double and without AVX each pixel loads its own samples (APART).

   Farrow branches (BP_BRANCHES) take a window from each branch with AVX2 in either precision. It is a vector from
   MIDDLE_LANE samples before m on; the pixel furthest from the middle, LANES/2 away, must be less than MIDDLE_LANE
   samples from it: slopes below 1 - 2/LANES. With AVX-512 windows are whole blocks of LANES samples, which begin
   BLOCK_ADVANCE = LANES/2 samples apart, at cache lines, all branches of a block side by side. m lies in the middle
   half of its window: of one block on slopes below 1/2 (TOGETHER), of two that follow without a gap below 1 (FOURS).
   An example of 8 lanes, m = 14:

       samples      0   4   8   12  16  20  24
       block 1          |------m|               m - LANES/2 < 8, the middle half ends before
       block 2              |--:-m--:|          TOGETHER: the furthest pixel is at most 4 samples away
       blocks 1, 3      |---:--m----:----|      FOURS: at most 8

   PART, EVEN, ODD: an example of 8 lanes (float, AVX2). Positions are double, so that 8 pixels are two vectors of 4
   doubles. The cheapest shuffle works inside each 128 bits, and takes two words of either operand there. PART orders
   the pixels so that one such shuffle brings them in order. With l the low and h the high word of a pixel's double:

       before     PART(v, 0)   pixels 0 1 4 5     words  l0 h0 l1 h1 | l4 h4 l5 h5     indices 0 to 7
                  PART(v, 2)   pixels 2 3 6 7     words  l2 h2 l3 h3 | l6 h6 l7 h7     indices 8 to 15
       after      EVEN   indices 0 2  8 10 4 6 12 14     l0 l1 l2 l3 | l4 l5 l6 l7     pixels 0 to 7
                  ODD    indices 1 3  9 11 5 7 13 15     h0 h1 h2 h3 | h4 h5 h6 h7

   gather_two (gather.c) uses the same order for two neighbouring floats that it moves as one double. EVEN then gives
   the values, ODD the next ones.

   FIXED-POINT NUMBERS IN DOUBLES (points and points_flat in runs.c). A double has 1 bit of sign, 11 of exponent and 52
   of mantissa. Its high word holds sign, exponent and 20 bits of the mantissa, its low word the other 32. To a number
   of magnitude below 2^(n-1), add 1.5 times 2^n: the exponent becomes n, whatever the number's sign. The last bit is
   then worth 2^(n-52), and the mantissa's lower bits are the number in two's complement:

       added      = 1.5 times   last bit   high word, 20 bits        low word, 32 bits
       FIXED_19   2^33          2^-19      more of the whole part    13 bits of whole part with sign; 19 of fraction
       FIXED_32   2^20          2^-32      whole part                32 bits of fraction

   Where the index comes from, by the way of reading (enum bp_reading):

       BP_NEAREST             FIXED_32   sample = high word - FIXED_32_HIGH, which is the high word of FIXED_32
       BP_BRANCHES            FIXED_32   the same; rest = low word 2^-32 - 1/2, the distance from the sample
       BP_LINE, BP_STEPS      FIXED_19   sample = low word >> 19; step = fraction x steps >> 19 (steps <= BP_STEPS_MOST)
       BP_CUBICS              FIXED_19   all 64 bits >> 19 leave 32 bits of whole part: interval = its lowest 8 bits
                                         (BP_INTERVAL_BITS), sample = the others; rest = fraction 2^-19
       phase in cycles        FIXED_32   low word as a signed number, times 2^-32: -1/2 to 1/2, whole cycles drop out

   In double with AVX, what FIXED_32 does is done by instructions that round (FRACTION, NEAREST in runs.c).

   13 bits are -4096 to 4095 points: run.base is subtracted, and a run spans at most POINTS_MOST points, but for cubics.
   Half a step is added before (scale.shift) where positions are rounded to the nearest step, as cutting bits off is
   floor. */
#ifndef SASBENCH_BACKPROJECTION_GENERAL_RUN_H
#define SASBENCH_BACKPROJECTION_GENERAL_RUN_H

#include "backprojection/general/sum.h"
#include "common/lanes.h"

/* Are there vectors of float, with instructions that no compiler makes of portable code: to permute a window of four
   values, to round a vector? */
#if defined __AVX__ && !REAL_DOUBLE
#define WINDOWS 1
#else
#define WINDOWS 0
#endif
/* Is there an instruction that permutes a whole vector by another one? */
#if defined __AVX2__
#define PERMUTES 1
#else
#define PERMUTES 0
#endif
/* Can it permute two vectors? Then the samples of Farrow branches lie in blocks (struct bp_layout). */
#define BLOCKS        (VECTOR_BYTES == 64)
#define BLOCK_ADVANCE (LANES / 2) /* samples from one block to the next */

#define INLINE static inline __attribute__((always_inline))

enum {
    NODES = 6,                     /* of a quintic */
    RUN_PIXELS = 256,              /* pixels at a time: a group's runs stay in the first-level cache */
    RUN_ROOM = RUN_PIXELS + LANES, /* of a run: its last vector may begin at any pixel */
    GROUP_RECEIVERS = BP_RECORDS,  /* that are summed together: sums are loaded and stored once for all */
    PARTS = LANES * sizeof(double) / VECTOR_BYTES /* vectors of doubles to a vector of `real` */
};

typedef double vector_double __attribute__((vector_size(VECTOR_BYTES)));
typedef int vector_int __attribute__((vector_size(LANES * sizeof(int)), aligned(sizeof(int)), may_alias));
typedef float vector_bits __attribute__((vector_size(VECTOR_BYTES))); /* moved, not computed with */

/* How the samples of neighbouring pixels are loaded. */
enum loading {
    APART,    /* each by itself */
    FOURS,    /* those of four pixels at once: at most half a sample from pixel to pixel. Branches: out of two blocks */
    TOGETHER, /* those of a vector at once: at most 2/LANES. Branches: out of one window */
    EXACT     /* each by itself, with full phase factors: where every delay is evaluated */
};

/* Where a run of pixels reads a record. */
struct run {
    int base;                                     /* sample of the upsampled record from which the others are counted */
    _Alignas(VECTOR_BYTES) int sample[RUN_ROOM];  /* on from which the taps are counted */
    _Alignas(VECTOR_BYTES) int step[RUN_ROOM];    /* row of the table of weights; where one is used */
    _Alignas(VECTOR_BYTES) real rest[RUN_ROOM];   /* position in the interval of a cubic, a line's fraction, or the
                                                       distance from the sample whose branches are read */
    _Alignas(VECTOR_BYTES) real cycles[RUN_ROOM]; /* phase, |cycles| <= 1/2 */
};

/* From a delay to a point, point = (tau - t0) fs fine + shift; its whole part is a sample or an interval of a cubic.
   From a point to cycles, cycles = point ratio + base. */
struct scale {
    double t0, fs, fine, shift, ratio, base;
};

/* Neighbouring receivers of a ping, or of several pings, that are summed together. */
struct receiver_group {
    const struct bp_table *table;
    const struct scale *scale;
    double phase_limit; /* rad */
    int receivers;      /* 1 to GROUP_RECEIVERS */
    const real *row;    /* their records (struct bp_ping) */
    struct bp_layout layout;
    real *re, *im;                  /* sums of the line's pixel 0 */
    const struct pair_span *within; /* [receivers] pixels that each is added to; NULL: all of a block */
};

/* Add a group to the pixels of a block, by quintics through its delays at the block's Chebyshev points, tau
   [node][receiver]. */
#define BP_RUNS REAL_ISA_NAME(bp_runs)
void BP_RUNS(const struct receiver_group *group, const struct bp_block *block, double (*tau)[GROUP_RECEIVERS]);

/* Add a run of each of the group's records, `count` pixels from pixel `first` of the line on: to pixels that the record
   is within. Overwrites the runs behind these pixels. */
#define BP_GATHER REAL_ISA_NAME(bp_gather)
void BP_GATHER(const struct receiver_group *group, enum loading loading, int first, int count, struct run *runs);

/* Chebyshev points of a block: its middle -+ these half lengths. */
static const double node[NODES] = {-0.96592582628906829, -0.70710678118654752, -0.25881904510252076,
                                   0.25881904510252076,  0.70710678118654752,  0.96592582628906829};

/* The pixel of a vector whose sample places the window. */
enum { MIDDLE_LANE = LANES / 2 - 1 };

/* Fixed-point numbers: the addends for 19 and 32 bits of fraction, and the values of their last bits. */
enum { POINT_BITS = 19, POINTS_MOST = 4000, FIXED_32_HIGH = 0x41380000 };
#define FIXED_19 0x1.8p33
#define FIXED_23 0x1.8p29
#define FIXED_32 0x1.8p20
#define LAST_19  ((real)0x1p-19)
#define LAST_32  ((real)0x1p-32)

INLINE vector_real *at(const real *values)
{
    return (vector_real *)values;
}

/* PART: the order of pixels in the parts of a vector from which one shuffle takes all low halves (EVEN) or all high
   ones (ODD) in order. ALL: all pixels in order, of which LANE is the number. */
#define LANE(n) n
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
