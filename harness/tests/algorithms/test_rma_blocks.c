/* Range migration's blocks: sums over the receivers in different orders, and phases that blocks share. */
#include "contract/param.h"
#include "range_migration/rma_engine.h"
#include "scene/simulate.h"
#include "tests/algorithms/rma_scenes.h"

/* The same image whether receivers are summed before or after the range IFFT: before it for several blocks at once, but
   for what their corrections are off even steps, far below the 2 pi 1e-10 that are taken for even here. */
static void other_ways(void **state)
{
    (void)state;
    static const struct grid part = {-0.14, 0.02, 8, 36, 0.5, 17};
    static const double targets[] = {36.4, 38.1, 42.9};
    static const struct {
        const char *spec, *other;
        double bound;
    } pairs[] = {
        {"rma_lbf:blocks=4,precision=double", "rma_lbf:blocks=4,sum=after,precision=double", 1e-11},
        {"rma_lbf:blocks=4", "rma_lbf:blocks=4,sum=after,phases=libm", 2e-6},
        {"rma_lbf:blocks=15,precision=double", "rma_lbf:blocks=15,sum=after,precision=double", 1e-11},
        {"rma_lbf:blocks=15", "rma_lbf:blocks=15,sum=after,phases=libm", 2e-6},
        {"rma_lbf:blocks=11,variant=printed", "rma_lbf:blocks=11,variant=printed,sum=after,phases=libm", 2e-6},
        {"rma_lbf:blocks=6,spacing=uniform,precision=double",
         "rma_lbf:blocks=6,spacing=uniform,sum=after,precision=double", 1e-14},
        {"rma_numeric:blocks=4,precision=double", "rma_numeric:blocks=4,sum=after,precision=double", 1e-14},
        {"rma_pca:blocks=1,precision=double", "rma_pca:blocks=1,sum=after,precision=double", 1e-14},
    };
    struct scene scene;
    struct echoes echoes;
    make_scene(&(struct rma_track){8, 40, 1066, 40e3, 0.044, -2.8, 0.8, 0.04}, &scene);
    add_targets(&scene, 3, targets);
    assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
    struct problem problem = problem_make(&scene.acquisition, 1, &part, PRECISION_DOUBLE);
    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        struct image image;
        form(pairs[k].spec, problem, &echoes, &image);
        assert_up_to(swath_error(pairs[k].other, problem, &echoes, &image), pairs[k].bound, "%s against %s",
                     pairs[k].spec, pairs[k].other);
        image_free(&image);
    }
    echoes_free(&echoes);
    free_scene(&scene);
}

/* Three and more blocks of rma_lbf share their receivers' phases. Those of other formulas, and blocks of even ranges,
   do not: their corrections differ by other amounts from block to block. */
static void shared(void **state)
{
    (void)state;
    static const struct grid part = {-0.14, 0.02, 8, 36, 0.5, 17};
    static const struct {
        const char *algorithm;
        enum rma_spacing spacing;
        int blocks;
        bool even;
    } plans[] = {{"rma_lbf", RMA_INVERSE, 3, true},      {"rma_lbf", RMA_INVERSE, 20, true},
                 {"rma_lbf", RMA_INVERSE, 2, false},     {"rma_lbf", RMA_UNIFORM, 3, false},
                 {"rma_numeric", RMA_INVERSE, 3, false}, {"rma_wu", RMA_INVERSE, 3, false}};
    struct scene scene;
    make_scene(&(struct rma_track){8, 40, 1066, 40e3, 0.044, -2.8, 0.8, 0.04}, &scene);
    const struct problem problem = problem_make(&scene.acquisition, 1, &part, PRECISION_FLOAT);
    for (size_t k = 0; k < sizeof plans / sizeof *plans; k++) {
        const struct algorithm *algorithm = algorithm_find(plans[k].algorithm);
        struct rma_options options;
        struct rma *rma;
        options_fill(algorithm, &options);
        options.blocks = plans[k].blocks;
        options.spacing = plans[k].spacing;
        assert_int_equal(rma_count(&problem, algorithm->method, &options, &rma), STATUS_OK);
        if (rma->swaths->even != plans[k].even)
            fail_msg("%d blocks of %s", plans[k].blocks, plans[k].algorithm);
        rma_destroy(rma);
    }
    free_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(other_ways), cmocka_unit_test(shared)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
