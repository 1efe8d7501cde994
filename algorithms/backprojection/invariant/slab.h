/* From records, one behind the other, to the invariant engine's slab, whose pings lie side by side (row.h). */
#ifndef SASBENCH_BACKPROJECTION_INVARIANT_SLAB_H
#define SASBENCH_BACKPROJECTION_INVARIANT_SLAB_H

#include <stddef.h>

#include "common/isa.h"

/* Where values go: sample i of ping p, complex value p pitch + i of a tile, to [i step + p] of re and of im. */
struct bp_scattering {
    size_t samples, pitch, step;
    void *re, *im; /* real */
};

/* Scatter the first `count` pings of a tile, and zeros behind them up to the next whole vector: rows have that room. */
typedef void bp_scatter_function(const struct bp_scattering *scattering, const void *tile, int count);

ISA_DECLARE(bp_scatter_function, bp_scatter);

#endif
