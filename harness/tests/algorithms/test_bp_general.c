/* The general engine's fast path, quintics in place of delays, against the exact path: images of odd scenes, threads
   and instruction sets. test_budget.c measures its phase. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/bp.h"
#include "contract/delay.h"
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

/* ---- images ---- */

static const struct image_case {
    const char *name;
    int pings, receivers, columns, rows;
    double x_first, x_step, r_first, r_step; /* of the grid */
    double first_offset, wobble, speed, limit;
    int first_sample, samples;
    bool together; /* all records begin alike, so that pings may be summed together */
} image_cases[] = {
    {"odd sizes, long rows", 7, 3, 331, 9, -2.013, 0.02, 19.87, 0.31, 0.04, 0, 2.5, INFINITY, 700, 400},
    {"one receiver, long columns", 13, 1, 9, 305, -1.2, 0.31, 17.03, 0.0251, 0, 0, 2.5, INFINITY, 600, 600},
    {"negative offsets", 5, 4, 61, 53, -0.4537, 0.02, 20.1, 0.025, -0.31, 0, -2.5, INFINITY, 700, 300},
    {"off the raster, aperture limit", 9, 3, 301, 11, -3.3337, 0.021, 20.1, 0.25, 0.04, 0, 2.5, 0.061, 700, 400},
    {"track in space, aperture limit", 11, 3, 57, 211, -1.7, 0.07, 12.3, 0.031, 0.04, 0.6, 2.5, 0.2, 300, 800},
    {"records end inside the lines", 9, 2, 151, 201, -4.5, 0.06, 18.1, 0.026, 0.04, 0.2, 2.5, INFINITY, 753, 110},
    {"pixels near and on the track", 6, 3, 91, 87, -1.1, 0.02, -0.4, 0.05, 0.04, 0.05, 2.5, INFINITY, 0, 400},
    {"far away, 120 samples from pixel to pixel", 3, 2, 5, 101, -6.1, 3, 1803.7, 3, 0.04, 0, 2.5, INFINITY, 72100,
     12200},
    {"one receiver, aperture limit", 14, 1, 401, 7, -4.0127, 0.02, 16.3, 0.4, 0, 0, 2.5, 0.2, 500, 600, true},
    {"two receivers, sways, aperture limit", 9, 2, 453, 5, -4.5, 0.02, 15.1, 0.7, 0.04, 0.2, 2.5, 0.21, 450, 600, true},
    {"one receiver, records end inside the lines", 10, 1, 301, 7, -4.5, 0.03, 18.1, 0.4, 0.04, 0.1, 75, 0.3, 740, 110,
     true},
    {"one receiver, steep beside its aperture", 14, 1, 81, 21, -1.5, 0.037, 7.4, 0.1, 0, 0, 2.5, 0.0743, 250, 200,
     true},
    {"long columns of long records, in parts", 3, 4, 3, 790, -1.2, 0.31, 17.03, 0.0313, 0.04, 0, 2.5, INFINITY, 600,
     2200},
    {"v/c = 0.05, stands oblique", 7, 3, 121, 33, -1.3, 0.03, 15.2, 0.09, -0.04, 0.3, 75, INFINITY, 500, 600},
};

static void make_image_case(const struct image_case *c, struct acquisition *a, struct grid *grid, struct echoes *echoes)
{
    struct random random = random_seed(11, (uint64_t)c->columns);
    *a = support_acquisition(c->pings, c->receivers, c->samples);
    a->aperture_limit = c->limit;
    for (int p = 0; p < a->pings; p++) {
        struct vector sway = vector_random(&random, c->wobble);
        a->t0[p] = (c->first_sample + (c->wobble > 0 && !c->together ? p % 3 : 0)) / a->fs;
        a->tx[p] = (struct vector){(p - a->pings / 2) * 0.173 + sway.x, sway.y, sway.z};
        a->velocity[p] = (struct vector){c->speed, c->wobble * c->speed / 3, 0};
        for (int m = 0; m < a->receivers; m++)
            a->rx[p * a->receivers + m] =
                (struct vector){a->tx[p].x + c->first_offset + 0.04 * m, a->tx[p].y + 0.01 * c->wobble * m, a->tx[p].z};
    }
    *grid = (struct grid){c->x_first, c->x_step, c->columns, c->r_first, c->r_step, c->rows};
    support_noise(a, &random, echoes);
}

static const struct {
    const char *spec;
    int fine; /* points of the grid that q is rounded to; 0: it is not */
} methods[] = {
    {"bp_nearest:", 1},
    {"bp_linear:beta=0,", 1},
    {"bp_linear:beta=8,", 9},
    {"bp_sinc:taps=2,", 0},
    {"bp_sinc:taps=8,", 0},
    {"bp_sinc:taps=16,window=kaiser,", 0},
    {"bp_zeropad:factor=8,", 8},
    {"bp_farrow:degree=3,", 1},
    {"bp_farrow:degree=8,factor=2,", 2},
    {"bp_fitted:taps=8,", 0},
    {"bp_fitted:taps=6,factor=4,", 0},
};
enum { METHODS = sizeof methods / sizeof *methods };

/* By how many samples the engine's positions may err: its points are multiples of 2^-19, and in single precision where
   lines bend little. */
static double position_error(const struct acquisition *a, enum precision precision, double limit)
{
    return limit * a->fs / (2 * M_PI * a->fc) + (precision == PRECISION_DOUBLE ? 0x1p-19 : 0x1p-17);
}

/* How many of a pixel's delays lie so near the middle between two points of the grid that an approximate one may choose
   the other. */
static int near_ties(const struct acquisition *a, struct vector p, int fine, double error)
{
    double reach = fine * error;
    int ties = 0;
    for (int ping = 0; ping < a->pings; ping++)
        for (int m = 0; m < a->receivers; m++) {
            double tau = delay_exact(a->tx[ping], a->rx[ping * a->receivers + m], a->velocity[ping], p, a->sound_speed);
            double point = (tau - a->t0[ping]) * a->fs * fine;
            ties += fabs(point - floor(point) - 0.5) <= reach;
        }
    return ties;
}

struct comparison {
    double difference; /* relative L2 over the pixels without near ties */
    double worst;      /* of the others: largest |difference| over the number of its near ties */
    int ties, pixels;  /* near ties, pixels that have some */
};

static struct comparison compare(const struct image *fast, const struct image *exact, const struct acquisition *a,
                                 int fine, double limit)
{
    const struct grid *grid = exact->patches;
    struct comparison c = {0};
    double difference = 0, norm = 0, error = position_error(a, fast->precision, limit);
    for (int i = 0; i < grid->r_count; i++)
        for (int j = 0; j < grid->x_count; j++) {
            struct vector p = {grid->x_first + j * grid->x_step, grid->r_first + i * grid->r_step, 0};
            int ties = fine ? near_ties(a, p, fine, error) : 0;
            double complex value = image_pixel(exact, 0, i, j), delta = image_pixel(fast, 0, i, j) - value;
            norm += creal(value * conj(value));
            if (ties == 0)
                difference += creal(delta * conj(delta));
            else
                c.worst = worse_of(c.worst, cabs(delta) / ties);
            c.ties += ties;
            c.pixels += ties > 0;
        }
    c.difference = sqrt(difference / norm);
    return c;
}

/* Every method, both precisions: the fast image lies within the phase limit of the exact one. Noise is the hardest
   echo: a sample that a tie lets go to its neighbour changes by more than itself, so the pixels that have near ties
   stand apart; they are as rare as the limit makes them and differ by no more than the values that may be exchanged. */
static void fast_near_exact(void **state)
{
    (void)state;
    const double limit = 1e-4;
    for (size_t k = 0; k < sizeof image_cases / sizeof *image_cases; k++) {
        struct acquisition a;
        struct grid grid;
        struct echoes echoes;
        make_image_case(&image_cases[k], &a, &grid, &echoes);
        struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        double pairs = (double)a.pings * a.receivers * grid.x_count * grid.r_count, largest[2] = {0, 0}, peak = 0;
        int ties = 0, pixels = 0;
        for (int n = 0; n < a.samples * a.receivers * a.pings; n++)
            peak = worse_of(peak, cabs(((double complex *)echoes.samples)[n]));
        for (int m = 0; m < METHODS; m++) {
            struct image exact, fast, again;
            char spec[96];
            snprintf(spec, sizeof spec, "%sprecision=double,exact=true", methods[m].spec);
            assert_int_equal(support_image(spec, problem, &echoes, &exact), STATUS_OK);
            for (int p = 0; p < 2; p++) {
                snprintf(spec, sizeof spec, "%sprecision=%s,engine=general,phase_limit=%g", methods[m].spec,
                         p ? "double" : "float", limit);
                omp_set_num_threads(2);
                assert_int_equal(support_image(spec, problem, &echoes, &fast), STATUS_OK);
                omp_set_num_threads(1);
                assert_int_equal(support_image(spec, problem, &echoes, &again), STATUS_OK);
                assert_memory_equal(fast.pixels[0], again.pixels[0],
                                    grid_pixels(&grid) * precision_size(fast.precision));
                struct comparison c = compare(&fast, &exact, &a, methods[m].fine, limit);
                double expected = 2 * methods[m].fine * position_error(&a, fast.precision, limit) * pairs;
                if (!(c.difference <= limit + (p ? 0 : 2e-6)) || !(c.worst <= 4 * peak)
                    || !(c.ties <= 2 * expected + 20))
                    fail_msg("%s, %s: differs by %g; by %g where %d pairs are near a tie", image_cases[k].name, spec,
                             c.difference, c.worst, c.ties);
                largest[p] = worse_of(largest[p], c.difference);
                ties += c.ties;
                pixels += c.pixels;
                image_free(&again);
                image_free(&fast);
            }
            image_free(&exact);
        }
        print_message("%s: within %.1e (float), %.1e (double); %d pairs near a tie in %d pixels, of %.0f pairs\n",
                      image_cases[k].name, largest[0], largest[1], ties, pixels, 2 * METHODS * pairs);
        assert_true(largest[1] > 0); /* it is another path */
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* Columns that are summed in parts, for their records are long, are those of patches too short for it. */
static void parts_make_the_whole(void **state)
{
    (void)state;
    enum { PATCHES = 4 };
    const struct image_case *c = image_cases;
    while (!strstr(c->name, "in parts"))
        c++;
    struct acquisition a;
    struct grid grid, grids[PATCHES];
    struct echoes echoes;
    struct image whole, split;
    make_image_case(c, &a, &grid, &echoes);
    for (int k = 0; k < PATCHES; k++) {
        const int first = grid.r_count * k / PATCHES;
        grids[k] = grid;
        grids[k].r_first += first * grid.r_step;
        grids[k].r_count = grid.r_count * (k + 1) / PATCHES - first;
    }
    const char *spec = "bp_farrow:degree=8,factor=2,precision=double,exact=true";
    assert_int_equal(support_image(spec, problem_make(&a, 1, &grid, PRECISION_DOUBLE), &echoes, &whole), STATUS_OK);
    assert_int_equal(support_image(spec, problem_make(&a, PATCHES, grids, PRECISION_DOUBLE), &echoes, &split),
                     STATUS_OK);
    double difference = 0, norm = 0;
    for (int k = 0; k < PATCHES; k++)
        for (int i = 0; i < grids[k].r_count; i++)
            for (int j = 0; j < grid.x_count; j++) {
                const double complex value = image_pixel(&split, k, i, j);
                norm += creal(value * conj(value));
                const double complex off = image_pixel(&whole, 0, grid.r_count * k / PATCHES + i, j) - value;
                difference += creal(off * conj(off));
            }
    assert_true(norm > 0 && sqrt(difference / norm) < 1e-9);
    image_free(&whole);
    image_free(&split);
    echoes_free(&echoes);
    acquisition_free(&a);
}

/* The functions for a machine without AVX and without fused multiply-adds, and those with AVX2 on a machine that has
   more, show the same images, on either path and in the invariant engine, but for what the general engine's fast path
   may err by (backprojection/budget.h). */
static void instruction_sets_agree(void **state)
{
    (void)state;
    static const char *const paths[] = {"exact=true", "engine=general", "engine=invariant"};
    double worst[2] = {0, 0}, worst_fast[2] = {0, 0};
    for (int k = 0; k < 2; k++)
        for (int m = 0; m < METHODS; m++)
            for (int n = 0; n < 3; n++)
                for (int p = 0; p < 2; p++) {
                    struct acquisition a;
                    struct grid grid;
                    struct echoes echoes;
                    struct image best, other;
                    char spec[96];
                    make_image_case(&image_cases[k], &a, &grid, &echoes);
                    if (n == 2)
                        grid.x_step = 0.173 / 7; /* on the pings' raster */
                    struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
                    snprintf(spec, sizeof spec, "%sprecision=%s,%s", methods[m].spec, p ? "double" : "float", paths[n]);
                    assert_int_equal(support_image(spec, problem, &echoes, &best), STATUS_OK);
                    for (int lower = 0; lower < 2; lower++) {
                        setenv("SASBENCH_ISA", lower ? "v3" : "baseline", 1);
                        assert_int_equal(support_image(spec, problem, &echoes, &other), STATUS_OK);
                        unsetenv("SASBENCH_ISA");
                        double *most = n == 1 ? &worst_fast[p] : &worst[p];
                        *most = worse_of(*most, support_difference(&other, &best));
                        image_free(&other);
                    }
                    image_free(&best);
                    echoes_free(&echoes);
                    acquisition_free(&a);
                }
    print_message("lesser instruction sets: within %.1e (float), %.1e (double) of the best; general: %.1e, %.1e\n",
                  worst[0], worst[1], worst_fast[0], worst_fast[1]);
    assert_true(worst[0] < 1e-6 && worst[1] < 1e-10);
    assert_true(worst_fast[0] < 0.15 * 1e-4 + 2e-6 && worst_fast[1] < 1e-9);
}

/* Carriers so low that no scene may have them, down to where turns underflow: still no index but those of the
   record. */
static void no_carrier_leaves_the_record(void **state)
{
    (void)state;
    static const double carriers[] = {1, 1e-10, 1e-20, 1e-36, 1e-44, 1e-300};
    for (int n = 0; n < 6 * 2 * METHODS; n++) {
        struct acquisition a;
        struct grid grid;
        struct echoes echoes;
        struct image exact, fast;
        char spec[96];
        make_image_case(&image_cases[0], &a, &grid, &echoes);
        a.fc = carriers[n / 2 % 6];
        struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        snprintf(spec, sizeof spec, "%sprecision=double,exact=true", methods[n / 12].spec);
        assert_int_equal(support_image(spec, problem, &echoes, &exact), STATUS_OK);
        snprintf(spec, sizeof spec, "%sprecision=%s,engine=general", methods[n / 12].spec, n % 2 ? "double" : "float");
        assert_int_equal(support_image(spec, problem, &echoes, &fast), STATUS_OK);
        double difference = support_difference(&fast, &exact);
        if (!(difference < 0.05)) /* positions are held to a quarter of a step only, for the phase asks for less */
            fail_msg("%s at %g Hz: differs by %g", spec, a.fc, difference);
        image_free(&fast);
        image_free(&exact);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

static void weights_linear(const struct interpolator *in, double fraction, double *w)
{
    (void)in;
    w[0] = 1 - fraction;
    w[1] = fraction;
}

/* Positions are fixed-point numbers: as many steps as they have room for are rounded to as exactly, more are
   refused. */
static void steps_fit_their_bits(void **state)
{
    (void)state;
    struct acquisition a;
    struct grid grid;
    struct echoes echoes;
    struct image images[2];
    make_image_case(&image_cases[0], &a, &grid, &echoes);
    const struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
    struct interpolator linear = {.upsample = 1, .steps = 4096, .taps = 2, .weights = weights_linear};
    void *plan;
    for (int exact = 0; exact < 2; exact++) {
        const struct bp_options options = {.engine = BP_ENGINE_GENERAL, .exact = exact, .phase_limit = 1e-6};
        struct stages stages;
        assert_int_equal(bp_plan(&problem, &linear, &options, &plan), STATUS_OK);
        assert_int_equal(image_allocate(1, &grid, PRECISION_DOUBLE, &images[exact]), STATUS_OK);
        stages_begin(&stages);
        assert_int_equal(bp_execute(plan, &echoes, &images[exact], &stages), STATUS_OK);
        bp_destroy(plan);
    }
    const double difference = support_difference(&images[0], &images[1]);
    print_message("4096 steps: within %.1e of the exact path\n", difference);
    assert_true(difference > 0 && difference < 1e-3); /* a step more or less changes a linear value by 1/4096 */
    const struct bp_options options = {.engine = BP_ENGINE_GENERAL, .phase_limit = 1e-6};
    linear.steps = 4097;
    assert_int_equal(bp_plan(&problem, &linear, &options, &plan), STATUS_UNSUPPORTED);
    assert_null(plan);
    assert_non_null(strstr(status_message(), "4097 steps between samples, must be at most 4096"));
    image_free(&images[0]);
    image_free(&images[1]);
    echoes_free(&echoes);
    acquisition_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fast_near_exact),        cmocka_unit_test(parts_make_the_whole),
        cmocka_unit_test(instruction_sets_agree), cmocka_unit_test(no_carrier_leaves_the_record),
        cmocka_unit_test(steps_fit_their_bits),
    };
    return cmocka_run_group_tests_name("bp_general", tests, NULL, NULL);
}
