/* A chunk of a row: row_tables.c tabulates it, sums.c sums it, row.c calls both. row.h has the picture. */
#ifndef SASBENCH_BACKPROJECTION_INVARIANT_CHUNK_H
#define SASBENCH_BACKPROJECTION_INVARIANT_CHUNK_H

#include "backprojection/invariant/row.h"
#include "common/lanes.h"

#define INLINE static inline __attribute__((always_inline))

/* A vector of samples, loaded once for all its products: loads are the limit. */
#define LOAD(name, pointer)                                                                                            \
    vector_real name = *(const vector_real *)(pointer);                                                                \
    HOLD(name)

/* Delay from transmission to a receiver `offset` ahead of the transmitter (delay.h): with b = ahead + offset,
   tau = leg + (v b + s)/(c^2 - v^2) = leg + (b^2 + r^2)/(s - v b), s = sqrt(c^2 b^2 + (c^2 - v^2) r^2). */
struct delay_terms {
    double v, c2, r2, er2, one_e;
    bool slow; /* the first form will do */
};

/* Shared by all receivers. */
struct row_tables {
    int group_count; /* in scratch->groups, with their part of the delays; one more group ends the last */
    int pieces;      /* in scratch->pieces; 0: each delay is evaluated */
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
    bool sparse;         /* entries are left out: scratch->kept holds the shifts of the others */
    const int *shift;    /* [entries] */
    int from, to;        /* shifts [from, to) are summed */
    const real *sr, *si; /* the receiver's traces, their ping 0 */
    real *re, *im;       /* sums [residue][stride] */
    size_t stride;
};

/* Choose how the row's delays are found; returns the number of pieces, 0: each delay is evaluated. `offset`: the
   greatest of any receiver; INFINITY: evaluate each, as some may lie at the record's ends. entries: of all groups;
   scratch->ahead holds, on entry, how far the ping lies ahead of the column. */
#define DELAYS_PLAN REAL_ISA_NAME(bp_delays_plan)
int DELAYS_PLAN(const struct bp_row *row, const struct delay_terms *terms, double offset, int entries);

/* The polynomials of the row's pieces, if any, for the receiver that is `offset` metres ahead of the transmitter. */
#define DELAYS_RECEIVER REAL_ISA_NAME(bp_delays_receiver)
void DELAYS_RECEIVER(const struct bp_row *row, const struct row_tables *tables, double offset);

/* Sample coordinate (q) and phase factor (wr, wi) of a chunk's entries for this receiver; 0 where the gate is. */
#define DELAYS_MAKE REAL_ISA_NAME(bp_delays_make)
void DELAYS_MAKE(const struct row_tables *tables, double offset, const struct chunk *chunk);

/* Divide the row's residues into groups whose sizes differ by one at the most, and tabulate what all receivers
   share. */
#define TABLES_BEGIN REAL_ISA_NAME(bp_tables_begin)
struct row_tables TABLES_BEGIN(const struct bp_row *row);

/* Tabulate samples and weights of a chunk's groups for the receiver that is `offset` metres ahead of the transmitter;
   sets chunk->entries and chunk->shift. */
#define TABLES_MAKE REAL_ISA_NAME(bp_tables_make)
void TABLES_MAKE(const struct row_tables *tables, double offset, struct chunk *chunk);

/* Add a chunk with its tables to all columns of its residues; of branches the same chunk of `rows` image rows. */
#define SUMS_ADD REAL_ISA_NAME(bp_sums_add)
void SUMS_ADD(struct chunk *chunks, int rows);

/* The same of Farrow branches. */
#define BRANCHES_ADD REAL_ISA_NAME(bp_branches_add)
void BRANCHES_ADD(const struct chunk *chunks, int rows);

/* `count` rounded up to whole vectors. */
static inline int whole_vectors(int count)
{
    return (count + LANES - 1) / LANES * LANES;
}

#endif
