/* Numbers of claims and tables that need no image: of a scene's acquisition, of a plan, and of what the polar-format
   filter keeps. `measured` keeps those that take work. */
#ifndef SASBENCH_PAPERS_UNIMAGED_H
#define SASBENCH_PAPERS_UNIMAGED_H

#include "papers/measured.h"

/* By enum scene_quantity from QUANTITY_SIZE_FACTOR on, and from QUANTITY_KEPT_DB on; NULL ends them. */
extern const char *const planned_names[], *const energy_names[];

/* Of the scene under the current assumptions (target -1): FLOPs of a plan; wk_size_factor of a wk_*; the factor by
   which the filter of a wk_polar upsamples the track. Of one of its point targets by itself (from 0): what the
   filter keeps, or changes, in dB over the target's energy. NAN with `missing` set where the scene, the plan or the
   filter refuses, where there is no such target, or where no ping sees it. */
double unimaged_value(struct measured *measured, const char *scene, const char *spec, int target,
                      enum scene_quantity quantity);

/* FLOPs as our plan counts them, or by the formula of the method's paper. Planned now if not measured. */
double measured_flops(struct measured *measured, const char *scene, const char *spec, bool by_formula);

/* Names of an acquisition's numbers, with their units; NULL ends them. NAN for those of straight tracks where the
   track is not straight. */
extern const char *const scene_number_names[];
double scene_number_value(int place, const struct acquisition *acquisition);

#endif
