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

/* The quickest by what FFTW took, planned by estimate: 1.05 us for 1024, 1.56 us for 960. */
static void quick_lengths(void **state)
{
    (void)state;
    static const int lengths[][2] = {{1, 1},       {63, 64},     {918, 1024},  {1025, 1280}, {1300, 1536},
                                     {1536, 1536}, {1700, 2048}, {2100, 2560}, {3100, 3200}, {5103, 5120}};
    for (size_t k = 0; k < sizeof lengths / sizeof *lengths; k++)
        assert_int_equal(fft_length_quick(lengths[k][0]), lengths[k][1]);
    for (int n = 1; n < 10000; n++) {
        const int least = fft_length_fast(n), quick = fft_length_quick(n);
        assert_true(quick >= least && is_fast(quick) && quick <= least + least / 4);
    }
}

static void lengths_end_with_int(void **state)
{
    (void)state;
    assert_int_equal(fft_length(1 << 30), 1 << 30);
    assert_int_equal(fft_length_fast(1 << 30), 1 << 30);
    assert_int_equal(fft_length(INT_MAX), 0);
    assert_int_equal(fft_length_fast(INT_MAX), 0);
    assert_int_equal(fft_length_quick(INT_MAX), 0);
    assert_int_equal(fft_length(1LL << 40), 0);
}

/* By the time that FFTW took for a FLOP, planned by estimate, over that of 512: 1536 1.6, 4096 1.4, 8192 2.1; records
   that are compressed between them 1.9, 1.7 and 2. */
static void slowness(void **state)
{
    (void)state;
    static const struct {
        int length;
        double least, most;
    } lengths[] = {{512, 1, 1},    {1280, 1, 1},     {384, 1, 1}, {1536, 1.3, 2},
                   {4096, 1.3, 2}, {8192, 1.7, 2.3}, {1009, 5, 7}};
    for (size_t k = 0; k < sizeof lengths / sizeof *lengths; k++) {
        const double found = fft_slowness(lengths[k].length);
        if (!(found >= lengths[k].least && found <= lengths[k].most))
            fail_msg("a FLOP of a transform of %d is said to take %g times as long", lengths[k].length, found);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths_are_the_next),
        cmocka_unit_test(quick_lengths),
        cmocka_unit_test(slowness),
        cmocka_unit_test(lengths_end_with_int),
    };
    return cmocka_run_group_tests_name("fft_length", tests, NULL, NULL);
}
