/* The inner sums of the translation-invariant engine: one image row from tables. delays.c, row_tables.c, sums.c,
   branches.c and row.c are built for each precision and instruction set; invariant_plan.c chooses one build at run
   time.

   WHY DELAYS REPEAT. The ping spacing is `ratio` azimuth steps. A pixel `ratio` columns further on sees the next ping
   as this pixel sees this ping. Write column n as n = rho + ratio j. Here rho = n mod ratio is its residue, j = n div
   ratio; a residue has `residue_columns` columns at the most. Ping p lies

       u = (x_first - grid_first - rho grid_step) + s spacing,   s = p - j

   ahead of column n. So delay, sample and phase factor of a pair depend on row, receiver, residue and the shift s
   alone. They are tabulated once and serve all columns of the residue:

       image[rho + ratio j] += w(s) trace[sample(s)][ping j + s]   for all j with 0 <= j + s < pings

   For one shift this is a constant times contiguous pings: no gather, no trigonometry, 4 multiply-adds a pair. It is
   exact but for the polynomials in place of a row's delays (pieces.h): the same pairs, samples and weights as the
   general engine with exact=true, in another order. With exact=true it evaluates all delays.

   PINGS BY COLUMNS. One residue with 8 columns, 5 pings, and the block of columns j = 2 to 5 in brackets. The numbers
   are the pings p = j + s that each shift brings to the columns. All pairs form a parallelogram. An aperture limit
   leaves out shifts at its upper and lower ends.

                j = 0  1 [2  3  4  5] 6  7
       s = -7                           0
       s = -6                        0  1
       s = -5           [.  .  .  0] 1  2      only the first pings meet the block
       s = -4           [.  .  0  1] 2  3
       s = -3           [.  0  1  2] 3  4
       s = -2           [0  1  2  3] 4         each column of the block has a ping
       s = -1         0 [1  2  3  4]
       s =  0      0  1 [2  3  4  .]           only the last pings meet the block
       s =  1      1  2 [3  4  .  .]
       s =  2      2  3 [4  .  .  .]
       s =  3      3  4
       s =  4      4

   The dots are zeros of the slab. A block no wider than the lead of the slab is summed for all its shifts at once and
   reads these zeros. In a wider block, the first and the last region are summed only for vectors of columns with a ping
   (sum_columns).

   THE SLAB holds compressed traces of some receivers, re and im apart: [receiver][range sample][lead, pings, zeros].
   Pings of one range sample are contiguous, as the sum over columns reads them. Vectors may begin before ping 0 and end
   behind the last one.

   THE LOOPS, from outside to inside:

       receivers, as many as fit the slab                       invariant.c  invariant_execute
         pass over the fine samples                                          the same; several only for large upsampled
                                                                             traces
           patch; image row, or several, by one thread each                  sum_rows
             receiver of the slab                               row.c        BP_ROW
               groups of neighbouring residues, as many as                   the same
               `capacity` holds: a chunk
                 tables of the chunk                            row_tables.c TABLES_MAKE, DELAYS_MAKE (delays.c)
                 block of columns                               sums.c       SUMS_ADD
                   shifts that bring pings to the same vectors               sum_columns
                   of the block: one region
                     group of residues                                       sum_block
                       shift, tap, vector of columns                         sum_one, sum_two, sum_taps
                 of Farrow branches, block of columns         branches.c   BRANCHES_ADD
                   shift of a group, of all rows that are                    sum_block, sum_rows_block
                   summed together
                     residues that read one sample: a run                    add_run
                       vector of columns, residue, branch                    add_vectors

   Loads of the traces are the limit, half of which cross a cache line. Neighbouring residues mostly read the same
   samples: they are summed together and share the loads. Tables and sums take turns, so that both stay in the cache. Up
   to two taps, and single residues of more taps, keep the sums of a block in registers over all shifts of a region.
   With Farrow branches, a vector of a sample's values stays in registers for all residues of a run. Their sums are read
   and written for each shift: Horner's rule and the phase factor are 2 branches + 2 multiply-adds between a load and a
   store.

   THE TABLES. An entry is one shift of one residue. A group's entries are ordered by shift and then residue, and are
   padded to whole vectors. Made once for a row and the receivers of the slab (TABLES_BEGIN): seconds on the way out
   (`leg`), metres along the track (`ahead`), the shift, and a gate of 1 or 0 for the aperture of this residue. Made
   once for a receiver: the place in the slab (`row`, `offset`) and the weights.
     - One or two taps: complex weights, phase factor times tap. In groups of two residues, an entry of the second that
       reads another sample than the first takes a branch with loads of its own (AVX-512), or is summed by itself
       (sum_entry, listed in `rows`), and its weight becomes 0.
     - More taps: phase factors (`wr`, `wi`) and real tap weights stand apart. A group reads the `rows` samples that any
       of its residues needs. The weights of a residue are 0 for samples that are not its own.
     - Farrow branches: phase factors, and in place of weights the distance from the sample.

   PRECONDITIONS OF THE LOOPS. They check only BP_SPREAD. This code ensures the others:

       whole ratio, even pings   invariant_condition: to 1e-7 of a cycle and of a sample, else unsupported
       zeros around the pings    plan_slab: a lead of 64 bytes, the widest vector, and as much behind the pings;
                                 invariant_execute clears the slab, and scatter writes pings only
       samples in the record     inside_record proves it for the whole row, else confine or keep checks entries;
                                 taps beyond the record's ends read the guard rows of the slab, which are zeros
       whole vectors             group_places, keep: entries of the padding hold valid values and are not summed;
                                 plan_patch: a row of sums has room for BP_LANES_MOST values behind its columns
       BP_SPREAD                 residues_together: groups are so small that, by steepness(), the samples of one shift
                                 lie at most BP_SPREAD apart; join_many asserts it, as it would write beyond its
                                 table else
       capacity                  plan_patch: the largest group with all shifts always fits
       int indices               raster_make, plan_slab: larger tables and slabs are unsupported
       same bits                 sum_rows: one thread sums a row, in an order that does not depend on the threads */
#ifndef SASBENCH_BACKPROJECTION_INVARIANT_ROW_H
#define SASBENCH_BACKPROJECTION_INVARIANT_ROW_H

#include <stdbool.h>
#include <stddef.h>

#include "common/isa.h"
#include "backprojection/invariant/pieces.h"
#include "backprojection/pairs/pairs.h"
#include "backprojection/reading.h"

/* A block of columns is 1 to BP_BLOCK_VECTORS vectors of 16 bytes (baseline), 32 (v3) or 64 (v4); a row of sums has
   room for BP_LANES_MOST values beyond its last column. */
enum { BP_BLOCK_VECTORS = 5, BP_LANES_MOST = 16 };

/* At most BP_TOGETHER residues are summed together; their samples of one shift lie at most BP_SPREAD apart where a
   value has more than two taps. With Farrow branches, at most BP_TOGETHER_BRANCHES; those that read the same sample are
   summed together, and those of up to BP_ROWS_MOST image rows where a row has so few residues. */
enum { BP_TOGETHER = 6, BP_SPREAD = 4, BP_TOGETHER_BRANCHES = 40, BP_ROWS_MOST = 8 };

/* Compressed traces of some receivers, pings contiguous: value (receiver g, row i, ping p) at
   [g receiver_stride + i ping_stride + lead + p]. Row i is the trace's sample i - guard, a fine one where it is
   upsampled (bp_whole); upsampled traces whose nearest value is read keep step_count of their `upsample` fine steps a
   sample, from step_first on: fine sample f is in row (f / upsample) step_count + f % upsample - step_first. Of Farrow
   branches row i branches + m is branch m of sample i - guard. */
struct bp_slab {
    const void *re, *im; /* real; 0 in the lead and as far behind the last ping */
    size_t receiver_stride;
    int ping_stride, lead;
    int step_first, step_count, step_rows;
};

/* Are traces in the slab from guard to guard, with all their fine steps? */
static inline bool bp_whole(const struct bp_table *table)
{
    return table->upsample == 1 || table->taps > 1;
}

/* One patch seen from the track: ping p lies at x_first + p spacing, column n at n/ratio spacings from the grid's
   beginning, so that delay and phase depend on (row, receiver, n mod ratio, p - n div ratio) only. */
struct bp_raster {
    double x_first, spacing; /* m, spacing > 0 */
    int pings;
    double speed, t0;             /* m/s, s */
    int ratio;                    /* azimuth steps to a ping spacing */
    double grid_first, grid_step; /* m */
    int columns;                  /* of the grid */
    int residue_columns;          /* of one residue at the most: ceil(columns/ratio) */
    struct pair_span shown;       /* wanted columns of a residue: vectors without any are left out */
    double limit;                 /* aperture limit */
    int stored;                   /* the first column with sums: vectors reach beyond the wanted ones */
    int rows;                     /* image rows summed together: with Farrow branches and few residues, else 1 */
    int together; /* residues summed together at most, 2 for up to two taps, 1 for the nearest fine step */
    const struct piece_fit *fit;
    double reach, longest; /* of pieces: piece_reach, 0: each delay is evaluated; greatest half length in m */
};

static inline int raster_residues(const struct bp_raster *raster)
{
    return raster->ratio < raster->columns ? raster->ratio : raster->columns;
}

/* Neighbouring residues that are summed together, and the shifts [begin, end) inside the aperture of any of them. */
struct bp_row_group {
    int residue, residues; /* the first one, how many */
    int begin, end;
    int first;    /* its entries' place among the row's: by shift and then residue, padded to whole vectors */
    int from, to; /* shifts inside the present receiver's record, counted from `begin` */
};

/* Distances ahead, in m, that share a polynomial of one receiver. For `place` from -1 to 1 the sample coordinate is sum
   c[m] place^m, and the phase fc/fs times that plus `cycles`. */
struct bp_piece {
    double begin, end;
};
struct bp_polynomial {
    double c[PIECE_POWERS], cycles;
};

/* Scratch of one row. Entries of a row: of all residues = min(ratio, columns), each BP_ENTRIES(pings +
   residue_columns) at the most; of one receiver and as many groups as fit into `capacity` >= the most
   residues of a group times BP_ENTRIES(pings + residue_columns). */
struct bp_row_scratch {
    struct bp_row_group *groups; /* [residues + 1], the last for its `first` */
    double *leg;                 /* [row's entries] s, from the transmitter; not where there are pieces */
    double *ahead; /* [row's entries] m, of the transmitter from the column when the echo leaves the pixel; with pieces,
                      the place in its piece, -1 to 1 */
    int *piece;    /* [row's entries] of each vector, by number of vector */
    struct bp_piece *pieces;                /* [PIECES_MOST] */
    struct bp_polynomial *polynomials;      /* [PIECES_MOST] of one receiver */
    double *node_leg, *node_ahead, *node_q; /* [PIECES_MOST PIECE_POWERS] leg, ahead, q of the pieces' nodes */
    int *shift;                             /* [row's entries] p - n div ratio */
    void *gate; /* real [row's entries] 1 inside the aperture of the entry's residue, else 0 */
    int capacity;
    double *q;     /* [capacity] sample coordinate; then, with cubics, the position inside their interval */
    int *kept;     /* [capacity] `shift` of kept entries, where some are left out */
    int *row;      /* [capacity] the first tap's row of the slab */
    int *offset;   /* [capacity] where the first tap's value for ping `shift` lies in the receiver's slab */
    int *step;     /* [capacity] fine step or interval between two samples */
    int *rows;     /* [capacity] samples that a shift of a group reads */
    void *wr, *wi; /* real [capacity][taps], or [capacity] where there are more than two */
    void *weights; /* real [capacity][taps + BP_SPREAD] where there are more than two taps; with branches [capacity],
                      the distance from the sample */
};

#define BP_ENTRIES(shifts) (((shifts) + BP_LANES_MOST - 1) / BP_LANES_MOST * BP_LANES_MOST)

/* One image row of a patch, and the receivers of the slab that are added to it. */
struct bp_row {
    const struct bp_medium *medium;
    const struct bp_table *table;
    const struct bp_raster *raster;
    const struct bp_slab *slab;
    double r;                             /* m */
    int receivers;                        /* of the slab */
    const double *offsets;                /* [receivers] m ahead of the transmitter */
    const struct bp_row_scratch *scratch; /* the calling thread's, of this row */
    void *re, *im; /* real [min(ratio, columns)][stride] sums: column rho + ratio j at [rho][j - stored] */
    int stride;    /* >= those columns + BP_LANES_MOST, the most of one vector */
};

/* Add the receivers to raster.rows neighbouring rows at most, which share all but r, scratch, re and im. */
typedef void bp_row_function(const struct bp_row *rows, int count);

ISA_DECLARE(bp_row_function, bp_row);

#endif
