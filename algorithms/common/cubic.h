/* Cubics through four of `count` >= 4 equally spaced values. */
#ifndef SASBENCH_COMMON_CUBIC_H
#define SASBENCH_COMMON_CUBIC_H

#include <math.h>

/* The first of the four about a place (0: the first value; places beyond them count as the ends), and Lagrange's
   weights. */
static inline int cubic_weights(double place, int count, double weights[4])
{
    place = fmin(fmax(place, 0), count - 1);
    int first = (int)fmin(fmax(floor(place) - 1, 0), count - 4);
    double u = place - first - 1;
    weights[0] = -u * (u - 1) * (u - 2) / 6;
    weights[1] = (u + 1) * (u - 1) * (u - 2) / 2;
    weights[2] = -(u + 1) * u * (u - 2) / 2;
    weights[3] = (u + 1) * u * (u - 1) / 6;
    return first;
}

#endif
