/* Delays, images and the check of grids at any speed below the sound's: against the same in more digits, and within
   bounds of work. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "contract/delay.h"
#include "scene/random.h"
#include "tests/support.h"

static double uniform(struct random *random, double low, double high)
{
    return low + (high - low) * random_uniform(random);
}

/* Along the track, solved by halving: c tau - |tx - p| - |rx + v tau - p| rises with tau. In more digits, no closed
   form. */
static long double delay_halving(double tx, double rx, double v, double x, double r, double c)
{
    long double low = 0, high = 1, leg = sqrtl(((long double)tx - x) * ((long double)tx - x) + (long double)r * r);
#define LATE(t) ((long double)c * (t)-leg - sqrtl((rx + v * (t)-x) * (rx + v * (t)-x) + (long double)r * r))
    while (LATE(high) < 0)
        high *= 2;
    for (int k = 0; k < 200; k++) {
        long double middle = (low + high) / 2;
        if (LATE(middle) < 0)
            low = middle;
        else
            high = middle;
    }
#undef LATE
    return high;
}

static const double rests[] = {0.9, 0.5, 0.1, 1e-3, 1e-6, 1e-9, 1e-12}; /* 1 - v/c */

/* Receivers that sail towards the echo, from far astern: the root's terms cancel in one of its forms. */
static void nothing_cancels(void **state)
{
    (void)state;
    const double c = 1500;
    double worst = 0;
    struct random random = random_seed(1, 0);
    for (int n = 0; n < 7000; n++) {
        const double v = c * (1 - rests[n % 7]) * (n % 2 ? 1 : -1), side = v > 0 ? 1 : -1;
        const double tx = uniform(&random, -30, -10) * side, rx = tx + uniform(&random, -90, -50) * side;
        const double x = uniform(&random, -1, 1), r = uniform(&random, 1, 20);
        const double tau = delay_exact((struct vector){tx, 0, 0}, (struct vector){rx, 0, 0}, (struct vector){v, 0, 0},
                                       (struct vector){x, r, 0}, c);
        const long double exact = delay_halving(tx, rx, v, x, r, c);
        worst = fmax(worst, (double)fabsl((tau - exact) / exact));
    }
    print_message("delays within %.1e of themselves\n", worst);
    assert_true(worst < 2e-15);
}

/* Both engines and `reference` on a sonar at great speed: noise, every pair's phase in more digits. */
static void images_at_speed(void **state)
{
    (void)state;
    enum { PINGS = 5, RECEIVERS = 4, SAMPLES = 1024, COLUMNS = 33, ROWS = 3 };
    const double c = 1500;
    for (int n = 0; n < 14; n++) {
        const double v = c * (1 - rests[n / 2]) * (n % 2 ? -1 : 1), ahead = n % 2 ? 50 : -50;
        struct acquisition a = {.sound_speed = c,
                                .fc = 150e3,
                                .fs = 30e3,
                                .bandwidth = 15e3,
                                .samples = SAMPLES,
                                .receivers = RECEIVERS,
                                .pings = PINGS,
                                .compressed = true,
                                .aperture_limit = INFINITY};
        struct echoes echoes;
        struct random random = random_seed(2, 0);
        assert_int_equal(acquisition_allocate(&a), STATUS_OK);
        for (int p = 0; p < PINGS; p++) {
            a.tx[p].x = 0.4 * ahead + 0.3 * (n % 2 ? PINGS - p : p);
            a.velocity[p].x = v;
            for (int m = 0; m < RECEIVERS; m++)
                a.rx[p * RECEIVERS + m].x = a.tx[p].x + ahead + 0.04 * m;
        }
        struct grid grid = {-0.165, 0.01, COLUMNS, 19.9, 0.1, ROWS};
        const double shortest = (double)delay_halving(a.tx[0].x, a.rx[0].x, v, 0, 20, c);
        for (int p = 0; p < PINGS; p++)
            a.t0[p] = floor(shortest * a.fs - SAMPLES / 2) / a.fs;
        support_noise(&a, &random, &echoes);
        struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        struct image exact, image;
        assert_int_equal(image_allocate(1, &grid, PRECISION_DOUBLE, &exact), STATUS_OK);
        for (int i = 0; i < ROWS * COLUMNS; i++) {
            const double x = grid.x_first + i % COLUMNS * grid.x_step, r = grid.r_first + i / COLUMNS * grid.r_step;
            double complex sum = 0;
            for (int k = 0; k < PINGS * RECEIVERS; k++) {
                const long double tau = delay_halving(a.tx[k / RECEIVERS].x, a.rx[k].x, v, x, r, c),
                                  cycles = a.fc * tau;
                const double q = (double)((tau - a.t0[0]) * a.fs), phase = 2 * M_PI * (double)(cycles - floorl(cycles));
                if (q >= 0 && q <= SAMPLES - 1)
                    sum += ((double complex *)echoes.samples)[k * SAMPLES + (int)(q + 0.5)] * cexp(I * phase);
            }
            ((double complex *)exact.pixels[0])[i] = sum;
        }
        static const char *const specs[] = {"bp_nearest:precision=double,exact=true",
                                            "bp_nearest:precision=double,engine=general",
                                            "bp_nearest:precision=double,engine=invariant"};
        for (int k = 0; k < 3; k++) {
            assert_int_equal(support_image(specs[k], problem, &echoes, &image), STATUS_OK);
            double difference = support_difference(&image, &exact);
            if (!(difference < (k == 1 ? 1e-4 : 1e-9)))
                fail_msg("v/c = %s(1 - %g), %s: differs by %g", n % 2 ? "-" : "", rests[n / 2], specs[k], difference);
            image_free(&image);
        }
        image_free(&exact);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

static bool any_pixel_meets(const struct acquisition *a, const struct grid *grid)
{
    for (int i = 0; i < grid->r_count * grid->x_count; i++)
        for (int k = 0; k < a->pings * a->receivers; k++) {
            struct vector p = {grid->x_first + i % grid->x_count * grid->x_step,
                               grid->r_first + i / grid->x_count * grid->r_step, 0};
            int ping = k / a->receivers;
            double q = (delay_exact(a->tx[ping], a->rx[k], a->velocity[ping], p, a->sound_speed) - a->t0[ping]) * a->fs;
            if (q >= 0 && q <= a->samples - 1)
                return true;
        }
    return false;
}

static void grids_meet_records_at_speed(void **state)
{
    (void)state;
    int met = 0;
    for (int n = 0; n < 1400; n++) {
        struct random random = random_seed(4, (uint64_t)n);
        struct acquisition a = {.sound_speed = 1500,
                                .fc = 1e5,
                                .fs = 2e4,
                                .bandwidth = 1e4,
                                .samples = 2 + (int)uniform(&random, 0, 3),
                                .receivers = 2,
                                .pings = 2};
        assert_int_equal(acquisition_allocate(&a), STATUS_OK);
        for (int p = 0; p < 2; p++) {
            a.t0[p] = uniform(&random, 0, 0.05);
            a.tx[p] = (struct vector){uniform(&random, -4, 4), uniform(&random, 0, 1), uniform(&random, 0, 1)};
            a.velocity[p].x = 1500 * (1 - rests[n % 7]);
            for (int m = 0; m < 2; m++)
                a.rx[2 * p + m] = (struct vector){a.tx[p].x + uniform(&random, -5, 5), uniform(&random, 0, 1), 0};
        }
        struct grid grid = {uniform(&random, -9, 9), uniform(&random, 0.01, 0.8), 9,
                            uniform(&random, -9, 9), uniform(&random, 0.01, 0.8), 12};
        bool expected = any_pixel_meets(&a, &grid);
        assert_int_equal(grid_meets_records(&a, 1, &grid, "trial"), expected ? STATUS_OK : STATUS_INVALID);
        met += expected;
        acquisition_free(&a);
    }
    assert_in_range(met, 100, 1300);
}

/* v/c = 1 - 1e-6, 1280 pairs, 160000 pixels, none of which meets a record: known at once. And a record of two samples
   that the pixels step over everywhere costs the pixels along a curve, not all. */
static void meeting_is_bounded(void **state)
{
    (void)state;
    for (int n = 0; n < 2; n++) {
        struct acquisition a = {.sound_speed = 1500,
                                .fc = 150e3,
                                .fs = 30e3,
                                .bandwidth = 15e3,
                                .samples = n ? 2 : 256,
                                .receivers = 40,
                                .pings = 32};
        assert_int_equal(acquisition_allocate(&a), STATUS_OK);
        for (int p = 0; p < a.pings; p++) {
            a.velocity[p].x = n ? 1e-3 : 1499.9985;
            a.tx[p].x = n ? 0 : -20 + 0.3 * p;
            a.t0[p] = n ? (40 + 1e-5) / 1500 : 0;
            for (int m = 0; m < a.receivers; m++)
                a.rx[p * a.receivers + m].x = a.tx[p].x + (n ? 0 : -50 + 0.04 * m);
        }
        struct grid grid =
            n ? (struct grid){-1000, 200, 11, -1000, 200, 11} : (struct grid){-2, 0.01, 400, 18, 0.01, 400};
        double begin = (double)clock();
        assert_int_equal(grid_meets_records(&a, 1, &grid, "trial"), STATUS_INVALID);
        assert_true(((double)clock() - begin) / CLOCKS_PER_SEC < 1);
        acquisition_free(&a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_cancels),
        cmocka_unit_test(images_at_speed),
        cmocka_unit_test(grids_meet_records_at_speed),
        cmocka_unit_test(meeting_is_bounded),
    };
    return cmocka_run_group_tests_name("delay", tests, NULL, NULL);
}
