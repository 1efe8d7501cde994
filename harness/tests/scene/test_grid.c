/* Grids: texts, and whether a pixel meets a record. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "contract/delay.h"
#include "scene/random.h"
#include "tests/scene/scene_fixture.h"

static void grid_texts(void **state)
{
    (void)state;
    struct grid grid;
    assert_int_equal(grid_parse("-0.016:0.0001:320,0.03:5e-5:400", &grid), STATUS_OK);
    assert_true(grid.x_first == -0.016 && grid.x_step == 0.0001 && grid.x_count == 320);
    assert_true(grid.r_first == 0.03 && grid.r_step == 5e-5 && grid.r_count == 400);
    assert_int_equal(grid_parse("-20:0.2:201,-20:0.2:201", &grid), STATUS_OK);
    assert_true(grid.r_first == -20 && grid.angle_rad == 0);
    assert_int_equal(grid_parse("0:0.1:5,40:0.1:6,-20", &grid), STATUS_OK);
    assert_true(grid.r_count == 6 && grid.angle_rad == -20 * M_PI / 180);
    const char *const bad[] = {
        "",
        "1",
        "0:1:2",
        "0:1:2,",
        "0:1:2,3:4",
        "0:1:2,3:4:5:6",
        "0:1:2,3:4:5,",
        "0:1:2;3:4:5",
        "a:1:2,3:4:5",
        "0:1:2.5,3:4:5",
        "0:1:0,3:4:5",
        "0:1:-2,3:4:5",
        "0:0:2,3:4:5",
        "0:-1:2,3:4:5",
        "0:1:2,3:nan:5",
        "inf:1:2,3:4:5",
        "0:inf:2,3:4:5",
        "0:1:3000000000,3:4:5",
        "0:1:99999999999999999999,3:4:5",
        "0:1:2000000000,0:1:2000000000",
        "1e12:1:5,0:1:1",
        "1e9:1e-9:5,0:1:1",
        "0,1:1:2,3:4:5",
        "0:1:2,3:4:5,90",
        "0:1:2,3:4:5,nan",
        "0:1:2,3:4:5,2 ",
        "0:1:2,3:4:5,2,3",
    };
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        if (grid_parse(bad[i], &grid) != STATUS_INVALID) {
            fail_msg("'%s' is accepted", bad[i]);
        }
        assert_message_has("must ", bad[i]);
    }
}

static bool any_pixel_meets(const struct acquisition *a, const struct grid *grid)
{
    for (int i = 0; i < grid->r_count; i++) {
        for (int j = 0; j < grid->x_count; j++) {
            struct vector p = {grid->x_first + j * grid->x_step, grid->r_first + i * grid->r_step, 0};
            for (int k = 0; k < a->pings * a->receivers; k++) {
                int ping = k / a->receivers;
                double tau = delay_exact(a->tx[ping], a->rx[k], a->velocity[ping], p, a->sound_speed);
                double q = (tau - a->t0[ping]) * a->fs;
                if (q >= 0 && q <= a->samples - 1) {
                    return true;
                }
            }
        }
    }
    return false;
}

/* Against every pixel and pair, on random geometry with records so short that both answers are common. */
static void meeting_agrees_with_trying_every_pixel(void **state)
{
    (void)state;
    struct random random = random_seed(11, 0);
    int met = 0;
    for (int trial = 0; trial < 2000; trial++) {
        struct acquisition a = {
            .sound_speed = 1500, .fc = 1e5, .fs = 2e4, .bandwidth = 1e4, .samples = 2, .receivers = 2, .pings = 2};
        assert_int_equal(acquisition_allocate(&a), STATUS_OK);
        a.samples += (int)(3 * random_uniform(&random));
        for (int k = 0; k < 2; k++) {
            a.t0[k] = 0.02 * random_uniform(&random);
            a.tx[k] = (struct vector){4 * random_uniform(&random), random_uniform(&random), random_uniform(&random)};
            a.rx[2 * k] = (struct vector){a.tx[k].x + 3 * random_uniform(&random), 0, 0};
            a.rx[2 * k + 1] = (struct vector){a.tx[k].x, random_uniform(&random), 2};
            a.velocity[k] = (struct vector){700 * random_uniform(&random), 300 * random_uniform(&random), 0};
        }
        struct grid grid = {-2 + 4 * random_uniform(&random),  0.01 + random_uniform(&random), 9,
                            -5 + 10 * random_uniform(&random), 0.01 + random_uniform(&random), 7};
        bool expected = any_pixel_meets(&a, &grid);
        assert_int_equal(grid_meets_records(&a, 1, &grid, "trial"), expected ? STATUS_OK : STATUS_INVALID);
        met += expected;
        acquisition_free(&a);
    }
    assert_in_range(met, 300, 1700);
}

/* A record of a millimetre, about the delay of one pixel at a time: that one is found, wherever it lies in the grid. */
static void lone_pixels_are_found(void **state)
{
    (void)state;
    struct acquisition a = {
        .sound_speed = 1500, .fc = 1e5, .fs = 1.5e6, .bandwidth = 1e4, .samples = 2, .receivers = 1, .pings = 1};
    const struct grid grid = {3.1, 0.4, 8, 2.3, 0.6, 7};
    assert_int_equal(acquisition_allocate(&a), STATUS_OK);
    for (int i = -1; i <= grid.r_count; i++) {
        for (int j = -1; j <= grid.x_count; j++) {
            const bool inside = i >= 0 && i < grid.r_count && j >= 0 && j < grid.x_count;
            const double tau = delay_exact(a.tx[0], a.rx[0], a.velocity[0], grid_point(&grid, i, j), a.sound_speed);
            a.t0[0] = tau - 0.5 / a.fs;
            const bool expected = any_pixel_meets(&a, &grid);
            assert_true(expected || !inside);
            if (grid_meets_records(&a, 1, &grid, "lone") != (expected ? STATUS_OK : STATUS_INVALID)) {
                fail_msg("row %d, column %d", i, j);
            }
        }
    }
    acquisition_free(&a);
}

/* Both ends of a record belong to it: the delay is 1 s exactly, sample 4 from the emission. */
static void records_hold_their_ends(void **state)
{
    (void)state;
    const struct {
        double t0;
        int samples;
        enum status expected;
    } cases[] = {{0, 5, STATUS_OK}, {0, 4, STATUS_INVALID}, {1, 2, STATUS_OK}, {1.25, 2, STATUS_INVALID}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        struct acquisition a = {.sound_speed = 2,
                                .fc = 1,
                                .fs = 4,
                                .bandwidth = 1,
                                .samples = cases[i].samples,
                                .receivers = 1,
                                .pings = 1};
        assert_int_equal(acquisition_allocate(&a), STATUS_OK);
        a.t0[0] = cases[i].t0;
        assert_int_equal(grid_meets_records(&a, 1, &(struct grid){0, 1, 1, 1, 1, 1}, "ends"), cases[i].expected);
        acquisition_free(&a);
    }
}

static void odd_grids_meet_or_not(void **state)
{
    (void)state;
    struct scene scene = scene_loaded(base_text); /* records from 24 to 32.5 ms: 18 to 24.4 m to either side */
    const struct {
        struct grid grid;
        enum status expected;
    } cases[] = {
        {{0, 0.1, 5, 20, 0.1, 5}, STATUS_OK},
        {{0, 0.1, 5, -21, 0.1, 5}, STATUS_OK}, /* the other side of the track */
        {{0, 0.1, 5, -10, 0.1, 5}, STATUS_INVALID},
        {{-1, 0.1, 21, -15, 0.1, 301}, STATUS_INVALID}, /* astride the track, all too near */
        {{-1, 0.1, 21, -25, 0.1, 501}, STATUS_OK},      /* astride, reaching far enough */
        {{-1, 50, 1, -100, 50, 5}, STATUS_INVALID},     /* -100 -50 0 50 100: steps over the records */
        {{-1, 50, 1, -80, 50, 5}, STATUS_OK},           /* holds 20 */
        {{-1e6, 1, 2000001, 1000, 1, 1}, STATUS_INVALID},
        {{-1e6, 0.5, 4000001, 20, 1, 1}, STATUS_OK},
        {{20, 1, 1, 0, 1, 1}, STATUS_OK}, /* ahead, on the track */
        {{0, 1, 1, 1e9, 1, 1}, STATUS_INVALID},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        if (grid_meets_records(&scene.acquisition, 1, &cases[i].grid, "the grid") != cases[i].expected) {
            fail_msg("case %zu is not %d", i, cases[i].expected);
        }
    }
    assert_message_has("the grid: no pixel meets any record", "message");
    assert_message_has("0.024 to 0.0325 s", "message");
    struct grid two[2] = {cases[2].grid, cases[0].grid};
    assert_int_equal(grid_meets_records(&scene.acquisition, 2, two, "both"), STATUS_OK);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grid_texts),
        cmocka_unit_test(records_hold_their_ends),
        cmocka_unit_test(lone_pixels_are_found),
        cmocka_unit_test(meeting_agrees_with_trying_every_pixel),
        cmocka_unit_test_setup_teardown(odd_grids_meet_or_not, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
