/* How pings and receivers sample the track (condition.h): their places along it, gaps between them, and the wavenumbers
   that they resolve. */
#include <math.h>
#include <stdio.h>

#include "contract/algorithm.h"

enum { CENTRES_MOST = 64 };

/* The first phase centres, half the receivers' offsets along the track, from a place on (m), in their order; with a
   `period` > 0 within one. Many at a time: an array may have thousands. */
static int centres_next(const struct acquisition *a, double period, double from, double centres[CENTRES_MOST])
{
    const struct vector axis = condition_axis(a);
    int count = 0;
    for (int m = 0; m < a->receivers; m++) {
        double place = condition_along(axis, a->tx[0], a->rx[m]) / 2;
        place -= period > 0 ? period * floor(place / period) : 0;
        if (!(place >= from) || (count == CENTRES_MOST && place >= centres[count - 1]))
            continue;
        int k = count < CENTRES_MOST ? count++ : count - 1;
        for (; k > 0 && centres[k - 1] > place; k--)
            centres[k] = centres[k - 1];
        centres[k] = place;
    }
    return count;
}

/* Phase centres that lie `apart` m and more from each other along the track; rows and arrays across it share places.
   With a `period` > 0 places come again after so many m, as from ping to ping. *extent (m, may be NULL): from the first
   of those counted to the last. */
static int centres_count(const struct acquisition *a, double period, double apart, double *extent)
{
    double centres[CENTRES_MOST], first = 0, last = -INFINITY;
    int count = 0;
    for (int some; count < a->receivers && (some = centres_next(a, period, last + apart, centres)) > 0;)
        for (int k = 0; k < some && count < a->receivers; k++)
            if (centres[k] >= last + apart) {
                last = centres[k];
                first = count++ > 0 ? first : last;
            }
    if (extent)
        *extent = last - first;
    return count - (period > 0 && count > 1 && first + period - last < apart);
}

/* Phase centres that sample the track: those within half of an even step count as one place. */
static int centres_sampling(const struct acquisition *a, double spacing)
{
    return centres_count(a, fabs(spacing), fabs(spacing) / a->receivers / 2, NULL);
}

/* Phase centres d/2 apart lie n d/2 from ping to ping without gaps, or k deep where the spacing is a k-th part of that;
   an array of one place along the track has no gaps of its own. */
struct condition condition_ghost(const struct acquisition *a, double spacing)
{
    double extent = (condition_offset(a, 2) - condition_offset(a, 0)) / 2;
    const int all = centres_count(a, 0, extent / (a->receivers - 1) / 2, &extent);
    const int count = centres_sampling(a, spacing) > 1 ? all : 1;
    const double half = count > 1 ? extent / (count - 1) * count : fabs(spacing);
    const double even = half / fmax(1, round(half / fabs(spacing)));
    const double speed = a->pri > 0 && condition_speed(a) > 0 ? fabs(spacing) / a->pri : condition_speed(a);
    struct condition ghost = {"ghost",
                              fabs(fabs(spacing) / even - 1),
                              1e-3,
                              false,
                              SEVERITY_WARN,
                              "gaps or overlaps between pings, which make ghosts: ping spacing over half the array, or "
                              "over a whole part of it, less 1",
                              ""};
    condition_cure_add(&ghost, "pings %.5g m apart in place of %.5g m", even, fabs(spacing));
    if (speed > 0)
        condition_cure_add(&ghost, ", a PRI of %.5g s at %.5g m/s", even / speed, speed);
    return ghost;
}

/* m, signed: the even spacing nearest to a track along `axis`, and where along it from ping 0 on it begins: the
   line through both ends, plus the least-squares line of what is left. */
static double even_spacing(const struct acquisition *a, struct vector axis, double *first)
{
    const int last = a->pings - 1;
    const double chord = condition_along(axis, a->tx[0], a->tx[last]) / last;
    double sum = 0, moment = 0, inertia = 0;
    for (int p = 0; p < a->pings; p++) {
        const double left = condition_along(axis, a->tx[0], a->tx[p]) - p * chord, arm = p - 0.5 * last;
        sum += left;
        moment += arm * left;
        inertia += arm * arm;
    }
    *first = sum / a->pings - 0.5 * last * moment / inertia;
    return chord + moment / inertia;
}

/* m: how far a place lies from the line along `axis` through another one. */
static double aside(struct vector axis, struct vector from, struct vector to)
{
    const double u = condition_along(axis, from, to);
    return hypot(hypot(to.x - from.x - u * axis.x, to.y - from.y - u * axis.y), to.z - from.z - u * axis.z);
}

/* m: the spacing of pings so near to a uniform straight track, along any axis, that they have its gaps; 0 for others.
   No ping is farther off than a quarter of it along the track, or all of it across, and the receivers stay where they
   are. */
static double spacing_sampled(const struct acquisition *a)
{
    struct straight_track track;
    const struct vector axis = condition_axis(a);
    double first = 0;
    if (acquisition_is_straight(a, &track))
        return fabs(track.spacing);
    const double step = even_spacing(a, axis, &first), spacing = fabs(step);
    for (int p = 0; p < a->pings; p++) {
        const struct vector *rx = a->rx + (size_t)p * (size_t)a->receivers;
        if (!(fabs(condition_along(axis, a->tx[0], a->tx[p]) - first - p * step) <= spacing / 4
              && aside(axis, a->tx[0], a->tx[p]) <= spacing))
            return 0;
        for (int m = 0; m < a->receivers; m++)
            if (!(fabs(condition_along(axis, a->tx[p], rx[m]) - condition_along(axis, a->tx[0], a->rx[m]))
                  <= spacing / 4))
                return 0;
    }
    return spacing;
}

void condition_beam_named(const struct acquisition *a, struct condition *condition)
{
    if (a->echo_sine > 0 || a->tx_length > 0)
        return;
    snprintf(condition->cure, sizeof condition->cure,
             "tx_length and rx_length (m), or echo_sine, in the echo file: without them the beam is unlimited");
}

struct condition condition_doppler(const struct problem *problem, double spacing)
{
    const struct acquisition *a = problem->acquisition;
    struct condition doppler = {
        "doppler",
        (a->fc + a->bandwidth / 2) * condition_slope(problem) * 2 * fabs(spacing) / centres_sampling(a, spacing),
        1.05,
        false,
        SEVERITY_WARN,
        "the largest azimuth wavenumber of the beam over that which receivers at n places sample, n/(2 spacing)",
        "pings closer together, more receivers along the track, a narrower beam or a lower speed"};
    condition_beam_named(a, &doppler);
    return doppler;
}

int conditions_sampled(const struct problem *problem, struct condition *list, int room)
{
    const struct acquisition *a = problem->acquisition;
    struct condition all[CONDITIONS_MAX];
    int count = conditions_general(problem, all, CONDITIONS_MAX);
    all[count++] = (struct condition){"above_dc",
                                      a->fc - a->bandwidth / 2,
                                      0,
                                      true,
                                      SEVERITY_WARN,
                                      "the lowest frequency fc - B/2 (Hz)",
                                      "a higher carrier or a narrower band"};
    const double spacing = a->pings > 1 ? spacing_sampled(a) : 0;
    if (spacing > 0) {
        all[count++] = condition_doppler(problem, spacing);
        if (a->receivers > 1)
            all[count++] = condition_ghost(a, spacing);
    }
    for (int k = 0; k < count && k < room; k++)
        list[k] = all[k];
    return count < room ? count : room;
}
