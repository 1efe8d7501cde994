/* A window of an image by azimuth transforms is an ordinary problem: the window's pixels, and the stretch of the track
   that they need. The image is linear in the pings: without some of them it differs by what these add to its pixels. A
   ping adds to a pixel as far as the azimuth filter reaches, to the widest angle that is focused, and the guard beyond
   (azimuth_guard). d m beyond that angle, filter and echo part by (d/zone)^2/2 cycles, zone = sqrt(lambda r/2): 18 at
   the guard's end, 4.5 half way. There the stretch begins to fade, so that its end makes no side lobes. */
#ifndef SASBENCH_RANGE_MIGRATION_STRETCH_H
#define SASBENCH_RANGE_MIGRATION_STRETCH_H

#include "contract/algorithm.h"

struct stretch {
    struct problem problem;      /* the whole one, or the window's: it then points to the two below */
    struct acquisition part;     /* a view of the pings */
    struct grid grid;            /* the window's pixels */
    bool cut;                    /* false: the whole problem */
    int pings, first;            /* of the whole; of these, the stretch's first */
    double fades;                /* pings: over so many it fades at either end */
    struct straight_track track; /* the whole one's, from this ping on */
};

/* Fill with the whole problem, also where the window is all of it; or with the window's grid, and still all pings. The
   track must be straight. */
void stretch_begin(const struct problem *problem, struct stretch *stretch);
/* Cut the track of a window: to pings from which a pixel at range r is seen between r tangent[0] and r tangent[1] ahead
   (m), up to `aside` m and the guard beyond; never fewer than two. */
void stretch_cut(struct stretch *stretch, const double tangent[2], double aside);

/* Set read[pings of the whole]. */
void stretch_reads(const struct stretch *stretch, bool *read);
/* Of ping p of the stretch: 1, less in the guard at an end that the whole track does not have. */
double stretch_weight(const struct stretch *stretch, int p);
/* The samples of the stretch among all of the acquisition. */
const void *stretch_samples(const struct stretch *stretch, const void *samples);

#endif
