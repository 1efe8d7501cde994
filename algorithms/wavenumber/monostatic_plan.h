/* Multi-receiver echoes as the echoes of one monostatic sonar, for what images these alone (SQ18 section 1: echoes of
   many receivers are preprocessed, and imaged as those of one).

   Receiver m of ping p becomes a ping of its own at the middle between it and the transmitter, all of them `spacing`
   apart. At the sonar's speed v, an echo from range rho along the beam's axis, theta off broadside, comes back to it at
   t with  rho = t (c^2 - v^2)/(2 (c - v sin theta)).  From that point the real pair has the exact delay tau_m(t)
   (delay.h), so that its compressed record x becomes

       y(t) = x(tau_m(t)) exp(j 2 pi fc (tau_m(t) - t))

   by taps of least squares (range_migration/delay_compensation.h). Exact along the axis, at any range; off it the phase
   is wrong by about pi fc d^2 (cos^2 theta' - cos^2 theta)/(2 c r). */
#ifndef SASBENCH_WAVENUMBER_MONOSTATIC_PLAN_H
#define SASBENCH_WAVENUMBER_MONOSTATIC_PLAN_H

#include "common/memory.h"
#include "contract/algorithm.h"
#include "contract/delay.h"

struct traces;

enum { MONOSTATIC_NODES = 2048 }; /* fractions of a sample with weights: their steps err by 2e-4 at the band's edge */

/* Of receiver m: its place among a ping's centres, and transmitter and receiver from its centre, m along the track. */
struct centre {
    int place;
    double tx, rx;
};

struct monostatic {
    const struct acquisition *acquisition; /* the problem's */
    enum precision precision;
    double first, spacing, speed, squint; /* m, signed; m/s; rad */
    int taps, threads, length;            /* length: values of a compressed record with its guards */
    double left;                          /* relative L2 error that the conversion is predicted to leave */
    struct centre *centres;               /* [receivers] */
    int *begins;                          /* [receivers][samples]: of the taps in a compressed record */
    unsigned short *nodes;                /* [receivers][samples]: their weights */
    void *turns;                          /* complex [receivers][samples]: the phases; 0 where nothing is read */
    void *weights;                        /* real [MONOSTATIC_NODES + 1][taps] */
    void *scratch;                        /* complex [threads][length] */
    struct traces *traces;
    struct work work;
    struct store store;
};

/* Seconds from a centre's emission: of the pair's echo from the point on the axis from which the centre's own echo
   takes t. NAN where t is not positive. */
static inline double monostatic_delay(const struct monostatic *m, const struct centre *centre, double t)
{
    const double c = m->acquisition->sound_speed, v = m->speed;
    const double range = t * (c - v) * (c + v) / (2 * (c - v * sin(m->squint)));
    const struct vector tx = {centre->tx, 0, 0}, rx = {centre->rx, 0, 0}, velocity = {v, 0, 0};
    const struct vector place = {range * sin(m->squint), range * cos(m->squint), 0};
    return t > 0 ? delay_exact(tx, rx, velocity, place, c) : NAN;
}

/* Tables and plans of a precision; failures are the store's. */
void monostatic_fill_float(struct monostatic *m);
void monostatic_fill_double(struct monostatic *m);
/* Records [pings][receivers][samples] to [pings receivers][samples]. The same bits for any number of threads. */
void monostatic_convert_float(const struct monostatic *m, const void *samples, void *converted);
void monostatic_convert_double(const struct monostatic *m, const void *samples, void *converted);

#endif
