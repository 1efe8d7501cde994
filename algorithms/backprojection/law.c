/* Error laws of interpolators (law.h). Fractions are averaged by the midpoint rule, as many in each step of those that
   round. */
#include "backprojection/law.h"

#include <math.h>
#include <stdlib.h>

#include "backprojection/farrow.h"
#include "common/delay.h"
#include "common/fft_length.h"
#include "common/pulse_band.h"
#include "common/turns.h"

enum { GAUSS = 8, BINS = 48, FINER = 16, FRACTIONS = 256, IN_A_STEP = 8, LOW = 4, HARMONICS = LOW + 2 };
/* The positive half of Gauss and Legendre's 16 points. */
static const double node[GAUSS] = {0.0950125098376374, 0.2816035507792589, 0.4580167776572274, 0.6178762444026438,
                                   0.7554044083550030, 0.8656312023878318, 0.9445750230732326, 0.9894009349916499};
static const double weight[GAUSS] = {0.1894506104550685, 0.1826034150449236, 0.1691565193950025, 0.1495959888165767,
                                     0.1246289712555339, 0.0951585116824928, 0.0622535239386479, 0.0271524594117541};

/* Pulses of more cycles of time and bandwidth have a flat spectrum. The flanks of others cost an interpolator that
   fails at half the sampling rate up to 0.5 over their number, relative L2. */
static const double FLAT = 20000;

/* The replica's own, in bins whose nodes are their middles of energy: an interpolator's error grows steeply at the
   band's edges. False without memory. */
static bool replica_spectrum(const struct acquisition *a, struct law_spectrum *spectrum)
{
    const int length = fft_length_fast((long long)fmax(2.0 * a->pulse_length, FINER * BINS));
    double *energy = pulse_energy(a, length), sum = 0, noise = 0;
    if (!energy)
        return false;
    for (int k = 0; k < length; k++) {
        sum += energy[k];
        noise += sqrt(energy[k]);
    }
    for (int k = 0; k < length; k++) /* white noise is compressed to the square root of the echoes' energy */
        energy[k] = (1 - a->noise) * energy[k] / sum + a->noise * sqrt(energy[k]) / noise;
    *spectrum = (struct law_spectrum){.count = BINS};
    for (int k = 0; k < length; k++) {
        const double nu = fmin(k, length - k) / (double)length;
        const int n = (int)fmin(2 * BINS * nu, BINS - 1);
        spectrum->nu[n] += nu * energy[k];
        spectrum->weight[n] += energy[k];
    }
    free(energy);
    for (int n = 0; n < BINS; n++) {
        spectrum->nu[n] = spectrum->weight[n] > 0 ? spectrum->nu[n] / spectrum->weight[n] : (n + 0.5) / (2 * BINS);
    }
    return true;
}

bool law_spectrum(const struct acquisition *a, struct law_spectrum *spectrum)
{
    const double band = fmin(a->bandwidth / a->fs, 1);
    if (!a->compressed && a->pulse_length * band <= FLAT)
        return replica_spectrum(a, spectrum);
    *spectrum = (struct law_spectrum){.count = GAUSS};
    const double beside = a->compressed ? a->noise * (1 - band) : 0;
    for (int n = 0; n < GAUSS; n++) {
        spectrum->nu[n] = node[n] * band / 2;
        spectrum->weight[n] = weight[n] * (1 - beside);
    }
    for (int n = 0; n < 2 * GAUSS && beside > 0; n++) { /* from the band's edge to half the sampling rate */
        const double place = n < GAUSS ? -node[GAUSS - 1 - n] : node[n - GAUSS];
        spectrum->nu[spectrum->count] = (1 + band + place * (1 - band)) / 4;
        spectrum->weight[spectrum->count++] = weight[n < GAUSS ? GAUSS - 1 - n : n - GAUSS] / 2 * beside;
    }
    return true;
}

/* H of Farrow branches of these gains (farrow_gains): what they make of exp(j 2 pi nu u), |u| <= 1/2, over it. */
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

/* Of one frequency: the Fourier coefficients of H - 1 over the fractions. */
struct harmonics {
    double complex mean;                /* of order 0 */
    double complex first[HARMONICS][2]; /* of some orders, of either sign */
    double spread;                      /* the mean of |H - 1|^2 */
};

/* The orders that scatter most: the first, and those of the steps between samples. */
static void orders_fill(int steps, int orders[HARMONICS])
{
    for (int k = 0; k < HARMONICS; k++)
        orders[k] = k < LOW || steps <= LOW ? k + 1 : (k - LOW + 1) * steps;
}

/* The energy that is scattered over fractions, but for what falls outside of the image. */
static double scattered(const struct harmonics *h, const int orders[HARMONICS], int upsample,
                        const struct scatter *scatter)
{
    const double all = fmax(h->spread - square(h->mean), 0);
    if (!scatter)
        return all;
    double rest = all, inside = 0;
    for (int k = 0; k < HARMONICS; k++) {
        const double energy = square(h->first[k][0]) + square(h->first[k][1]);
        inside += energy * scatter_share(scatter, orders[k] * upsample);
        rest -= energy;
    }
    return inside + fmax(rest, 0) * scatter->most;
}

/* Adds a fraction of a frequency, one of `count`; waves NULL: the orders are not asked for. */
static void harmonics_add(struct harmonics *h, double complex off, const double complex *waves, int count)
{
    h->mean += off / count;
    h->spread += square(off) / count;
    for (int k = 0; k < HARMONICS && waves; k++) {
        h->first[k][0] += product(off, waves[k]) / count;
        h->first[k][1] += product(off, conj(waves[k])) / count;
    }
}

/* Of all frequencies. */
static double harmonics_error(const struct harmonics *list, const struct law_spectrum *spectrum,
                              const struct interpolator *in, const int orders[HARMONICS], const struct scatter *scatter)
{
    double mean = 0, variance = 0;
    for (int n = 0; n < spectrum->count; n++) {
        mean += spectrum->weight[n] * creal(list[n].mean);
        variance += spectrum->weight[n] * (square(list[n].mean) + scattered(&list[n], orders, in->upsample, scatter));
    }
    variance -= mean * mean;
    return sqrt(fmax(variance, 0) / ((1 + mean) * (1 + mean) + variance)); /* <|H|^2> = |<H>|^2 + variance */
}

double interpolation_error(const struct interpolator *in, const void *options, const struct law_spectrum *spectrum,
                           const struct scatter *scatter)
{
    double gains[LAW_NODES][FARROW_MOST + 1]; /* of branches */
    struct harmonics list[LAW_NODES] = {{0}};
    int orders[HARMONICS];
    const int steps = in->steps, rounded = steps > 0 ? IN_A_STEP * steps : 0;
    const int count = rounded > FRACTIONS ? rounded : steps > 0 ? FRACTIONS / steps * steps : FRACTIONS;
    double *taps = malloc((size_t)in->taps * sizeof *taps);
    if (!taps)
        return NAN;
    orders_fill(steps, orders);
    for (int n = 0; n < spectrum->count && in->degree > 0; n++)
        farrow_gains(in->degree, spectrum->nu[n] / in->upsample, gains[n]);
    for (int k = 0; k < count; k++) {
        const double fraction = (k + 0.5) / count, place = steps > 0 ? floor(fraction * steps + 0.5) / steps : fraction;
        const int whole = (int)floor(place);
        double complex waves[HARMONICS];
        for (int m = 0; m < HARMONICS; m++)
            waves[m] = cexp(-2 * I * M_PI * orders[m] * fraction);
        taps[0] = 1;
        if (in->weights)
            in->weights(options, place - whole, taps);
        for (int n = 0; n < spectrum->count; n++) {
            const double nu = spectrum->nu[n] / in->upsample;
            const double complex read = in->degree > 0 ? branches_response(in->degree, gains[n], nu, fraction - 0.5)
                                                       : taps_response(taps, whole + in->first, in->taps, nu, fraction);
            const double lost = in->preemphasis && nu > 0 ? pow(sin(M_PI * nu) / (M_PI * nu), 2) : 1;
            harmonics_add(&list[n], read / lost - 1, scatter ? waves : NULL, count);
        }
    }
    free(taps);
    return harmonics_error(list, spectrum, in, orders, scatter);
}

/* A pulse sinc(B t) at d samples from a record's end is 1/(pi rho d), rho = B/fs, where the first tap reads zero, whose
   weight is 1/(pi d). The integral of the square of their product, at most 1, from the end to d. */
static double end_energy(double rho, double d)
{
    const double share = 1 / (M_PI * M_PI * rho), whole = sqrt(share);
    return d < whole ? d : whole + share * share / 3 * (1 / pow(whole, 3) - 1 / pow(d, 3));
}

/* Its mean over distances between a and b, of which those below 0 are left out and those beyond `reach` add nothing. */
static double end_mean(double rho, double reach, double a, double b)
{
    const double near = fmax(fmin(a, b), 0), far = fmax(fmax(a, b), near + 1e-3);
    return near < reach ? (end_energy(rho, fmin(far, reach)) - end_energy(rho, near)) / (far - near) : 0;
}

/* The mean over column j of a patch, as one pair sees it. */
static double column_ends(const struct acquisition *a, const struct grid *g, double reach, double j, int ping,
                          int receiver)
{
    enum { ROWS = 9 };
    const double last = a->samples - 1, rho = a->bandwidth / a->fs;
    const struct vector rx = a->rx[(size_t)ping * (size_t)a->receivers + (size_t)receiver];
    double sum = 0, before = 0;
    int inside = 0;
    for (int i = 0; i < ROWS; i++) {
        const struct vector place = grid_point(g, i * (g->r_count - 1.0) / (ROWS - 1), j);
        const double delay = delay_exact(a->tx[ping], rx, a->velocity[ping], place, a->sound_speed);
        const double q = (delay - a->t0[ping]) * a->fs;
        if (i > 0 && fmax(q, before) > 0 && fmin(q, before) < last) {
            sum += end_mean(rho, reach, before, q) + end_mean(rho, reach, last - before, last - q);
            inside++;
        }
        before = q;
    }
    return inside ? sum / inside : 0;
}

double law_ends(const struct problem *problem, int taps)
{
    enum { COLUMNS = 3, PINGS = 5, RECEIVERS = 2, TERMS = COLUMNS * PINGS * RECEIVERS };
    const struct acquisition *a = problem->acquisition;
    double sum = 0, pixels = 0;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        const double own = (double)g->r_count * g->x_count;
        for (int n = 0; n < TERMS; n++)
            sum += own / TERMS
                   * column_ends(a, g, taps / 2.0, n % COLUMNS * (g->x_count - 1.0) / (COLUMNS - 1),
                                 n / COLUMNS % PINGS * (a->pings - 1) / (PINGS - 1),
                                 n / COLUMNS / PINGS * (a->receivers - 1));
        pixels += own;
    }
    return sqrt(fmin(sum / pixels, 1));
}
