/* Which pairs an image sums, where rounding would decide: pixels on the cone of the aperture limit, on the transmitter,
   on the track; who counts them and when. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "backprojection/pairs/pairs.h"
#include "backprojection/pairs/turned.h"
#include "contract/delay.h"
#include "scene/random.h"
#include "tests/support.h"

static void make(struct acquisition *a, int pings, int receivers, int samples, double spacing, double speed)
{
    *a = support_acquisition(pings, receivers, samples);
    for (int p = 0; p < pings; p++) {
        a->tx[p].x = (p - pings / 2) * spacing;
        a->velocity[p].x = speed;
        for (int m = 0; m < receivers; m++)
            a->rx[p * receivers + m].x = a->tx[p].x + 0.0625 * (m + 1);
    }
}

/* Grids and pings in binary fractions, so that whole triangles lie exactly on the cone: every pixel is in a span
   exactly where the definition says so. */
static void spans_hold_the_cone(void **state)
{
    (void)state;
    static const double limits[] = {0.5, 0.6, 0.8, 0.28, 0.1, 5.0 / 13, 0.75};
    int exact = 0;
    for (uint64_t seed = 0; seed < 1000; seed++) {
        struct random random = random_seed(seed, 5);
        struct acquisition a;
        make(&a, 5, 1, 2000, 0.5, 2);
        a.aperture_limit = limits[seed % 7];
        struct grid grid = {
            -4 + 0.125 * (int)(8 * random_uniform(&random)),  0.125, 1 + (int)(60 * random_uniform(&random)),
            -2 + 0.125 * (int)(32 * random_uniform(&random)), 0.125, 1 + (int)(30 * random_uniform(&random))};
        for (int n = 0; n < 2 * 5; n++) {
            const bool along_x = n % 2;
            const struct vector h = acquisition_heading(&a, n / 2), tx = a.tx[n / 2];
            for (int k = 0; k < grid_line_count(&grid, along_x); k++) {
                const struct pixel_line line = grid_line(&grid, along_x, k);
                struct pair_span spans[2];
                const int count = pair_spans(&a, n / 2, h, &line, spans);
                for (int i = 0; i < line.count; i++) {
                    struct vector p = line_pixel(&line, i);
                    double along = fabs(p.x - tx.x), edge = a.aperture_limit * sqrt(along * along + p.y * p.y);
                    bool inside = false;
                    for (int s = 0; s < count; s++)
                        inside |= i >= spans[s].begin && i < spans[s].end;
                    exact += along == edge;
                    if (inside != (along <= edge))
                        fail_msg("seed %d, limit %g: pixel (%g, %g) from (%g, 0): %d", (int)seed, a.aperture_limit, p.x,
                                 p.y, tx.x, inside);
                }
            }
        }
        acquisition_free(&a);
    }
    assert_true(exact > 1000); /* the case does occur */
}

/* Oblique cones in space, which may hold a line's middle or its ends, touch it or miss it. */
static void spans_hold_oblique_cones(void **state)
{
    (void)state;
    int parts[3] = {0};
    for (uint64_t seed = 0; seed < 4000; seed++) {
        struct random random = random_seed(seed, 6);
        struct acquisition a;
        make(&a, 1, 1, 2000, 0.5, 2);
        a.tx[0] =
            (struct vector){random_uniform(&random), random_uniform(&random), seed % 3 ? random_uniform(&random) : 0};
        a.aperture_limit = seed % 5 ? random_uniform(&random) : 0.01;
        double u = 6.28 * random_uniform(&random), w = seed % 2 ? 1.5 * random_uniform(&random) : 0;
        struct vector h = {cos(u) * cos(w), sin(u) * cos(w), sin(w)};
        struct grid grid = {-1,
                            seed % 4 ? 0.01 : 1e-6,
                            seed % 2 ? 300 : 1,
                            2 * random_uniform(&random) - 1,
                            seed % 4 ? 0.01 : 1e-6,
                            seed % 2 ? 1 : 300};
        const struct pixel_line line = grid_line(&grid, seed % 2, 0);
        struct pair_span spans[2];
        const int count = pair_spans(&a, 0, h, &line, spans);
        parts[count]++;
        for (int i = 0; i < line.count; i++) {
            struct vector p = line_pixel(&line, i);
            double x = p.x - a.tx[0].x, y = p.y - a.tx[0].y, z = p.z - a.tx[0].z;
            double over = fabs(x * h.x + y * h.y + z * h.z) - a.aperture_limit * sqrt(x * x + y * y + z * z);
            bool inside = false;
            for (int s = 0; s < count; s++)
                inside |= i >= spans[s].begin && i < spans[s].end;
            if (fabs(over) > 1e-14 && inside != (over < 0))
                fail_msg("seed %d: pixel %d is %g outside: %d", (int)seed, i, over, inside);
        }
        acquisition_free(&a);
    }
    assert_true(parts[0] > 100 && parts[1] > 100 && parts[2] > 100);
}

/* Tracks either way, squinted beams, turned grids: pairs are those within the limit of the beam's axis. */
static void limits_count_from_the_axis(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 300; seed++) {
        struct random random = random_seed(seed, 7);
        struct acquisition a;
        make(&a, 9, 2, 4000, (seed % 2 ? 0.5 : -0.5), 2);
        a.echo_squint = seed % 3 ? 2 * random_uniform(&random) - 1 : 0;
        a.aperture_limit = 0.02 + 0.5 * random_uniform(&random);
        const struct grid grid = {20 * random_uniform(&random) - 10,
                                  0.3,
                                  23,
                                  5 + 10 * random_uniform(&random),
                                  0.2,
                                  11,
                                  seed % 5 ? 0.8 * random_uniform(&random) - 0.4 : 0};
        struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        struct turned_problem turned;
        double expected = 0;
        for (int n = 0; n < 9 * 23 * 11; n++) {
            struct vector p = grid_point(&grid, n / 9 / 23, n / 9 % 23);
            expected += fabs(sin(atan2(p.x - a.tx[n % 9].x, p.y) - a.echo_squint)) <= a.aperture_limit ? 2 : 0;
        }
        const double whole = pairs_count(&problem); /* as an outside engine asks, which knows nothing of turning */
        assert_int_equal(problem_turn_back(&problem, &turned, NULL), STATUS_OK);
        assert_true(problem.patches[0].angle_rad == 0);
        double pairs = pairs_count(&problem);
        if (pairs != expected || whole != expected)
            fail_msg("seed %d: %g pairs, %g before the grid is turned, %g expected", (int)seed, pairs, whole, expected);
        turned_free(&turned);
        acquisition_free(&a);
    }
}

/* Patches in different axes are counted each in its own. */
static void patches_count_in_their_own_axes(void **state)
{
    (void)state;
    struct acquisition a;
    double sum = 0;
    make(&a, 9, 2, 700, 0.5, 2); /* the records end within the patches */
    a.aperture_limit = 0.3;
    const struct grid grids[] = {
        {-3, 0.1, 40, 6, 0.1, 50, 0}, {2, 0.1, 30, 5, 0.2, 41, -0.7}, {0, 0.5, 9, 4, 2, 9, 0.4}};
    for (int k = 0; k < 3; k++) {
        const struct problem alone = problem_make(&a, 1, &grids[k], PRECISION_DOUBLE);
        const double pairs = pairs_count(&alone), pixels = grids[k].x_count * grids[k].r_count;
        double expected = 0;
        for (int n = 0; n < 9 * 2 * (int)pixels; n++) {
            const int pixel = n / 18, p = n / 2 % 9;
            const struct vector at = grid_point(&grids[k], pixel / grids[k].x_count, pixel % grids[k].x_count);
            const double q = (delay_exact(a.tx[p], a.rx[n % 18], a.velocity[p], at, a.sound_speed) - a.t0[p]) * a.fs;
            expected += fabs(sin(atan2(at.x - a.tx[p].x, at.y))) <= a.aperture_limit && q >= 0 && q <= a.samples - 1;
        }
        assert_true(expected > 0 && expected < 18 * pixels);
        assert_close(pairs, expected, 0);
        sum += pairs;
    }
    const struct problem all = problem_make(&a, 3, grids, PRECISION_DOUBLE);
    assert_close(pairs_count(&all), sum, 0);
    acquisition_free(&a);
}

/* Of a large problem some lines are counted, of a small one all: records that cut, grids turned, high and wide. */
static void estimates_are_close(void **state)
{
    (void)state;
    double worst = 0;
    for (uint64_t seed = 0; seed < 12; seed++) {
        struct random random = random_seed(seed, 9);
        struct acquisition a;
        const bool large = seed % 3;
        make(&a, large ? 150 : 9, 8, 500 + (int)(600 * random_uniform(&random)), 0.1, 2);
        a.aperture_limit = seed % 4 ? 0.1 + 0.7 * random_uniform(&random) : 1;
        const int count = large ? 900 : 30;
        const struct grid grid = {-8, 16. / count, count, 4, 14. / count, count, seed % 2 ? 0.3 : 0};
        const struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        const double pairs = pairs_count(&problem), estimate = pairs_estimate(&problem);
        if (!large)
            assert_true(estimate == pairs && pairs > 0);
        worst = worse_of(worst, fabs(estimate / pairs - 1));
        acquisition_free(&a);
    }
    print_message("estimated to %.1e\n", worst);
    assert_true(worst > 0 && worst < 0.02);
}

/* Pixels on the transmitters, in coordinates that double holds exactly or does not: both engines sum the same pairs. */
static void engines_agree_on_the_track(void **state)
{
    (void)state;
    static const double steps[] = {0.0625, 0.02, 0.03}, limits[] = {0.5, 0.05, 1e-9, 0.9999},
                        firsts[] = {0, -0.25, -0.2, 1e-17};
    for (int n = 0; n < 3 * 4 * 4; n++) {
        struct acquisition a;
        struct echoes echoes;
        struct image exact, invariant;
        struct random random = random_seed(3, (uint64_t)n);
        const double step = steps[n % 3];
        make(&a, 9, 2, 400, 2 * step, 2.5);
        a.aperture_limit = limits[n / 3 % 4];
        support_noise(&a, &random, &echoes);
        struct grid grid = {-16 * step, step, 33, firsts[n / 12], 0.05, 9};
        struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        assert_int_equal(support_image("bp_sinc:window=kaiser,exact=true,precision=double", problem, &echoes, &exact),
                         STATUS_OK);
        assert_int_equal(
            support_image("bp_sinc:window=kaiser,engine=invariant,precision=double", problem, &echoes, &invariant),
            STATUS_OK);
        double difference = support_difference(&invariant, &exact);
        if (!(difference < 1e-10))
            fail_msg("step %g, limit %g, rows from %g: differ by %g", step, a.aperture_limit, grid.r_first, difference);
        image_free(&exact);
        image_free(&invariant);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* Counting costs more than this plan: it is done when the work is asked for. */
static void plans_do_not_count(void **state)
{
    (void)state;
    struct acquisition a;
    struct spec spec;
    void *plan;
    make(&a, 300, 4, 2000, 0.5, 2);
    struct grid grid = {-20, 0.02, 2000, 5, 0.02, 2000};
    struct problem problem = problem_make(&a, 1, &grid, PRECISION_FLOAT);
    assert_int_equal(spec_parse("bp_nearest:engine=general", &spec), STATUS_OK);
    struct work work = {0};
    double least[2] = {INFINITY, INFINITY}; /* planning, counting: other work on the machine only adds to them */
    for (int k = 0; k < 5; k++) {
        const double begin = (double)clock();
        assert_int_equal(algorithm_plan(spec.algorithm, &problem, spec.options, &plan), STATUS_OK);
        const double planned = (double)clock();
        work = spec.algorithm->work(plan);
        least[0] = fmin(least[0], planned - begin);
        least[1] = fmin(least[1], (double)clock() - planned);
        spec.algorithm->destroy(plan);
    }
    print_message("planned in %.3f s, counted in %.3f s of the processor\n", least[0] / CLOCKS_PER_SEC,
                  least[1] / CLOCKS_PER_SEC);
    assert_true(work.pairs == pairs_count(&problem) && work.pairs > 0);
    assert_true(least[1] > 4 * least[0]);
    spec_free(&spec);
    acquisition_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spans_hold_the_cone),        cmocka_unit_test(spans_hold_oblique_cones),
        cmocka_unit_test(limits_count_from_the_axis), cmocka_unit_test(patches_count_in_their_own_axes),
        cmocka_unit_test(engines_agree_on_the_track), cmocka_unit_test(plans_do_not_count),
        cmocka_unit_test(estimates_are_close),
    };
    return cmocka_run_group_tests_name("pairs", tests, NULL, NULL);
}
