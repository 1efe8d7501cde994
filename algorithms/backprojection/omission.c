#include "backprojection/omission.h"

#include <math.h>

#include "common/delay.h"

enum { PINGS_LEAST = 10, FREQUENCIES = 3 };
static const double abscissas[FREQUENCIES] = {-0.7745966692414834, 0, 0.7745966692414834};
static const double weights[FREQUENCIES] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

/* The middle pixel, and how wide the image is (m). */
static struct vector middle_of(const struct problem *problem, double *width)
{
    const struct grid *g = &problem->patches[problem->patch_count / 2];
    *width = (g->x_count - 1) * g->x_step;
    return grid_point(g, (g->r_count - 1) / 2.0, (g->x_count - 1) / 2.0);
}

/* What ping p brings into the spectrum of a pixel, and the sine of its angle. */
static double ping_weight(const struct acquisition *a, int p, struct vector pixel, double *sine)
{
    const double u = a->tx[p].x - pixel.x, r = hypot(pixel.y - a->tx[p].y, a->tx[p].z);
    const double amplitude = condition_amplitude(a, r, u);
    *sine = u / hypot(u, r);
    return amplitude * amplitude * pow(1 - *sine * *sine, -1.5);
}

/* The energy that pings bring to a pixel, adding to `all`, and to `beyond` from outside `sine`. Returns how many. */
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
    if (a->echo_squint != 0 || a->noisy || !(a->echo_sine > 0 && condition_seen_sine(a) < INFINITY))
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

/* Of what is planned with: times the law; and over the fewest pings. */
static const double SHARE = 1.25, EDGES = 4;

double aperture_planned(const struct problem *problem, double sine)
{
    struct condition list[CONDITIONS_MAX];
    const int count = conditions_sampled(problem, list, CONDITIONS_MAX);
    bool repeats = false;
    int fewest;
    for (int k = 0; k < count; k++)
        repeats |= list[k].severity == SEVERITY_WARN && !condition_holds(&list[k]);
    const double law = aperture_law(problem, sine, &fewest);
    return isnan(law) || repeats ? INFINITY : hypot(SHARE * law, EDGES / fewest);
}

double aperture_least(const struct problem *problem, double error)
{
    const double least = aperture_planned(problem, 1); /* of the edges alone */
    return error > least ? aperture_sine(problem, sqrt(error * error - least * least) / SHARE) : 1;
}

/* Seconds by which a pair's delay is off. */
static double delay_off(const struct acquisition *a, int p, int m, struct vector pixel, enum motion motion)
{
    const struct vector tx = a->tx[p], v = a->velocity[p], still = {0, 0, 0};
    struct vector rx = a->rx[(size_t)p * (size_t)a->receivers + (size_t)m];
    const double exact = delay_exact(tx, rx, v, pixel, a->sound_speed);
    if (motion == MOTION_BROADSIDE) {
        const double travel = 2 * hypot(pixel.y, pixel.z) / a->sound_speed;
        rx = (struct vector){rx.x + v.x * travel, rx.y + v.y * travel, rx.z + v.z * travel};
    }
    return delay_exact(tx, rx, still, pixel, a->sound_speed) - exact;
}

double motion_error(const struct problem *problem, enum motion motion)
{
    const struct acquisition *a = problem->acquisition;
    const double spacing = a->pings > 1 ? fabs(a->tx[1].x - a->tx[0].x) : 0, wavelength = a->sound_speed / a->fc;
    const int receivers = a->receivers;
    double sum = 0, power = 0, at, width;
    double complex mean = 0;
    const struct vector pixel = middle_of(problem, &width);
    const double ghost = spacing > 0 ? wavelength * fabs(pixel.y) / (2 * spacing) : INFINITY; /* m */
    for (int p = 0; p < a->pings; p++) {
        const double weight = ping_weight(a, p, pixel, &at);
        for (int n = 0; n < FREQUENCIES && weight > 0; n++) {
            const double frequency = a->fc + abscissas[n] * a->bandwidth / 2, share = weight * weights[n];
            for (int j = 0; j < receivers; j++) { /* j = 0: the mean over the receivers */
                const double beside = (j <= receivers / 2 ? j : receivers - j) * ghost;
                const double inside = j == 0 ? 1 : 1 - beside / fmax(width, 1e-9 * ghost);
                double complex term = 0;
                for (int m = 0; m < receivers && inside > 0; m++)
                    term +=
                        cexp(2 * I * M_PI * (frequency * delay_off(a, p, m, pixel, motion) - (double)j * m / receivers))
                        / receivers;
                mean += j == 0 ? share * term : 0;
                power += inside > 0 ? share * inside * creal(term * conj(term)) : 0;
            }
            sum += share;
        }
    }
    return sum > 0 ? sqrt(fmax(0, 1 - creal(mean * conj(mean)) / (sum * power))) : NAN;
}
