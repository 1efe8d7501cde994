/* Which pixel-record pairs an image sums: those inside the record and inside the aperture limit. */
#ifndef SASBENCH_BACKPROJECTION_PAIRS_PAIRS_H
#define SASBENCH_BACKPROJECTION_PAIRS_PAIRS_H

#include <float.h>

#include "contract/algorithm.h"

/* Evenly spaced pixels along azimuth or range: pixel i lies at (x_first + i x_step, r_first + i r_step, 0). */
struct pixel_line {
    double x_first, r_first; /* m */
    double x_step, r_step;   /* m: one of them is > 0, the other 0 */
    int count;               /* pixels, >= 1 */
};

/* Pixels [begin, end) of a line. */
struct pair_span {
    int begin, end;
};

/* Lines of a grid: its rows (along_x) or its columns, in the grid's own axes. */
int grid_line_count(const struct grid *grid, bool along_x);
struct pixel_line grid_line(const struct grid *grid, bool along_x, int number);
struct vector line_pixel(const struct pixel_line *line, int i);

/* m: the distance by rounding between a pixel and a transmitter in the same place, from the magnitudes of their
   coordinates. Below it the angle is meaningless, and the pixel counts as inside any aperture limit. */
static inline double apex_slack(double pixel, double transmitter)
{
    return 4 * DBL_EPSILON * (pixel + transmitter);
}

/* Pixels of the line with |sin theta_t| <= aperture_limit, theta_t from the transmitter at emission to the pixel, off
   the plane normal to `normal` (acquisition_normal of the ping). Fills at most two spans, in rising order; returns
   their count. */
int pair_spans(const struct acquisition *acquisition, int ping, struct vector normal, const struct pixel_line *line,
               struct pair_span spans[2]);

/* Pixels of `within` (not empty) whose delay lies inside the record of one receiver: at most two spans, in rising
   order; returns their count. */
int record_spans(const struct acquisition *acquisition, int ping, int receiver, const struct pixel_line *line,
                 struct pair_span within, struct pair_span spans[2]);

/* Fill met[pings]: false where a ping is certainly in no pair: its aperture and those of the pings beside it contain no
   pixel, or all delays are outside its records. Returns the number of pings met. */
int pings_met(const struct problem *problem, bool *met);

/* Samples of a record, as fractions counted from its first one, both ends included. */
struct sample_span {
    double first, last;
};

/* Samples that contain all delays of a problem's pairs, and those of pixels up to `beside` m ahead of or behind them;
   no more than the record. Only pings that are met count (NULL: all are); {0, 0} without any. */
struct sample_span pairs_samples(const struct problem *problem, const bool *met, double beside);

/* The number of pairs of a problem inside its records and its aperture limit: the pairs that back projection sums.
   Exact, unless problem->estimate, and the same on every machine. Grids may be turned (turned.h), for this function
   alone. NAN without memory to turn them. */
double pairs_count(const struct problem *problem);

/* pairs_count within 2 %, from some of the lines of a large problem, in a fraction of a second; of a small one the same
   number. The same on every machine. */
double pairs_estimate(const struct problem *problem);

/* Pixels of all patches. */
double problem_pixels(const struct problem *problem);

#endif
