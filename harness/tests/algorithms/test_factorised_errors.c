/* Factorised back projection's errors against what is asked for. */
#include <math.h>

#include "backprojection/factorised/taps.h"
#include "tests/algorithms/factorised_scenes.h"
#include "tests/support.h"

static void errors_are_as_asked_for(void **state)
{
    (void)state;
    static const double errors[] = {1e-1, 1e-2, 1e-3, 1e-4};
    for (int kind = 0; kind < FACTORISED_KINDS; kind++)
        for (int stages = 1; stages <= 3; stages++)
            factorised_check((enum factorised_kind)kind, stages, sizeof errors / sizeof *errors, errors);
}

/* The taps' own error, against the exponential at random frequencies of the band. */
static void taps_have_their_error(void **state)
{
    (void)state;
    static const double errors[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5};
    struct random random = random_seed(11, 1);
    for (size_t k = 0; k < sizeof errors / sizeof *errors; k++) {
        enum { DRAWS = 20000 };
        struct polar_taps taps;
        double sum = 0;
        assert_int_equal(polar_taps_choose(errors[k], 1.1, &taps), STATUS_OK);
        for (int n = 0; n < DRAWS; n++) {
            const double nu = (random_uniform(&random) - 0.5) / taps.oversampling, u = random_uniform(&random) - 0.5;
            double complex value = 0;
            for (int t = 0; t < taps.taps; t++) {
                double weight = 0;
                for (int m = taps.branches - 1; m >= 0; m--)
                    weight = weight * u + taps.coefficients[m * taps.taps + t];
                value += weight * cexp(2 * M_PI * I * nu * (t - 0.5 * (taps.taps - 1)));
            }
            const double off = cabs(value - cexp(2 * M_PI * I * nu * u));
            sum += off * off / DRAWS;
        }
        print_message("%d taps, %.2f times oversampled, asked for %g: error %.2e, by the law %.2e\n", taps.taps,
                      taps.oversampling, errors[k], sqrt(sum), taps.error);
        assert_close(sqrt(sum) / taps.error, 1, 0.15);
        assert_true(taps.error <= errors[k] && taps.error > 0.5 * errors[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_are_as_asked_for),
        cmocka_unit_test(taps_have_their_error),
    };
    return cmocka_run_group_tests_name("factorised_errors", tests, NULL, NULL);
}
