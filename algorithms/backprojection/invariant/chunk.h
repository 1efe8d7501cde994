/* What tables.c, sums.c and row.c share: a chunk of a row, tabulated by one, summed by the next. row.h has the
   picture. */
#ifndef SASBENCH_BACKPROJECTION_INVARIANT_CHUNK_H
#define SASBENCH_BACKPROJECTION_INVARIANT_CHUNK_H

#include "backprojection/invariant/row.h"
#include "common/lanes.h"

#define INLINE static inline __attribute__((always_inline))

/* Delay from transmission to a receiver `offset` ahead of the transmitter (delay.h): with b = ahead + offset,
   tau = leg + (v b + s)/(c^2 - v^2) = leg + (b^2 + r^2)/(s - v b), s = sqrt(c^2 b^2 + (c^2 - v^2) r^2). */
struct delay_terms {
    double v, c2, r2, er2, one_e;
    bool slow; /* the first form will do */
};

/* What all receivers share. */
struct row_tables {
    int group_count; /* in scratch->groups, with their part of the delays and one more group that ends the last */
    struct delay_terms terms;
    bool inside_record; /* proved for all of the row's delays */
};

/* Groups [begin, end) of one receiver, all of as many residues, with their tables. */
struct chunk {
    const struct bp_medium *medium;
    const struct bp_raster *raster;
    const struct bp_table *table;
    const struct bp_slab *slab;
    const struct bp_row_scratch *scratch;
    int begin, end;
    int entries;         /* of all groups, in whole vectors */
    bool sparse;         /* entries are left out: scratch->kept holds the shifts of those that are there */
    const int *shift;    /* [entries] */
    int from, to;        /* shifts [from, to) are summed */
    const real *sr, *si; /* the receiver's traces, their ping 0 */
    real *re, *im;       /* sums [residue][stride] */
    size_t stride;
};

/* Divide the row's residues into groups that differ by one at the most, and tabulate what serves all receivers. */
#define TABLES_BEGIN REAL_ISA_NAME(bp_tables_begin)
struct row_tables TABLES_BEGIN(const struct bp_row *row);

/* Tabulate samples and weights of a chunk's groups for the receiver that is `offset` metres ahead of the transmitter;
   sets chunk->entries and chunk->shift. */
#define TABLES_MAKE REAL_ISA_NAME(bp_tables_make)
void TABLES_MAKE(const struct row_tables *tables, double offset, struct chunk *chunk);

/* Add a chunk with its tables to all columns of its residues. */
#define SUMS_ADD REAL_ISA_NAME(bp_sums_add)
void SUMS_ADD(struct chunk *chunk);

/* `count` rounded up to whole vectors. */
static inline int whole_vectors(int count)
{
    return (count + LANES - 1) / LANES * LANES;
}

#endif
