/* The error law of an interpolator, from its response alone: its value for the signal exp(j 2 pi nu q) at the fraction
   delta of a sample, over the exact value,

       H(nu, delta) = sum over k of  h_k(delta) exp(j 2 pi nu (k - delta)).

   Over a scene all fractions are equally likely, and errors that depend on delta scatter over the image. With c_0(nu)
   the mean of H over delta, and < > the mean over the echoes' energy spectrum,

       E^2 = 1 - |<c_0>|^2 / <mean over delta of |H|^2>

   is the relative L2 error after one best complex gain. Part of the scattered energy may fall outside of an image: for
   a whole scene E is a close upper bound. */
#ifndef SASBENCH_BACKPROJECTION_LAW_H
#define SASBENCH_BACKPROJECTION_LAW_H

#include "backprojection/bp.h"
#include "backprojection/law_spectrum.h"

/* The error law; the interpolator's own upsampling divides the frequencies. NAN without memory. */
double interpolation_error(const struct interpolator *interpolator, const struct law_spectrum *spectrum);

/* The error by taps that read zero beyond the records' ends, relative L2 over an image with equal echoes from every
   pixel: 0 where no pixel lies within taps/2 samples of an end. */
double law_ends(const struct problem *problem, int taps);

#endif
