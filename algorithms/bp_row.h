/* The inner sums of the translation-invariant engine: one image row from tables, built for each precision and
   instruction set; chosen at run time by bp_invariant.c. */
#ifndef SASBENCH_BP_ROW_H
#define SASBENCH_BP_ROW_H

#include "bp_sum.h"

/* A block of columns is 1 to BP_BLOCK_VECTORS vectors of 16 bytes (baseline), 32 (v3) or 64 (v4); a row of sums has room
   for BP_LANES_MOST values beyond its last column. */
enum { BP_BLOCK_VECTORS = 3, BP_LANES_MOST = 16 };

/* Compressed records of some receivers, pings contiguous: value (receiver g, row i, ping p) at
   [g receiver_stride + i ping_stride + lead + p]. Row i is the record's sample i - guard; upsampled records keep `width`
   of their `upsample` phases from `phase` on: row (f / upsample) width + f % upsample - phase for fine sample f. */
struct bp_slab {
    const void *re, *im;            /* real; 0 in the lead and behind the last ping */
    size_t receiver_stride;
    int ping_stride, lead;
    int phase, width;
};

/* One patch seen from the track: ping p lies at x_first + p spacing, column n at n/ratio spacings from the grid's
   beginning, so that delay and phase depend on (row, receiver, n mod ratio, p - n div ratio) only. */
struct bp_raster {
    double x_first, spacing;        /* m, spacing > 0 */
    int pings;
    double speed, t0;               /* m/s, s */
    int ratio;                      /* azimuth steps to a ping spacing */
    double grid_first, grid_step;   /* m */
    int columns, blocks;            /* of the grid; ceil(columns/ratio) */
    double limit;                   /* aperture limit */
};

/* The shifts [begin, end) of one column phase inside the aperture. */
struct bp_row_shifts {
    int begin, end;
    int first;                      /* its entries' place among the row's, which are padded to whole vectors */
    /* Of the present receiver, whose other entries lie outside its record or pass: */
    int count, least;               /* entries, and the first one's shift */
    bool gapless;                   /* no shift between its first and its last is left out */
};

/* Scratch of one thread. Shifts of a row: of all phases = min(ratio, columns), each BP_ENTRIES(pings + blocks) at the most;
   entries: of one receiver and as many phases as fit into `capacity` >= BP_ENTRIES(pings + blocks). */
struct bp_row_scratch {
    struct bp_row_shifts *phases;   /* [phases + 1], the last for its `first` */
    double *leg;                    /* [shifts] s, from the transmitter */
    double *ahead;                  /* [shifts] m, of the transmitter from the column when the echo leaves the pixel */
    int *shift;                     /* [shifts] p - n div ratio, rising within a phase */
    int capacity;
    double *q;                      /* [capacity] sample coordinate */
    int *kept;                      /* [capacity] `shift` of entries that are kept, where some are not */
    int *offset;                    /* [capacity] where the first tap's value for ping `shift` lies in the receiver's slab */
    int *step;                      /* [capacity] fine step between two samples */
    void *wr, *wi, *weights;        /* real [capacity], [capacity], [capacity][taps] */
};
#define BP_ENTRIES(shifts) (((shifts) + BP_LANES_MOST - 1) / BP_LANES_MOST * BP_LANES_MOST)

/* Add `count` receivers, `offsets[g]` metres ahead of the transmitter, to one image row at range r: sums hold
   [ratio][stride] values re, then im, of column rho + ratio j at [rho][j]; stride >= blocks + BP_LANES_MOST, the most of one vector. */
typedef void bp_row_function(const struct bp_medium *medium, const struct bp_table *table, const struct bp_raster *raster,
                             const struct bp_slab *slab, double r, const double *offsets, int count,
                             const struct bp_row_scratch *scratch, void *re, void *im, int stride);

bp_row_function bp_row_float_baseline, bp_row_double_baseline;
bp_row_function bp_row_float_v3, bp_row_double_v3;  /* x86-64-v3: AVX2, FMA */
bp_row_function bp_row_float_v4, bp_row_double_v4;  /* x86-64-v4: AVX-512 */

#endif
