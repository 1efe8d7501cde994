#include "tests/algorithms/factorised_scenes.h"

#include <fftw3.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "metrics/metrics.h"
#include "tests/support.h"

enum { SAMPLES = 240 };

const char *const factorised_names[FACTORISED_KINDS] = {
    "straight",   "curved, 4 receivers", "aperture limit", "squinted limit",
    "both sides", "records end",         "turned",         "along x"};
const struct grid factorised_grids[FACTORISED_KINDS] = {
    {-1.0, 0.05, 41, 11.0, 0.03, 61, 0},  {-1.0, 0.05, 41, 11.0, 0.03, 61, 0},  {-1.0, 0.05, 41, 11.0, 0.03, 61, 0},
    {1.0, 0.05, 41, 11.0, 0.03, 61, 0},   {-0.6, 0.1, 13, -8.0, 0.125, 129, 0}, {-1.0, 0.05, 41, 7.5, 0.03, 61, 0},
    {3.0, 0.05, 41, 10.0, 0.03, 61, 0.3}, {11.0, 0.03, 61, -1.0, 0.05, 41, 0},
};

void factorised_scene(enum factorised_kind kind, struct acquisition *a, struct echoes *echoes)
{
    struct random random = random_seed(7, 1);
    static double complex turns[SAMPLES];
    const int receivers = kind == CURVED ? 4 : 1, edge = SAMPLES / 4 - 1;
    *a = support_acquisition(FACTORISED_PINGS, receivers, SAMPLES);
    a->fc = 60e3;
    a->fs = 20e3;
    a->bandwidth = 10e3;
    a->aperture_limit = kind == LIMITED ? 0.1 : kind == SQUINTED ? 0.15 : INFINITY;
    a->echo_squint = kind == SQUINTED ? 0.15 : 0;
    for (int p = 0; p < FACTORISED_PINGS; p++) {
        const double bend = kind == CURVED ? 0.3 * sin(0.08 * p) : 0, deep = kind == CURVED ? 0.2 * cos(0.05 * p) : 0;
        a->t0[p] = (kind == SIDES ? 0 : 200 + (kind == CURVED ? p % 3 : 0)) / a->fs;
        a->tx[p] = (struct vector){(p - FACTORISED_PINGS / 2) * 0.05, bend, deep};
        a->velocity[p] = (struct vector){1.5, kind == CURVED ? 0.4 : 0, 0};
        for (int m = 0; m < receivers; m++)
            a->rx[p * receivers + m] = (struct vector){a->tx[p].x + 0.05 + 0.02 * m, bend + 0.01 * m, deep};
    }
    assert_int_equal(acquisition_check(a, factorised_names[kind]), STATUS_OK);
    assert_int_equal(echoes_allocate(a, PRECISION_DOUBLE, echoes), STATUS_OK);
    for (int n = 0; n < SAMPLES; n++)
        turns[n] = cexp(2 * M_PI * I * n / SAMPLES);
    double complex *s = (double complex *)echoes->samples;
    for (int record = 0; record < FACTORISED_PINGS * receivers; record++) {
        double complex bins[SAMPLES];
        for (int k = -edge; k <= edge; k++)
            bins[(k + SAMPLES) % SAMPLES] = random_normal(&random);
        for (int n = 0; n < SAMPLES; n++, s++) {
            *s = 0;
            for (int k = -edge; k <= edge; k++) {
                const int bin = (k + SAMPLES) % SAMPLES;
                *s += bins[bin] * turns[bin * n % SAMPLES];
            }
        }
    }
}

/* Noise of a flat spectrum over the acquisition's band, and none elsewhere. */
static void flat_noise(const struct acquisition *a, struct random *random, struct echoes *echoes)
{
    const int samples = a->samples, edge = (int)fmin(0.5 * samples * a->bandwidth / a->fs, 0.5 * (samples - 1));
    const size_t records = (size_t)a->pings * (size_t)a->receivers;
    assert_int_equal(echoes_allocate(a, PRECISION_DOUBLE, echoes), STATUS_OK);
    double complex *bins = fftw_malloc((size_t)samples * sizeof *bins);
    fftw_plan back = fftw_plan_dft_1d(samples, bins, bins, FFTW_BACKWARD, FFTW_ESTIMATE);
    for (size_t record = 0; record < records; record++) {
        memset(bins, 0, (size_t)samples * sizeof *bins);
        for (int k = -edge; k <= edge; k++)
            bins[(k + samples) % samples] = random_normal(random);
        fftw_execute(back);
        memcpy((double complex *)echoes->samples + record * (size_t)samples, bins, (size_t)samples * sizeof *bins);
    }
    fftw_destroy_plan(back);
    fftw_free(bins);
}

static double between(struct random *random, double low, double high)
{
    return low + (high - low) * random_uniform(random);
}

void factorised_near_scene(int seed, double oversampling, struct acquisition *a, struct grid *grid,
                           struct echoes *echoes)
{
    enum { COLUMNS = 6, ROWS = 48 };
    struct random random = random_seed((uint64_t)seed, 3);
    const int pings = (int)between(&random, 200, 1000), receivers = (int)between(&random, 1, 4);
    const double fs = between(&random, 30e3, 90e3), spacing = between(&random, 0.004, 0.016), c = 1500;
    const double near = between(&random, 0.3, 6), deep = between(&random, 0.3, 3), pitch = between(&random, 0, 0.02);
    const double half = between(&random, 0.15, 0.6) * pings * spacing, begin = random_uniform(&random);
    const double far = hypot(near + deep, 0.5 * pings * spacing + half), limit = between(&random, -2, 1);
    const double end = near + between(&random, 0.4, 1.1) * (far - near);
    *a = support_acquisition(pings, receivers, (int)(2 * end / c * fs));
    a->fc = 100e3;
    a->fs = fs;
    a->bandwidth = fs / (oversampling > 0 ? oversampling : between(&random, 1, 3));
    a->aperture_limit = limit > 0.2 ? limit : INFINITY;
    for (int p = 0; p < pings; p++) {
        a->tx[p] = (struct vector){(p - 0.5 * pings) * spacing, 0, 0};
        for (int m = 0; m < receivers; m++)
            a->rx[p * receivers + m] = (struct vector){a->tx[p].x + 0.03 + pitch * m, 0, 0};
    }
    assert_int_equal(acquisition_check(a, "near"), STATUS_OK);
    const double firsts[] = {near, -near - deep, -0.5 * deep};
    *grid = (struct grid){-half, 2 * half / (COLUMNS - 1), COLUMNS, firsts[seed % 3], deep / (ROWS - 1), ROWS, 0};
    if (begin < 0.3) /* pixels exactly before the sonar, and on its track */
        *grid = (struct grid){0, spacing, COLUMNS, seed % 3 == 2 ? 0 : firsts[seed % 3], deep / (ROWS - 1), ROWS, 0};
    flat_noise(a, &random, echoes);
}

double factorised_error(const char *spec, struct problem problem, const struct echoes *echoes,
                        const struct image *exact)
{
    struct image image;
    if (support_image(spec, problem, echoes, &image) != STATUS_OK)
        fail_msg("%s: %s", spec, status_message());
    const double error = metrics_error(&image, exact).error;
    image_free(&image);
    return error;
}

void factorised_check(enum factorised_kind kind, int stages, int count, const double *errors)
{
    struct acquisition a;
    struct echoes echoes;
    struct image exact;
    factorised_scene(kind, &a, &echoes);
    const struct problem problem = problem_make(&a, 1, &factorised_grids[kind], PRECISION_DOUBLE);
    assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
    for (int k = 0; k < count; k++) {
        char spec[120];
        snprintf(spec, sizeof spec, "bp_factorised:stages=%d,base=4,factor=4,error=%g,precision=double", stages,
                 errors[k]);
        const double error = factorised_error(spec, problem, &echoes, &exact);
        print_message("%s, %s: error %.2e\n", factorised_names[kind], spec, error);
        if (!(error <= errors[k] && error >= errors[k] / 30))
            fail_msg("%s, %s: error is %g", factorised_names[kind], spec, error);
    }
    image_free(&exact);
    echoes_free(&echoes);
    acquisition_free(&a);
}
