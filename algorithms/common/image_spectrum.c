#include "common/image_spectrum.h"

#include <math.h>

#include "contract/condition.h"

double image_cells(const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    const double cell = a->sound_speed / (4 * a->fc * fmin(condition_cut_sine(a), 1));
    double width = 0;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        width = fmax(width, fabs(g->x_count * g->x_step * cos(g->angle_rad))
                                + fabs(g->r_count * g->r_step * sin(g->angle_rad)));
    }
    return width / cell;
}

double image_gain(const struct acquisition *a, double cells, double frequency)
{
    return cells > 0 ? fmin(fabs(a->fc / (a->fc + frequency)), cells) / fmin(1, cells) : 1;
}
