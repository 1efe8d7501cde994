/* What an aperture limit takes off back projection's image, and omega-k's keeps, within the wavenumbers that pings
   sample: echoes of targets far along the track from a pixel at the same delay, from pings beyond the pixel's aperture.
   Few targets have any, and few columns: more of them are looked at than tone.h can. */
#ifndef SASBENCH_RANGE_MIGRATION_LIMIT_H
#define SASBENCH_RANGE_MIGRATION_LIMIT_H

#include "range_migration/conditions.h"

/* Of one receiver at the transmitter, relative L2 of the image; of targets that are not known as they lie evenly over each patch and as far again about
   it. */
double limit_error(const struct rma_view *view);

#endif
