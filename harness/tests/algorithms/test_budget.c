/* The error budget of the general engine (backprojection/budget.h): the phase of random geometries, and the part of
   single precision alone. */
#include <math.h>
#include <stdio.h>

#include "backprojection/general/blocks.h"
#include "contract/delay.h"
#include "common/isa.h"
#include "scene/random.h"
#include "tests/support.h"

static double uniform(struct random *random, double low, double high)
{
    return low + (high - low) * random_uniform(random);
}

static struct vector vector_random(struct random *random, double size)
{
    struct vector v = {uniform(random, -size, size), 0, 0};
    v.y = uniform(random, -size, size);
    v.z = uniform(random, -size, size);
    return v;
}

/* One ping and one receiver near a line of pixels, at any scale from centimetres to kilometres; records of ones that
   hold every delay, so that each pixel of a nearest-sample image is the pair's phase factor. */
static void random_pair(uint64_t seed, struct acquisition *a, struct grid *grid, struct echoes *echoes)
{
    static const double machs[] = {0, 1e-3, 0.05, 0.3};
    struct random random = random_seed(seed, 1);
    double size = pow(10, uniform(&random, -1, 3)), c = 1500, speed = c * machs[seed % 4];
    int count = (int)uniform(&random, 17, 1200);
    *a = (struct acquisition){
        .sound_speed = c, .receivers = 1, .pings = 1, .samples = 3000, .compressed = true, .aperture_limit = INFINITY};
    assert_int_equal(acquisition_allocate(a), STATUS_OK);
    a->tx[0] = vector_random(&random, size);
    a->tx[0].z *= 0.1;
    struct vector offset = vector_random(&random, 0.3 * size), heading = vector_random(&random, 1);
    double length = sqrt(heading.x * heading.x + heading.y * heading.y + heading.z * heading.z);
    a->rx[0] = (struct vector){a->tx[0].x + offset.x, a->tx[0].y + offset.y, a->tx[0].z + offset.z};
    a->velocity[0] =
        (struct vector){speed * heading.x / length, speed * heading.y / length, speed * heading.z / length};
    double step = 2 * size * random_uniform(&random) / count;
    *grid = (struct grid){uniform(&random, -size, size), step, seed % 2 ? count : 1,
                          uniform(&random, -size, size), step, seed % 2 ? 1 : count};
    double longest = 2 * 8 * size / (c - speed); /* every distance is below 8 size */
    a->fs = a->bandwidth = (a->samples - 2) / longest;
    a->fc = pow(10, uniform(&random, 1, 5.5)) / longest; /* at most 3e5 cycles: rounding stays below 1e-9 rad */
    assert_int_equal(echoes_allocate(a, PRECISION_DOUBLE, echoes), STATUS_OK);
    for (int n = 0; n < a->samples; n++)
        ((double complex *)echoes->samples)[n] = 1;
}

/* The share of the line's pixels that take their delay from a quintic. */
static double share_of_quintics(const struct acquisition *a, const struct grid *grid, double limit)
{
    struct ping_box box = ping_box_make(a, 0, 1, grid, limit);
    struct pixel_line line = grid_line(grid, grid->x_count > 1, 0);
    struct pair_span left = {0, line.count};
    struct bp_block blocks[BP_BLOCKS];
    double pixels = 0;
    for (int count, next = 0; (count = blocks_make(&box, &line, &left, blocks)) > 0;)
        for (int b = 0; b < count; b++) {
            assert_int_equal(blocks[b].begin, next); /* no gap, no overlap */
            next = blocks[b].end;
            pixels += blocks[b].exact ? 0 : blocks[b].end - blocks[b].begin;
        }
    assert_int_equal(left.begin, line.count);
    return pixels / line.count;
}

/* The phase errs by less than the limit, for any geometry and limit, and comes near it: the bound is no idle one. In
   single precision sums and phase factors add to it (bends_keep_their_share). */
static void phase_below_limit(void **state)
{
    (void)state;
    static const double limits[] = {1e-2, 1e-4, 1e-6};
    for (size_t k = 0; k < sizeof limits / sizeof *limits; k++) {
        double worst[2] = {0, 0}, share = 0;
        int cases = 600;
        for (int seed = 0; seed < cases; seed++) {
            struct acquisition a;
            struct grid grid;
            struct echoes echoes;
            struct image images[2];
            random_pair((uint64_t)seed, &a, &grid, &echoes);
            struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
            for (int n = 0; n < 2; n++) {
                char spec[96];
                snprintf(spec, sizeof spec, "bp_nearest:precision=%s,phase_limit=%g", precision_name((enum precision)n),
                         limits[k]);
                assert_int_equal(support_image(spec, problem, &echoes, &images[n]), STATUS_OK);
            }
            share += share_of_quintics(&a, &grid, limits[k]) / cases;
            for (int i = 0; i < grid.r_count; i++)
                for (int j = 0; j < grid.x_count; j++) {
                    struct vector p = {grid.x_first + j * grid.x_step, grid.r_first + i * grid.r_step, 0};
                    double cycles = a.fc * delay_exact(a.tx[0], a.rx[0], a.velocity[0], p, a.sound_speed);
                    double complex exact = cexp(I * 2 * M_PI * (cycles - rint(cycles)));
                    for (int n = 0; n < 2; n++)
                        worst[n] = worse_of(worst[n], cabs(image_pixel(&images[n], 0, i, j) - exact));
                }
            image_free(&images[0]);
            image_free(&images[1]);
            echoes_free(&echoes);
            acquisition_free(&a);
        }
        print_message(
            "limit %g rad: largest phase error %.1e rad (float), %.1e (double), %.0f %% of the delays from quintics\n",
            limits[k], worst[PRECISION_FLOAT], worst[PRECISION_DOUBLE], 100 * share);
        assert_true(worst[PRECISION_DOUBLE] <= limits[k] + 1e-9 && worst[PRECISION_FLOAT] <= limits[k] + 4.6e-6);
        assert_true(worst[PRECISION_DOUBLE] > 0.05 * limits[k] && share > 0.5);
    }
}

/* One ping over a line of pixels at distance `range` broadside, so short that its quintics err by less than 0.01 of the
   limit, but bent by up to a hundred cycles; records of ones. */
static void bent_line(double range, double limit, double fc, struct acquisition *a, struct grid *grid,
                      struct echoes *echoes)
{
    const double c = 1500, half = 0.4 * pow(256 * pow(range, 5) * limit * c / (2 * M_PI * fc), 1.0 / 6);
    *a = (struct acquisition){.sound_speed = c,
                              .fc = fc,
                              .fs = 10e3,
                              .bandwidth = 10e3,
                              .receivers = 1,
                              .pings = 1,
                              .samples = 64,
                              .compressed = true,
                              .aperture_limit = INFINITY};
    assert_int_equal(acquisition_allocate(a), STATUS_OK);
    a->t0[0] = 2 * range / c - 10 / a->fs;
    *grid = (struct grid){-half, half / 200, 401, range, 1, 1};
    assert_int_equal(echoes_allocate(a, PRECISION_DOUBLE, echoes), STATUS_OK);
    for (int n = 0; n < a->samples; n++)
        ((double complex *)echoes->samples)[n] = 1;
}

/* rad: what single precision may add to a run whose bend is the most that the limit allows. */
static double float_bound(double limit)
{
    const double bend = fmin(16, 0x1p17 * limit), sum = exp2(ceil(log2(bend + 0.5)));
    return 2 * M_PI * (3 * 0x1p-24 * bend + 0x1p-25 * sum) + 2.2e-6;
}

/* Bends, their sum with the straight line and the phase factors, where quintics have no share in the error. */
static void bends_keep_their_share(void **state)
{
    (void)state;
    static const double limits[] = {1e-5, 1e-4, 1e-3}, ranges[] = {30, 100, 300, 1000, 3000};
    for (size_t k = 0; k < sizeof limits / sizeof *limits; k++) {
        double worst = 0;
        struct random random = random_seed(5, k);
        for (int n = 0; n < 100; n++) {
            struct acquisition a;
            struct grid grid;
            struct echoes echoes;
            struct image image;
            char spec[96];
            bent_line(ranges[n % 5], limits[k], uniform(&random, 50e3, 300e3), &a, &grid, &echoes);
            struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
            snprintf(spec, sizeof spec, "bp_nearest:engine=general,precision=float,phase_limit=%g", limits[k]);
            assert_int_equal(support_image(spec, problem, &echoes, &image), STATUS_OK);
            for (int j = 0; j < grid.x_count; j++) {
                struct vector p = {grid.x_first + j * grid.x_step, grid.r_first, 0};
                double cycles = a.fc * delay_exact(a.tx[0], a.rx[0], a.velocity[0], p, a.sound_speed);
                worst =
                    worse_of(worst, cabs(image_pixel(&image, 0, 0, j) - cexp(I * 2 * M_PI * (cycles - rint(cycles)))));
            }
            image_free(&image);
            echoes_free(&echoes);
            acquisition_free(&a);
        }
        print_message("limit %g rad: largest phase error of single precision %.1e rad, at most %.1e\n", limits[k],
                      worst, float_bound(limits[k]));
        assert_true(worst <= float_bound(limits[k]) + 0.01 * limits[k]);
        if (limits[k] >= 1e-4 && isa_choose() != ISA_BASELINE) /* which has no bends in float */
            assert_true(worst > 0.2 * float_bound(limits[k]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(phase_below_limit),
        cmocka_unit_test(bends_keep_their_share),
    };
    return cmocka_run_group_tests_name("budget", tests, NULL, NULL);
}
