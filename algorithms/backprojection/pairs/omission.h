/* What an image loses where something is left out of the geometry: laws from the acquisition alone. Relative L2
   errors of the complex image after one best complex gain.

   They are means over the pings that see a pixel, weighted by the energy that each brings into the image's azimuth
   spectrum: by stationary phase A^2 (1 - s^2)^(-3/2) a ping, s the sine of its angle off broadside and A the echo's
   amplitude. */
#ifndef SASBENCH_BACKPROJECTION_PAIRS_OMISSION_H
#define SASBENCH_BACKPROJECTION_PAIRS_OMISSION_H

#include "contract/algorithm.h"

/* Pairs with |sin theta_t| > sine: the share of the energy that they bring to middles, edges and corners of the
   patches. NAN where there is no law: fewer than 10 pings see one of these, the beam is unknown or squinted, or
   noise comes from all sides. */
double aperture_error(const struct problem *problem, double sine);
/* What is planned with: 1.25 times the law, which is up to 15 % below what is measured, and what the edges of the cut
   make of neighbouring targets, up to 4 over the pings that see a pixel. Where the aperture ends while echoes are
   strong, by a beam with edges or by the scene's own limit, at least 1.25 times what the azimuth profile of a target
   loses: pixels beside a target sum other pings than it does, so that side lobes of both apertures differ in phase, not
   in size alone. INFINITY where there is no law, and where pings lie so far apart that targets repeat: what an aperture
   leaves out is then seen beside them. */
double aperture_planned(const struct problem *problem, double sine);
/* Its inverse: the least sine that loses at most `error`; 1 where none below does. */
double aperture_least(const struct problem *problem, double error);
/* The inverse of the law: the least sine that loses at most `error`; INFINITY where there is no law. */
double aperture_sine(const struct problem *problem, double error);

#endif
