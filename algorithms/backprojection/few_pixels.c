#include "backprojection/few_pixels.h"

#include <math.h>
#include <stdlib.h>

#include "backprojection/pairs/echo_pairs.h"
#include "backprojection/law.h"
#include "backprojection/response.h"
#include "common/image_spectrum.h"
#include "common/turns.h"
#include "contract/condition.h"

enum {
    FRACTIONS = 256,     /* of a sample */
    CELLS_MOST = 2048,   /* pixels times frequencies */
    SUMS_MOST = 16000000 /* over pairs, pixels, targets and frequencies */
};

/* What is measured lies up to a fifth above. */
static const double SHARE = 1.2;

/* Compressed echoes of known targets have the bins of their record's own transform that lie inside the band; many bins
   are as good as a band. False without memory. */
static bool spectrum_fill(const struct problem *problem, struct law_spectrum *spectrum)
{
    const struct acquisition *a = problem->acquisition;
    const double bin = a->fs / a->samples, half = fmin(a->bandwidth, a->fs) / 2;
    const int last = (int)floor(half / bin + 1e-6);
    if (!a->compressed || last >= LAW_NODES) {
        struct acquisition whole = *a;
        if (a->compressed)
            whole.bandwidth = fmin((2.0 * last + 1) * bin, a->fs);
        return law_spectrum(&whole, image_cells(problem), spectrum);
    }
    double sum = 0;
    *spectrum = (struct law_spectrum){.count = last + 1, .reach = a->samples / 2.0};
    for (int k = 0; k <= last; k++) {
        const bool halved = k == 0 || fabs(k * bin - a->bandwidth / 2) < 1e-6 * bin;
        spectrum->nu[k] = (double)k / a->samples;
        spectrum->weight[k] = halved ? 0.5 : 1;
        sum += spectrum->weight[k];
    }
    for (int k = 0; k <= last; k++) {
        spectrum->weight[k] /= sum;
        spectrum->scattered[k] = spectrum->weight[k];
        spectrum->amplitude[k][0] = spectrum->amplitude[k][1] = spectrum->weight[k] / 2;
    }
    return true;
}

static int pixels_count(const struct problem *problem)
{
    const struct grid *grids;
    const int count = problem_judged(problem, &grids);
    double pixels = 0;
    for (int k = 0; k < count; k++)
        pixels += (double)grids[k].x_count * grids[k].r_count;
    return (int)fmin(pixels, CELLS_MOST + 1);
}

/* One pixel's sums over the pairs of one target. */
struct pixel {
    const struct law_spectrum *spectrum;
    double fc, fs;           /* Hz */
    double complex gain;     /* the target's amplitude, over the greatest */
    double complex *sums;    /* [FRACTIONS][spectrum->count][2] */
    double turns[LAW_NODES]; /* Hz: nu fs */
    bool too_far;            /* some pair, from the target */
};

static void pair_add(void *context, const struct echo_pair *pair, double delay, double q)
{
    struct pixel *pixel = context;
    const int count = pixel->spectrum->count, fraction = (int)fmin((q - floor(q)) * FRACTIONS, FRACTIONS - 1);
    const double difference = delay - pair->delay;
    const double complex main = pixel->gain * pair->amplitude * turns(pixel->fc * difference);
    double complex *sum = pixel->sums + (size_t)fraction * (size_t)count * 2;
    pixel->too_far = pixel->too_far || !(fabs(difference * pixel->fs) <= pixel->spectrum->reach);
    for (int n = 0; n < count && !pixel->too_far; n++, sum += 2) {
        const double complex turn = turns(pixel->turns[n] * difference);
        sum[0] += product(main, turn);
        sum[1] += product(main, conj(turn));
    }
}

/* What one target adds to all pixels; false where some are too far from it. */
static bool target_add(const struct problem *problem, const struct echo_pair *pairs, double complex gain,
                       struct few_pixels *few)
{
    const struct acquisition *a = problem->acquisition;
    const struct grid *grids;
    const int count = problem_judged(problem, &grids);
    struct pixel pixel = {.spectrum = &few->spectrum, .fc = a->fc, .fs = a->fs, .gain = gain, .sums = few->sums};
    for (int n = 0; n < few->spectrum.count; n++)
        pixel.turns[n] = few->spectrum.nu[n] * a->fs;
    for (int k = 0; k < count; k++)
        for (int n = 0; n < grids[k].r_count * grids[k].x_count && !pixel.too_far; n++) {
            echo_pairs_visit(a, pairs, grid_point(&grids[k], n / grids[k].x_count, n % grids[k].x_count), pair_add,
                             &pixel);
            pixel.sums += (size_t)FRACTIONS * (size_t)few->spectrum.count * 2;
        }
    return !pixel.too_far;
}

bool few_pixels_find(const struct problem *problem, struct few_pixels *few)
{
    const struct acquisition *a = problem->acquisition;
    const int pixels = pixels_count(problem);
    const double pairs = (double)a->pings * a->receivers, most = problem_amplitude_most(problem);
    *few = (struct few_pixels){.pixels = pixels};
    if (!(most > 0) || !isfinite(most) || !echoes_known(problem) || pixels > CELLS_MOST
        || !spectrum_fill(problem, &few->spectrum) || (double)pixels * few->spectrum.count > CELLS_MOST
        || pairs * pixels * problem->target_count * few->spectrum.count > SUMS_MOST)
        return false;
    struct echo_pair *echoes = malloc((size_t)pairs * sizeof *echoes);
    few->sums = calloc((size_t)pixels * FRACTIONS * (size_t)few->spectrum.count * 2, sizeof *few->sums);
    bool near = echoes && few->sums;
    for (int k = 0; k < problem->target_count && near; k++) {
        const struct target *target = &problem->targets[k];
        echo_pairs_fill(a, (struct vector){target->x, target->r, 0}, echoes);
        near = target_add(problem, echoes, target->amplitude / most, few);
    }
    free(echoes);
    if (!near)
        few_pixels_free(few);
    return near;
}

void few_pixels_free(struct few_pixels *few)
{
    free(few->sums);
    *few = (struct few_pixels){.pixels = 0};
}

/* Adds what a fraction's response makes of each pixel, and the exact values. */
static void fraction_add(const struct few_pixels *few, int fraction, const double complex *read, double complex *made,
                         double complex *exact)
{
    const struct law_spectrum *spectrum = &few->spectrum;
    for (int p = 0; p < few->pixels; p++) {
        const double complex *sum =
            few->sums + ((size_t)p * FRACTIONS + (size_t)fraction) * (size_t)spectrum->count * 2;
        for (int n = 0; n < spectrum->count; n++, sum += 2) {
            const double complex above = spectrum->amplitude[n][0] * sum[0], below = spectrum->amplitude[n][1] * sum[1];
            exact[p] += above + below;
            made[p] += product(read[n], above) + product(conj(read[n]), below);
        }
    }
}

double few_pixels_error(const struct few_pixels *few, const struct interpolator *in, const void *options)
{
    struct response response;
    double of_made = 0, of_exact = 0;
    double complex *values = calloc(2 * (size_t)few->pixels, sizeof *values), both = 0;
    if (!values || !response_begin(in, options, &few->spectrum, &response)) {
        free(values);
        return NAN;
    }
    double complex *made = values, *exact = values + few->pixels;
    for (int k = 0; k < FRACTIONS; k++) {
        const double fraction = in->upsample * (k + 0.5) / FRACTIONS;
        double complex read[LAW_NODES];
        response_at(&response, fraction - floor(fraction), read);
        fraction_add(few, k, read, made, exact);
    }
    for (int p = 0; p < few->pixels; p++) {
        both += product(made[p], conj(exact[p]));
        of_made += square(made[p]);
        of_exact += square(exact[p]);
    }
    response_end(&response);
    free(values);
    const double error = of_exact > 0 && of_made > 0 ? unlike(both, of_made * of_exact) : 1;
    return fmin(SHARE * error, interpolation_error(in, options, &few->spectrum, NULL));
}
