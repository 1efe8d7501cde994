/* The share that frequencies have in an image. The image of a target is as wide along the track as its wavelength makes
   it: of each pair's energy at low frequencies, which a pulse of few cycles has in its flanks, images show more. */
#ifndef SASBENCH_COMMON_IMAGE_SPECTRUM_H
#define SASBENCH_COMMON_IMAGE_SPECTRUM_H

#include "contract/algorithm.h"

/* The width of the grids where errors count, the widest of them, over that of a target's image at the carrier. */
double image_cells(const struct problem *problem);

/* Energy in an image of that many cells at fc + `frequency` Hz over that at fc, of echoes that have the same at both:
   as |fc / (fc + frequency)|, unless the grid ends first. */
double image_gain(const struct acquisition *acquisition, double cells, double frequency);

#endif
