/* The exact two-way delay without the stop-and-hop approximation: BP22 Eq. (1) = LBF21 Eq. (1), written in space. */
#ifndef SASBENCH_CONTRACT_DELAY_H
#define SASBENCH_CONTRACT_DELAY_H

#include <math.h>

#include "contract/acquisition.h"

/* c^2 - |velocity|^2 without a square root, which would lose the digits of c - |velocity| in rounding modes other than
   the usual one: the greatest component v goes into (c - v)(c + v), where nothing cancels, and the others are
   subtracted. */
static inline double delay_margin(struct vector velocity, double c)
{
    double x = fabs(velocity.x), y = fabs(velocity.y), z = fabs(velocity.z), v = fmax(x, fmax(y, z));
    double others = v == x ? y * y + z * z : v == y ? x * x + z * z : x * x + y * y;
    return (c - v) * (c + v) - others;
}

/* Seconds from the emission at `tx` over the point `p` to the receiver, which is at `rx` at emission and moves with
   `velocity` (|velocity| < c) until reception: solves c tau = |tx - p| + |rx + velocity tau - p| in closed form. The
   root is always the positive one, (q + s)/e = n/(s - q), by the form that adds. e = c^2 - |velocity|^2 is
   delay_margin, so that nothing cancels at any speed (6e-17 s). */
static inline double delay_exact(struct vector tx, struct vector rx, struct vector velocity, struct vector p, double c)
{
    double ax = tx.x - p.x, ay = tx.y - p.y, az = tx.z - p.z;
    double t = sqrt(ax * ax + ay * ay + az * az) / c;
    double bx = rx.x - p.x + velocity.x * t, by = rx.y - p.y + velocity.y * t, bz = rx.z - p.z + velocity.z * t;
    double e = delay_margin(velocity, c);
    double q = bx * velocity.x + by * velocity.y + bz * velocity.z, n = bx * bx + by * by + bz * bz;
    double s = sqrt(q * q + e * n);
    return t + (q >= 0 ? (q + s) / e : n / (s - q));
}

#endif
