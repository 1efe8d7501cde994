/* The inner sums of the general engine: one line of pixels over one ping. sum.c, runs.c and gather.c are
   built for each precision and instruction set; general.c chooses one build at run time. run.h has the drawing of a run
   of pixels, budget.h the error budget. */
#ifndef SASBENCH_BACKPROJECTION_GENERAL_SUM_H
#define SASBENCH_BACKPROJECTION_GENERAL_SUM_H

#include "common/isa.h"
#include "backprojection/general/blocks.h"
#include "backprojection/reading.h"

/* How the batch's records lie in memory: of each branch (one but for BP_BRANCHES) all real parts, then all imaginary
   ones. With AVX-512 branches are cut into blocks of a vector's samples, [block][branch][re, im][sample], which begin
   half a vector apart: each sample is in two of them. */
struct bp_layout {
    size_t record; /* values from one record to the next */
    size_t apart;  /* from a branch's real parts to its imaginary ones, and from these to the next branch */
    int blocks;    /* of a record, each of `apart` samples, apart/2 from one to the next; 1 where it is not cut */
};

/* Receivers of one ping, with their records. */
struct bp_ping {
    struct vector tx, velocity;
    double t0;
    int receivers;
    const struct vector *rx; /* [receivers] at emission */
    const void *rows;        /* real [receivers][record]; one value behind the last may be read */
    struct bp_layout layout;
    struct pair_span within; /* pixels that it is added to */
};

/* Neighbouring pings that are summed together: one, or several with at most BP_RECORDS receivers in all. They start
   recording at the same time after emission, and their records follow one another. */
enum { BP_RECORDS = 4 };
struct bp_pings {
    int count;
    const struct bp_ping *ping; /* [count] */
};

/* Add the receivers' contributions to the pixels of some blocks of a line, where all delays lie inside the record:
   re[i], im[i] += value times exp(+j 2 pi fc tau) for pixel i, of each ping for the pixels `within`. Blocks of several
   pings are valid for each of them; those of one lie within its pixels. */
typedef void bp_sum_function(const struct bp_medium *medium, const struct bp_table *table, const struct bp_pings *pings,
                             const struct pixel_line *line, int block_count, const struct bp_block *blocks, void *re,
                             void *im);

ISA_DECLARE(bp_sum_function, bp_sum);

#endif
