/* The error laws of interpolators: their closed forms, and errors measured in scenes drawn from seeds. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "measure/metrics.h"
#include "measure/session.h"
#include "measure/timing.h"
#include "tests/support.h"

/* What is forecast of a SPEC on a problem. */
static struct forecast forecast_of(const char *text, const struct problem *problem)
{
    struct forecast forecast;
    struct spec spec;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    assert_int_equal(spec.algorithm->forecast(problem, spec.options, &forecast), STATUS_OK);
    spec_free(&spec);
    return forecast;
}

/* Laws that can be written down, at rho = B/fs. */
static void closed_forms(void **state)
{
    (void)state;
    static const struct {
        const char *spec;
        double factor, power, low, high; /* factor rho^power times low to high */
    } laws[] = {
        {"bp_nearest", M_PI / 6, 1, 0.96, 1.01}, /* its first order */
        {"bp_zeropad:factor=4", M_PI / 24, 1, 0.99, 1.01}, {"bp_zeropad:factor=64", M_PI / 384, 1, 0.99, 1.01},
        {"bp_linear:beta=1024", 0.295, 2, 0.98, 1.1},      {"bp_sinc:taps=4", 0.40 / 4, 0, 0.5, 1.5},
        {"bp_sinc:taps=16", 0.40 / 16, 0, 0.5, 1.5},
    };
    struct acquisition a = support_acquisition(2, 1, 64);
    const struct grid grid = {0, 0.01, 4, 10, 0.01, 4};
    const struct problem problem = {&a, 1, &grid, PRECISION_DOUBLE};
    for (size_t k = 0; k < sizeof laws / sizeof *laws; k++)
        for (double rho = 0.3; rho < 0.8; rho += 0.2) {
            a.bandwidth = rho * a.fs;
            const double error = forecast_of(laws[k].spec, &problem).error[CAUSE_INTERPOLATION];
            const double ratio = error / (laws[k].factor * pow(rho, laws[k].power));
            print_message("%-24s rho %.1f: %.3e, %.3f of the closed form\n", laws[k].spec, rho, error, ratio);
            if (!(ratio > laws[k].low && ratio < laws[k].high))
                fail_msg("%s at B/fs = %g: the law says %g, %g times its closed form", laws[k].spec, rho, error, ratio);
        }
    acquisition_free(&a);
}

/* A law is near what is measured, and seldom below it. */
static void measured(void **state)
{
    (void)state;
    static const char *const specs[] = {"bp_nearest",         "bp_linear:beta=32",   "bp_zeropad:factor=4",
                                        "bp_sinc:taps=8",     "bp_farrow:degree=3",  "bp_sinc:taps=8,window=kaiser",
                                        "bp_farrow:degree=2", "bp_zeropad:factor=32"};
    enum { SPECS = sizeof specs / sizeof *specs, FIRST = 1001, SEEDS = 8 };
    double ratios[SPECS * SEEDS];
    int below = 0, count = 0;
    for (int seed = FIRST; seed < FIRST + SEEDS; seed++) {
        struct scene scene;
        struct session session;
        support_random_scene(seed, &scene);
        assert_int_equal(session_open(&scene, &session), STATUS_OK);
        for (int k = 0; k < SPECS; k++) {
            struct image image;
            struct spec spec;
            assert_int_equal(spec_parse(specs[k], &spec), STATUS_OK);
            assert_int_equal(session_image(&session, &spec, &image), STATUS_OK);
            const struct problem problem = session_problem(&scene, spec.algorithm, PRECISION_FLOAT);
            const struct forecast forecast = forecast_of(specs[k], &problem);
            const double predicted = forecast_error(&forecast),
                         error = metrics_error(&image, &session.reference).error_gain;
            print_message("seed %d, B/fs %.2f, %-30s predicted %.2e, measured %.2e, ratio %.2f\n", seed,
                          scene.acquisition.bandwidth / scene.acquisition.fs, specs[k], predicted, error,
                          predicted / error);
            if (!(predicted > 0.9 * error))
                fail_msg("seed %d, %s: an error of %g is predicted, %g measured", seed, specs[k], predicted, error);
            below += predicted < error / 1.12;
            ratios[count++] = predicted / error;
            image_free(&image);
            spec_free(&spec);
        }
        session_close(&session);
        scene_free(&scene);
    }
    const double middle = median(ratios, count); /* sorts them */
    print_message("predicted over measured: %.2f to %.2f, median %.2f\n", ratios[0], ratios[count - 1], middle);
    if (below > count / 50)
        fail_msg("%d of %d errors are above what a planner counts on", below, count);
    if (!(middle > 1 && middle < 1.8))
        fail_msg("the median of predicted over measured errors is %g, must be from 1 to 1.8", middle);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms),
        cmocka_unit_test_setup_teardown(measured, folder_make, folder_remove),
    };
    return cmocka_run_group_tests_name("law", tests, NULL, NULL);
}
