/* Factorised back projection with a tree: the pixels that it sums from records; bits, instruction sets, memory. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/factorised/factorised.h"
#include "tests/algorithms/factorised_scenes.h"
#include "tests/allocations.h"
#include "tests/support.h"

/* Every kind of scene once; all errors and trees: test_factorised_errors. */
static void every_kind_is_imaged(void **state)
{
    (void)state;
    const double error = 1e-2;
    for (int kind = 0; kind < FACTORISED_KINDS; kind++)
        factorised_check((enum factorised_kind)kind, 2, 1, &error);
}

/* Pixels are read from images, and all of them where nothing prevents it. */
static void images_are_read(void **state)
{
    (void)state;
    for (int kind = 0; kind < FACTORISED_KINDS; kind++) {
        struct acquisition a;
        struct echoes echoes;
        struct factorised *plan;
        factorised_scene((enum factorised_kind)kind, &a, &echoes);
        const struct problem problem = problem_make(&a, 1, &factorised_grids[kind], PRECISION_DOUBLE);
        const struct tree_settings settings = {1e-2, 4, 4, 2};
        assert_int_equal(factorised_plan(&problem, &settings, &plan), STATUS_OK);
        const double all = (double)grid_pixels(&factorised_grids[kind]) * a.pings * a.receivers,
                     direct = plan->direct / all;
        print_message("%s: %.3g of the pairs are summed from records\n", factorised_names[kind], direct);
        if (kind == SIDES) /* near pixels, seen far off the axis */
            assert_true(direct > 0 && direct < 0.95);
        else if (kind == LIMITED || kind == SQUINTED || kind == ENDED)
            assert_true(direct > 0 && direct < 0.5);
        else
            assert_true(direct == 0);
        factorised_destroy(plan);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* One image whatever the number of threads; float near double, by any instruction set. */
static void bits_and_precisions(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 3, 5};
    static const char *const isas[] = {"baseline", "v3", "v4"};
    static const char *const specs[] = {"bp_factorised:stages=2,base=4,factor=4,error=1e-3,precision=float",
                                        "bp_factorised:stages=2,base=4,factor=4,error=1e-3,precision=double"};
    struct acquisition a;
    struct echoes echoes;
    factorised_scene(CURVED, &a, &echoes);
    const struct grid *grid = &factorised_grids[CURVED];
    const struct problem problem = problem_make(&a, 1, grid, PRECISION_DOUBLE);
    struct image first[2];
    for (int precision = 0; precision < 2; precision++)
        for (size_t k = 0; k < sizeof threads / sizeof *threads; k++) {
            struct image image;
            omp_set_num_threads(threads[k]);
            assert_int_equal(support_image(specs[precision], problem, &echoes, &image), STATUS_OK);
            if (k == 0) {
                first[precision] = image;
                continue;
            }
            assert_memory_equal(image.pixels[0], first[precision].pixels[0],
                                grid_pixels(grid) * precision_size(image.precision));
            image_free(&image);
        }
    for (size_t k = 0; k < sizeof isas / sizeof *isas; k++) /* where the machine has less, the most that it has */
        for (int precision = 0; precision < 2; precision++) {
            struct image image;
            setenv("SASBENCH_ISA", isas[k], 1);
            assert_int_equal(support_image(specs[precision], problem, &echoes, &image), STATUS_OK);
            const double rounding = support_difference(&image, &first[PRECISION_DOUBLE]);
            print_message("%s, %s: differs by %.1e\n", isas[k], precision_name((enum precision)precision), rounding);
            assert_true(rounding <= (precision == PRECISION_DOUBLE ? 1e-8 : 5e-6));
            image_free(&image);
        }
    unsetenv("SASBENCH_ISA");
    image_free(&first[0]);
    image_free(&first[1]);
    echoes_free(&echoes);
    acquisition_free(&a);
}

/* A plan holds what it says, execute takes nothing, and whichever allocation fails, plan says so and leaves nothing. */
static void memory(void **state)
{
    (void)state;
    enum { MOST = 500 };
    struct acquisition a;
    struct echoes echoes;
    struct image image;
    struct stages stages;
    struct factorised *plan;
    factorised_scene(LIMITED, &a, &echoes);
    const struct problem problem = problem_make(&a, 1, &factorised_grids[LIMITED], PRECISION_DOUBLE);
    const struct tree_settings settings = {1e-2, 4, 4, 2};
    support_image_make(&factorised_grids[LIMITED], 1, PRECISION_DOUBLE, &image);
    omp_set_num_threads(1);
    allocations_begin(-1);
    assert_int_equal(factorised_plan(&problem, &settings, &plan), STATUS_OK);
    const struct allocations planned = allocations_now();
    stages_begin(&stages);
    factorised_execute(plan, &echoes, &image, &stages);
    const struct allocations executed = allocations_now();
    const double bytes = factorised_work(plan).bytes;
    factorised_destroy(plan);
    const struct allocations left = allocations_end();
    print_message("a plan holds %.0f bytes and says %.0f\n", planned.bytes, bytes);
    assert_close(bytes / planned.bytes, 1, 0.01);
    assert_int_equal(executed.taken, planned.taken);
    assert_int_equal(executed.plans, planned.plans);
    assert_int_equal(left.blocks, 0);
    assert_int_equal(left.plans, left.plans_destroyed);
    int calls = 0;
    for (bool refused = true; refused; calls++) {
        assert_true(calls < MOST);
        allocations_begin(calls);
        const enum status status = factorised_plan(&problem, &settings, &plan);
        factorised_destroy(plan);
        const struct allocations after = allocations_end();
        refused = after.refused > 0;
        assert_int_equal(status, refused ? STATUS_FAILED : STATUS_OK);
        assert_int_equal(after.blocks, 0);
        assert_int_equal(after.plans, after.plans_destroyed);
    }
    print_message("each of %d allocations was refused\n", calls - 1);
    assert_true(calls > 15);
    image_free(&image);
    echoes_free(&echoes);
    acquisition_free(&a);
}

/* A tree whose grids claim to hold more than they do: what lies beside their lines, or before their places, is zero and
   counted, and there is no image. */
static void reads_outside_fail(void **state)
{
    (void)state;
    struct acquisition a;
    struct echoes echoes;
    struct image image;
    factorised_scene(SIDES, &a, &echoes);
    const struct tree_settings settings = {1e-2, 4, 4, 2};
    for (int precision = 0; precision < 2; precision++)
        for (int places = -1; places < 2; places++) { /* -1: as it is */
            const struct grid *grid = &factorised_grids[SIDES];
            const struct problem problem = problem_make(&a, 1, grid, (enum precision)precision);
            struct factorised *plan;
            struct echoes converted;
            struct stages stages;
            assert_int_equal(factorised_plan(&problem, &settings, &plan), STATUS_OK);
            assert_int_equal(echoes_convert(&echoes, problem.precision, &converted), STATUS_OK);
            support_image_make(grid, 1, problem.precision, &image);
            for (int n = 0; n < plan->tree.first[2] && places >= 0; n++)
                for (int view = 0; view < plan->tree.views; view++) {
                    struct polar *polar = &plan->tree.subapertures[n].polars[view];
                    if (places)
                        polar->near *= 0.5;
                    polar->low = places ? polar->low : -0.99;
                    polar->high = places ? polar->high : 0.99;
                }
            stages_begin(&stages);
            const enum status status = factorised_execute(plan, &converted, &image, &stages);
            assert_int_equal(status, places < 0 ? STATUS_OK : STATUS_FAILED);
            if (places >= 0) {
                print_message("%s\n", status_message());
                assert_non_null(strstr(status_message(), "outside of subapertures' images"));
            }
            assert_true(isfinite(support_peak(&image)));
            factorised_destroy(plan);
            image_free(&image);
            echoes_free(&converted);
        }
    echoes_free(&echoes);
    acquisition_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_is_imaged), cmocka_unit_test(images_are_read),
        cmocka_unit_test(bits_and_precisions),  cmocka_unit_test(memory),
        cmocka_unit_test(reads_outside_fail),
    };
    return cmocka_run_group_tests_name("conformance_factorised", tests, NULL, NULL);
}
