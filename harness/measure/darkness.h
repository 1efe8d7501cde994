/* What an image shows of the echoes that it is made of, against what error laws take for granted: how dark it is beside
   them, and whether they hold the pulse's whole band. */
#ifndef SASBENCH_MEASURE_DARKNESS_H
#define SASBENCH_MEASURE_DARKNESS_H

#include "contract/algorithm.h"

/* Root mean squares over the pixels, in units of the image: of what the energies of a pixel's echoes add up to, and of
   the image itself. */
struct darkness {
    double echoes, image;
    double ratio; /* 1: their squares' */
    double edges; /* 1: mean square frequencies, below */
    double ghosts;
};

enum { DARKNESS_CONDITIONS = 3 };

/* The ratio is

       D = sum over pixels and pairs |echo(delay)|^2 / sum over pixels |image|^2

   of range-compressed echoes, and of the pairs that back projection sums and whose ping sees the pixel: inside the
   record, the aperture limit and the beam, where that is known (condition_beam_sine). N echoes in phase make D = 1/N;
   speckle that fills the beam at most about 1; noise 1. More is what echoes that come from elsewhere leave, which
   cancel. What is wrong with each pair does not: an error e relative to the echoes is e sqrt(D) relative to the image.

   The other is

       F = sum over the same of |s[n+1] - s[n]|^2 / sum of (|s[n]|^2 + |s[n+1]|^2)/2 / 4 <sin^2(pi nu)>,

   n and n + 1 the samples around the delay and < > the mean over the pulse's energy spectrum (law_spectrum.h): 1 where
   pixels read pulses as a whole. A pulse's range side lobes alone lie at the ends of its band: up to 3, of a band that
   is flat and narrow. There interpolators err most, whose laws are of the whole band.

   Ghosts are the energy, over the image's, of the pairs whose ping does not see the pixel, and whose wavenumber there
   lies beyond the band that the pings of a straight track sample, or beyond the element's first null, as they add up
   unless they cancel. Back projection sums these pairs, azimuth transforms do not. In a dark image they may come from
   anywhere, and be all that it shows.

   Samples around the delays, of at most a quarter of a million pairs, which are spread over records and pixels; the
   same bits for any number of threads. `image` is a finished one (imaging.h) of these echoes, on whichever patches.
   Where no echo reaches a pixel, the ratio and the ghosts are 0, `edges` 1; where only the image is zero, INFINITY. All
   are NAN without memory. */
struct darkness image_darkness(const struct echoes *echoes, const struct image *image);

/* Warnings: "dark_image" where the ratio is more than twice that of noise, "side_lobes" where those of what lies
   elsewhere have a sixth of the energy, "unseen_echoes" where ghosts have half the energy. */
void darkness_conditions(const struct darkness *darkness, struct condition list[DARKNESS_CONDITIONS]);

#endif
