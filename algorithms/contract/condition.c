/* The conditions that algorithms share (condition.h). Back projection forms a correct sum in any case: an unmet
   condition appears in its image as ghosts or overlaid echoes, which are not its error. */
#include "contract/condition.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "contract/algorithm.h"
#include "contract/delay.h"

/* The beam where none is given: where the transmitter's power is half of that at broadside, in lambda/D. */
static const double LOBE = 0.443;
static const double LOBES = 3; /* of a beam that tapers are followed this far, in nulls */

struct condition condition_most(enum severity severity, const char *name, double value, double limit,
                                const char *meaning, const char *cure)
{
    struct condition condition = {name, value, limit, false, severity, meaning, ""};
    condition_cure_add(&condition, "%s", cure);
    return condition;
}

struct condition condition_least(enum severity severity, const char *name, double value, double limit,
                                 const char *meaning, const char *cure)
{
    struct condition condition = condition_most(severity, name, value, limit, meaning, cure);
    condition.at_least = true;
    return condition;
}

bool condition_holds(const struct condition *condition)
{
    return condition->at_least ? condition->value > condition->limit : condition->value <= condition->limit;
}

void condition_message(const struct condition *condition, char *text, size_t size)
{
    snprintf(text, size, "condition %s: %s is %.3g; %s %g is needed (cure: %s)", condition->name, condition->meaning,
             condition->value, condition->at_least ? "more than" : "at most", condition->limit, condition->cure);
}

void condition_cure_add(struct condition *condition, const char *format, ...)
{
    const size_t used = strlen(condition->cure);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(condition->cure + used, sizeof condition->cure - used, format, arguments);
    va_end(arguments);
}

double condition_at_most(double value)
{
    const double unit = pow(10, floor(log10(value)) - 2);
    return floor(value / unit) * unit;
}

/* The number of the first that refuses; count if none does. */
static int first_refusal(const struct condition *list, int count)
{
    int k = 0;
    while (k < count && (list[k].severity != SEVERITY_REFUSE || condition_holds(&list[k])))
        k++;
    return k;
}

bool conditions_accept(const struct condition *list, int count)
{
    return first_refusal(list, count) == count;
}

enum status conditions_check(const char *name, const struct condition *list, int count)
{
    char text[400];
    int k = first_refusal(list, count);
    if (k == count)
        return STATUS_OK;
    condition_message(&list[k], text, sizeof text);
    return status_set(STATUS_UNSUPPORTED, "%s: %s", name, text);
}

double condition_sinc(double z)
{
    return fabs(z) < 1e-9 ? 1 : sin(M_PI * z) / (M_PI * z);
}

double condition_worse(double worst, double value)
{
    return isnan(worst) || isnan(value) ? NAN : fmax(worst, value);
}

/* Where the echoes' amplitude, by both elements' sinc, falls to a quarter. */
static double quarter_sine(const struct acquisition *a)
{
    double inside = 0, outside = 1 / fmax(a->tx_length, a->rx_length); /* in 1/m: the first null */
    for (int k = 0; k < 50; k++) {
        double middle = (inside + outside) / 2;
        *(condition_sinc(a->tx_length * middle) * condition_sinc(a->rx_length * middle) > 0.25 ? &inside : &outside) =
            middle;
    }
    return inside * a->sound_speed / a->fc;
}

double condition_cut_sine(const struct acquisition *a)
{
    if (a->echo_sine > 0)
        return a->echo_sine;
    return a->tx_length > 0 ? LOBE * a->sound_speed / a->fc / a->tx_length : INFINITY;
}

double condition_beam_sine(const struct acquisition *a)
{
    const double sine = condition_cut_sine(a);
    return a->echo_tapers ? fmin(sine, quarter_sine(a)) : sine;
}

bool condition_beam_known(const struct acquisition *a)
{
    return !a->noisy && a->echo_sine > 0 && condition_seen_sine(a) < INFINITY;
}

double condition_seen_sine(const struct acquisition *a)
{
    return a->echo_tapers ? fmin(a->echo_sine, LOBES * a->sound_speed / a->fc / a->tx_length) : condition_beam_sine(a);
}

/* Sine, off the beam's axis, of a target r m beside the track from a place u m ahead of it. */
static double beam_sine_at(const struct acquisition *a, double r, double u)
{
    return (u * cos(a->echo_squint) + r * sin(a->echo_squint)) / hypot(u, r);
}

double condition_pair_amplitude(const struct acquisition *a, double r, double u, double d)
{
    const double sine = beam_sine_at(a, r, u), turns = a->fc / a->sound_speed;
    if (!(fabs(sine) <= condition_seen_sine(a)))
        return 0;
    if (!a->echo_tapers)
        return 1;
    return condition_sinc(a->tx_length * sine * turns)
           * condition_sinc(a->rx_length * beam_sine_at(a, r, u + d) * turns);
}

double condition_amplitude(const struct acquisition *a, double r, double u)
{
    return condition_pair_amplitude(a, r, u, 0);
}

double condition_along(struct vector axis, struct vector from, struct vector to)
{
    return vector_dot(vector_difference(to, from), axis);
}

/* Unit vector from one ping to another; acquisition_heading where they are in one place. */
static struct vector axis_between(const struct acquisition *a, int first, int last)
{
    const struct vector way = vector_difference(a->tx[last], a->tx[first]);
    const double length = vector_norm(way);
    const struct vector axis =
        length > 0 ? (struct vector){way.x / length, way.y / length, way.z / length} : acquisition_heading(a, first);
    return axis.x < 0 ? (struct vector){-axis.x, -axis.y, -axis.z} : axis;
}

/* Over many pings, so that sway from ping to ping turns no beam. */
static struct vector axis_about(const struct acquisition *a, int ping)
{
    enum { PART = 16 };
    const int around = a->pings / PART > 0 ? a->pings / PART : 1, last = a->pings - 1;
    return axis_between(a, ping > around ? ping - around : 0, ping + around < last ? ping + around : last);
}

struct vector condition_axis(const struct acquisition *a)
{
    return axis_between(a, 0, a->pings - 1);
}

double condition_offset(const struct acquisition *a, int n)
{
    const struct vector axis = condition_axis(a);
    double least = INFINITY, greatest = -INFINITY;
    for (int m = 0; m < a->receivers; m++) {
        const double offset = condition_along(axis, a->tx[0], a->rx[m]);
        least = fmin(least, offset);
        greatest = fmax(greatest, offset);
    }
    return least + n / 2.0 * (greatest - least);
}

int algorithm_conditions(const struct algorithm *algorithm, const struct problem *problem, const void *options,
                         struct condition *list, int room)
{
    return algorithm->conditions ? algorithm->conditions(problem, algorithm->method, options, list, room)
                                 : conditions_general(problem, list, room);
}

/* ---- delays ---- */

/* Requirements of the pixels on the records, the worst of some places of the patches and some pings that see them. */
struct extent {
    double delay;  /* s: the longest that lies in a record */
    double places; /* samples: the largest magnitude of a sample coordinate */
    double slope;  /* s/m: the steepest along the track, less that on the beam's axis */
    int ends[2];   /* receivers at the ends of the array, however it lies and is numbered */
};

/* m: the distance of ping p from the position that has a place on its beam's axis, negative beyond the axis. A place is
   seen within the beam's sine times its distance. */
static double off_axis(const struct acquisition *a, int p, struct vector place, double *distance)
{
    const struct vector axis = axis_about(a, p), way = vector_difference(a->tx[p], place);
    const double u = vector_dot(way, axis);
    const struct vector across = {way.x - u * axis.x, way.y - u * axis.y, way.z - u * axis.z};
    const double across2 = vector_dot(across, across);
    *distance = sqrt(u * u + across2);
    return a->echo_squint != 0 ? u * cos(a->echo_squint) + sqrt(across2) * sin(a->echo_squint) : u;
}

bool condition_sees(const struct acquisition *a, double sine, int ping, struct vector place)
{
    double range, off = fabs(off_axis(a, ping, place, &range));
    return off <= sine * range;
}

/* The first and the last ping that see a place, and the one with the place nearest to its axis; -1: none. */
static void pings_seeing(const struct acquisition *a, double sine, struct vector place, int pings[3])
{
    double nearest = INFINITY, range;
    pings[0] = pings[1] = pings[2] = -1;
    for (int p = 0; p < a->pings; p++) {
        double off = fabs(off_axis(a, p, place, &range));
        if (!(off <= sine * range))
            continue;
        pings[0] = pings[0] < 0 ? p : pings[0];
        pings[1] = p;
        pings[2] = off < nearest ? p : pings[2];
        nearest = fmin(nearest, off);
    }
}

static struct vector moved(struct vector place, struct vector axis, double m)
{
    return (struct vector){place.x + m * axis.x, place.y + m * axis.y, place.z + m * axis.z};
}

/* For other columns, pings lie closer to the edge of the beam than for the tested ones: move the place along the track
   as far as `ping` sees it, at most by the way to `next`, which does not see `place`. */
static struct vector place_at_edge(const struct acquisition *a, double sine, int ping, int next, struct vector place)
{
    const struct vector axis = axis_about(a, ping);
    double inside = 0, outside = condition_along(axis, a->tx[next], a->tx[ping]);
    for (int k = 0; k < 50; k++) {
        const double middle = (inside + outside) / 2;
        *(condition_sees(a, sine, ping, moved(place, axis, middle)) ? &inside : &outside) = middle;
    }
    return moved(place, axis, inside);
}

/* The receiver farthest from `from`, at the first ping. */
static int receiver_farthest(const struct acquisition *a, struct vector from)
{
    int farthest = 0;
    double most = -1;
    for (int m = 0; m < a->receivers; m++) {
        const double away = hypot(hypot(a->rx[m].x - from.x, a->rx[m].y - from.y), a->rx[m].z - from.z);
        farthest = away > most ? m : farthest;
        most = fmax(most, away);
    }
    return farthest;
}

static void extent_add_pings(const struct acquisition *a, double sine, struct vector p, const int pings[3],
                             struct extent *extent)
{
    const double step = a->sound_speed / a->fc / 100, on_axis = -2 * sin(a->echo_squint) / a->sound_speed;
    for (int n = 0; n < 6; n++) {
        const int ping = pings[n / 2], m = extent->ends[n % 2];
        const int next = n / 2 == 0 ? ping - 1 : n / 2 == 1 ? ping + 1 : -1;
        if (ping < 0)
            continue;
        const struct vector tx = a->tx[ping], rx = a->rx[(size_t)ping * (size_t)a->receivers + (size_t)m];
        const struct vector edge = next >= 0 && next < a->pings ? place_at_edge(a, sine, ping, next, p) : p;
        const struct vector axis = axis_about(a, ping);
        const struct vector behind = moved(edge, axis, -step / 2), ahead = moved(edge, axis, step / 2);
        const double delay = delay_exact(tx, rx, a->velocity[ping], p, a->sound_speed);
        const double change = delay_exact(tx, rx, a->velocity[ping], behind, a->sound_speed)
                              - delay_exact(tx, rx, a->velocity[ping], ahead, a->sound_speed);
        const double place = (delay - a->t0[ping]) * a->fs;
        extent->slope = fmax(extent->slope, fabs(change / step - on_axis));
        if (place >= 0 && place <= a->samples - 1) {
            extent->delay = fmax(extent->delay, delay);
            extent->places = fmax(extent->places, place);
        }
    }
}

/* The place of row i that lies nearest to the axis of ping p's beam. */
static struct vector row_on_axis(const struct acquisition *a, int p, const struct grid *g, double i)
{
    double first = 0, last = g->x_count - 1, range;
    const double begin = off_axis(a, p, grid_point(g, i, first), &range);
    const double end = off_axis(a, p, grid_point(g, i, last), &range);
    if ((begin < 0) == (end < 0))
        return grid_point(g, i, fabs(begin) < fabs(end) ? first : last);
    for (int k = 0; k < 50; k++) {
        double middle = (first + last) / 2;
        *((off_axis(a, p, grid_point(g, i, middle), &range) < 0) == (begin < 0) ? &first : &last) = middle;
    }
    return grid_point(g, i, first);
}

/* A patch whose corners and middle no ping sees: the axis of each ping on its first, middle and last row. */
static void extent_search(const struct acquisition *a, double sine, const struct grid *g, struct extent *extent)
{
    for (int p = 0; p < a->pings; p++)
        for (int n = 0; n < 3; n++) {
            const struct vector place = row_on_axis(a, p, g, n / 2.0 * (g->r_count - 1));
            if (condition_sees(a, sine, p, place))
                extent_add_pings(a, sine, place, (const int[3]){-1, -1, p}, extent);
        }
}

static struct extent extent_of(const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    const double sine = condition_beam_sine(a);
    struct extent extent = {.ends = {receiver_farthest(a, a->rx[0])}};
    extent.ends[1] = receiver_farthest(a, a->rx[extent.ends[0]]);
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        bool seen = false;
        for (int n = 0; n < 5; n++) { /* the corners, and the middle */
            double u = n < 4 ? n % 2 : 0.5, w = n < 4 ? n / 2 : 0.5;
            const struct vector place = grid_point(g, w * (g->r_count - 1), u * (g->x_count - 1));
            int pings[3];
            pings_seeing(a, sine, place, pings);
            extent_add_pings(a, sine, place, pings, &extent);
            seen = seen || pings[0] >= 0;
        }
        if (!seen)
            extent_search(a, sine, g, &extent);
    }
    return extent;
}

/* ---- the conditions ---- */

static void add(struct condition *list, int room, int *count, struct condition condition)
{
    if (*count < room)
        list[(*count)++] = condition;
}

double condition_slope(const struct problem *problem)
{
    return extent_of(problem).slope;
}

double condition_speed(const struct acquisition *a)
{
    double fastest = 0;
    for (int p = 0; p < a->pings; p++)
        fastest = fmax(fastest, vector_norm(a->velocity[p]));
    return fastest;
}

/* s: the way from ping p to the next over the mean speed of both; 0 where they do not move. */
static double interval_after(const struct acquisition *a, int p)
{
    const struct vector *tx = a->tx + p;
    const double speed = (vector_norm(a->velocity[p]) + vector_norm(a->velocity[p + 1])) / 2;
    const double way = vector_norm(vector_difference(tx[1], tx[0]));
    return speed > 0 ? way / speed : 0;
}

/* s: the time from ping to ping; if it is not given, the median of the ways' times, which a turn between two legs does
   not change. 0: not given, and nothing moves. */
static double ping_interval(const struct acquisition *a)
{
    double low = 0, high = 0;
    int moving = 0;
    if (a->pri > 0)
        return a->pri;
    for (int p = 0; p + 1 < a->pings; p++) {
        high = fmax(high, interval_after(a, p));
        moving += interval_after(a, p) > 0;
    }
    for (int k = 0; k < 50; k++) {
        const double middle = (low + high) / 2;
        int below = 0;
        for (int p = 0; p + 1 < a->pings; p++)
            below += interval_after(a, p) > 0 && interval_after(a, p) <= middle;
        *(2 * below >= moving ? &high : &low) = middle;
    }
    return high;
}

int conditions_general(const struct problem *problem, struct condition *list, int room)
{
    const struct acquisition *a = problem->acquisition;
    const struct extent extent = extent_of(problem);
    const double interval = ping_interval(a);
    int count = 0;
    add(list, room, &count,
        condition_least(SEVERITY_REFUSE, "subsonic", 1 - condition_speed(a) / a->sound_speed, 0, "1 - |v|/c",
                        "a lower speed"));
    add(list, room, &count,
        condition_most(SEVERITY_REFUSE, "sampled", a->bandwidth / a->fs, 1, "bandwidth over sampling rate",
                       "a higher sampling rate"));
    add(list, room, &count,
        condition_most(SEVERITY_REFUSE, "phase_digits", 8 * M_PI * a->fc * extent.delay * DBL_EPSILON / 2, 1e-3,
                       "the phase's rounding in double, 8 pi fc tau 2^-53 (rad)", "shorter delays or a lower carrier"));
    add(list, room, &count,
        condition_most(SEVERITY_REFUSE, "index_digits", extent.places, INT_MAX,
                       "the largest sample coordinate that is read", "shorter records"));
    if (a->pings > 1 && interval > 0) {
        struct condition unambiguous =
            condition_most(SEVERITY_WARN, "unambiguous", extent.delay / interval, 1,
                           "the longest delay over the time from ping to ping, beyond which real records overlap",
                           "more time from ping to ping");
        condition_cure_add(&unambiguous, " than %.3g s", extent.delay);
        add(list, room, &count, unambiguous);
    }
    return count;
}
