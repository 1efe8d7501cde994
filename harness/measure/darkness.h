/* How the echoes behind an image differ from what error laws assume: how dark the image is beside them, and whether
   they fill the pulse's whole band. */
#ifndef SASBENCH_MEASURE_DARKNESS_H
#define SASBENCH_MEASURE_DARKNESS_H

#include "contract/algorithm.h"

/* Root mean squares over the pixels, in units of the image: of the summed energies of a pixel's echoes, and of the
   image itself. */
struct darkness {
    double echoes, image;
    double ratio; /* 1: ratio of their squares */
    double edges; /* 1: mean square frequency, below */
    double ghosts;
};

enum { DARKNESS_CONDITIONS = 3 };

/* The ratio is

       D = sum over pixels and pairs |echo(delay)|^2 / sum over pixels |image|^2

   of range-compressed echoes, over the pairs that back projection sums and whose ping sees the pixel: inside the
   record, the aperture limit and the beam, where it is given (condition_beam_sine). N echoes in phase make D = 1/N;
   speckle that fills the beam at most about 1; noise 1. D is larger where echoes from elsewhere cancel. Errors of the
   pairs do not cancel: an error e relative to the echoes is e sqrt(D) relative to the image.

   The mean square frequency is

       F = sum over the same of |s[n+1] - s[n]|^2 / sum of (|s[n]|^2 + |s[n+1]|^2)/2 / 4 <sin^2(pi nu)>,

   n and n + 1 the samples around the delay and < > the mean over the pulse's energy spectrum (law_spectrum.h): 1 where
   pixels read pulses as a whole. A pulse's range side lobes alone lie at the ends of its band: up to 3, of a band that
   is flat and narrow. There interpolators err most, and their laws assume the whole band.

   Ghosts are the energy, over the image's, of pairs whose ping does not see the pixel and whose wavenumber there lies
   beyond the band that the pings of a straight track sample, or beyond the element's first null. Their energies add up;
   cancellation is not counted. Back projection sums these pairs, azimuth transforms do not. A dark image may show
   ghosts alone.

   At most a quarter of a million pairs are read, spread over records and pixels; the same bits for any number of
   threads. `image` is a finished one (imaging.h) of these echoes, on whichever patches. Where no echo reaches a
   pixel, the ratio and the ghosts are 0, `edges` 1; where only the image is zero, INFINITY. All are NAN without
   memory. */
struct darkness image_darkness(const struct echoes *echoes, const struct image *image);

/* Warnings: "dark_image" where the ratio is more than twice that of noise, "side_lobes" where side lobes from
   elsewhere have a sixth of the energy, "unseen_echoes" where ghosts have half the energy. */
void darkness_conditions(const struct darkness *darkness, struct condition list[DARKNESS_CONDITIONS]);

#endif
