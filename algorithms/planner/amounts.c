#include "planner/amounts.h"

#include <math.h>

#include "backprojection/pairs.h"
#include "backprojection/turned.h"

enum status pairs_of_problem(const struct problem *problem, double *pairs)
{
    struct problem along = *problem;
    struct turned_problem turned = {0};
    enum status status = problem_turn_back(&along, &turned, NULL);
    *pairs = status == STATUS_OK ? pairs_count(&along) : 0;
    turned_free(&turned);
    return status;
}

double reads_of_images(const struct problem *problem, double pairs)
{
    /* Of an image; pairs that one takes for a record and for a ping, beside those of its places; that a pixel takes. */
    static const double LINES = 8, RECORD = 130, PING = 600, PIXEL = 1.4;
    const struct acquisition *a = problem->acquisition;
    const double pixels = problem_pixels(problem), step = a->sound_speed / (2 * a->fs);
    double places = 0;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        places += fmin(g->r_count * g->r_step, g->x_count * g->x_step) / step + RECORD + PING / a->receivers;
    }
    return PIXEL * pixels + pairs / pixels * LINES * places;
}
