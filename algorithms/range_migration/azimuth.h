/* The error of an image before it is formed, as its norm sums it: the azimuth of range migration, carried out for some
   targets at single frequencies. */
#ifndef SASBENCH_RANGE_MIGRATION_AZIMUTH_H
#define SASBENCH_RANGE_MIGRATION_AZIMUTH_H

#include "range_migration/conditions.h"

/* Relative L2 error, after one best complex gain, of the image of targets that lie evenly over all patches (1);
   INFINITY where no ping sees any of them or the arrays are too long to be worth it, NAN without memory. */
double azimuth_error(const struct rma_view *view);

#endif
