/* Error laws of interpolators (law.h). Fractions are averaged by the midpoint rule, as many in each step of those that
   round. */
#include "backprojection/law.h"

#include <math.h>
#include <stdlib.h>

#include "backprojection/response.h"
#include "contract/delay.h"
#include "common/turns.h"

enum { FRACTIONS = 32, IN_A_STEP = 4 };

/* Of one frequency, over the fractions: of H - 1. */
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

double interpolation_error(const struct interpolator *in, const void *options, const struct law_spectrum *spectrum)
{
    struct moments list[LAW_NODES] = {{0}};
    struct response response;
    const int steps = in->steps, rounded = steps > 0 ? IN_A_STEP * steps : 0;
    const int count = rounded > FRACTIONS ? rounded : steps > 0 ? FRACTIONS / steps * steps : FRACTIONS;
    if (!response_begin(in, options, spectrum, &response))
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
