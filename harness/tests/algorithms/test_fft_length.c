/* Lengths of transforms against a search over all numbers. */
#include "common/fft_length.h"

#include <limits.h>

#include "tests/assertions.h"

/* What is left of n without its factors of 2, 3, 5 and 7. */
static int rest_of(int n, int largest_factor)
{
    for (int factor = 2; factor <= largest_factor; factor++)
        while (n % factor == 0)
            n /= factor;
    return n;
}

static bool is_fast(int n)
{
    int power = 1;
    while (n % 2 == 0) {
        n /= 2;
        power *= 2;
    }
    return n <= 4 * power && rest_of(n, 5) == 1;
}

static void lengths_are_the_next(void **state)
{
    (void)state;
    for (int n = 1; n < 5000; n++) {
        int next = n, fast = n;
        while (rest_of(next, 7) != 1)
            next++;
        while (!is_fast(fast))
            fast++;
        assert_int_equal(fft_length(n), next);
        assert_int_equal(fft_length_fast(n), fast);
    }
}

static void lengths_end_with_int(void **state)
{
    (void)state;
    assert_int_equal(fft_length(1 << 30), 1 << 30);
    assert_int_equal(fft_length_fast(1 << 30), 1 << 30);
    assert_int_equal(fft_length(INT_MAX), 0);
    assert_int_equal(fft_length_fast(INT_MAX), 0);
    assert_int_equal(fft_length(1LL << 40), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths_are_the_next),
        cmocka_unit_test(lengths_end_with_int),
    };
    return cmocka_run_group_tests_name("fft_length", tests, NULL, NULL);
}
