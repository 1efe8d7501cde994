/* The error of an image before it is formed: what range migration makes of a point target, in azimuth. */
#ifndef SASBENCH_RANGE_MIGRATION_PREDICTION_H
#define SASBENCH_RANGE_MIGRATION_PREDICTION_H

#include "range_migration/rma_conditions.h"

/* Relative L2 error of azimuth slices through point targets on the wanted columns (1), the worst of every patch's first
   and last row and of some between them; INFINITY where no ping sees any of them, NAN without memory. */
double prediction_error(const struct rma_view *view);

#endif
