/* Range compression's products, sums and partings of whole records against complex numbers, at all lengths that leave
   different rests of vectors, in both precisions, by the build for this machine. */
#include <complex.h>
#include <math.h>
#include <string.h>

#include "backprojection/planes.h"
#include "tests/assertions.h"

enum { MOST = 70, TAPS = 5 };

struct numbers {
    double complex x[MOST + TAPS], h[MOST];
    double gains[MOST];
};

/* Numbers without a pattern, none of them 0. */
static struct numbers numbers_make(void)
{
    struct numbers made;
    for (int k = 0; k < MOST + TAPS; k++)
        made.x[k] = sin(1.7 * k + 0.3) + I * cos(2.9 * k);
    for (int k = 0; k < MOST; k++) {
        made.h[k] = cos(0.7 * k) + I * sin(1.3 * k + 0.1);
        made.gains[k] = 1.5 + sin(0.9 * k);
    }
    return made;
}

/* `count` numbers in the precision that is asked for, and back. */
static void put(enum precision precision, const double *from, size_t count, void *to)
{
    for (size_t k = 0; k < count; k++)
        if (precision == PRECISION_DOUBLE)
            ((double *)to)[k] = from[k];
        else
            ((float *)to)[k] = (float)from[k];
}

static double got(enum precision precision, const void *from, size_t k)
{
    return precision == PRECISION_DOUBLE ? ((const double *)from)[k] : (double)((const float *)from)[k];
}

static void assert_same(enum precision precision, const void *found, const double complex *expected, int length)
{
    const double *values = (const double *)expected;
    for (int k = 0; k < 2 * length; k++)
        if (!(fabs(got(precision, found, (size_t)k) - values[k]) <= (precision == PRECISION_DOUBLE ? 1e-14 : 4e-6)))
            fail_msg("length %d: value %d is %g, not %g", length, k, got(precision, found, (size_t)k), values[k]);
}

/* The factor of bin k of `length`, by its conjugate beyond fs/2. */
static double complex factor(const double complex *h, int k, int length)
{
    return 2 * k < length ? h[k] : 2 * k > length ? conj(h[length - k]) : creal(h[k]);
}

static void spectra_are_multiplied(void **state)
{
    (void)state;
    const struct numbers n = numbers_make();
    for (int p = 0; p < 2 * MOST; p++) {
        const enum precision precision = p % 2 ? PRECISION_DOUBLE : PRECISION_FLOAT;
        const struct planes *planes = planes_choose(precision);
        const int length = 1 + p / 2;
        double complex x[MOST], h[MOST], y[MOST], expected[MOST];
        double gains[MOST];
        put(precision, (const double *)n.x, 2 * MOST, x);
        put(precision, (const double *)n.h, 2 * MOST, h);
        put(precision, n.gains, MOST, gains);
        for (int k = 0; k < length; k++)
            expected[k] = n.x[k] * factor(n.h, k, length);
        planes->turn(x, h, (size_t)length, y);
        assert_same(precision, y, expected, length);
        for (int imaginary = 0; imaginary < 2; imaginary++) {
            for (int k = 0; k < length; k++)
                expected[k] = n.x[k] * n.gains[k] * (imaginary ? I : 1);
            planes->weigh(x, gains, imaginary, (size_t)length, y);
            assert_same(precision, y, expected, length);
        }
        for (int k = 0; k < length; k++)
            expected[k] = n.x[k] * n.h[k];
        planes->filter(x, h, (size_t)length);
        assert_same(precision, x, expected, length);
    }
}

static void neighbours_are_summed(void **state)
{
    (void)state;
    static const double weights[TAPS] = {0.3, -1.1, 2.0, 0.7, -0.4};
    const struct numbers n = numbers_make();
    for (int p = 0; p < 2 * MOST; p++) {
        const enum precision precision = p % 2 ? PRECISION_DOUBLE : PRECISION_FLOAT;
        const int length = 1 + p / 2;
        double complex x[MOST + TAPS], y[MOST], expected[MOST] = {0};
        put(precision, (const double *)n.x, 2 * (MOST + TAPS), x);
        for (int k = 0; k < length; k++)
            for (int t = 0; t < TAPS; t++)
                expected[k] += weights[t] * n.x[k + t];
        planes_choose(precision)->convolve(x, weights, TAPS, (size_t)length, false, y);
        assert_same(precision, y, expected, length);
        for (int k = 0; k < length; k++)
            expected[k] *= 2;
        planes_choose(precision)->convolve(x, weights, TAPS, (size_t)length, true, y);
        assert_same(precision, y, expected, length);
    }
}

/* Into one block of any size, or into five that begin half a block apart; what lies behind a block stays as it is. */
static void values_are_parted(void **state)
{
    (void)state;
    enum { BLOCK = 16, STEP = 2 * BLOCK + 3, BLOCKS = 5 };
    const struct numbers n = numbers_make();
    for (int p = 0; p < 2 * MOST; p++) {
        const enum precision precision = p % 2 ? PRECISION_DOUBLE : PRECISION_FLOAT;
        const int count = 1 + p / 2;
        double complex x[MOST];
        double untouched[BLOCKS * STEP], to[BLOCKS * STEP];
        for (int k = 0; k < BLOCKS * STEP; k++)
            untouched[k] = 9;
        put(precision, (const double *)n.x, 2 * MOST, x);
        for (int blocks = 1; blocks <= BLOCKS; blocks += BLOCKS - 1) {
            put(precision, untouched, BLOCKS * STEP, to);
            if (blocks > 1)
                planes_choose(precision)->part_blocks(x, (size_t)count, BLOCKS, BLOCK, STEP, to);
            else
                planes_choose(precision)->part(x, (size_t)count, BLOCK, to);
            for (int k = 0; k < BLOCKS * STEP; k++) {
                const int b = k / STEP, within = k % STEP, value = b * BLOCK / 2 + within % BLOCK;
                const double part = within < BLOCK ? creal(n.x[value % MOST]) : cimag(n.x[value % MOST]);
                const double expected = b >= blocks || within >= 2 * BLOCK ? 9 : value < count ? part : 0;
                assert_close(got(precision, to, (size_t)k), expected, 1e-6);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spectra_are_multiplied),
        cmocka_unit_test(neighbours_are_summed),
        cmocka_unit_test(values_are_parted),
    };
    return cmocka_run_group_tests_name("planes", tests, NULL, NULL);
}
