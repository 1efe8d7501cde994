/* Numbers that claims and tables ask for and no image is needed for: of a scene's acquisition, of what a plan carries,
   of what the polar-format filter keeps. Those that take work are kept in `measured` once they are asked for. */
#ifndef SASBENCH_PAPERS_UNIMAGED_H
#define SASBENCH_PAPERS_UNIMAGED_H

#include "papers/measured.h"

/* By enum scene_quantity from QUANTITY_SIZE_FACTOR on, and from QUANTITY_KEPT_DB on; NULL ends them. */
extern const char *const planned_names[], *const energy_names[];

/* Of the scene as it is assumed (target -1): FLOPs of a plan; wk_size_factor of a wk_*; times that the filter of a
   wk_polar upsamples the track. Of one of its point targets by itself (from 0), dB over its energy: what the filter
   keeps, or changes. NAN with `missing` set where the scene, the plan or the filter refuses, where there is no such
   target, or no ping sees it. */
double unimaged_value(struct measured *measured, const char *scene, const char *spec, int target,
                      enum scene_quantity quantity);

/* FLOPs as our plan counts them or by its paper's formula. Planned now where it was not measured. */
double measured_flops(struct measured *measured, const char *scene, const char *spec, bool by_formula);

/* Numbers of an acquisition by name, with their units; NULL ends them. NAN for what only a straight track has. */
extern const char *const scene_number_names[];
double scene_number_value(int place, const struct acquisition *acquisition);

#endif
