#include "choice/process.h"

#include <math.h>

#include "backprojection/pairs/pairs.h"

static const double DOUBLE = 2 * sizeof(double), FLOAT = 2 * sizeof(float); /* of a complex number */
/* Measured on Debian 12: a simulation of few echoes, whose image is written. */
static const double PROGRAM = 17e6;

double process_bytes(const struct problem *problem, double plan_bytes)
{
    const struct acquisition *a = problem->acquisition;
    const double samples = (double)a->pings * a->receivers * a->samples;
    const double size = problem->precision == PRECISION_DOUBLE ? DOUBLE : FLOAT;
    const double image = problem_pixels(problem) * size;
    return PROGRAM + image + fmax(plan_bytes + samples * (DOUBLE + size), image);
}
