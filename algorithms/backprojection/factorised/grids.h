/* Where the polar grids of subapertures lie and how fine they are (tree.h has the idea). */
#ifndef SASBENCH_BACKPROJECTION_FACTORISED_GRIDS_H
#define SASBENCH_BACKPROJECTION_FACTORISED_GRIDS_H

#include "backprojection/factorised/tree.h"

#define SINE_WIDEST 0.99 /* of a line with a direction */

/* Part of a polar plane, rho_low > rho_high: none. */
struct sector {
    double rho_low, rho_high; /* m */
    double low, high;         /* s */
};

/* The part of a patch whose pixels may read a subaperture: where its frequencies allow, inside the aperture limit. */
struct sector sector_of_pixels(const struct tree *tree, const struct subaperture *part, int view);
/* The smallest sector that contains `part` and the grid of another subaperture. */
struct sector sector_of_grid(const struct tree *tree, const struct subaperture *part, const struct subaperture *whole,
                             int view);
/* The smallest sector that contains both. */
struct sector sector_join(struct sector a, struct sector b);

/* Raise step->rho and step->sine (samples a metre and a unit of s) to the needs of a sector's highest frequencies, and
   step->tangent to its greatest. */
void sector_rates(const struct tree *tree, const struct subaperture *part, int view, struct sector sector,
                  struct polar_step *step);
/* The grid that interpolates all of a sector. */
void grid_cover(const struct tree *tree, const struct polar_step *step, struct sector sector, struct polar *polar);
/* Cut off places outside of a record (level 0), or outside of the parts' images. */
void grid_clip_records(const struct tree *tree, const struct subaperture *part, int view, struct polar *polar);
void grid_clip_parts(const struct tree *tree, const struct subaperture *part, int view, struct polar *polar);

#endif
