/* The error of an image by pairs left out: laws from the acquisition alone. Relative L2 errors of the complex image
   after one best complex gain.

   They are means over the pings that see a pixel, weighted by the energy that each brings into the image's azimuth
   spectrum: by stationary phase A^2 (1 - s^2)^(-3/2) a ping, s the sine of its angle off broadside and A the echo's
   amplitude. */
#ifndef SASBENCH_BACKPROJECTION_PAIRS_OMISSION_H
#define SASBENCH_BACKPROJECTION_PAIRS_OMISSION_H

#include "contract/algorithm.h"

/* Pairs with |sin theta_t| > sine: their share of the energy at middles, edges and corners of the patches. NAN where
   there is no law: fewer than 10 pings see one of these places, the beam is not given or squinted, or noise comes from
   all sides. */
double aperture_error(const struct problem *problem, double sine);
/* The error for planning: 1.25 times the law, which is up to 15 % below measured errors, plus the effect of the cut's
   edges on neighbouring targets, up to 4 over the pings that see a pixel. If echoes are strong where the aperture ends
   (a beam with edges, the scene's own limit), at least 1.25 times the loss of a target's azimuth profile: pixels beside
   a target sum other pings, so that side lobes of both apertures differ in phase, not in size alone. INFINITY without a
   law, and where pings lie so far apart that targets repeat: the echoes left out then appear beside them. */
double aperture_planned(const struct problem *problem, double sine);
/* The inverse of aperture_planned: the least sine with an error of at most `error`; 1 if no smaller sine has it. */
double aperture_least(const struct problem *problem, double error);
/* The inverse of the law: the least sine with an error of at most `error`; INFINITY without a law. */
double aperture_sine(const struct problem *problem, double error);

#endif
