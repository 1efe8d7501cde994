/* The tests' own tools: a planted NaN passes none of them. */
#include <complex.h>

#include "tests/support.h"

static void nan_is_close_to_nothing(void **state)
{
    (void)state;
    assert_true(is_close(1, 1, 0) && is_close(1.5, 1, 0.5) && is_close(-1e300, 1e300, INFINITY));
    assert_false(is_close(1 + 1e-9, 1, 1e-10) || is_close(INFINITY, 1, 1e300));
    assert_false(is_close(NAN, 1, 1e9) || is_close(NAN, 1, INFINITY) || is_close(1, NAN, 1e9)
                 || is_close(NAN, NAN, 1e9));
    assert_false(is_close(1, 1, NAN));
}

static void nan_stays_the_worst(void **state)
{
    (void)state;
    assert_true(worse_of(1, 2) == 2 && worse_of(2, 1) == 2);
    assert_true(isnan(worse_of(0, NAN)) && isnan(worse_of(NAN, 3)) && isnan(worse_of(worse_of(0, NAN), INFINITY)));
}

/* One NaN among the pixels shows in the peak and in the difference, whichever image has it. */
static void nan_shows_in_images(void **state)
{
    (void)state;
    const struct grid grid = {0, 1, 3, 1, 1, 2};
    for (int place = 0; place < 6; place++) {
        struct image good, bad;
        assert_int_equal(image_allocate(1, &grid, PRECISION_DOUBLE, &good), STATUS_OK);
        assert_int_equal(image_allocate(1, &grid, PRECISION_DOUBLE, &bad), STATUS_OK);
        for (int n = 0; n < 6; n++) {
            ((double complex *)good.pixels[0])[n] = n;
            ((double complex *)bad.pixels[0])[n] = n == place ? NAN : n;
        }
        assert_close(support_peak(&good), 5, 0);
        assert_close(support_difference(&good, &good), 0, 0);
        assert_true(isnan(support_peak(&bad)));
        assert_true(isnan(support_difference(&bad, &good)) && isnan(support_difference(&good, &bad)));
        image_free(&good);
        image_free(&bad);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nan_is_close_to_nothing),
        cmocka_unit_test(nan_stays_the_worst),
        cmocka_unit_test(nan_shows_in_images),
    };
    return cmocka_run_group_tests_name("support", tests, NULL, NULL);
}
