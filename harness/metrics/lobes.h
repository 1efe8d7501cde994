/* Helpers that slices and their lobes share. Used within metrics/ only. */
#ifndef SASBENCH_METRICS_LOBES_H
#define SASBENCH_METRICS_LOBES_H

#include "metrics/metrics.h"

/* Metrics before any measurement: all undefined, no reason yet. */
struct slice_metrics slice_undefined(void);

/* Index of the highest of power[first..last]; the first of equal ones. */
int maximum_find(const double *power, int first, int last);

#endif
