/* The conditions that algorithms share (condition.h). Back projection forms a correct sum whatever they say: what fails
   here shows in its image as ghosts or overlaid echoes, and is not its error. */
#include "condition.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>

#include "algorithm.h"
#include "common/delay.h"

static const double pi = 3.14159265358979323846;

/* The beam of echoes that do not say theirs: where the transmitter's power is half of that broadside, in lambda/D. */
static const double LOBE = 0.443;

bool condition_holds(const struct condition *condition)
{
    return condition->at_least ? condition->value > condition->limit : condition->value <= condition->limit;
}

void condition_message(const struct condition *condition, char *text, size_t size)
{
    snprintf(text, size, "condition %s: %s is %.3g; %s %g is needed (cure: %s)", condition->name, condition->meaning,
             condition->value, condition->at_least ? "more than" : "at most", condition->limit, condition->cure);
}

enum status conditions_check(const char *name, const struct condition *list, int count)
{
    char text[400];
    for (int k = 0; k < count; k++)
        if (list[k].severity == SEVERITY_REFUSE && !condition_holds(&list[k])) {
            condition_message(&list[k], text, sizeof text);
            return status_set(STATUS_UNSUPPORTED, "%s: %s", name, text);
        }
    return STATUS_OK;
}

double condition_sinc(double z)
{
    return fabs(z) < 1e-9 ? 1 : sin(pi * z) / (pi * z);
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

double condition_beam_sine(const struct acquisition *a)
{
    double sine = a->echo_sine > 0 ? a->echo_sine : INFINITY;
    if (!(a->echo_sine > 0) && a->tx_length > 0)
        sine = LOBE * a->sound_speed / a->fc / a->tx_length;
    return a->echo_tapers ? fmin(sine, quarter_sine(a)) : sine;
}

double condition_offset(const struct acquisition *a, int n)
{
    double least = INFINITY, greatest = -INFINITY;
    for (int m = 0; m < a->receivers; m++) {
        least = fmin(least, a->rx[m].x - a->tx[0].x);
        greatest = fmax(greatest, a->rx[m].x - a->tx[0].x);
    }
    return least + n / 2.0 * (greatest - least);
}

int algorithm_conditions(const struct algorithm *algorithm, const struct problem *problem, const void *options,
                         struct condition *list, int room)
{
    return algorithm->conditions ? algorithm->conditions(problem, options, list, room)
                                 : conditions_general(problem, list, room);
}

/* ---- delays ---- */

/* What the pixels ask of the records, worst over the corners of the patches and some pings that see them. */
struct extent {
    double delay;  /* s: the longest that lies in a record */
    double places; /* samples: the largest magnitude of a sample coordinate */
    double slope;  /* s/m: the steepest along the track */
};

/* The first and the last ping that see (x, r), and the nearest one. */
static void pings_seeing(const struct acquisition *a, double x, double r, int pings[3])
{
    double sine = condition_beam_sine(a), nearest = INFINITY;
    pings[0] = pings[1] = pings[2] = -1;
    for (int p = 0; p < a->pings; p++) {
        double u = a->tx[p].x - x, range = sqrt(u * u + pow(a->tx[p].y - r, 2) + pow(a->tx[p].z, 2));
        if (!(fabs(u) <= sine * range))
            continue;
        pings[0] = pings[0] < 0 ? p : pings[0];
        pings[1] = p;
        pings[2] = fabs(u) < nearest ? p : pings[2];
        nearest = fmin(nearest, fabs(u));
    }
}

static void extent_add(const struct acquisition *a, double x, double r, struct extent *extent)
{
    int pings[3];
    pings_seeing(a, x, r, pings);
    for (int n = 0; n < 6; n++) {
        int p = pings[n / 2], m = n % 2 ? a->receivers - 1 : 0;
        if (p < 0)
            continue;
        struct vector tx = a->tx[p], rx = a->rx[(size_t)p * (size_t)a->receivers + (size_t)m], v = a->velocity[p];
        double step = a->sound_speed / a->fc / 100;
        double delay = delay_exact(tx, rx, v, (struct vector){x, r, 0}, a->sound_speed);
        double ahead = delay_exact(tx, rx, v, (struct vector){x - step, r, 0}, a->sound_speed);
        double place = (delay - a->t0[p]) * a->fs;
        extent->slope = fmax(extent->slope, fabs(ahead - delay) / step);
        if (place >= 0 && place <= a->samples - 1) {
            extent->delay = fmax(extent->delay, delay);
            extent->places = fmax(extent->places, place);
        }
    }
}

static struct extent extent_of(const struct problem *problem)
{
    struct extent extent = {0, 0, 0};
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        for (int n = 0; n < 4; n++) {
            const struct vector p = grid_point(g, n / 2 * (g->r_count - 1), n % 2 * (g->x_count - 1));
            extent_add(problem->acquisition, p.x, p.y, &extent);
        }
    }
    return extent;
}

/* ---- the conditions ---- */

static void add(struct condition *list, int room, int *count, struct condition condition)
{
    if (*count < room)
        list[(*count)++] = condition;
}

static double speed_of(const struct acquisition *a)
{
    double fastest = 0;
    for (int p = 0; p < a->pings; p++)
        fastest = fmax(fastest, sqrt(pow(a->velocity[p].x, 2) + pow(a->velocity[p].y, 2) + pow(a->velocity[p].z, 2)));
    return fastest;
}

int conditions_general(const struct problem *problem, struct condition *list, int room)
{
    const struct acquisition *a = problem->acquisition;
    const struct extent extent = extent_of(problem);
    double speed = speed_of(a);
    int count = 0;
    add(list, room, &count,
        (struct condition){"subsonic", 1 - speed / a->sound_speed, 0, true, SEVERITY_REFUSE, "1 - |v|/c",
                           "a lower speed"});
    add(list, room, &count,
        (struct condition){"sampled", a->bandwidth / a->fs, 1, false, SEVERITY_REFUSE, "bandwidth over sampling rate",
                           "a higher sampling rate"});
    add(list, room, &count,
        (struct condition){"phase_digits", 8 * pi * a->fc * extent.delay * DBL_EPSILON / 2, 1e-3, false,
                           SEVERITY_REFUSE, "the phase's rounding in double, 8 pi fc tau 2^-53 (rad)",
                           "shorter delays or a lower carrier"});
    add(list, room, &count,
        (struct condition){"index_digits", extent.places, INT_MAX, false, SEVERITY_REFUSE,
                           "the largest sample coordinate that is read", "shorter records"});
    if (a->pings > 1 && speed > 0) {
        double interval = fabs(a->tx[a->pings - 1].x - a->tx[0].x) / (a->pings - 1) / speed;
        add(list, room, &count,
            (struct condition){"unambiguous", extent.delay / interval, 1, false, SEVERITY_WARN,
                               "the longest delay over the time from ping to ping, beyond which real records overlap",
                               "more time from ping to ping"});
    }
    return count;
}

struct condition condition_ghost(const struct acquisition *a, double spacing)
{
    double half = fabs(condition_offset(a, 2) - condition_offset(a, 0)) / (a->receivers - 1) * a->receivers / 2;
    return (struct condition){"ghost",
                              fabs(fabs(spacing) / half - 1),
                              1e-3,
                              false,
                              SEVERITY_WARN,
                              "how far the ping spacing is from half the array, which makes ghosts (relative)",
                              "pings half the array's length apart"};
}

int conditions_sampled(const struct problem *problem, const void *options, struct condition *list, int room)
{
    const struct acquisition *a = problem->acquisition;
    struct straight_track track;
    int count = conditions_general(problem, list, room);
    (void)options;
    add(list, room, &count,
        (struct condition){"above_dc", a->fc - a->bandwidth / 2, 0, true, SEVERITY_WARN,
                           "the lowest frequency fc - B/2 (Hz)", "a higher carrier or a narrower band"});
    if (a->pings < 2 || !acquisition_is_straight(a, &track))
        return count;
    add(list, room, &count,
        (struct condition){
            "doppler", (a->fc + a->bandwidth / 2) * extent_of(problem).slope * 2 * fabs(track.spacing) / a->receivers,
            1.05, false, SEVERITY_WARN,
            "the widest azimuth wavenumber in the beam over what the receivers sample, M/(2 spacing)",
            "pings closer together, more receivers, a narrower beam or a lower speed"});
    if (a->receivers > 1)
        add(list, room, &count, condition_ghost(a, track.spacing));
    return count;
}
