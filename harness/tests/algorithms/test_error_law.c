/* The error laws of the interpolators at fs = 2B (FORMULAS of the project, README "Error laws"): a point off the range
   bins, and the median over ten seeds of a speckle scene, each within a factor 1.5 of the independently measured
   value. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "metrics/metrics.h"
#include "scene/simulate.h"
#include "measure/timing.h"
#include "tests/support.h"

/* Point errors: the independently measured values, within a factor 1.5; `point_gain` 0 where none is stated. Speckle:
   the published values are one draw of scatterers and lie above the median of draws throughout (by 1.27 in the middle
   of the rows, by up to 1.9), so the medians measured over 60 seeds stand here, and the published draw beside them.
   Nobody has published bp_farrow's: they are measured here, and lie below the law of test_farrow.c, which is for a
   flat band. */
static const struct {
    const char *spec;
    double point, point_gain, speckle, draw;
} laws[] = {
    {"bp_nearest", .098, .095, 0.216, 0.33},
    {"bp_linear:beta=2", .0704, .031, 0.0985, 0.123},
    {"bp_linear:beta=8", .0699, .0251, 0.0964, 0.116},
    {"bp_linear:beta=1024", .0703, .0249, 0.0955, 0.116},
    {"bp_zeropad:factor=8", 2.8e-3, 2.7e-3, 0.00994, 0.0128},
    {"bp_zeropad:factor=32", 1.0e-3, 1.0e-3, 0.00225, 0.0036},
    {"bp_farrow:degree=3", 1.5e-4, 0, 2.2e-4, 2.2e-4},
    {"bp_farrow:degree=5", 4.9e-7, 0, 8.3e-7, 8.3e-7},
    {"bp_sinc:taps=4", 1.5e-2, 0, 0.0864, 0.15},
    {"bp_sinc:taps=8", 2.4e-3, 0, 0.0411, 0.054},
    {"bp_sinc:taps=16", 3.4e-4, 0, 0.0137, 0.02},
    {"bp_sinc:taps=32", 4.5e-5, 0, 0.0006, 0.0007},
    {"bp_sinc:taps=4,window=kaiser", 2e-2, 0, 0.0361, 0.046},
    {"bp_sinc:taps=8,window=kaiser", 7.5e-5, 0, 0.00101, 0.0012},
    {"bp_sinc:taps=16,window=kaiser", 6.5e-5, 0, 0.000405, 0.0005},
    {"bp_sinc:taps=32,window=kaiser", 1.1e-5, 0, 3.46e-05, 5e-05},
};
enum { LAWS = sizeof laws / sizeof *laws, SEEDS = 10 };

static struct error_metrics measure(const char *spec, const struct problem *problem, const struct echoes *echoes,
                                    const struct image *exact)
{
    struct image image;
    char text[96];
    snprintf(text, sizeof text, "%s%sprecision=double", spec, strchr(spec, ':') ? "," : ":");
    assert_int_equal(support_image(text, *problem, echoes, &image), STATUS_OK);
    struct error_metrics error = metrics_error(&image, exact);
    image_free(&image);
    return error;
}

static void within(const char *spec, const char *what, double value, double law, double published)
{
    print_message("%-32s %-10s %.3g (law %.3g, published %.3g)\n", spec, what, value, law, published);
    if (!(value < 1.5 * law && value > law / 1.5))
        fail_msg("%s: %s error is %g, the law says %g", spec, what, value, law);
}

static void point(void **state)
{
    (void)state;
    struct scene scene;
    struct echoes echoes;
    struct image exact;
    support_scene("study/point", &scene);
    support_echoes(&scene, &echoes);
    struct grid slice = {-1, 0.005, 401, 100.137, 1, 1};
    struct problem problem = problem_make(&scene.acquisition, 1, &slice, PRECISION_DOUBLE);
    assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
    for (int k = 0; k < LAWS; k++) {
        struct error_metrics error = measure(laws[k].spec, &problem, &echoes, &exact);
        within(laws[k].spec, "point", error.error, laws[k].point, laws[k].point);
        if (laws[k].point_gain > 0)
            within(laws[k].spec, "after gain", error.error_gain, laws[k].point_gain, laws[k].point_gain);
    }
    image_free(&exact);
    echoes_free(&echoes);
    scene_free(&scene);
}

/* study/speckle with another seed. */
static void seeded_scene(int seed, struct scene *scene)
{
    char path[] = "/tmp/sasbench-XXXXXX.cfg";
    int descriptor = mkstemps(path, 4);
    FILE *file = descriptor >= 0 ? fdopen(descriptor, "w") : NULL;
    assert_non_null(file);
    fprintf(file,
            "base = {\n@include \"study/speckle.cfg\"\n};\n"
            "record = { first_sample = 3493; samples = 1024; };\n" /* shorter: the test is quicker */
            "targets = { fields = ( { x = [-1.0, 1.0]; r = [99.937, 100.337]; count = 40; seed = %d; } ); };\n",
            seed);
    fclose(file);
    support_scene(path, scene);
    unlink(path);
}

static void speckle(void **state)
{
    (void)state;
    static double errors[LAWS][SEEDS];
    for (int seed = 1; seed <= SEEDS; seed++) {
        struct scene scene;
        struct echoes echoes;
        struct image exact;
        seeded_scene(seed, &scene);
        assert_int_equal(scene.target_count, 40);
        support_echoes(&scene, &echoes);
        struct problem problem = problem_make(&scene.acquisition, scene.patch_count, scene.patches, PRECISION_DOUBLE);
        assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
        for (int k = 0; k < LAWS; k++)
            errors[k][seed - 1] = measure(laws[k].spec, &problem, &echoes, &exact).error;
        image_free(&exact);
        echoes_free(&echoes);
        scene_free(&scene);
    }
    for (int k = 0; k < LAWS; k++) {
        double middle = median(errors[k], SEEDS); /* sorts them */
        print_message("%-32s %d seeds: %.2g to %.2g, median %.2g\n", laws[k].spec, SEEDS, errors[k][0],
                      errors[k][SEEDS - 1], middle);
        within(laws[k].spec, "speckle", middle, laws[k].speckle, laws[k].draw);
    }
}

/* rms of what linear interpolation leaves of frequencies -edge .. edge over `period`, in cycles a sample: its response
   is sinc^2(nu) in the mean over the places between two samples, and 1 - (2/3) sin^2(pi nu) is the mean of its square.
   Emphasised, the former becomes 1. */
static double linear_law(int edge, int period, bool preemphasis)
{
    double square = 0;
    for (int k = -edge; k <= edge; k++) {
        const double x = M_PI * k / period, mean = k == 0 ? 1 : pow(sin(x) / x, 2);
        const double power = 1 - 2.0 / 3 * sin(x) * sin(x);
        square += preemphasis ? power / (mean * mean) - 1 : power - 2 * mean + 1;
    }
    return sqrt(square / (2 * edge + 1));
}

/* Laws for a flat band B/fs = rho, each within its own factor: linear interpolation with and without preemphasis, and
   sinc under a Kaiser window that knows the band, whose law is rough. */
static void flat_bands(void **state)
{
    (void)state;
    static const double bands[] = {0.4, 0.5, 0.7};
    static const struct grid grid = {-2.0, 0.171 / 7, 161, 21.03, 0.017, 61};
    for (size_t b = 0; b < sizeof bands / sizeof *bands; b++) {
        enum { PERIOD = 240 }; /* of support_flat_noise */
        const double rho = bands[b];
        const int edge = (int)floor(rho * PERIOD / 2);
        const struct {
            const char *spec;
            double law, factor;
        } flat[] = {
            {"bp_linear:beta=1024,engine=invariant", linear_law(edge, PERIOD, false), 1.05},
            {"bp_linear:beta=1024,preemphasis=on,engine=invariant", linear_law(edge, PERIOD, true), 1.05},
            {"bp_sinc:taps=4,window=kaiser_band,engine=invariant", 0.25 * exp(-0.5 * M_PI * 4 * (1 - rho)), 2},
            {"bp_sinc:taps=8,window=kaiser_band,engine=invariant", 0.25 * exp(-0.5 * M_PI * 8 * (1 - rho)), 2},
            {"bp_sinc:taps=16,window=kaiser_band,engine=invariant", 0.25 * exp(-0.5 * M_PI * 16 * (1 - rho)), 2},
        };
        struct acquisition a;
        struct echoes echoes;
        struct image exact;
        support_flat_noise(rho, &a, &echoes);
        assert_int_equal(a.samples, PERIOD);
        const struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
        for (size_t k = 0; k < sizeof flat / sizeof *flat; k++) {
            const double error = measure(flat[k].spec, &problem, &echoes, &exact).error;
            print_message("%-36s band %.2f: error %.3g, by the law %.3g\n", flat[k].spec, rho, error, flat[k].law);
            if (!(error < flat[k].factor * flat[k].law && error > flat[k].law / flat[k].factor))
                fail_msg("%s, band %g: error is %g, the law says %g", flat[k].spec, rho, error, flat[k].law);
        }
        image_free(&exact);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(point),
        cmocka_unit_test(speckle),
        cmocka_unit_test(flat_bands),
    };
    return cmocka_run_group_tests_name("error law", tests, NULL, NULL);
}
