/* An interpolator's error where few pixels show known targets: carried out. The error law (law.h) takes frequencies and
   fractions of a sample as they are over a scene. A lone target's own row has neither: its pixels read the echo near
   its maximum, where a filter over frequency is little more than a gain, and what depends on the fraction adds up over
   the band. With the sums over pairs by frequency and fraction,

       S(nu, delta) = sum over the pairs that a pixel reads at delta of
                      amplitude exp(j 2 pi (fc + nu fs) (tau - tau_t)),

   tau_t the target's delay, an interpolator of the response H (response.h) makes of a pixel the sum over nu and delta
   of a(nu) H(nu, delta) S(nu, delta), a(nu) the pulse's amplitude; 1 in place of H makes the exact one. */
#ifndef SASBENCH_BACKPROJECTION_FEW_PIXELS_H
#define SASBENCH_BACKPROJECTION_FEW_PIXELS_H

#include "backprojection/bp.h"
#include "backprojection/law_spectrum.h"

struct few_pixels {
    int pixels;
    struct law_spectrum spectrum;
    double complex *sums; /* [pixels][fractions][spectrum.count][2]: of nu and of -nu */
};

/* False where the targets are not known, or pixels lie so far from them, or are so many, that the law of whole images
   holds (NULL in struct problem); then there is nothing to free. */
bool few_pixels_find(const struct problem *problem, struct few_pixels *few);
void few_pixels_free(struct few_pixels *few);

/* To plan with: relative L2, after one best complex gain, with what is measured above it; at most what the error law
   says of a whole scene. NAN without memory. */
double few_pixels_error(const struct few_pixels *few, const struct interpolator *interpolator, const void *options);

#endif
