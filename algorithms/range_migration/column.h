/* Shared by convert.c and focus.c: the work of one thread at one azimuth wavenumber (for each precision and instruction
   set; BP_ISA names it). */
#ifndef SASBENCH_RANGE_MIGRATION_COLUMN_H
#define SASBENCH_RANGE_MIGRATION_COLUMN_H

#include "range_migration/rma_engine.h"
#include "common/clock.h"
#include "common/phasor.h"

enum {
    LANES = RMA_ALIGNMENT / sizeof(real), /* real parts and imaginary parts of a row take turns */
    VECTOR = VECTOR_BYTES / sizeof(real)  /* of the instruction set: the compiler keeps wider ones in memory */
};
typedef real vec __attribute__((vector_size(VECTOR_BYTES), may_alias));
typedef real vec_unaligned __attribute__((vector_size(VECTOR_BYTES), aligned(sizeof(real)), may_alias));

struct workspace {
    const struct rma *rma;
    const struct rma_swath *swath;
    char *scratch;
    double *seconds, mark;
    struct rma_line line;
    int q;
};

static inline void *buffer(const struct workspace *w, enum rma_buffer which)
{
    return w->scratch + w->rma->scratch_at[which];
}

static inline void stage_end(struct workspace *w, enum rma_stage stage)
{
    double now = clock_monotonic();
    w->seconds[stage] += now - w->mark;
    w->mark = now;
}

/* The receivers' spectra at this wavenumber, corrected for each block and added up (or not yet): `sums` has
   [needed][1 or receivers] rows. Evanescent bins have any values. */
void REAL_ISA_NAME(rma_convert)(struct workspace *w, real *sums);

/* By delay compensation: monostatic echoes of wavenumbers p, p + period, ... that are used, in the order of turns, each
   in its own of `cuts`, complex [receivers][row]. */
void REAL_ISA_NAME(rma_receivers)(struct workspace *w, int p, real *cuts);

/* Rows of a patch, complex, from K = j 2 pi/(length step): interpolation (LBF21 Eq. (16)
   for the exact K), bulk focusing at the first row, weight, IFFT. `z`: the spectrum with its guards, real parts before
   imaginary ones. */
void REAL_ISA_NAME(rma_stolt)(struct workspace *w, const struct rma_patch *patch, const real *z, real *stored);

/* The same rows from the bins of F, by chirp transforms. */
void REAL_ISA_NAME(rma_chirp_rows)(struct workspace *w, const struct rma_patch *patch, const real *z, real *stored);

#endif
