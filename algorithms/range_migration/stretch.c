/* The pings of a window of an image by azimuth transforms (stretch.h). */
#include "range_migration/stretch.h"

#include <math.h>

#include "range_migration/rma.h"

void stretch_begin(const struct problem *problem, struct stretch *stretch)
{
    const struct pixel_window w = problem_window(problem, 0);
    *stretch = (struct stretch){.problem = *problem, .pings = problem->acquisition->pings};
    stretch->problem.window = NULL;
    stretch->cut = w.columns < problem->patches[0].x_count || w.rows < problem->patches[0].r_count;
    acquisition_is_straight(problem->acquisition, &stretch->track);
    if (!stretch->cut)
        return;
    stretch->grid = grid_part(problem->patches, problem->window);
    stretch->problem.patches = &stretch->grid;
}

void stretch_cut(struct stretch *stretch, const double tangent[2], double aside)
{
    const struct acquisition *a = stretch->problem.acquisition;
    const struct grid *g = &stretch->grid;
    const struct straight_track *track = &stretch->track;
    double low = INFINITY, high = -INFINITY, guard = INFINITY; /* pings */
    for (int k = 0; k < 4; k++) {
        const struct vector p = grid_point(g, k / 2 * (g->r_count - 1), k % 2 * (g->x_count - 1));
        const double beyond = aside + azimuth_guard(a, p.y);
        guard = fmin(guard, azimuth_guard(a, p.y) / fabs(track->spacing));
        for (int side = 0; side < 2; side++) {
            const double x = p.x - p.y * tangent[side] + (side ? -beyond : beyond);
            low = fmin(low, (x - track->x_first) / track->spacing);
            high = fmax(high, (x - track->x_first) / track->spacing);
        }
    }
    stretch->fades = guard / 2;
    const int last_two = a->pings - 2;
    stretch->first = (int)fmax(0, fmin(floor(low), last_two));
    const int last = (int)fmin(a->pings - 1, fmax(ceil(high), stretch->first + 1));
    stretch->part = acquisition_part(a, stretch->first, last - stretch->first + 1);
    stretch->problem.acquisition = &stretch->part;
    stretch->track.x_first += stretch->first * track->spacing;
}

void stretch_reads(const struct stretch *stretch, bool *read)
{
    for (int p = 0; p < stretch->pings; p++)
        read[p] = p >= stretch->first && p < stretch->first + stretch->problem.acquisition->pings;
}

double stretch_weight(const struct stretch *stretch, int p)
{
    const int last = stretch->problem.acquisition->pings - 1;
    const int in[2] = {p, last - p};
    const bool ends[2] = {stretch->first == 0, stretch->first + last + 1 == stretch->pings};
    double weight = 1;
    for (int k = 0; k < 2; k++)
        if (stretch->cut && !ends[k] && in[k] < stretch->fades)
            weight *= pow(sin(M_PI / 2 * (in[k] + 0.5) / stretch->fades), 2);
    return weight;
}

const void *stretch_samples(const struct stretch *stretch, const void *samples)
{
    const struct acquisition *a = stretch->problem.acquisition;
    const size_t size = stretch->problem.precision == PRECISION_DOUBLE ? 16 : 8;
    return (const char *)samples + (size_t)stretch->first * (size_t)a->receivers * (size_t)a->samples * size;
}
