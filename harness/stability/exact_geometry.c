/* Geometry in extended precision (exact_geometry.h). Every constant is a long double: a double one would make its
   whole expression double. */
#include "stability/exact_geometry.h"

#include <math.h>

const long double exact_pi = 3.14159265358979323846264338327950288L;

static struct exact_point point_of(struct vector v)
{
    return (struct exact_point){v.x, v.y, v.z};
}

static struct exact_point difference(struct exact_point a, struct exact_point b)
{
    return (struct exact_point){a.x - b.x, a.y - b.y, a.z - b.z};
}

static long double dot(struct exact_point a, struct exact_point b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static long double length(struct exact_point a)
{
    return sqrtl(dot(a, a));
}

struct exact_pair exact_pair_of(const struct acquisition *a, int ping, int receiver)
{
    return (struct exact_pair){point_of(a->tx[ping]),
                               point_of(a->rx[(size_t)ping * (size_t)a->receivers + (size_t)receiver]),
                               point_of(a->velocity[ping]), a->t0[ping]};
}

struct exact_point exact_pixel_of(const struct grid *patch, int i, int j)
{
    const long double x = patch->x_first + (long double)j * patch->x_step;
    const long double r = patch->r_first + (long double)i * patch->r_step, angle = patch->angle_rad;
    return (struct exact_point){x * cosl(angle) + r * sinl(angle), r * cosl(angle) - x * sinl(angle), 0.0L};
}

/* From the receiver at reception to the point. */
static struct exact_point way_back(const struct exact_pair *pair, struct exact_point p, long double delay)
{
    return (struct exact_point){pair->rx.x + pair->velocity.x * delay - p.x,
                                pair->rx.y + pair->velocity.y * delay - p.y,
                                pair->rx.z + pair->velocity.z * delay - p.z};
}

long double exact_delay(const struct exact_pair *pair, struct exact_point p, long double c)
{
    const struct exact_point u = difference(pair->rx, p), v = pair->velocity;
    const long double out = length(difference(pair->tx, p)), speed = length(v), a = (c - speed) * (c + speed);
    const long double b = c * out + dot(u, v), k = (out - length(u)) * (out + length(u));
    const long double root = b * b - a * k;
    long double delay = (b + sqrtl(root > 0.0L ? root : 0.0L)) / a;
    for (int n = 0; n < 4; n++) {
        const struct exact_point w = way_back(pair, p, delay);
        const long double back = length(w), fault = out + back - c * delay;
        if (!(back > 0.0L))
            break;
        const long double better = delay + fault / (c - dot(v, w) / back);
        const long double left = out + length(way_back(pair, p, better)) - c * better;
        if (!(fabsl(left) < fabsl(fault)))
            break;
        delay = better;
    }
    return delay;
}

static long double sinc(long double z)
{
    return fabsl(z) < 1e-12L ? 1.0L : sinl(exact_pi * z) / (exact_pi * z);
}

/* The sine off the beam's axis, which points `squint` ahead; `along` counts backwards. Behind the beam it has its
   largest value. */
static long double sine_of(long double along, long double across, long double squint)
{
    const long double distance = hypotl(along, across), sine = along * cosl(squint) + across * sinl(squint);
    if (across * cosl(squint) < along * sinl(squint))
        return copysignl(1.0L, sine);
    return distance > 0.0L ? sine / distance : 0.0L;
}

long double exact_beam(const struct scene *scene, const struct exact_pair *pair, struct exact_point p,
                       long double delay)
{
    const struct acquisition *a = &scene->acquisition;
    const struct exact_point out = difference(pair->tx, p), back = way_back(pair, p, delay);
    const long double across_out = hypotl(out.y, out.z), across_back = hypotl(back.y, back.z);
    const long double squint = a->echo_squint;
    const long double sine_out = sine_of(out.x, across_out, squint), sine_back = sine_of(back.x, across_back, squint);
    const long double sine_middle = sine_of((out.x + back.x) / 2.0L, (across_out + across_back) / 2.0L, squint);
    const long double wavenumber = (long double)a->fc / a->sound_speed, elements = a->tx_length * wavenumber;
    const long double edge = scene->beam.limit * (1.0L + 1e-12L);
    long double measure = 0.0L;
    switch (scene->beam.truncation) {
    case TRUNCATION_NONE: break;
    case TRUNCATION_TX: measure = elements * sine_out; break;
    case TRUNCATION_MID: measure = elements * sine_middle; break;
    case TRUNCATION_DOPPLER: measure = elements * (sine_out + sine_back) / 2.0L; break;
    case TRUNCATION_SINE: measure = sine_out; break;
    }
    if (scene->beam.truncation != TRUNCATION_NONE && fabsl(measure) > edge)
        return 0.0L;
    return scene->beam.kind == BEAM_RECT ? 1.0L
                                         : sinc(elements * sine_out) * sinc(a->rx_length * wavenumber * sine_back);
}

long double exact_sine(const struct exact_pair *pair, struct exact_point p, struct vector normal)
{
    const struct exact_point out = difference(pair->tx, p);
    const long double distance = length(out);
    return distance > 0.0L ? fabsl(dot(out, point_of(normal))) / distance : 0.0L;
}
