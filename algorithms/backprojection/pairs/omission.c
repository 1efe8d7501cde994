#include "backprojection/pairs/omission.h"

#include <math.h>

#include "contract/delay.h"
#include "common/turns.h"

enum { PINGS_LEAST = 10 };

/* The energy of ping p in the spectrum of a pixel, and the sine of its angle. */
static double ping_weight(const struct acquisition *a, int p, struct vector pixel, double *sine)
{
    const double u = a->tx[p].x - pixel.x, r = hypot(pixel.y - a->tx[p].y, a->tx[p].z);
    const double amplitude = condition_amplitude(a, r, u);
    *sine = u / hypot(u, r);
    return amplitude * amplitude * pow(1 - *sine * *sine, -1.5);
}

/* Add the pings' energy at a pixel to `all`, and that from outside `sine` to `beyond`. Returns the number of pings. */
static int pings_weigh(const struct acquisition *a, struct vector pixel, double sine, double *all, double *beyond)
{
    int seeing = 0;
    for (int p = 0; p < a->pings; p++) {
        double at;
        const double weight = ping_weight(a, p, pixel, &at);
        if (!(fabs(at) <= a->aperture_limit))
            continue;
        seeing += weight > 0;
        *all += weight;
        *beyond += fabs(at) > sine ? weight : 0;
    }
    return seeing;
}

/* The law, and the fewest pings that see one of the places; NAN without a law. */
static double aperture_law(const struct problem *problem, double sine, int *fewest)
{
    enum { PLACES = 3 };
    const struct acquisition *a = problem->acquisition;
    double all = 0, beyond = 0;
    *fewest = a->pings;
    if (a->echo_squint != 0 || !condition_beam_known(a))
        return NAN;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        for (int n = 0; n < PLACES * PLACES; n++) {
            const double i = (g->r_count - 1.0) * (n / PLACES) / (PLACES - 1);
            const double j = (g->x_count - 1.0) * (n % PLACES) / (PLACES - 1);
            const int seeing = pings_weigh(a, grid_point(g, i, j), sine, &all, &beyond);
            *fewest = seeing < *fewest ? seeing : *fewest;
        }
    }
    return *fewest >= PINGS_LEAST ? sqrt(beyond / all) : NAN;
}

double aperture_error(const struct problem *problem, double sine)
{
    int fewest;
    return aperture_law(problem, sine, &fewest);
}

double aperture_sine(const struct problem *problem, double error)
{
    double low = 0, high = 1;
    if (isnan(aperture_error(problem, 1)))
        return INFINITY;
    for (int k = 0; k < 24; k++) {
        const double middle = (low + high) / 2;
        *(aperture_error(problem, middle) <= error ? &high : &low) = middle;
    }
    return high;
}

/* Factors of the planned error: of the law; and over the fewest pings. */
static const double SHARE = 1.25, EDGES = 4;

/* Does the aperture end where echoes are still strong? */
static bool ends_at_once(const struct acquisition *a)
{
    static const double STRONG = 0.01; /* of the power on the beam's axis */
    const double edge = fmin(a->aperture_limit, condition_seen_sine(a)) * (1 - 1e-6), r = 1e3;
    const double amplitude = condition_amplitude(a, r, edge < 1 ? r * edge / sqrt(1 - edge * edge) : r);
    const double axis = condition_amplitude(a, r, 0);
    return amplitude * amplitude > STRONG * axis * axis;
}

enum { REACH = 64 /* pixels on either side of a target */, PIXELS = 2 * REACH + 1 };

/* Pixels beside a target, by the whole aperture and by the limited one. */
struct profile {
    int reach;
    double complex whole[PIXELS], limited[PIXELS];
};

/* The azimuth profile through a target in the middle of a patch: each pixel sums the pings within its own sine. Enough
   receivers that repetitions lie beyond the profile. */
static void profile_make(const struct acquisition *a, const struct grid *g, double sine, struct profile *profile)
{
    const double i = (g->r_count - 1) / 2.0, j = (g->x_count - 1) / 2.0, wavelength = a->sound_speed / a->fc;
    const struct vector target = grid_point(g, i, j), still = {0, 0, 0};
    const double spacing = a->pings > 1 ? fabs(a->tx[1].x - a->tx[0].x) : 0, r = hypot(target.y, target.z);
    *profile = (struct profile){.reach = g->x_count / 2 < REACH ? g->x_count / 2 : REACH};
    const double needed = ceil(4 * profile->reach * g->x_step * spacing / (wavelength * fmax(r, wavelength)));
    const int receivers = (int)fmax(1, fmin(a->receivers, needed));
    for (int n = 0; n < a->pings * receivers; n++) {
        const int p = n / receivers, m = n % receivers;
        const struct vector tx = a->tx[p];
        const struct vector rx = a->rx[p * a->receivers + (2 * m + 1) * a->receivers / (2 * receivers)];
        const double seen = condition_amplitude(a, hypot(target.y - tx.y, tx.z), tx.x - target.x);
        const double own = delay_exact(tx, rx, still, target, a->sound_speed);
        for (int k = -profile->reach; k <= profile->reach && seen > 0; k++) {
            const struct vector pixel = grid_point(g, i, j + k);
            const double u = tx.x - pixel.x, at = fabs(u) / hypot(u, hypot(pixel.y - tx.y, tx.z));
            if (!(at <= a->aperture_limit))
                continue;
            const double late = delay_exact(tx, rx, still, pixel, a->sound_speed) - own;
            const double complex term = seen * condition_sinc(a->bandwidth * late) * cexp(2 * I * M_PI * a->fc * late);
            profile->whole[profile->reach + k] += term;
            profile->limited[profile->reach + k] += at <= sine ? term : 0;
        }
    }
}

static double profile_error(const struct problem *problem, double sine)
{
    enum { PATCHES = 4 };
    const int step = (problem->patch_count + PATCHES - 1) / PATCHES;
    double whole = 0, limited = 0;
    double complex both = 0;
    for (int k = 0; k < problem->patch_count; k += step) {
        struct profile profile;
        profile_make(problem->acquisition, &problem->patches[k], sine, &profile);
        for (int n = 0; n <= 2 * profile.reach; n++) {
            whole += creal(profile.whole[n] * conj(profile.whole[n]));
            limited += creal(profile.limited[n] * conj(profile.limited[n]));
            both += profile.whole[n] * conj(profile.limited[n]);
        }
    }
    const double power = whole * limited;
    return power > 0 ? unlike(both, power) : 1;
}

/* For a problem with a law. */
static double planned_error(const struct problem *problem, double sine)
{
    int fewest;
    const double law = SHARE * aperture_law(problem, sine, &fewest), planned = hypot(law, EDGES / fewest);
    return ends_at_once(problem->acquisition) ? fmax(planned, SHARE * profile_error(problem, sine)) : planned;
}

/* Is there a law, and do targets not repeat? `least`: the error of the edges alone. */
static bool has_law(const struct problem *problem, double *least)
{
    struct condition list[CONDITIONS_MAX];
    const int count = conditions_sampled(problem, list, CONDITIONS_MAX);
    int fewest;
    for (int k = 0; k < count; k++)
        if (list[k].severity == SEVERITY_WARN && !condition_holds(&list[k]))
            return false;
    if (isnan(aperture_law(problem, 1, &fewest)))
        return false;
    *least = EDGES / fewest;
    return true;
}

double aperture_planned(const struct problem *problem, double sine)
{
    double least;
    return has_law(problem, &least) ? planned_error(problem, sine) : INFINITY;
}

double aperture_least(const struct problem *problem, double error)
{
    enum { STEPS = 6 };
    double least;
    if (!has_law(problem, &least) || !(error > least))
        return 1;
    double low = aperture_sine(problem, sqrt(error * error - least * least) / SHARE), high = 1;
    if (!ends_at_once(problem->acquisition) || planned_error(problem, low) <= error)
        return low;
    for (int k = 0; k < STEPS; k++) {
        const double middle = (low + fmin(high, problem->acquisition->aperture_limit)) / 2;
        *(planned_error(problem, middle) <= error ? &high : &low) = middle;
    }
    return high;
}
