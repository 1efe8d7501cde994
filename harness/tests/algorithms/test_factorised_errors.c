/* Factorised back projection's errors against what is asked for. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

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

/* Near pixels, of which grids hold few: images are read inside of them only, or the imager fails, and their errors are
   as asked for. `count` seeds from `first` on. */
static void near_trees(int first, int count, double oversampling)
{
    static const double errors[] = {1e-1, 1e-2, 1e-3, 1e-4};
    for (int seed = first; seed < first + count; seed++) {
        const double asked = errors[seed / 3 % 4];
        struct acquisition a;
        struct echoes echoes;
        struct image exact;
        struct grid grid;
        char spec[120];
        factorised_near_scene(seed, oversampling, &a, &grid, &echoes);
        const struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
        snprintf(spec, sizeof spec, "bp_factorised:stages=%d,base=16,factor=8,error=%g,precision=double",
                 1 + seed / 12 % 3, asked);
        const double error = factorised_error(spec, problem, &echoes, &exact);
        print_message("seed %d: fs/B %.3f, r from %.2f m, %s: error %.2e\n", seed, a.fs / a.bandwidth, grid.r_first,
                      spec, error);
        if (!(error <= asked))
            fail_msg("seed %d, %s: error is %g", seed, spec, error);
        image_free(&exact);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* SASBENCH_SEEDS=FIRST-LAST: others. */
static void near_trees_hold(void **state)
{
    (void)state;
    int first = 1, last = 36;
    const char *seeds = getenv("SASBENCH_SEEDS");
    if (seeds)
        assert_int_equal(sscanf(seeds, "%d-%d", &first, &last), 2);
    near_trees(first, last - first + 1, 0);
}

/* Records that are sampled hardly more than their band needs. */
static void bare_sampling_holds(void **state)
{
    (void)state;
    static const double oversampling[] = {1, 1.005, 1.01, 1.05};
    for (size_t k = 0; k < sizeof oversampling / sizeof *oversampling; k++)
        near_trees(100 + 3 * (int)k, 3, oversampling[k]);
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
        cmocka_unit_test(near_trees_hold),
        cmocka_unit_test(bare_sampling_holds),
        cmocka_unit_test(taps_have_their_error),
    };
    return cmocka_run_group_tests_name("factorised_errors", tests, NULL, NULL);
}
