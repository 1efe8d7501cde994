/* Sharpness of images, differences of slices. */
#include <math.h>
#include <stdlib.h>

#include "metrics/metrics.h"
#include "tests/support.h"

/* A tenth more of the exact image is -20 dB of its peak away everywhere that the slice has it. */
static void test_slice_difference(void **state)
{
    (void)state;
    const struct grid grid = {-1, 0.02, 101, 9.9, 0.025, 9, 0};
    const struct acquisition acquisition = {.sound_speed = 1500, .fc = 150e3, .bandwidth = 20e3};
    const struct target target = {0, 10, 1};
    const struct grid shorter = {-1, 0.02, 100, 9.9, 0.025, 9, 0};
    struct image image, exact, other;
    double *position, *decibels;
    int count;
    support_image_make(&grid, 1, PRECISION_DOUBLE, &image);
    support_image_make(&grid, 1, PRECISION_DOUBLE, &exact);
    for (int j = 0; j < 101; j++) {
        const double value = exp(-pow((j - 50) / 8.0, 2));
        support_pixel_set(&exact, 0, 4, j, value);
        support_pixel_set(&image, 0, 4, j, (1 + 0.1 * I) * value);
    }
    metrics_slice_samples(&image, &acquisition, &target, AXIS_AZIMUTH, &position, &decibels, &count);
    assert_true(count > 100);
    double *difference = metrics_slice_difference(&image, &exact, &acquisition, &target, AXIS_AZIMUTH, count);
    assert_non_null(difference);
    assert_close(difference[count / 2], -20, 1e-6);
    const int quarter = count / 2 + count / 20;
    assert_close(difference[quarter] - difference[count / 2], decibels[quarter] - decibels[count / 2], 1e-6);
    free(difference);
    assert_null(metrics_slice_difference(&image, &exact, &acquisition, &target, AXIS_AZIMUTH, count - 2));
    support_image_make(&shorter, 1, PRECISION_DOUBLE, &other);
    assert_null(metrics_slice_difference(&image, &other, &acquisition, &target, AXIS_AZIMUTH, count));
    free(position);
    free(decibels);
    image_free(&image);
    image_free(&exact);
    image_free(&other);
}

static void check_sharpness(const struct image *image, double entropy, double contrast, double ratio)
{
    struct sharpness s = metrics_sharpness(image);
    assert_close(s.entropy, entropy, 1e-9);
    assert_close(s.contrast, contrast, 1e-7); /* the root of a difference */
    if (isnan(ratio))
        assert_true(isnan(s.peak_over_median));
    else
        assert_close(s.peak_over_median, ratio, 1e-6 * ratio);
}

/* Even pixels, one bright pixel, powers 1 to n, whatever the scale. */
static void test_sharpness(void **state)
{
    (void)state;
    enum { ROWS = 4, COLUMNS = 5, COUNT = 2 * ROWS * COLUMNS };
    const struct grid grids[2] = {{0, 1, COLUMNS, 10, 1, ROWS, 0}, {9, 1, COLUMNS, 10, 1, ROWS, 0}};
    const double scales[] = {1, 1e-160, 1e150};
    struct image image;
    support_image_make(grids, 2, PRECISION_DOUBLE, &image);
    assert_true(isnan(metrics_sharpness(&image).entropy) && isnan(metrics_sharpness(&image).contrast));
    support_pixel_set(&image, 1, 2, 3, 7 * I);
    check_sharpness(&image, 0, sqrt(COUNT - 1.0), NAN);
    for (size_t scale = 0; scale < sizeof scales / sizeof *scales; scale++) {
        double entropy = 0, sum = COUNT * (COUNT + 1) / 2.0, squares = 0;
        for (int k = 0; k < COUNT; k++)
            support_pixel_set(&image, k / 20, k % 20 / COLUMNS, k % COLUMNS, scales[scale] * cexp(k * I));
        check_sharpness(&image, log(COUNT), 0, 1);
        for (int k = 0; k < COUNT; k++) { /* a permutation of 1 .. COUNT */
            int level = 7 * k % COUNT + 1;
            support_pixel_set(&image, k / 20, k % 20 / COLUMNS, k % COLUMNS, scales[scale] * sqrt(level));
            entropy -= level / sum * log(level / sum);
            squares += (double)level * level;
        }
        double mean = sum / COUNT;
        check_sharpness(&image, entropy, sqrt(squares / COUNT - mean * mean) / mean,
                        sqrt((double)COUNT / (COUNT / 2 + 1)));
    }
    support_pixel_set(&image, 0, 0, 0, NAN);
    assert_true(isnan(metrics_sharpness(&image).peak_over_median));
    image_free(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slice_difference),
        cmocka_unit_test(test_sharpness),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
