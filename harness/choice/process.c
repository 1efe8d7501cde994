#include "choice/process.h"

#include <math.h>

#include "backprojection/pairs/pairs.h"

static const double DOUBLE = 2 * sizeof(double), FLOAT = 2 * sizeof(float); /* of a complex number */
/* Measured on Debian 12: a simulation of few echoes, whose image is written. */
static const double PROGRAM = 18.5e6;
static const double READER = 10e6; /* buffers of the process that reads an echo file in part */

double process_bytes(const struct problem *problem, double plan_bytes)
{
    const struct acquisition *a = problem->acquisition;
    const double samples = (double)a->pings * a->receivers * a->samples;
    const double size = problem->precision == PRECISION_DOUBLE ? DOUBLE : FLOAT;
    const double image = problem_pixels(problem) * size;
    return PROGRAM + image + fmax(plan_bytes + samples * (DOUBLE + size), image);
}

double process_tile_bytes(const struct problem *problem, double plan_bytes, double pings)
{
    const struct acquisition *a = problem->acquisition;
    const struct pixel_window w = problem_window(problem, 0);
    const double size = problem->precision == PRECISION_DOUBLE ? DOUBLE : FLOAT;
    const double records = (double)a->pings * a->receivers;
    return PROGRAM + READER + records * sizeof *a->rx + pings * a->receivers * a->samples * size
           + 2.0 * w.rows * w.columns * size + plan_bytes;
}

double process_reading_bytes(const struct acquisition *a)
{
    return PROGRAM + (double)a->pings * a->receivers * a->samples * DOUBLE;
}
