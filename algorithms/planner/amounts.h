/* What a problem asks of any back projection, whatever its interpolator. */
#ifndef SASBENCH_PLANNER_AMOUNTS_H
#define SASBENCH_PLANNER_AMOUNTS_H

#include "algorithm.h"

/* Pairs of back projection, which sums along x and r: turned grids are turned back. Errors: STATUS_UNSUPPORTED where
   patches are turned by different angles, STATUS_FAILED without memory. */
enum status pairs_of_problem(const struct problem *problem, double *pairs);

/* The least that images of subapertures take in place of `pairs`, in pairs: each pixel reads an image, each record is
   read by some lines of places of one. */
double reads_of_images(const struct problem *problem, double pairs);

#endif
