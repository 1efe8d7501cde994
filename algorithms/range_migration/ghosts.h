/* Grating lobes: where back projection and azimuth transforms differ by principle. */
#ifndef SASBENCH_RANGE_MIGRATION_GHOSTS_H
#define SASBENCH_RANGE_MIGRATION_GHOSTS_H

#include "contract/algorithm.h"

/* The condition grating_lobes of a uniform straight track (acquisition_is_straight) and patches at r > 0, turned or
   not. Back projection also sums, at a pixel, pings from which the pixel has a wavenumber that the pings do not sample;
   what such a ping saw elsewhere at the same delay is a ghost in back projection's image, and not in that of a
   transform. With an aperture limit it may be the other way round. The value is the ghosts of point targets in the
   patches over the targets' own images (relative L2), the worst of the patches. It refuses where a patch holds ghosts
   of the other patches' targets, and with an aperture limit. Where a patch without one is so wide that targets at its
   ends make ghosts within it, it warns: whether there are such targets is not known (omega-k refuses there too, as it
   predicts no error). */
struct condition ghosts_condition(const struct problem *problem, const struct straight_track *track);

#endif
