/* Pixels farther apart than the resolution may miss the peaks of a scene's targets: what they show is weak, and errors,
   which lie between them as well, are large beside it. */
#ifndef SASBENCH_BACKPROJECTION_COARSE_H
#define SASBENCH_BACKPROJECTION_COARSE_H

#include "contract/algorithm.h"

/* How many times larger errors are, relative to what the pixels show, than relative to an image of the same places at
   the resolution: the root of the energies' ratio, of some of the known targets; at least 1. 1 where pixels are near
   enough, or targets or the beam are not known. */
double coarse_factor(const struct problem *problem);

#endif
