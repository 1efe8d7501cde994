/* What range migration refuses, by name, and scenes beside it that it images. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/simulate.h"
#include "tests/algorithms/rma_scenes.h"

/* What cannot be imaged is refused with its reason. */
static void refusals(void **state)
{
    (void)state;
    static const struct {
        const char *reason;
        struct grid grid;
        int pings;
        double limit, bend;
    } cases[] = {
        {"straight", {0, 0.02, 3, 40, 0.1, 3}, 8, INFINITY, 0.1},
        {"number of pings", {0, 0.02, 3, 40, 0.1, 3}, 1, INFINITY, 0},
        {"aperture_limit", {0, 0.02, 3, 40, 0.1, 3}, 8, 0.05, 0},
        {"range r of the nearest pixel", {0, 0.02, 3, 0, 0.1, 3}, 8, INFINITY, 0},
        {"condition in_wavenumbers:", {0, 5, 9, 40, 0.1, 3}, 8, INFINITY, 0},
        {"outside the record", {0, 0.02, 3, 90, 0.1, 3}, 8, INFINITY, 0},
        {"spa_amplitude", {0, 0.02, 3, 0.5, 0.1, 3}, 8, INFINITY, 0},
        {"work", {0, 1e-6, 3, 40, 1e-6, 3}, 8, INFINITY, 0},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct scene scene;
        struct spec spec;
        void *plan;
        make_scene(&(struct rma_track){cases[k].pings, 20, 400, 24e3, k == 6 ? 0 : 0.048, 0, 0.4, 0.04}, &scene);
        scene.acquisition.aperture_limit = cases[k].limit;
        scene.acquisition.tx[cases[k].pings - 1].y = cases[k].bend;
        struct problem problem = problem_make(&scene.acquisition, 1, &cases[k].grid, PRECISION_FLOAT);
        assert_int_equal(spec_parse("rma_lbf", &spec), STATUS_OK);
        assert_int_equal(algorithm_plan(spec.algorithm, &problem, spec.options, &plan), STATUS_UNSUPPORTED);
        print_message("    %s\n", status_message());
        assert_non_null(strstr(status_message(), cases[k].reason));
        assert_null(plan);
        spec_free(&spec);
        free_scene(&scene);
    }
}

/* Why a method refuses a scene at range r; the empty text where it does not. */
static const char *refusal(const char *text, struct scene *scene, double r)
{
    struct grid grid = {-0.16, 0.01, 33, r, 0.025, 1};
    struct problem problem = problem_make(&scene->acquisition, 1, &grid, PRECISION_DOUBLE);
    struct spec spec;
    void *plan;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    enum status status = algorithm_plan(spec.algorithm, &problem, spec.options, &plan);
    spec.algorithm->destroy(plan);
    spec_free(&spec);
    return status == STATUS_OK ? "" : status_message();
}

/* Each condition refuses by name what would be a wrong image, and its neighbour that is sound is not refused. */
static void conditions(void **state)
{
    (void)state;
    static const struct {
        const char *spec, *name;
        double fc, bandwidth, spacing, first_offset, speed,
            r; /* receivers 0.04 m apart, 150 m before the record's end */
    } cases[] = {
        {"rma_numeric", "", 150e3, 15e3, 0.4, 0, 2.5, 100},
        {"rma_numeric", "above_dc", 10e3, 30e3, 0.4, 0, 2.5, 100}, /* was a crash */
        {"rma_numeric", "above_dc", 7.5e3, 15e3, 0.4, 0, 2.5, 100},
        {"rma_numeric", "doppler", 150e3, 15e3, 2, 0, 2.5, 100}, /* pings too far apart: error .58 */
        {"rma_numeric", "", 150e3, 15e3, 0.16, 0, 75, 100},
        {"rma_numeric", "doppler", 150e3, 15e3, 0.4, 0, 150, 100},  /* the whole band aside: .59 */
        {"rma_numeric", "doppler", 150e3, 15e3, 0.4, 30, 2.5, 100}, /* receivers far ahead: 1.0 */
        {"rma_numeric", "spa_amplitude", 150e3, 15e3, 0.4, 0, 2.5, 0.5},
        {"rma_numeric", "stationary", 2e3, 1e3, 0.4, 0, 2.5, 0.4},
        {"rma_numeric", "subsonic", 150e3, 15e3, 0.4, 0, -1400, 100},
        {"rma_lbf", "", 150e3, 15e3, 0.16, 0, 15, 100},
        {"rma_lbf", "lbf_law", 150e3, 15e3, 0.16, 0, 75, 100},
        {"rma_pca", "", 150e3, 15e3, 0.4, 0, 2.5, 100},
        {"rma_pca", "pca_law", 150e3, 15e3, 0.16, 0, 75, 100}, /* broadside alone does not show it */
        {"rma_wu", "wu_law", 150e3, 15e3, 0.16, 0, 75, 100},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct scene scene;
        make_scene(&(struct rma_track){30, 20, 4096, 40e3, 0, -15 * cases[k].spacing, cases[k].spacing, 0.04}, &scene);
        struct acquisition *a = &scene.acquisition;
        a->fc = cases[k].fc;
        a->bandwidth = cases[k].bandwidth;
        for (int p = 0; p < a->pings; p++) {
            a->velocity[p].x = cases[k].speed;
            for (int m = 0; m < a->receivers; m++)
                a->rx[p * a->receivers + m].x += cases[k].first_offset;
        }
        const char *reason = refusal(cases[k].spec, &scene, cases[k].r);
        char name[60];
        snprintf(name, sizeof name, "condition %s:", cases[k].name);
        if (cases[k].name[0] ? !strstr(reason, name) : reason[0] != 0)
            fail_msg("case %d, %s: '%s'", (int)k, name, reason);
        free_scene(&scene);
    }
}

/* A track that is short against what the elements would see: the angles that no ping has need neither record nor work.
   10 MHz at 50 m with 2 mm elements, and 7.7 cm of record. */
static void short_track(void **state)
{
    (void)state;
    struct scene scene;
    struct echoes echoes;
    struct image exact;
    make_scene(&(struct rma_track){101, 8, 1024, 10e6, 666161 / 10e6, -0.2, 0.004, 0.001}, &scene);
    struct acquisition *a = &scene.acquisition;
    a->fc = 10e6;
    a->bandwidth = 5e6;
    a->tx_length = 0.002;
    for (int p = 0; p < a->pings; p++)
        a->velocity[p].x = 2.5;
    scene.beam = (struct beam){BEAM_RECT, TRUNCATION_NONE, 0, false};
    const double r[] = {50};
    const struct grid grid = {-0.004, 0.00025, 33, 50, 1, 1};
    add_targets(&scene, 1, r);
    scene.targets[0].x = 0;
    assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
    struct problem problem = problem_make(a, 1, &grid, PRECISION_DOUBLE);
    form("reference:precision=double", problem, &echoes, &exact);
    assert_true(swath_error("rma_numeric:precision=double", problem, &echoes, &exact) < 0.05);
    image_free(&exact);
    echoes_free(&echoes);
    free_scene(&scene);
}

/* Sampled 65 times as fast as the band asks for, receivers 17 m astern, in a record of 1 ms: the row lies before the
   record, where its converted echo has to have room, and what is far outside the band takes no part. */
static void sampled_much_too_fast(void **state)
{
    (void)state;
    struct scene scene;
    struct echoes echoes;
    struct image exact;
    const double fs = 979137, first = 131087;
    make_scene(&(struct rma_track){4, 40, 1024, fs, first / fs, -1.2, 0.8, 0.04}, &scene);
    struct acquisition *a = &scene.acquisition;
    a->bandwidth = 15e3;
    a->tx_length = 0.08;
    for (int p = 0; p < a->pings; p++) {
        a->velocity[p].x = 2.5;
        for (int m = 0; m < a->receivers; m++)
            a->rx[p * a->receivers + m].x = a->tx[p].x - 17.333 + 0.04 * m;
    }
    scene.beam = (struct beam){BEAM_RECT, TRUNCATION_TX, 0.443, false};
    const double r[] = {100.137};
    const struct grid grid = {-0.16, 0.01, 33, 100.137, 1, 1};
    add_targets(&scene, 1, r);
    scene.targets[0].x = 0;
    assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
    struct problem problem = problem_make(a, 1, &grid, PRECISION_DOUBLE);
    form("reference:precision=double", problem, &echoes, &exact);
    assert_close(swath_error("rma_numeric:precision=double", problem, &echoes, &exact), 0, 0.02);
    image_free(&exact);
    echoes_free(&echoes);
    free_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refusals),
        cmocka_unit_test(conditions),
        cmocka_unit_test(short_track),
        cmocka_unit_test(sampled_much_too_fast),
    };
    return cmocka_run_group_tests_name("rma_refusals", tests, NULL, NULL);
}
