/* Which pixel-pulse pairs an image sums: those inside the record and inside the aperture limit. */
#ifndef SASBENCH_PAIRS_H
#define SASBENCH_PAIRS_H

#include "algorithm.h"

/* Range rows [begin, end) of one image column. */
struct pair_span {
    int begin, end;
};

/* Rows of the column at azimuth x (m) with |sin theta_t| <= aperture_limit, theta_t from the transmitter at emission to the
   pixel, off the plane normal to `heading` (acquisition_heading of the ping). Fills at most two spans, in rising order;
   returns their count. */
int pair_spans(const struct acquisition *acquisition, int ping, struct vector heading, const struct grid *grid, double x,
               struct pair_span spans[2]);

/* All pairs of a problem inside its records and its aperture limit: what a back projection sums. Exact, and the same on
   every machine. */
double pairs_count(const struct problem *problem);

/* Pixels of all patches. */
double problem_pixels(const struct problem *problem);

#endif
