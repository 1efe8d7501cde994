/* Where a target lies far along the track from a pixel at the same delay, a ping sees one under another angle than the
   other. What it sees of the pixel beyond an aperture limit, but within the wavenumbers that pings sample, is left out
   by back projection and kept by omega-k; and what lies beyond those wavenumbers the other way round. Few targets have
   any of this, and few columns: more of them are looked at than tone.h can. */
#ifndef SASBENCH_RANGE_MIGRATION_ALIASES_H
#define SASBENCH_RANGE_MIGRATION_ALIASES_H

#include "range_migration/rma_conditions.h"

/* Of one receiver at the transmitter, relative L2 of the image; of targets that are not known as they lie evenly over
   each patch and as far again about it. */
double aliases_error(const struct rma_view *view);

#endif
