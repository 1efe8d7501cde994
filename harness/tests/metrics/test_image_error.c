/* Errors against the exact image: closed forms, sums by hand, parts of an image. */
#include <math.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "metrics/metrics.h"
#include "tests/support.h"

static double complex pattern(int i, int j)
{
    return (1 + 0.5 * sin(3 * i + j)) * cexp(I * (0.7 * i - 1.3 * j));
}

static void test_error_of_a_gain(void **state)
{
    (void)state;
    struct grid grid = {0, 0.02, 5, 10, 0.025, 4};
    struct image image, reference;
    support_image_make(&grid, 1, PRECISION_DOUBLE, &image);
    support_image_make(&grid, 1, PRECISION_DOUBLE, &reference);
    double complex gain = 0.9 * cexp(0.2 * I);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 5; j++) {
            support_pixel_set(&reference, 0, i, j, pattern(i, j));
            support_pixel_set(&image, 0, i, j, gain * pattern(i, j));
        }
    struct error_metrics e = metrics_error(&image, &reference);
    assert_close(e.error, cabs(gain - 1), 1e-12);
    assert_close(e.peak_ratio, cabs(gain - 1), 1e-12);
    assert_close(e.phase_rms_rad, 0.2, 1e-12);
    assert_true(e.error_gain < 1e-14);
    image_free(&image);
    image_free(&reference);
}

/* Three strong pixels and one below a tenth of the maximum. */
static void test_error_by_hand(void **state)
{
    (void)state;
    struct grid grid = {0, 0.02, 4, 10, 0.025, 1};
    struct image image, reference;
    support_image_make(&grid, 1, PRECISION_DOUBLE, &image);
    support_image_make(&grid, 1, PRECISION_DOUBLE, &reference);
    double complex wanted[] = {2, I, 1, 0.19}, value[] = {2 * cexp(0.1 * I), I, 1, -0.19};
    double error = 0, cross_re = 0, cross_im = 0, energy = 6 + 0.19 * 0.19;
    for (int j = 0; j < 4; j++) {
        support_pixel_set(&reference, 0, 0, j, wanted[j]);
        support_pixel_set(&image, 0, 0, j, value[j]);
        error += pow(cabs(value[j] - wanted[j]), 2);
        cross_re += creal(wanted[j] * conj(value[j]));
        cross_im += cimag(wanted[j] * conj(value[j]));
    }
    struct error_metrics e = metrics_error(&image, &reference);
    assert_close(e.error, sqrt(error / energy), 1e-12);
    assert_close(e.error_gain, sqrt(1 - (cross_re * cross_re + cross_im * cross_im) / (energy * energy)), 1e-9);
    assert_close(e.phase_rms_rad, sqrt(4 * 0.01 / 6), 1e-12);
    assert_close(e.peak_ratio, 0.38 / 2, 1e-12);
    /* A zero image is all wrong, and its phase is not "0". */
    memset(image.pixels[0], 0, 4 * sizeof(double complex));
    e = metrics_error(&image, &reference);
    assert_close(e.error, 1, 1e-12);
    assert_close(e.error_gain, 1, 1e-12);
    assert_true(isnan(e.phase_rms_rad));
    support_pixel_set(&image, 0, 0, 2, NAN);
    e = metrics_error(&image, &reference);
    assert_true(isnan(e.error) && isnan(e.error_gain) && isnan(e.phase_rms_rad) && isnan(e.peak_ratio));
    e = metrics_error(&reference, &image);
    assert_true(isnan(e.error) && isnan(e.peak_ratio));
    memset(image.pixels[0], 0, 4 * sizeof(double complex));
    e = metrics_error(&reference, &image);
    assert_true(isnan(e.error) && isnan(e.error_gain) && isnan(e.phase_rms_rad) && isnan(e.peak_ratio));
    image_free(&image);
    image_free(&reference);
}

/* A tenth of the largest magnitude counts as strong, less does not. */
static void test_strong_pixels(void **state)
{
    (void)state;
    struct grid grid = {0, 0.02, 3, 10, 0.025, 1};
    struct image image, reference;
    support_image_make(&grid, 1, PRECISION_DOUBLE, &image);
    support_image_make(&grid, 1, PRECISION_DOUBLE, &reference);
    const double wanted[] = {10, 1, 0.999};
    for (int j = 0; j < 3; j++) {
        support_pixel_set(&reference, 0, 0, j, wanted[j]);
        support_pixel_set(&image, 0, 0, j, wanted[j] * cexp(0.1 * j * I));
    }
    struct error_metrics e = metrics_error(&image, &reference);
    assert_close(e.phase_rms_rad, sqrt(1 * 0.01 / 101), 1e-12);
    assert_close(e.peak_ratio, cabs(0.999 * (cexp(0.2 * I) - 1)) / 10, 1e-12);
    image_free(&image);
    image_free(&reference);
}

/* The reference on parts of the image, found by their places; a float image against a double reference. */
static void test_error_of_parts(void **state)
{
    (void)state;
    struct grid whole[] = {{50, 0.02, 3, 10, 0.025, 3}, {-1, 0.02, 101, 100, 0.025, 41}};
    struct grid parts[] = {{-1 + 7 * 0.02, 0.02, 10, 100 + 3 * 0.025, 0.025, 5},
                           {-1 + 91 * 0.02, 0.02, 10, 100 + 36 * 0.025, 0.025, 5}};
    const int first[][2] = {{3, 7}, {36, 91}};
    struct image image, reference;
    support_image_make(whole, 2, PRECISION_FLOAT, &image);
    support_image_make(parts, 2, PRECISION_DOUBLE, &reference);
    for (int i = 0; i < 41; i++)
        for (int j = 0; j < 101; j++)
            support_pixel_set(&image, 1, i, j, pattern(i, j));
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 5; i++)
            for (int j = 0; j < 10; j++)
                support_pixel_set(&reference, k, i, j, pattern(first[k][0] + i, first[k][1] + j));
    assert_true(metrics_error(&image, &reference).error < 1e-7);
    support_pixel_set(&image, 1, 0, 0, NAN); /* outside the parts: not looked at */
    assert_true(metrics_error(&image, &reference).error < 1e-7);
    parts[1].x_first += 1e-4 * 0.02; /* off the raster */
    assert_true(isnan(metrics_error(&image, &reference).error));
    parts[1].x_first += 0.02 - 1e-4 * 0.02; /* sticks out by a column */
    assert_true(isnan(metrics_error(&image, &reference).error));
    static const struct grid others[] = {
        {-0.98, 0.021, 10, 100.025, 0.025, 5},    {-0.98, 0.02, 10, 100.025, 0.026, 5},
        {-0.98, 0.02, 10, 100.0250025, 0.025, 5}, {-0.98, 0.02, 10, 100 + 37 * 0.025, 0.025, 5},
        {-0.98, 0.02, 10, 100 - 0.025, 0.025, 5}, {-1.02, 0.02, 10, 100.025, 0.025, 5},
    }; /* other steps; between rows; out by a row or a column */
    for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
        parts[1] = others[k];
        assert_true(isnan(metrics_error(&image, &reference).error));
    }
    image_free(&image);
    image_free(&reference);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_error_of_a_gain),
        cmocka_unit_test(test_error_by_hand),
        cmocka_unit_test(test_strong_pixels),
        cmocka_unit_test(test_error_of_parts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
