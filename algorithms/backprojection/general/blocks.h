/* Blocks of pixels whose delays are replaced by a quintic through six exact delays; their length by the phase limit. */
#ifndef SASBENCH_BACKPROJECTION_GENERAL_BLOCKS_H
#define SASBENCH_BACKPROJECTION_GENERAL_BLOCKS_H

#include "backprojection/pairs/pairs.h"

/* A box around a ping's transmitter, and its receivers from emission until the last echo of the image. */
struct ping_box {
    struct vector low, high; /* m */
    double reach;            /* m^(1/6): a block at distance rho may extend reach rho^(5/6) to either side; 0: none */
    double longest;          /* m: nor longer than this: at most 2^18 cycles to either side of its middle */
};

/* Pixels [begin, end) of a line. */
struct bp_block {
    int begin, end;
    bool exact;             /* too near the array: each delay is evaluated */
    struct pair_span shown; /* runs without any of these pixels may be left out; never a part of a run, as a pixel's
                               bits depend on its place in it */
};
enum { BP_BLOCKS = 16, BP_BLOCK_LEAST = 16 }; /* blocks made at a time; fewest pixels of a block that pays */

/* The box of a ping for the pixels of some patches, with blocks whose phase errs by at most phase_limit (rad, >= 0). */
struct ping_box ping_box_make(const struct acquisition *acquisition, int ping, int patch_count,
                              const struct grid *patches, double phase_limit);

/* The box of two pings: its blocks are valid for both. */
struct ping_box ping_box_join(const struct ping_box *a, const struct ping_box *b);

/* m: least and largest distance from any point of the box to any pixel of [begin, end). */
double ping_box_clearance(const struct ping_box *box, const struct pixel_line *line, int begin, int end);
double ping_box_extent(const struct ping_box *box, const struct pixel_line *line, int begin, int end);

/* s: mean difference of the delays of neighbouring pixels of a span, seen from a transmitter. */
double blocks_slope(const struct acquisition *acquisition, int ping, const struct pixel_line *line,
                    struct pair_span span);

/* Take up to BP_BLOCKS blocks off the beginning of *left; returns their count, 0 when nothing is left. */
int blocks_make(const struct ping_box *box, const struct pixel_line *line, struct pair_span *left,
                struct bp_block blocks[BP_BLOCKS]);

#endif
