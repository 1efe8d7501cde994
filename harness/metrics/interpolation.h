/* Images between their pixels. Used within metrics/ only.

   Interpolation is separable, with a Kaiser-windowed sinc of 2 TAPS_HALF taps, whose error is below -80 dB for
   images that fill up to 85 % of the sampled band. In range the carrier exp(+j 4 pi fc r/c) has a period of
   millimetres, far below the range step, and is taken off first. */
#ifndef SASBENCH_METRICS_INTERPOLATION_H
#define SASBENCH_METRICS_INTERPOLATION_H

#include "contract/algorithm.h"

enum { TAPS_HALF = 24 };      /* samples to either side */
#define RASTER_TOLERANCE 1e-6 /* of a step: a nearer place counts as on the raster */

/* The distance from the raster, in steps, that still counts as on it: rounding of coordinates far from 0 may be much
   of a fine step. Below a quarter of a step in any case. */
double raster_tolerance(double largest_m, double step);

/* Weights of the samples base - TAPS_HALF + 1 .. base + TAPS_HALF for a place `fraction` of a step, in [0, 1), past
   sample `base`. On the raster only the sample itself has weight. */
void taps_fill(double fraction, double taps[2 * TAPS_HALF]);

/* A target's place in the patch that contains it best; patch -1 when none contains it. */
struct place {
    int patch;
    const struct grid *grid;
    double column, row; /* sample coordinates along x and r */
    double margin_m;    /* to the nearest edge of the patch */
};
struct place place_find(const struct image *image, double x, double r);

/* The image along one axis through a place, without the carrier's phase between the rows: `count` columns from
   `first` on at the place's fractional row, or all rows at its fractional column ([r_count]). */
void columns_interpolate(const struct image *image, const struct acquisition *acquisition, const struct place *place,
                         int first, int count, double complex *samples);
void rows_interpolate(const struct image *image, const struct acquisition *acquisition, const struct place *place,
                      double complex *samples);

#endif
