/* Error laws of interpolators (law.h). Fractions are averaged by the midpoint rule; interpolators that round have
   equally many in each step. */
#include "backprojection/law.h"

#include <math.h>
#include <stdlib.h>

#include "backprojection/farrow.h"
#include "contract/condition.h"
#include "contract/delay.h"
#include "common/turns.h"

/* An interpolator's response H(nu, delta) (law.h). */
struct response {
    const struct interpolator *in;
    const struct law_spectrum *spectrum;
    double gains[LAW_NODES][FARROW_MOST + 1]; /* of branches */
    double *taps;                             /* [in->taps] */
};

/* H of Farrow branches with these gains (farrow_gains): their value for exp(j 2 pi nu u), |u| <= 1/2, over the exact
   one. */
static double complex branches_response(int degree, const double *gains, double nu, double u)
{
    static const double complex signs[] = {1, I};
    double power = 1;
    double complex sum = 0;
    for (int m = 0; m <= degree; m++, power *= u)
        sum += signs[m % 2] * gains[m] * power;
    return sum * cexp(-2 * I * M_PI * nu * u);
}

/* H of taps, the first of them `first` samples on. */
static double complex taps_response(const double *taps, int first, int count, double nu, double fraction)
{
    const double complex step = cexp(2 * I * M_PI * nu);
    double complex wave = cexp(2 * I * M_PI * nu * (first - fraction)), sum = 0;
    for (int k = 0; k < count; k++, wave *= step)
        sum += taps[k] * wave;
    return sum;
}

/* The arguments must outlive it. False without memory; then there is nothing to free. */
static bool response_begin(const struct interpolator *in, const struct law_spectrum *spectrum,
                           struct response *response)
{
    *response = (struct response){.in = in, .spectrum = spectrum};
    response->taps = malloc((size_t)in->taps * sizeof *response->taps);
    for (int n = 0; n < spectrum->count && in->degree > 0; n++)
        farrow_gains(in->degree, spectrum->nu[n] / in->upsample, response->gains[n]);
    return response->taps != NULL;
}

/* H at each frequency of the spectrum, list [spectrum->count]; the fraction, 0 to 1, is of upsampled samples. */
static void response_at(struct response *response, double fraction, double complex *list)
{
    const struct interpolator *in = response->in;
    const int steps = in->steps;
    const double place = steps > 0 ? floor(fraction * steps + 0.5) / steps : fraction;
    const double u = fraction < 0.5 ? fraction : fraction - 1;
    const int whole = (int)floor(place);
    response->taps[0] = 1;
    if (in->weights)
        in->weights(in, place - whole, response->taps);
    for (int n = 0; n < response->spectrum->count; n++) {
        const double nu = response->spectrum->nu[n] / in->upsample;
        const double complex read = in->degree > 0
                                        ? branches_response(in->degree, response->gains[n], nu, u)
                                        : taps_response(response->taps, whole + in->first, in->taps, nu, fraction);
        const double lost = in->preemphasis && nu > 0 ? pow(sin(M_PI * nu) / (M_PI * nu), 2) : 1;
        list[n] = read / lost;
    }
}

static void response_end(struct response *response)
{
    free(response->taps);
    response->taps = NULL;
}

enum { FRACTIONS = 32, IN_A_STEP = 4 };

/* Mean of H - 1 and of its square at one frequency, over the fractions. */
struct moments {
    double complex mean;
    double squares;
};

static double error_of(const struct moments *list, const struct law_spectrum *spectrum)
{
    double mean = 0, variance = 0;
    for (int n = 0; n < spectrum->count; n++) {
        mean += spectrum->weight[n] * creal(list[n].mean);
        variance += spectrum->weight[n] * square(list[n].mean)
                    + spectrum->scattered[n] * fmax(list[n].squares - square(list[n].mean), 0);
    }
    variance -= mean * mean;
    return sqrt(fmax(variance, 0) / ((1 + mean) * (1 + mean) + variance)); /* <|H|^2> = |<H>|^2 + variance */
}

double interpolation_error(const struct interpolator *in, const struct law_spectrum *spectrum)
{
    struct moments list[LAW_NODES] = {{0}};
    struct response response;
    const int steps = in->steps, rounded = steps > 0 ? IN_A_STEP * steps : 0;
    const int count = rounded > FRACTIONS ? rounded : steps > 0 ? FRACTIONS / steps * steps : FRACTIONS;
    if (!response_begin(in, spectrum, &response))
        return NAN;
    for (int k = 0; k < count; k++) {
        double complex read[LAW_NODES];
        response_at(&response, (k + 0.5) / count, read);
        for (int n = 0; n < spectrum->count; n++) {
            list[n].mean += (read[n] - 1) / count;
            list[n].squares += square(read[n] - 1) / count;
        }
    }
    response_end(&response);
    return error_of(list, spectrum);
}

/* A pulse sinc(B t) at d samples from a record's end is 1/(pi rho d), rho = B/fs, at the first tap that reads zero,
   whose weight is 1/(pi d). The integral of the square of their product, at most 1, from the end to d. */
static double end_energy(double rho, double d)
{
    const double share = 1 / (M_PI * M_PI * rho), whole = sqrt(share);
    return d < whole ? d : whole + share * share / 3 * (1 / pow(whole, 3) - 1 / pow(d, 3));
}

/* Mean energy over distances between a and b, without those below 0; those beyond `reach` add nothing. */
static double end_mean(double rho, double reach, double a, double b)
{
    const double near = fmax(fmin(a, b), 0), far = fmax(fmax(a, b), near + 1e-3);
    return near < reach ? (end_energy(rho, fmin(far, reach)) - end_energy(rho, near)) / (far - near) : 0;
}

/* A column of a patch in parts: the sum of the pairs' amplitudes, and of their errors, root mean square over a part.
   The norm of a sum is at most the sum of the norms, and near it where pairs are equally near to an end. */
enum { PARTS = 8 };
struct column {
    double seen[PARTS], missed[PARTS];
};

/* The amplitude of a place's echo, as it is summed. */
static double seen_amplitude(const struct acquisition *a, int ping, struct vector normal, struct vector place)
{
    const struct vector *tx = &a->tx[ping], way = {place.x - tx->x, place.y - tx->y, place.z - tx->z};
    const double along = fabs(way.x * normal.x + way.y * normal.y + way.z * normal.z);
    const double sine = along / sqrt(way.x * way.x + way.y * way.y + way.z * way.z), turns = a->fc / a->sound_speed;
    if (sine > fmin(condition_cut_sine(a), a->aperture_limit))
        return 0;
    return a->echo_tapers
               ? fabs(condition_sinc(a->tx_length * sine * turns) * condition_sinc(a->rx_length * sine * turns))
               : 1;
}

/* Add a pair's echoes of column j of a patch. */
static void column_add(const struct acquisition *a, const struct grid *g, double reach, double j, int ping,
                       int receiver, struct column *column)
{
    const double last = a->samples - 1, rho = a->bandwidth / a->fs;
    const struct vector rx = a->rx[(size_t)ping * (size_t)a->receivers + (size_t)receiver];
    const struct vector normal = acquisition_normal(a, ping);
    double before = 0;
    for (int i = 0; i <= PARTS; i++) {
        const struct vector place = grid_point(g, i * (g->r_count - 1.0) / PARTS, j);
        const double delay = delay_exact(a->tx[ping], rx, a->velocity[ping], place, a->sound_speed);
        const double q = (delay - a->t0[ping]) * a->fs;
        if (i > 0 && fmax(q, before) > 0 && fmin(q, before) < last) {
            const double amplitude = seen_amplitude(a, ping, normal, place);
            column->seen[i - 1] += amplitude;
            column->missed[i - 1] +=
                amplitude * sqrt(end_mean(rho, reach, before, q) + end_mean(rho, reach, last - before, last - q));
        }
        before = q;
    }
}

/* The n-th of `most` evenly spaced places among `count` >= `most`. */
static int evenly(int n, int most, int count)
{
    return most > 1 ? (int)((double)n * (count - 1) / (most - 1)) : 0;
}

/* The share of a patch's energy in the errors. */
static double patch_ends(const struct acquisition *a, const struct grid *g, double reach)
{
    enum { COLUMNS = 3, PINGS_MOST = 32, RECEIVERS_MOST = 4 };
    const int pings = a->pings < PINGS_MOST ? a->pings : PINGS_MOST;
    const int receivers = a->receivers < RECEIVERS_MOST ? a->receivers : RECEIVERS_MOST;
    double missed = 0, seen = 0;
    for (int n = 0; n < COLUMNS; n++) {
        struct column column = {{0}, {0}};
        for (int k = 0; k < pings * receivers; k++)
            column_add(a, g, reach, n * (g->x_count - 1.0) / (COLUMNS - 1), evenly(k / receivers, pings, a->pings),
                       evenly(k % receivers, receivers, a->receivers), &column);
        for (int i = 0; i < PARTS; i++) {
            missed += column.missed[i] * column.missed[i];
            seen += column.seen[i] * column.seen[i];
        }
    }
    return seen > 0 ? missed / seen : 0;
}

double law_ends(const struct problem *problem, int taps)
{
    double sum = 0, pixels = 0;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        const double own = (double)grid_pixels(g);
        sum += own * patch_ends(problem->acquisition, g, taps / 2.0);
        pixels += own;
    }
    return sqrt(fmin(sum / pixels, 1));
}
