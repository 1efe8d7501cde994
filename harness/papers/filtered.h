/* Numbers of SQ18 and PF05 that claims ask for and no image is needed for: what a plan carries, and what the
   polar-format filter keeps. Each is worked out when it is first asked for, from the scene as it is then assumed, and
   kept in `measured`. */
#ifndef SASBENCH_PAPERS_FILTERED_H
#define SASBENCH_PAPERS_FILTERED_H

#include "papers/measured.h"

/* By enum scene_quantity, the first two and the others; NULL ends them. */
extern const char *const planned_names[], *const energy_names[];

/* Of the scene (target -1): wk_size_factor of a wk_*; times that the filter of a wk_polar upsamples the track. Of
   one of its point targets by itself (from 0), dB over its energy: what the filter keeps, or changes. NAN with
   `missing` set where the scene, the plan or the filter refuses, where there is no such target, or no ping sees it. */
double unimaged_value(struct measured *measured, const char *scene, const char *spec, int target,
                      enum scene_quantity quantity);

#endif
