/* Range migration after delay compensation: its parts against what they stand for, and its images against exact ones
   over a deep swath, wide and narrow, raw and compressed. */
#include <complex.h>
#include <math.h>
#include <stdlib.h>

#include "contract/delay.h"
#include "range_migration/delay_compensation.h"
#include "scene/simulate.h"
#include "tests/algorithms/rma_scenes.h"

/* At the carrier the compensated spectrum is the exact one; at nu = 0 it is so for all frequencies. */
static void spectrum(void **state)
{
    (void)state;
    const struct spectrum_setting setting = {1500, 3, 150e3, 0};
    for (int k = 0; k < 60; k++) {
        double d = -0.5 + 0.1 * (k % 30), r = 20 + 7 * k, nu = (k % 7 - 3) * 4.1;
        double exact = spectrum_exact(&setting, d, r, 150e3, nu);
        assert_true(fabs(spectrum_compensated(&setting, d, r, 150e3, nu) - exact) < 1e-8);
        exact = spectrum_exact(&setting, d, r, 137e3, 0);
        assert_true(fabs(spectrum_compensated(&setting, d, r, 137e3, 0) - exact) < 1e-8);
        /* The delay broadside, from the geometry alone: the target passes abeam while the pulse is under way. */
        double u = (spectrum_exact(&setting, d, r, 150e3, 1e-3) - spectrum_exact(&setting, d, r, 150e3, -1e-3))
                   / (-2 * M_PI * 2e-3);
        struct vector tx = {u, 0, 0}, rx = {u + d, 0, 0}, velocity = {3, 0, 0}, target = {0, r, 0};
        double late = delay_exact(tx, rx, velocity, target, 1500) - 2 * r / 1500 / sqrt(1 - 4e-6);
        assert_true(fabs(spectrum_abeam(&setting, d, r) - late) < 1e-12);
    }
}

/* Taps delay tones of the band by any fraction, of a flat and of a pulse's spectrum; fewer of them worse. */
static void taps(void **state)
{
    (void)state;
    struct delay_taps made;
    struct acquisition a = {.compressed = true, .fs = 25e3, .bandwidth = 20e3};
    double last = 1;
    for (int count = 8; count <= 24; count += 8) {
        double worst = 0, weights[DELAY_TAPS], slopes[DELAY_TAPS];
        assert_int_equal(delay_taps_make(&a, 1, count, &made), STATUS_OK);
        const double error = delay_taps_error(&a, 1, count, 0.5);
        for (int k = 0; k <= 33; k++) {
            double sum = 0, fraction = k / 33.0;
            delay_taps_weights(&made, fraction, weights, slopes);
            for (int n = 0; n < 101; n++) { /* mean square over the band */
                double w = 2 * M_PI * 0.4 * (n - 50) / 50.5;
                double complex value = -cexp(I * w * fraction), slope = -I * w * cexp(I * w * fraction);
                for (int t = 0; t < count; t++) {
                    value += weights[t] * cexp(I * w * (t + 1 - count / 2));
                    slope += slopes[t] * cexp(I * w * (t + 1 - count / 2));
                }
                sum += pow(cabs(value), 2) / 101;
                assert_true(cabs(slope) < 30 * (error + 1e-4));
            }
            worst = fmax(worst, sqrt(sum));
        }
        print_message("    %d taps: %.2e, said %.2e\n", count, worst, error);
        assert_true(worst < 1.02 * error && worst > 0.7 * error && error < last / 8);
        last = error;
    }
    assert_true(last < 1.2e-4);
}

static void make_deep(int receivers, int pings, struct scene *scene)
{
    make_scene(&(struct rma_track){pings, receivers, 4640, 25e3, 1230 / 25e3, -0.5 * (pings - 1) * receivers * 0.02,
                                   receivers * 0.02, 0.04},
               scene);
}

/* What two terms leave of the phasors is small, and they are as told: a vector of ones and another, orthonormal. */
static void terms(void **state)
{
    (void)state;
    static const struct grid swath = {0, 0.1, 2, 40, 0.03, 4000};
    struct scene scene;
    struct straight_track track;
    struct rma_method method = {.spectrum = spectrum_compensated};
    make_deep(66, 20, &scene);
    struct problem problem = problem_make(&scene.acquisition, 1, &swath, PRECISION_DOUBLE);
    assert_true(acquisition_is_straight(&scene.acquisition, &track));
    struct rma_view view = rma_view_of(&problem, &method, &track);
    double left[DELAY_TERMS];
    for (int count = 1; count <= DELAY_TERMS; count++) {
        struct delay_terms made;
        assert_true(delay_terms_make(&view, count, &made));
        assert_true(delay_terms_left(&view, count) == made.left);
        left[count - 1] = made.left;
        double worst = 0;
        for (int k = 0; k < 40; k++) {
            double nu = -9 + 0.45 * k, r = 41 + 2.7 * k;
            double weights[4];
            int first = delay_terms_place(&made, &view.setting, nu, weights);
            for (int m = 0; m < 66; m++) {
                double complex sum = -cexp(I * spectrum_residual(&view.setting, 0.04 * m, r, nu));
                for (int k4 = 0; k4 < 4 * made.terms; k4++)
                    sum += made.basis[k4 / 4 * 66 + m] * weights[k4 % 4]
                           * delay_terms_value(&made, first + k4 % 4, k4 / 4, r);
                worst = fmax(worst, cabs(sum));
            }
        }
        print_message("    %d terms leave %.1e; at most %.1e at any place\n", count, made.left, worst);
        assert_true(worst < 20 * made.left + 1e-6);
        for (int p = 0; p < made.terms; p++)
            for (int q = 0; q <= p; q++) {
                double product = -(p == q);
                for (int m = 0; m < 66; m++)
                    product += made.basis[p * 66 + m] * made.basis[q * 66 + m];
                assert_true(fabs(product) < 1e-12);
            }
        delay_terms_free(&made);
    }
    assert_true(left[0] < 0.02 && left[1] < left[0] / 20 && left[2] <= left[1]);
    free_scene(&scene);
}

enum { TARGETS = 4 };
static const double deep_targets[TARGETS] = {41.03, 57.31, 100.17, 170.4};

/* 41 to 170 m in one swath, at fs = 1.25 B, patches of +-24 range cells: the exact spectrum's error, and little
   more. */
static void deep_swath(void **state)
{
    (void)state;
    static const struct {
        const char *spec;
        double bounds[TARGETS];
    } runs[] = {{"rma_delay:precision=double", {1.3e-3, 9e-4, 6.5e-4, 5e-4}},
                {"rma_delay", {1.3e-3, 9e-4, 6.5e-4, 5e-4}},
                {"rma_delay:taps=24", {1e-3, 6.5e-4, 3.5e-4, 2.5e-4}},
                {"rma_delay:taps=24,terms=3", {1e-3, 6.5e-4, 3.5e-4, 2.5e-4}},
                {"rma_delay:taps=24,stolt=16,precision=double", {1e-3, 6.5e-4, 3.5e-4, 2.5e-4}},
                {"rma_delay:terms=1", {1e-2, 4.5e-3, 1.1e-3, 5.5e-4}},
                {"rma_numeric:blocks=100", {1e-3, 5.5e-4, 2.6e-4, 1.5e-4}}};
    struct scene scene;
    struct echoes echoes;
    struct image exact, image;
    struct grid patches[TARGETS];
    make_deep(66, 20, &scene);
    add_targets(&scene, TARGETS, deep_targets);
    assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
    for (int t = 0; t < TARGETS; t++)
        patches[t] = (struct grid){scene.targets[t].x - 0.16, 0.02, 17, deep_targets[t] - 0.72, 0.03, 49};
    struct problem problem = problem_make(&scene.acquisition, TARGETS, patches, PRECISION_DOUBLE);
    form("reference:precision=double", problem, &echoes, &exact);
    for (size_t k = 0; k < sizeof runs / sizeof *runs; k++) {
        form(runs[k].spec, problem, &echoes, &image);
        for (int t = 0; t < TARGETS; t++) {
            double error = patch_error(&image, &exact, t);
            print_message("    %-32s at %g m: %.2e\n", runs[k].spec, deep_targets[t], error);
            assert_up_to(error, runs[k].bounds[t], "error of %s at %g m", runs[k].spec, deep_targets[t]);
        }
        image_free(&image);
    }
    image_free(&exact);
    echoes_free(&echoes);
    free_scene(&scene);
}

/* Receivers at even places are added up in two steps: the image is that of one step, which a receiver takes that is
   1e-9 of a wavelength off its place. More receivers than the track's spacing asks for (48 in place of 40), fewer, odd
   numbers, a track backwards. */
static void two_steps(void **state)
{
    (void)state;
    static const struct {
        int receivers, periods;
        double direction;
    } arrays[] = {{40, 40, 1}, {48, 40, -1}, {35, 35, 1}, {24, 48, 1}, {22, 22, -1}};
    static const double targets[] = {60.2, 61.1};
    static const struct grid part = {-0.14, 0.02, 8, 60, 0.05, 30};
    static const char *const specs[] = {"rma_delay:precision=double", "rma_delay:terms=3,precision=double",
                                        "rma_delay:terms=1"};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) {
        const double spacing = arrays[k].direction * arrays[k].periods * 0.02;
        struct scene scene;
        struct echoes echoes;
        struct image image;
        make_scene(&(struct rma_track){12, arrays[k].receivers, 512, 25e3, 1980 / 25e3, -5.5 * spacing, spacing, 0.04},
                   &scene);
        struct acquisition *a = &scene.acquisition;
        add_targets(&scene, 2, targets);
        assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
        struct problem problem = problem_make(a, 1, &part, PRECISION_DOUBLE);
        for (size_t n = 0; n < sizeof specs / sizeof *specs; n++) {
            const double folded = support_work(specs[n], problem).flops;
            for (int p = 0; p < a->pings; p++)
                a->rx[p * a->receivers + 3].x += 1e-11;
            const double plain = support_work(specs[n], problem).flops;
            form(specs[n], problem, &echoes, &image);
            for (int p = 0; p < a->pings; p++)
                a->rx[p * a->receivers + 3].x -= 1e-11;
            assert_true(folded < 0.9 * plain);
            print_message("    %d receivers, %.2f of the FLOPs:\n", a->receivers, folded / plain);
            assert_up_to(swath_error(specs[n], problem, &echoes, &image), n < 2 ? 1e-11 : 3e-7, "%s, %d receivers",
                         specs[n], a->receivers);
            image_free(&image);
        }
        echoes_free(&echoes);
        free_scene(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spectrum),   cmocka_unit_test(taps),      cmocka_unit_test(terms),
        cmocka_unit_test(deep_swath), cmocka_unit_test(two_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
