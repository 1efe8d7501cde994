/* Where the polar grids of subapertures lie and how fine they are (tree.h has the idea). */
#ifndef SASBENCH_BACKPROJECTION_FACTORISED_GRIDS_H
#define SASBENCH_BACKPROJECTION_FACTORISED_GRIDS_H

#include "backprojection/factorised/tree.h"

#define SINE_WIDEST 0.99 /* of a line: it has a direction */

/* Part of a polar plane, rho_low > rho_high: none. */
struct sector {
    double rho_low, rho_high; /* m */
    double low, high;         /* s */
};

/* What pixels of a patch may read from a subaperture: the patch, as near and as far off the axis as its frequencies
   allow, inside the aperture limit. */
struct sector sector_of_pixels(const struct tree *tree, const struct subaperture *part, int view);
/* The least sector about `part` that holds another one's grid. */
struct sector sector_of_grid(const struct tree *tree, const struct subaperture *part, const struct subaperture *whole,
                             int view);
/* Both. */
struct sector sector_join(struct sector a, struct sector b);

/* Raise step->rho and step->sine to the samples a metre and a unit of s that a sector's highest frequencies take, and
   step->tangent to its greatest. */
void sector_rates(const struct tree *tree, const struct subaperture *part, int view, struct sector sector,
                  struct polar_step *step);
/* The grid that interpolates all of a sector. */
void grid_cover(const struct tree *tree, const struct polar_step *step, struct sector sector, struct polar *polar);
/* What of a grid may be read: not its margins, which the taps need. */
void grid_margins(const struct tree *tree, const struct polar_step *step, struct polar *polar);
/* Cut off the places that are outside of a record (level 0), or that the parts' images do not hold. */
void grid_clip_records(const struct tree *tree, const struct subaperture *part, int view, struct polar *polar);
void grid_clip_parts(const struct tree *tree, const struct subaperture *part, int view, struct polar *polar);

#endif
