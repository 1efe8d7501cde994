/* Lines of pixels and batches of records: shared by the general engine and factorised back projection, around the inner
   sums (sum.h). */
#ifndef SASBENCH_BACKPROJECTION_GENERAL_LINES_H
#define SASBENCH_BACKPROJECTION_GENERAL_LINES_H

#include "backprojection/bp_engine.h"
#include "backprojection/general/sum.h"
#include "backprojection/pairs/pairs.h"

/* How a record of `length` values in each of `branches` lies in memory; `blocks`: it is read as BP_BRANCHES. */
struct bp_layout bp_layout_make(enum precision precision, size_t length, int branches, bool blocks);

/* Values of a record's branch: those of the trace without a kernel's guards. */
size_t bp_branch_length(const struct bp *bp);
/* Complex values of a record before they are spread: its trace, and after it the branches of a kernel. */
size_t bp_record_values(const struct bp *bp);
/* Compress record `index` into `row`, real [layout->record]; `scratch`: complex [bp_record_values] of this thread. */
void bp_record_fill(const struct bp *bp, const struct bp_layout *layout, const struct echoes *echoes, size_t index,
                    void *scratch, void *row);

/* Records to be added to lines of pixels. */
struct bp_lines {
    const struct bp *bp; /* medium, table, precision */
    bp_sum_function *sum;
    const struct acquisition *acquisition; /* in the lines' axes */
    const struct vector *normal;           /* [pings] acquisition_normal */
    const struct ping_box *boxes;          /* [pings] */
    const void *rows;                      /* of record `first` and those behind it */
    struct bp_layout layout;
    struct pair_span shown; /* wanted pixels of a line; sums of others near them may change as well. {0, 0}: all */
};

/* Add records [first, first + count) to the pixels of a line that lie inside their times and inside the aperture limit:
   re[i], im[i] of pixel i. */
void bp_lines_add(const struct bp_lines *lines, const struct pixel_line *line, size_t first, int count, void *re,
                  void *im);

/* Planar sums of a patch, all re and then all im, real [lines][pixels of a line], into the pixels of a window, complex
   [rows][columns]. */
void bp_lines_store(enum precision precision, const struct grid *grid, bool along_x, const void *sums,
                    const struct pixel_window *window, void *pixels);

#endif
