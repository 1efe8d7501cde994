/* The error of an image before it is formed, as its norm sums it: the azimuth of range migration, carried out for some
   targets at single frequencies. */
#ifndef SASBENCH_RANGE_MIGRATION_AZIMUTH_H
#define SASBENCH_RANGE_MIGRATION_AZIMUTH_H

#include "range_migration/rma_conditions.h"

/* Relative L2 error (1), after one best complex gain, that the image of the problem's known targets is planned with, or
   where none are known on its rows, that of targets evenly over all patches; INFINITY where no ping sees any of them or
   the arrays are too long to be worth it, NAN without memory. */
double azimuth_error(const struct rma_view *view);

#endif
