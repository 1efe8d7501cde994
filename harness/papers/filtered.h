/* Numbers of SQ18 and PF05 that claims ask for and no image is needed for: what a plan carries, and what the
   polar-format filter keeps. Each is worked out when it is first asked for, from the scene as it is then assumed, and
   kept in `measured`. */
#ifndef SASBENCH_PAPERS_FILTERED_H
#define SASBENCH_PAPERS_FILTERED_H

#include "papers/measured.h"

extern const char *const planned_names[]; /* by enum scene_quantity, the first two; NULL ends them */

/* wk_size_factor of a wk_* on a scene; times that the filter of a wk_polar upsamples the track. NAN with `missing` set
   where the scene, the plan or the filter refuses. */
double planned_value(struct measured *measured, const char *scene, const char *spec, enum scene_quantity quantity);

/* dB: what the filter of a wk_polar keeps of a scene's point target (from 0) by itself, or changes; both over its
   energy. NAN with `missing` set where there is no such target, where no ping sees it or the filter refuses. */
double filtered_value(struct measured *measured, const char *scene, const char *spec, int target,
                      enum scene_quantity quantity);

#endif
