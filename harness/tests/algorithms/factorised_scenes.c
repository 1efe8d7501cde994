#include "tests/algorithms/factorised_scenes.h"

#include <math.h>
#include <stdio.h>

#include "measure/metrics.h"
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

static double error_of(const char *spec, struct problem problem, const struct echoes *echoes, const struct image *exact)
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
        const double error = error_of(spec, problem, &echoes, &exact);
        print_message("%s, %s: error %.2e\n", factorised_names[kind], spec, error);
        if (!(error <= errors[k] && error >= errors[k] / 30))
            fail_msg("%s, %s: error is %g", factorised_names[kind], spec, error);
    }
    image_free(&exact);
    echoes_free(&echoes);
    acquisition_free(&a);
}
