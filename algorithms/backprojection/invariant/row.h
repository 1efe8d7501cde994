/* The inner sums of the translation-invariant engine: one image row from tables, built for each precision and
   instruction set; chosen at run time by bp_invariant.c. */
#ifndef SASBENCH_BACKPROJECTION_INVARIANT_ROW_H
#define SASBENCH_BACKPROJECTION_INVARIANT_ROW_H

#include <stdbool.h>
#include <stddef.h>

#include "backprojection/pairs.h"
#include "backprojection/reading.h"

/* A block of columns is 1 to BP_BLOCK_VECTORS vectors of 16 bytes (baseline), 32 (v3) or 64 (v4); a row of sums has room
   for BP_LANES_MOST values beyond its last column. */
enum { BP_BLOCK_VECTORS = 3, BP_LANES_MOST = 16 };

/* At most BP_TOGETHER column phases are summed together; their samples of one shift lie at most BP_SPREAD apart where a
   value has more than two taps. */
enum { BP_TOGETHER = 6, BP_SPREAD = 4 };

/* Compressed records of some receivers, pings contiguous: value (receiver g, row i, ping p) at
   [g receiver_stride + i ping_stride + lead + p]. Row i is the record's sample i - guard; upsampled records keep `width`
   of their `upsample` phases from `phase` on: row (f / upsample) width + f % upsample - phase for fine sample f. */
struct bp_slab {
    const void *re, *im; /* real; 0 in the lead and as far behind the last ping */
    size_t receiver_stride;
    int ping_stride, lead;
    int phase, width;
};

/* One patch seen from the track: ping p lies at x_first + p spacing, column n at n/ratio spacings from the grid's
   beginning, so that delay and phase depend on (row, receiver, n mod ratio, p - n div ratio) only. */
struct bp_raster {
    double x_first, spacing; /* m, spacing > 0 */
    int pings;
    double speed, t0;             /* m/s, s */
    int ratio;                    /* azimuth steps to a ping spacing */
    double grid_first, grid_step; /* m */
    int columns, blocks;          /* of the grid; ceil(columns/ratio) */
    double limit;                 /* aperture limit */
    int together;                 /* phases summed together at most, 2 for up to two taps, 1 for upsampled records */
};

/* Neighbouring column phases that are summed together, and the shifts [begin, end) inside the aperture of any of them. */
struct bp_row_group {
    int phase, phases; /* the first one, how many */
    int begin, end;
    int first;    /* its entries' place among the row's: by shift and then phase, padded to whole vectors */
    int from, to; /* of these, what is inside the present receiver's record: shifts counted from `begin` */
};

/* Scratch of one thread. Entries of a row: of all phases = min(ratio, columns), each BP_ENTRIES(pings + blocks) at the most;
   of one receiver and as many groups as fit into `capacity` >= BP_TOGETHER BP_ENTRIES(pings + blocks). */
struct bp_row_scratch {
    struct bp_row_group *groups; /* [phases + 1], the last for its `first` */
    double *leg;                 /* [row's entries] s, from the transmitter */
    double *ahead; /* [row's entries] m, of the transmitter from the column when the echo leaves the pixel */
    int *shift;    /* [row's entries] p - n div ratio */
    void *gate;    /* real [row's entries] 1 inside the phase's aperture, else 0 */
    int capacity;
    double *q;     /* [capacity] sample coordinate; then, with cubics, the position inside their interval */
    int *kept;     /* [capacity] `shift` of entries that are kept, where some are not */
    int *row;      /* [capacity] the first tap's row of the slab */
    int *offset;   /* [capacity] where the first tap's value for ping `shift` lies in the receiver's slab */
    int *step;     /* [capacity] fine step or interval between two samples */
    int *rows;     /* [capacity] samples that a shift of a group reads */
    void *wr, *wi; /* real [capacity][taps], or [capacity] where there are more than two */
    void *weights; /* real [capacity][taps + BP_SPREAD] where there are more than two taps */
};
#define BP_ENTRIES(shifts) (((shifts) + BP_LANES_MOST - 1) / BP_LANES_MOST * BP_LANES_MOST)

/* Add `count` receivers, `offsets[g]` metres ahead of the transmitter, to one image row at range r: sums hold
   [ratio][stride] values re, then im, of column rho + ratio j at [rho][j]; stride >= blocks + BP_LANES_MOST, the most of one vector. */
typedef void bp_row_function(const struct bp_medium *medium, const struct bp_table *table,
                             const struct bp_raster *raster, const struct bp_slab *slab, double r,
                             const double *offsets, int count, const struct bp_row_scratch *scratch, void *re, void *im,
                             int stride);

bp_row_function bp_row_float_baseline, bp_row_double_baseline;
bp_row_function bp_row_float_v3, bp_row_double_v3; /* x86-64-v3: AVX2, FMA */
bp_row_function bp_row_float_v4, bp_row_double_v4; /* x86-64-v4: AVX-512 */

#endif
