/* The exact images: their delays, their echoes, and `reference` against them on every extreme scene. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contract/delay.h"
#include "files/paths.h"
#include "scene/random.h"
#include "scene/simulate.h"
#include "stability/exact_geometry.h"
#include "stability/exact_image.h"
#include "tests/support.h"

static double between(struct random *random, double low, double high)
{
    return low + (high - low) * random_uniform(random);
}

/* Two formulas, two precisions: they agree to what double holds, and the exact one solves the equation better. */
static void delays_solve_the_equation(void **state)
{
    (void)state;
    struct random random = random_seed(11, 0);
    double slow = 0, fast = 0, worst_left = 0;
    for (int n = 0; n < 2000; n++) {
        const double c = 1500, speed = n % 4 == 0 ? 1499 : between(&random, -30, 30);
        const struct vector tx = {between(&random, -50, 50), 0, 0}, velocity = {speed, 0, 0};
        const struct vector rx = {tx.x + between(&random, -5, 5), 0, 0}, p = {0, between(&random, 0.1, 300), 0};
        const struct exact_pair pair = {{tx.x, 0, 0}, {rx.x, 0, 0}, {speed, 0, 0}, 0};
        const struct exact_point point = {p.x, p.y, 0};
        const long double delay = exact_delay(&pair, point, c);
        const long double back = hypotl(rx.x + (long double)speed * delay - p.x, p.y);
        const long double left = hypotl(tx.x - p.x, p.y) + back - c * delay;
        worst_left = worse_of(worst_left, (double)fabsl(left / (c * delay)));
        const double off = (double)(fabsl(delay_exact(tx, rx, velocity, p, c) - delay) / delay);
        *(n % 4 == 0 ? &fast : &slow) = worse_of(n % 4 == 0 ? fast : slow, off);
    }
    print_message("left %.1e; delay_exact differs by %.1e, at 0.999 c by %.1e\n", worst_left, slow, fast);
    assert_true(worst_left < 1e-18);           /* a double could not say so */
    assert_true(slow > 1e-17 && slow < 1e-15); /* and its own delay differs */
    assert_true(fast < 1e-12);                 /* by as much as 1/(1 - v/c) allows */
}

/* Long records: sinc(B t). The closed form is the record's period; the difference falls with its square. */
static void echo_tends_to_sinc(void **state)
{
    (void)state;
    struct acquisition a = {.fs = 30e3, .bandwidth = 15e3, .fc = 150e3, .samples = 65536};
    double worst = 0;
    for (int n = -400; n <= 400; n++) {
        const long double t = n / 400.0L * 8 / 15e3L, z = exact_pi * 15e3L * t;
        const long double sinc = n == 0 ? 1.0L : sinl(z) / z;
        worst = worse_of(worst, (double)fabsl(exact_echo(&a, t) - sinc));
    }
    assert_true(worst < 3e-8);
    a.samples = 256; /* and it repeats */
    assert_close((double)(exact_echo(&a, 1e-4L) - exact_echo(&a, 1e-4L + 256 / 30e3L)), 0, 1e-17);
    a.bandwidth = 1; /* less than a bin: one frequency */
    assert_true(exact_echo(&a, 3e-3L) == 1.0L);
}

/* |image - sums| / |sums| of the worst patch, and `reference`'s own share of rounding: its phase, times the
 * cancellation. */
static double distance(const struct image *image, const struct exact_sum *sums)
{
    double worst = 0;
    for (int k = 0; k < image->patch_count; k++) {
        const struct grid *patch = &image->patches[k];
        long double difference = 0, norm = 0;
        for (int i = 0; i < patch->r_count; i++)
            for (int j = 0; j < patch->x_count; j++, sums++) {
                const double complex pixel = image_pixel(image, k, i, j);
                const long double re = creal(pixel) - sums->re, im = cimag(pixel) - sums->im;
                difference += re * re + im * im;
                norm += sums->re * sums->re + sums->im * sums->im;
            }
        worst = worse_of(worst, norm > 0 ? (double)sqrtl(difference / norm) : (double)difference);
    }
    return worst;
}

/* 30 roundings of the phase and of the coordinates. At fs = B the bin at fs/2 holds both ends of the band, and the
   record is one bin of N short of the echo. */
static double rounding_of(const struct scene *scene)
{
    const struct acquisition *a = &scene->acquisition;
    const double last = a->t0[0] + (a->samples - 1) / a->fs, place = 2 * fabs(a->tx[0].x) / a->sound_speed;
    return 30 * 2 * M_PI * (a->fc + a->fs) * (fmax(fabs(a->t0[0]), fabs(last)) + place) * 0x1p-53
           + (a->bandwidth < a->fs ? 0 : 1.0 / a->samples);
}

static void reference_is_exact_on_extreme_scenes(void **state)
{
    (void)state;
    char **names;
    int count, read = 0;
    assert_int_equal(scene_names(data_path(DATA_EXTREME), &names, &count), STATUS_OK);
    for (int k = 0; k < count; k++) {
        char name[200];
        struct scene scene;
        struct echoes echoes;
        struct image image;
        snprintf(name, sizeof name, SCENES_EXTREME "/%s", names[k]);
        if (scene_load(name, data_path(DATA_SCENES), &scene) != STATUS_OK)
            continue; /* which ones must be: test_stability */
        if (!exact_ideal_excludes(&scene)) {
            const struct problem problem =
                problem_make(&scene.acquisition, scene.patch_count, scene.patches, PRECISION_DOUBLE);
            struct exact_sum *sums = calloc(exact_pixels(scene.patch_count, scene.patches), sizeof *sums);
            assert_non_null(sums);
            support_echoes(&scene, &echoes);
            assert_int_equal(support_image("reference:precision=double", problem, &echoes, &image), STATUS_OK);
            assert_int_equal(exact_ideal(&scene, sums), STATUS_OK);
            const double off = distance(&image, sums), most = 1e-9 + rounding_of(&scene);
            print_message("%-28s reference is %.1e off, bound %.1e\n", name, off, most);
            if (!(off <= most))
                fail_msg("%s: reference is %.3g off the exact image, at most %.3g is accepted", name, off, most);
            read++;
            free(sums);
            image_free(&image);
            echoes_free(&echoes);
        }
        scene_free(&scene);
    }
    scene_names_free(names, count);
    assert_true(read >= 38);
}

/* The plain paths of all methods are their own sums in long double, to rounding. */
static void methods_are_their_own_sums(void **state)
{
    (void)state;
    static const struct {
        const char *spec;
        struct exact_reading reading;
    } methods[] = {
        {"bp_nearest:exact=true,precision=double", {.kind = READING_NEAREST, .upsample = 1, .phases = 1}},
        {"bp_linear:beta=8,exact=true,precision=double", {.kind = READING_LINEAR, .upsample = 1, .phases = 9}},
        {"bp_sinc:taps=8,exact=true,precision=double", {.kind = READING_SINC, .upsample = 1, .taps = 8}},
        {"bp_sinc:taps=16,window=kaiser,exact=true,precision=double",
         {.kind = READING_SINC, .upsample = 1, .taps = 16, .kaiser = 5}},
        {"bp_zeropad:factor=8,exact=true,precision=double", {.kind = READING_NEAREST, .upsample = 8, .phases = 1}},
        {"bp_zeropad:factor=3,exact=true,precision=double", {.kind = READING_NEAREST, .upsample = 3, .phases = 1}},
        {"bp_farrow:degree=3,exact=true,precision=double",
         {.kind = READING_POLYNOMIAL, .upsample = 1, .phases = 1, .degree = 3}},
        {"bp_farrow:degree=8,exact=true,precision=double",
         {.kind = READING_POLYNOMIAL, .upsample = 1, .phases = 1, .degree = 8}},
        {"bp_farrow:degree=4,factor=2,exact=true,precision=double",
         {.kind = READING_POLYNOMIAL, .upsample = 2, .phases = 1, .degree = 4}},
        {"bp_fitted:taps=6,exact=true,precision=double",
         {.kind = READING_FITTED, .upsample = 1, .taps = 6, .band = 0.5}},
        {"bp_fitted:taps=8,factor=4,exact=true,precision=double",
         {.kind = READING_FITTED, .upsample = 4, .taps = 8, .band = 0.125}},
    };
    struct scene scene;
    struct echoes echoes;
    support_scene("extreme/base", &scene);
    for (int odd = 0; odd < 2; odd++) { /* an odd record has no bin at fs/2 to share */
        scene.acquisition.samples -= odd;
        support_echoes(&scene, &echoes);
        const struct problem problem =
            problem_make(&scene.acquisition, scene.patch_count, scene.patches, PRECISION_DOUBLE);
        struct exact_sum *sums = calloc(exact_pixels(scene.patch_count, scene.patches), sizeof *sums);
        assert_non_null(sums);
        for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
            struct image image;
            assert_int_equal(support_image(methods[k].spec, problem, &echoes, &image), STATUS_OK);
            assert_int_equal(exact_method(&problem, echoes.samples, &methods[k].reading, sums), STATUS_OK);
            if (!(distance(&image, sums) <= 5e-10))
                fail_msg("%s: %.3g off its own sum", methods[k].spec, distance(&image, sums));
            image_free(&image);
        }
        free(sums);
        echoes_free(&echoes);
    }
    scene_free(&scene);
}

/* A sound speed that is wrong in the twelfth digit is seen: the image moves by kappa_phase times as much. */
static void twelfth_digit_is_seen(void **state)
{
    (void)state;
    struct scene scene;
    support_scene("extreme/base", &scene);
    const size_t pixels = exact_pixels(scene.patch_count, scene.patches);
    struct exact_sum *right = calloc(2 * pixels, sizeof *right), *wrong = right + pixels;
    struct echoes echoes;
    const struct exact_reading reading = {.kind = READING_NEAREST, .upsample = 1, .phases = 1};
    support_echoes(&scene, &echoes);
    const struct problem problem = problem_make(&scene.acquisition, scene.patch_count, scene.patches, PRECISION_DOUBLE);
    assert_int_equal(exact_method(&problem, echoes.samples, &reading, right), STATUS_OK);
    scene.acquisition.sound_speed *= 1 + 1e-12;
    assert_int_equal(exact_method(&problem, echoes.samples, &reading, wrong), STATUS_OK);
    long double difference = 0, norm = 0;
    for (size_t i = 0; i < pixels; i++) {
        difference += powl(hypotl(wrong[i].re - right[i].re, wrong[i].im - right[i].im), 2);
        norm += powl(hypotl(right[i].re, right[i].im), 2);
    }
    const double kappa = 2 * M_PI * 150e3 * 2 * 100.137 / 1500;
    assert_close((double)sqrtl(difference / norm) / (kappa * 1e-12), 1, 0.02);
    free(right);
    echoes_free(&echoes);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(delays_solve_the_equation),
        cmocka_unit_test(echo_tends_to_sinc),
        cmocka_unit_test(reference_is_exact_on_extreme_scenes),
        cmocka_unit_test(methods_are_their_own_sums),
        cmocka_unit_test(twelfth_digit_is_seen),
    };
    return cmocka_run_group_tests_name("exact", tests, NULL, NULL);
}
