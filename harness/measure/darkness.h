/* How dark an image is beside the echoes that it is made of. */
#ifndef SASBENCH_MEASURE_DARKNESS_H
#define SASBENCH_MEASURE_DARKNESS_H

#include "contract/algorithm.h"

/* Root mean squares over the pixels, in units of the image: of what the energies of a pixel's echoes add up to, and of
   the image itself. */
struct darkness {
    double echoes, image;
    double ratio; /* 1: their squares'; NAN without memory */
};

/* The ratio is

       D = sum over pixels and pairs |echo(delay)|^2 / sum over pixels |image|^2

   of range-compressed echoes, and of the pairs that back projection sums and whose ping sees the pixel: inside the
   record, the aperture limit and the beam, where that is known (condition_beam_sine). N echoes in phase make D = 1/N;
   speckle that fills the beam at most about 1; noise 1. More is what echoes that come from elsewhere leave, which
   cancel. What is wrong with each pair does not: an error e relative to the echoes is e sqrt(D) relative to the image.

   Samples nearest to the delays, of at most a quarter of a million pairs, which are spread over records and pixels;
   the same bits for any number of threads. `image` is a finished one (imaging.h) of these echoes, on whichever patches.
   The ratio is 0 where no echo reaches a pixel, INFINITY where only the image is zero. */
struct darkness image_darkness(const struct echoes *echoes, const struct image *image);

/* "dark_image", a warning with both figures, where the ratio is more than twice that of noise. */
struct condition darkness_condition(const struct darkness *darkness);

#endif
