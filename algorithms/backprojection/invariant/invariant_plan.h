/* The plan of the translation-invariant engine: invariant_plan.c makes it, invariant.c executes it. row.h has the
   picture. */
#ifndef SASBENCH_BACKPROJECTION_INVARIANT_INVARIANT_PLAN_H
#define SASBENCH_BACKPROJECTION_INVARIANT_INVARIANT_PLAN_H

#include "backprojection/bp_engine.h"
#include "backprojection/invariant/row.h"
#include "backprojection/invariant/slab.h"

enum { TILE = 16 }; /* pings compressed together: one cache line of each fine sample */

struct invariant {
    bp_row_function *row;
    bp_scatter_function *scatter;
    struct bp_raster *rasters; /* [patch_count] */
    struct piece_fit fit;
    double *offsets;         /* [receivers] m ahead of the transmitter */
    bool reversed;           /* the sonar sails towards -x: pings are taken from the last to the first */
    struct bp_slab slab;     /* step_first: of the current pass */
    size_t slab_rows;        /* of one receiver, at most */
    int receivers;           /* of one pass */
    int passes;              /* over the fine steps of upsampled traces, which bound the slab's size */
    void *slab_re, *slab_im; /* real [receivers][slab_rows][ping_stride] */
    void *tiles;             /* [threads][tile_bytes]: complex [TILE][branches][shape.length]; of fine steps
                                       spectra [TILE][shape.pitch] and one step's values [TILE][shape.pitch] */
    size_t tile_bytes;
    int rows;                       /* raster.rows of any patch, at most */
    struct bp_row_scratch *scratch; /* [threads][rows], all in `tables` */
    void *tables;
    int patch_count;
    int *strides; /* [patch_count] */
    void **sums;  /* [patch_count]: re then im, real [wanted rows][min(ratio, columns)][stride] */
};

/* The callbacks of struct bp_engine, but for execute. */
enum status invariant_applicable(const struct bp *bp);
void invariant_units(const struct bp *bp, struct forecast *forecast);
enum status invariant_plan(struct bp *bp);

#endif
