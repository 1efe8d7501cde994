/* Delays, angles and beams in extended precision, written apart from the engines (contract/delay.h) and from the
   simulator, so that their faults cannot hide here. long double has at least 64 bits of mantissa. */
#ifndef SASBENCH_STABILITY_EXACT_GEOMETRY_H
#define SASBENCH_STABILITY_EXACT_GEOMETRY_H

#include <float.h>

#include "scene/scene.h"

_Static_assert(LDBL_MANT_DIG >= 64, "the exact image needs a long double of 64 bits or more");

extern const long double exact_pi;

/* A point in space, m. */
struct exact_point {
    long double x, y, z;
};

/* One record: a ping as one receiver received it. */
struct exact_pair {
    struct exact_point tx, rx, velocity; /* m, m at emission, m/s */
    long double t0;                      /* s: time of the first sample */
};

struct exact_pair exact_pair_of(const struct acquisition *acquisition, int ping, int receiver);

/* Pixel (i, j) of a patch: its coordinates are multiplied out in long double. */
struct exact_point exact_pixel_of(const struct grid *patch, int i, int j);

/* s: the root of c tau = |tx - p| + |rx + velocity tau - p| (BP22 Eq. (1)), from the quadratic and then by Newton's
   method on the equation itself. */
long double exact_delay(const struct exact_pair *pair, struct exact_point p, long double sound_speed);

/* Amplitude of the echo of a unit target at p with this delay, by the scene's beam at the carrier. */
long double exact_beam(const struct scene *scene, const struct exact_pair *pair, struct exact_point p,
                       long double delay);

/* |sin theta_t| of p off the plane across `normal`. */
long double exact_sine(const struct exact_pair *pair, struct exact_point p, struct vector normal);

#endif
