/* Slices: exact images against independent numbers, closed forms, and what must stay undefined. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "metrics/metrics.h"
#include "tests/metrics/exact_image.h"

static void check_slice(const struct exact_scene *s, const struct slice_metrics *m)
{
    assert_string_equal(m->reason, "");
    assert_close(m->pslr_db[DEFINITION_NULL], s->pslr_db, 0.02);
    assert_close(m->islr_db[DEFINITION_NULL], s->islr_null_db, 0.02);
    assert_close(m->islr_db[DEFINITION_3DB], s->islr_3db_db, 0.02);
    assert_close(m->width_m / s->width_m, 1, 0.005);
    assert_close(m->position_error_m, 0, 1e-5);
    assert_true(isnan(m->pslr_db[DEFINITION_3DB]));
}

/* A single row through the target: azimuth needs no more. */
static void test_azimuth_on_raster(void **state)
{
    (void)state;
    const struct exact_scene *scenes[] = {&scene_a, &scene_b, &scene_c, &scene_d};
    for (int k = 0; k < 4; k++) {
        const struct exact_scene *s = scenes[k];
        int side = (int)lround(3 / s->x_step);
        struct grid grid = {s->target_x - side * s->x_step, s->x_step, 2 * side + 1, s->target_r, 0.025, 1};
        struct acquisition acquisition = acquisition_of(s);
        struct target target = {s->target_x, s->target_r, 1};
        struct image image;
        exact_image(s, &grid, k % 2 ? PRECISION_FLOAT : PRECISION_DOUBLE, &image);
        struct slice_metrics m = metrics_slice(&image, &acquisition, &target, AXIS_AZIMUTH);
        check_slice(s, &m);
        assert_close(m.extent_m, 3, 1e-6);
        double complex peak = metrics_value(&image, &acquisition, s->target_x, s->target_r);
        assert_close(creal(peak), s->peak, 1e-4 * s->peak);
        assert_close(cimag(peak), 0, 1e-4 * s->peak);
        image_free(&image);
    }
}

/* The target between rows and columns: the same numbers must come out, and values between the pixels must be true. */
static void test_off_raster(void **state)
{
    (void)state;
    const struct exact_scene *s = &scene_a;
    struct grid grid = {-3 + 0.37 * 0.02, 0.02, 300, 90 - 0.5 + 0.41 * 0.025, 0.025, 40};
    struct acquisition acquisition = acquisition_of(s);
    struct target target = {s->target_x, s->target_r, 1};
    struct image image;
    exact_image(s, &grid, PRECISION_DOUBLE, &image);
    struct slice_metrics m = metrics_slice(&image, &acquisition, &target, AXIS_AZIMUTH);
    check_slice(s, &m);
    assert_true(m.extent_m < 3 && m.extent_m > 2.97);
    int count;
    struct exact_pair *pairs = exact_pairs(s, &count);
    for (int k = 0; k < 20; k++) {
        double x = 0.2 * sin(1.0 + 7 * k), r = 90 + 0.02 * sin(2.0 + 5 * k);
        double complex value = metrics_value(&image, &acquisition, x, r), wanted = exact_value(s, pairs, count, x, r);
        assert_true(cabs(value - wanted) < 1.5e-3 * s->peak); /* the patch ends 20 rows away */
    }
    free(pairs);
    /* A flat spectrum over B makes a sinc of c t/2 in range: zeros every c/(2B), -13.26 dB, narrowed by nothing. */
    m = metrics_slice(&image, &acquisition, &target, AXIS_RANGE);
    assert_string_equal(m.reason, "");
    assert_close(m.width_m, 0.88589 * sound_m_s / (2 * s->bandwidth), 0.0004);
    assert_close(m.pslr_db[DEFINITION_NULL], -13.26, 0.1);
    assert_close(m.position_error_m, 0, 1e-4);
    assert_true(isnan(m.pslr_db[DEFINITION_PIXEL]));
    image_free(&image);
}

/* Plane waves that fill 85 % of the band in azimuth and in range, on the carrier: below -80 dB. */
static void test_interpolation(void **state)
{
    (void)state;
    struct grid grid = {-1, 0.02, 101, 50, 0.025, 101};
    struct acquisition acquisition = acquisition_of(&scene_a);
    double kx[] = {0, 0.425 / 0.02, -0.425 / 0.02, 0.3 / 0.02};
    double kr[] = {0, 0.425 / 0.025, 0.2 / 0.025, -0.425 / 0.025};
    struct image image;
    support_image_make(&grid, 1, PRECISION_DOUBLE, &image);
    for (int w = 0; w < 4; w++) {
        for (int pass = 0; pass < 2; pass++) {
            for (int i = 0; pass == 0 && i < grid.r_count; i++)
                for (int j = 0; j < grid.x_count; j++) {
                    double x = -1 + j * 0.02, r = 50 + i * 0.025;
                    support_pixel_set(&image, 0, i, j,
                                      cexp(2 * M_PI * I * (kx[w] * x + (kr[w] + 2 * carrier_hz / sound_m_s) * r)));
                }
            for (int k = 0; pass == 1 && k < 50; k++) {
                double x = 0.3 * sin(11.0 * k), r = 51.25 + 0.4 * sin(17.0 * k);
                double complex wanted = cexp(2 * M_PI * I * (kx[w] * x + (kr[w] + 2 * carrier_hz / sound_m_s) * r));
                assert_true(cabs(metrics_value(&image, &acquisition, x, r) - wanted) < 1e-4);
            }
        }
    }
    assert_true(isnan(creal(metrics_value(&image, &acquisition, 1.0001, 51))));
    assert_true(isnan(creal(metrics_value(&image, &acquisition, 0, 49.99))));
    image_free(&image);
}

/* BP22's array with a target at 180 m: the papers' tables read the slice at the pixels, which flatters the PSLR. */
static void test_pixel_definition(void **state)
{
    (void)state;
    struct exact_scene s = scene_a;
    s.x_first = -15 * 0.8;
    s.pings = 31;
    s.target_r = 180;
    s.cut_at_midpoint = true;
    s.cut = 0.405;
    int pairs_count, side = 250 * 16, count = 2 * side + 1;
    struct exact_pair *pairs = exact_pairs(&s, &pairs_count);
    double *power = malloc(sizeof *power * (size_t)count);
    assert_non_null(power);
    for (int k = 0; k < count; k++) {
        double complex value = exact_value(&s, pairs, pairs_count, (k - side) * 0.02 / 16, 180);
        power[k] = creal(value * conj(value));
    }
    struct slice_metrics m = metrics_of_power(power, count, -side * 0.02 / 16, 0.02 / 16, 0.02);
    assert_close(m.pslr_db[DEFINITION_PIXEL], -14.84, 0.02);
    assert_close(m.islr_db[DEFINITION_PIXEL], -10.35, 0.02);
    assert_close(m.pslr_db[DEFINITION_NULL], -13.34, 0.04); /* known for an unstated ping phase */
    assert_close(m.islr_db[DEFINITION_NULL], -10.45, 0.04);
    m = metrics_of_power(power, count, -side * 0.02 / 16, 0.02 / 16, 0);
    assert_true(isnan(m.pslr_db[DEFINITION_PIXEL]));
    assert_string_equal(m.reason, "");
    free(power);
    free(pairs);
}

/* --- Closed forms -------------------------------------------------------------------------------------------- */

enum { SAMPLES = 6001, MIDDLE = 3000 };
static double power[SAMPLES]; /* step 1 mm, the target in the middle */

static void lobe_add(double at_m, double height, double null_m)
{
    for (int k = 0; k < SAMPLES; k++)
        power[k] += height * pow(sinc(((k - MIDDLE) * 1e-3 - at_m) / null_m), 2);
}

static struct slice_metrics measure(void)
{
    return metrics_of_power(power, SAMPLES, -MIDDLE * 1e-3, 1e-3, 0);
}

static void check_undefined(struct slice_metrics m, const char *reason)
{
    assert_non_null(strstr(m.reason, reason));
    assert_true(isnan(m.pslr_db[DEFINITION_NULL]) && isnan(m.islr_db[DEFINITION_NULL]));
    assert_true(isnan(m.islr_db[DEFINITION_3DB]) && isnan(m.pslr_db[DEFINITION_PIXEL]));
}

static void test_sinc(void **state)
{
    (void)state;
    memset(power, 0, sizeof power);
    lobe_add(0.01234, 7, 0.05);
    struct slice_metrics m = measure();
    assert_string_equal(m.reason, "");
    assert_close(m.pslr_db[DEFINITION_NULL], -13.2615, 0.005);
    assert_close(m.width_m, 0.885893 * 0.05, 2e-5);
    assert_close(m.position_error_m, 0.01234, 1e-6);
    assert_close(m.extent_m, 3, 1e-9);
    /* 0.902823 of the energy lies between the zeros; of the rest 2/(2 pi^2 60) lies beyond 60 zeros to each side. */
    double beyond = 1 / (M_PI * M_PI * 60);
    assert_close(m.islr_db[DEFINITION_NULL], 10 * log10((1 - 0.902823 - beyond) / 0.902823), 0.01);
}

static void test_several_peaks(void **state)
{
    (void)state;
    memset(power, 0, sizeof power);
    lobe_add(0, 1, 0.05);
    lobe_add(1.2, 0.25, 0.05);
    struct slice_metrics m = measure(); /* a weaker neighbour is the largest sidelobe */
    assert_close(m.pslr_db[DEFINITION_NULL], 10 * log10(0.25), 0.01);
    lobe_add(1.2, 0.75 + 1e-8, 0.05);
    m = measure(); /* an equal one must not turn on rounding */
    assert_close(m.pslr_db[DEFINITION_NULL], 0, 0.01);
    lobe_add(1.2, 1, 0.05);
    check_undefined(measure(), "the strongest peak lies +1.2 m");
    memset(power, 0, sizeof power);
    lobe_add(-0.4, 1, 0.05);
    check_undefined(measure(), "the strongest peak lies -0.4 m");
}

static void test_lobes_cut(void **state)
{
    (void)state;
    memset(power, 0, sizeof power);
    lobe_add(0, 1, 4); /* falls to half, but not to a minimum */
    struct slice_metrics m = measure();
    check_undefined(m, "no first minimum");
    assert_close(m.width_m, 0.885893 * 4, 1e-3);
    memset(power, 0, sizeof power);
    lobe_add(0, 1, 20);
    check_undefined(measure(), "does not fall to half");
    memset(power, 0, sizeof power);
    lobe_add(0, 1, 2.5); /* a minimum, but the sidelobe behind it is cut */
    m = measure();
    assert_true(isnan(m.pslr_db[DEFINITION_NULL]));
    assert_non_null(strstr(m.reason, "sidelobe is cut"));
    for (int k = 0; k < SAMPLES; k++)
        power[k] = k + 1;
    check_undefined(measure(), "at its end");
    for (int k = 0; k < SAMPLES; k++)
        power[k] = SAMPLES - k;
    check_undefined(metrics_of_power(power + MIDDLE, 100, 0, 1e-3, 0), "at its end");
    for (int side = -1; side <= 1; side += 2) { /* a neighbour so near that the power between is above half */
        memset(power, 0, sizeof power);
        lobe_add(0, 1, 0.05);
        lobe_add(side * 0.055, 0.95, 0.05);
        check_undefined(measure(), "does not fall to half");
    }
    memset(power, 0, sizeof power);
    lobe_add(0, 1, 1); /* of the sidelobes at +-1.43 m, only the left one is seen, in part */
    m = metrics_of_power(power + MIDDLE - 1200, 2301, -1.2, 1e-3, 0);
    assert_true(isnan(m.pslr_db[DEFINITION_NULL]));
    assert_non_null(strstr(m.reason, "sidelobe is cut by the slice's end at -1.2 m"));
}

/* A sidelobe on either side counts by every definition, in PSLR and ISLR: a neighbour of a tenth of the power, whose
   main lobe has a tenth of the energy. */
static void test_either_side(void **state)
{
    (void)state;
    struct slice_metrics sides[2];
    const double all = 1.1 - (1 / 60. + 0.05 / 36 + 0.05 / 84) / (M_PI * M_PI); /* some zeros away the slice ends */
    for (int side = 0; side < 2; side++) {
        memset(power, 0, sizeof power);
        lobe_add(0, 1, 0.05);
        lobe_add(side ? 1.2 : -1.2, 0.1, 0.05);
        sides[side] = metrics_of_power(power, SAMPLES, -MIDDLE * 1e-3, 1e-3, 0.02);
        assert_string_equal(sides[side].reason, "");
        assert_close(sides[side].pslr_db[DEFINITION_NULL], -10, 0.01);
        assert_close(sides[side].pslr_db[DEFINITION_PIXEL], -10, 0.01);
        assert_close(sides[side].islr_db[DEFINITION_NULL], 10 * log10(all / 0.902823 - 1), 0.005);
    }
    for (int d = 0; d < 3; d++)
        assert_close(sides[0].islr_db[d], sides[1].islr_db[d], 1e-9);
    assert_close(sides[0].width_m, sides[1].width_m, 1e-12);
    /* -3 dB: 0.7220 of a sinc squared's energy lies between. Pixels: five of them, 0.4 zeros apart. */
    double five = 1;
    for (int k = 1; k <= 2; k++)
        five += 2 * pow(sinc(0.4 * k), 2);
    assert_close(sides[0].islr_db[DEFINITION_3DB], 10 * log10(all / 0.722 - 1), 0.02);
    assert_close(sides[0].islr_db[DEFINITION_PIXEL], 10 * log10(all * 2.5 / five - 1), 0.02);
}

/* The main lobe of five pixels, and one at least to either side of it. */
static void test_pixels_cut(void **state)
{
    (void)state;
    static const struct {
        int left, right; /* pixels beside the target's */
        bool defined;
    } cases[] = {{3, 3, true}, {2, 10, false}, {10, 2, false}, {3, 10, true}};
    const int pixel = 40; /* samples */
    memset(power, 0, sizeof power);
    lobe_add(0, 1, 0.05);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const int first = MIDDLE - cases[k].left * pixel, last = MIDDLE + cases[k].right * pixel;
        struct slice_metrics m =
            metrics_of_power(power + first, last - first + 1, (first - MIDDLE) * 1e-3, 1e-3, pixel * 1e-3);
        assert_int_equal(!isnan(m.islr_db[DEFINITION_PIXEL]), cases[k].defined);
        assert_int_equal(strstr(m.reason, "no main lobe of 5 pixels") == NULL, cases[k].defined);
    }
}

static void test_nothing_to_measure(void **state)
{
    (void)state;
    memset(power, 0, sizeof power);
    check_undefined(measure(), "zero");
    lobe_add(0, 1, 0.05);
    power[17] = NAN;
    check_undefined(measure(), "not finite");
    power[17] = INFINITY;
    check_undefined(measure(), "not finite");
    check_undefined(metrics_of_power(power + MIDDLE - 1, 2, -1e-3, 1e-3, 0), "shorter than 3 samples");
    for (int k = 0; k < SAMPLES; k++)
        power[k] = 1;
    check_undefined(measure(), "");
}

static void test_undefined_slices(void **state)
{
    (void)state;
    struct acquisition acquisition = acquisition_of(&scene_a);
    struct target target = {0, 90, 1};
    struct image image;

    struct grid fine = {-1, 0.02, 101, 89.9, 0.025, 9};
    support_image_make(&fine, 1, PRECISION_DOUBLE, &image);
    check_undefined(metrics_slice(&image, &acquisition, &target, AXIS_AZIMUTH), "zero");
    check_undefined(metrics_slice(&image, &acquisition, &(struct target){5, 90, 1}, AXIS_AZIMUTH), "no patch");
    check_undefined(metrics_slice(&image, &acquisition, &(struct target){-1, 90, 1}, AXIS_AZIMUTH), "shorter than 3");
    support_pixel_set(&image, 0, 4, 50, NAN);
    check_undefined(metrics_slice(&image, &acquisition, &target, AXIS_AZIMUTH), "not finite");
    image_free(&image);

    struct grid one_row = {-1, 0.02, 101, 90, 0.025, 1};
    support_image_make(&one_row, 1, PRECISION_DOUBLE, &image);
    check_undefined(metrics_slice(&image, &acquisition, &target, AXIS_RANGE), "shorter than 3");
    image_free(&image);

    struct grid coarse_range = {-1, 0.02, 101, 89.4, 0.06, 21}; /* c/(2B) = 0.05 m */
    support_image_make(&coarse_range, 1, PRECISION_DOUBLE, &image);
    check_undefined(metrics_slice(&image, &acquisition, &target, AXIS_RANGE), "range step");
    check_undefined(metrics_slice(&image, &acquisition, &(struct target){0, 90.02, 1}, AXIS_AZIMUTH), "range step");
    image_free(&image);

    struct grid coarse_azimuth = {-3, 0.05, 121, 90, 0.025, 1}; /* the spectrum reaches 22 cycles/m */
    exact_image(&scene_a, &coarse_azimuth, PRECISION_DOUBLE, &image);
    check_undefined(metrics_slice(&image, &acquisition, &target, AXIS_AZIMUTH), "azimuth step");
    image_free(&image);
}

/* Of two patches that hold a target, the one that reaches further around it counts. */
static void test_best_patch(void **state)
{
    (void)state;
    struct acquisition acquisition = acquisition_of(&scene_a);
    struct target target = {0, 90, 1};
    struct grid patches[] = {{-0.1, 0.02, 11, 89.975, 0.025, 3}, {-1, 0.02, 101, 89.75, 0.025, 21}};
    struct image image;
    support_image_make(patches, 2, PRECISION_DOUBLE, &image);
    for (int j = 0; j < 101; j++)
        support_pixel_set(&image, 1, 10, j, sinc((j - 50) * 0.02 / 0.05));
    struct slice_metrics m = metrics_slice(&image, &acquisition, &target, AXIS_AZIMUTH);
    assert_close(m.extent_m, 1, 1e-9);
    assert_close(m.width_m, 0.885893 * 0.05, 1e-4);
    image_free(&image);
}

static void test_slice_samples(void **state)
{
    (void)state;
    struct acquisition acquisition = acquisition_of(&scene_a);
    struct target target = {0, 90, 1};
    struct grid grid = {-1, 0.02, 101, 90, 0.025, 1};
    struct image image;
    double *position_m, *power_db;
    int count;
    support_image_make(&grid, 1, PRECISION_DOUBLE, &image);
    metrics_slice_samples(&image, &acquisition, &target, AXIS_AZIMUTH, &position_m, &power_db, &count);
    assert_int_equal(count, 0);
    assert_null(position_m);
    for (int j = 0; j < 101; j++)
        support_pixel_set(&image, 0, 0, j, 3 * sinc((j - 50) * 0.02 / 0.05));
    metrics_slice_samples(&image, &acquisition, &target, AXIS_AZIMUTH, &position_m, &power_db, &count);
    assert_true(count > 1000 && count % 2 == 1);
    assert_close(position_m[0], -1, 1e-9);
    assert_close(position_m[count / 2], 0, 1e-12);
    assert_close(power_db[count / 2], 0, 1e-9);
    for (int k = 0; k < count; k++)
        if (fabs(position_m[k] - 0.02) < 1e-9)
            assert_close(power_db[k], 20 * log10(sinc(0.4)), 1e-6);
    free(position_m);
    free(power_db);
    image_free(&image);
}

/* Rows of a million pixels: what is measured along them must not cost the square of their number. */
static void test_long_row(void **state)
{
    (void)state;
    struct acquisition acquisition = acquisition_of(&scene_a);
    struct target target = {0, 90, 1};
    const int half = 499991, count = 2 * half + 1; /* a prime number of pixels */
    struct grid grid = {-half * 2e-6, 2e-6, count, 90, 0.025, 1};
    struct image image;
    support_image_make(&grid, 1, PRECISION_DOUBLE, &image);
    for (int j = 0; j < count; j++)
        support_pixel_set(&image, 0, 0, j, sinc((j - half) * 2e-6 / 0.05));
    struct slice_metrics m = metrics_slice(&image, &acquisition, &target, AXIS_AZIMUTH);
    assert_string_equal(m.reason, "");
    assert_close(m.width_m, 0.885893 * 0.05, 1e-6);
    assert_close(m.pslr_db[DEFINITION_NULL], -13.2615, 1e-3);
    for (int j = 1; j < count; j += 2)
        support_pixel_set(&image, 0, 0, j, -image_pixel(&image, 0, 0, j));
    check_undefined(metrics_slice(&image, &acquisition, &target, AXIS_AZIMUTH), "azimuth step");
    image_free(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_azimuth_on_raster),
        cmocka_unit_test(test_off_raster),
        cmocka_unit_test(test_interpolation),
        cmocka_unit_test(test_pixel_definition),
        cmocka_unit_test(test_sinc),
        cmocka_unit_test(test_several_peaks),
        cmocka_unit_test(test_either_side),
        cmocka_unit_test(test_lobes_cut),
        cmocka_unit_test(test_pixels_cut),
        cmocka_unit_test(test_nothing_to_measure),
        cmocka_unit_test(test_undefined_slices),
        cmocka_unit_test(test_best_patch),
        cmocka_unit_test(test_slice_samples),
        cmocka_unit_test(test_long_row),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
