/* Problems in turned axes (turned.h). */
#include "backprojection/pairs/turned.h"

#include <stdlib.h>

static double bytes_of(const struct acquisition *a, int patches)
{
    const size_t vectors = (size_t)a->pings * (2 + (size_t)a->receivers) * sizeof *a->tx;
    return (double)((size_t)patches * sizeof(struct grid) + vectors + (size_t)a->pings * sizeof *a->t0
                    + (size_t)a->pulse_length * sizeof *a->pulse);
}

enum status problem_turn_back(struct problem *problem, struct turned_problem *turned, double *bytes)
{
    const int count = problem->patch_count;
    const double angle = problem->patches[0].angle_rad;
    *turned = (struct turned_problem){0};
    for (int k = 1; k < count; k++)
        if (problem->patches[k].angle_rad != angle)
            return status_set(STATUS_UNSUPPORTED, "patches lie in different axes, turned by %g and %g rad", angle,
                              problem->patches[k].angle_rad);
    if (angle == 0)
        return STATUS_OK;
    turned->patches = malloc((size_t)count * sizeof *turned->patches);
    if (!turned->patches)
        return status_set(STATUS_FAILED, "no memory for %d patches", count);
    enum status status = acquisition_turn(problem->acquisition, angle, &turned->acquisition);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < count; k++) {
        turned->patches[k] = problem->patches[k];
        turned->patches[k].angle_rad = 0;
    }
    problem->acquisition = &turned->acquisition;
    problem->patches = turned->patches;
    if (bytes)
        *bytes += bytes_of(&turned->acquisition, count);
    return STATUS_OK;
}

void turned_free(struct turned_problem *turned)
{
    free(turned->patches);
    acquisition_free(&turned->acquisition);
    *turned = (struct turned_problem){0};
}
