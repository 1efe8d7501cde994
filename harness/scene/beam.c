/* The beams of transmitter and receivers (simulate.h). */
#include <math.h>

#include "scene/simulate.h"

#define REAL_DOUBLE 1 /* the phasors' precision */
#include "common/phasor.h"

/* An element has no direction to a point at its own place: it is seen as on the axis, sine 0. `along` counts from
   the point to the element, backwards. */
static double sine(const struct acquisition *a, double along, double across)
{
    double distance = hypot(along, across);
    if (a->echo_squint != 0) {
        const double c = cos(a->echo_squint), s = sin(a->echo_squint), ahead = across * c - along * s;
        along = along * c + across * s;
        if (ahead < 0) { /* the beam has no back lobe */
            return along < 0 ? -1 : 1;
        }
    }
    return distance > 0 ? along / distance : 0;
}

struct beam_angles beam_angles(const struct acquisition *a, int ping, int receiver, struct vector p, double tau)
{
    struct vector t = a->tx[ping], r = a->rx[(size_t)ping * (size_t)a->receivers + (size_t)receiver];
    struct vector v = a->velocity[ping];
    double ut = t.x - p.x, ur = r.x + v.x * tau - p.x, um = (ut + ur) / 2;
    double across_t = hypot(t.y - p.y, t.z - p.z), across_r = hypot(r.y + v.y * tau - p.y, r.z + v.z * tau - p.z);
    return (struct beam_angles){sine(a, ut, across_t), sine(a, ur, across_r), sine(a, um, (across_t + across_r) / 2)};
}

/* sin(pi z) and pi z, z >= 0: 1 and 1 at 0, and 0 above 2^31, where z is hardly exact to a turn. Vectorises. */
static inline void sinc(double z, double *numerator, double *denominator)
{
    const double turns = z < 0x1p31 ? 0.5 * z : 0x1p30;
    double c, s;
    phasor(turns - (double)(int)(turns + 0.5), &c, &s);
    *numerator = z < 1e-9 ? 1 : s;
    *denominator = z < 1e-9 ? 1 : M_PI * z;
}

/* What grows by a hertz until it meets the beam's edge; 0 where that does not depend on frequency. */
static double edge_slope(const struct scene *scene, const struct beam_angles *angles)
{
    const double length_s = scene->acquisition.tx_length / scene->acquisition.sound_speed;
    switch (scene->beam.truncation) {
    case TRUNCATION_TX: return length_s * fabs(angles->tx);
    case TRUNCATION_MID: return length_s * fabs(angles->mid);
    case TRUNCATION_DOPPLER: return length_s * fabs(angles->tx + angles->rx) / 2;
    default: return 0;
    }
}

void beam_weights(const struct scene *scene, const struct beam_angles *angles, const double *offset, int count,
                  double *weight)
{
    const struct acquisition *a = &scene->acquisition;
    const struct beam *beam = &scene->beam;
    const double tx = a->tx_length / a->sound_speed * fabs(angles->tx);
    const double rx = a->rx_length / a->sound_speed * fabs(angles->rx);
    const double edge = beam->limit * (1 + 1e-12); /* an edge met exactly counts as inside */
    const double slope = edge_slope(scene, angles);
    bool any = false;
    for (int k = 0; k < count; k++) {
        const double f = fabs(a->fc + offset[k]);
        const bool inside = beam->truncation == TRUNCATION_SINE ? fabs(angles->tx) <= edge : slope * f <= edge;
        weight[k] = inside || beam->truncation == TRUNCATION_NONE;
        any = any || weight[k] > 0;
    }
    if (!any || beam->kind == BEAM_RECT)
        return;
#pragma omp simd
    for (int k = 0; k < count; k++) {
        const double f = fabs(a->fc + offset[k]);
        double tx_over, tx_under, rx_over, rx_under;
        sinc(tx * f, &tx_over, &tx_under);
        sinc(rx * f, &rx_over, &rx_under);
        weight[k] *= tx_over * rx_over / (tx_under * rx_under);
    }
}

double beam_sine(const struct scene *scene)
{
    const struct acquisition *a = &scene->acquisition;
    double lowest = scene->beam.per_frequency ? a->fc - a->bandwidth / 2 : a->fc;
    if (scene->beam.truncation == TRUNCATION_SINE)
        return scene->beam.limit;
    if (!(lowest > 0) || scene->beam.truncation == TRUNCATION_NONE)
        return INFINITY;
    return scene->beam.limit * a->sound_speed / lowest / a->tx_length;
}
