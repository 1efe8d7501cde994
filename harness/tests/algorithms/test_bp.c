/* The back projection engines. The exact path against a naive sum, one pair at a time, on random tracks in space: which
   pairs count, how samples are read, records that begin and end inside the image, aperture limits on oblique headings.
   Then the fast paths against the exact one. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/bp.h"
#include "common/delay.h"
#include "backprojection/pairs.h"
#include "data/random.h"
#include "tests/support.h"

static double uniform(struct random *random, double low, double high)
{
    return low + (high - low) * random_uniform(random);
}

/* A wobbling track and a grid near it; every third one is straight, records are short enough to be left by some pairs. */
static void random_case(uint64_t seed, struct acquisition *a, struct grid *grid, struct echoes *echoes)
{
    struct random random = random_seed(seed, 0);
    *a = (struct acquisition){.sound_speed = 1500,
                              .fc = uniform(&random, 20e3, 150e3),
                              .fs = 30e3,
                              .bandwidth = 15e3,
                              .samples = (int)uniform(&random, 20, 300),
                              .receivers = (int)uniform(&random, 1, 5),
                              .pings = (int)uniform(&random, 1, 9),
                              .compressed = true,
                              .aperture_limit = seed % 2 ? INFINITY : uniform(&random, 0.05, 0.99)};
    assert_int_equal(acquisition_allocate(a), STATUS_OK);
    double wobble = seed % 3 ? uniform(&random, 0, 3) : 0, height = seed % 3 ? uniform(&random, -4, 4) : 0;
    double speed = seed % 5 ? uniform(&random, -4, 4) : 0;
    double slope = seed % 3 ? uniform(&random, -3, 3) : 0, t0 = floor(uniform(&random, 0, 300)) / a->fs;
    for (int p = 0; p < a->pings; p++) {
        a->t0[p] = seed % 4 ? t0 : t0 + p / a->fs;
        a->tx[p] = (struct vector){p * 0.7 - 2, slope * p * 0.7 + wobble * random_uniform(&random), height};
        a->velocity[p] = (struct vector){speed, speed * slope, 0};
        for (int m = 0; m < a->receivers; m++)
            a->rx[p * a->receivers + m] = (struct vector){a->tx[p].x + 0.1 * m - 0.15, a->tx[p].y + 0.01 * m, height};
    }
    *grid = (struct grid){uniform(&random, -6, 1), uniform(&random, 0.02, 0.4), (int)uniform(&random, 1, 20),
                          uniform(&random, -8, 8), uniform(&random, 0.01, 0.2), (int)uniform(&random, 1, 600)};
    assert_int_equal(echoes_allocate(a, PRECISION_DOUBLE, echoes), STATUS_OK);
    for (int n = 0; n < a->samples * a->receivers * a->pings; n++)
        ((double complex *)echoes->samples)[n] = random_normal(&random);
}

/* How a method reads a record at sample coordinate q, written down once more from its definition. */
static double complex read_nearest(const double complex *s, int n, double q)
{
    (void)n;
    return s[(int)floor(q + 0.5)];
}

static double complex read_linear3(const double complex *s, int n, double q)
{
    double point = floor(q * 4 + 0.5) / 4;
    int i = (int)floor(point);
    return (1 - (point - i)) * s[i] + (i + 1 < n ? (point - i) * s[i + 1] : 0);
}

static double complex read_sinc6(const double complex *s, int n, double q)
{
    double complex sum = 0;
    for (int i = (int)floor(q) - 2; i <= (int)floor(q) + 3; i++) {
        double z = 3.14159265358979323846 * (q - i);
        if (i >= 0 && i < n)
            sum += s[i] * (fabs(z) < 1e-9 ? 1 : sin(z) / z);
    }
    return sum;
}

static const struct {
    const char *spec;
    double complex (*read)(const double complex *s, int n, double q);
} methods[] = {
    {"bp_nearest:precision=double,exact=true", read_nearest},
    {"bp_linear:beta=3,precision=double,exact=true", read_linear3},
    {"bp_sinc:taps=6,precision=double,exact=true", read_sinc6},
};

/* The pixel by definition; *pairs counts what it sums. */
static double complex naive(const struct echoes *echoes, double x, double r, int method, long long *pairs)
{
    const struct acquisition *a = echoes->acquisition;
    double complex sum = 0;
    for (int p = 0; p < a->pings; p++) {
        struct vector h = acquisition_heading(a, p), d = {x - a->tx[p].x, r - a->tx[p].y, -a->tx[p].z};
        double sine = fabs(d.x * h.x + d.y * h.y + d.z * h.z) / sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
        if (sine > a->aperture_limit)
            continue;
        for (int m = 0; m < a->receivers; m++) {
            int pair = p * a->receivers + m;
            double tau = delay_exact(a->tx[p], a->rx[pair], a->velocity[p], (struct vector){x, r, 0}, a->sound_speed);
            double q = (tau - a->t0[p]) * a->fs, cycles = a->fc * tau;
            if (q < 0 || q > a->samples - 1)
                continue;
            ++*pairs;
            sum += methods[method].read((const double complex *)echoes->samples + (size_t)pair * (size_t)a->samples,
                                        a->samples, q)
                   * cexp(I * 2 * 3.14159265358979323846 * (cycles - rint(cycles)));
        }
    }
    return sum;
}

static void naive_sums(void **state)
{
    (void)state;
    double largest = 0, total = 0, possible = 0;
    for (uint64_t seed = 1; seed <= 150; seed++) {
        struct acquisition a;
        struct grid grid;
        struct echoes echoes;
        random_case(seed, &a, &grid, &echoes);
        struct problem problem = {&a, 1, &grid, PRECISION_DOUBLE};
        int method = (int)(seed % 3);
        struct image image;
        assert_int_equal(support_image(methods[method].spec, problem, &echoes, &image), STATUS_OK);
        long long pairs = 0;
        for (int i = 0; i < grid.r_count; i++)
            for (int j = 0; j < grid.x_count; j++) {
                double complex exact =
                    naive(&echoes, grid.x_first + j * grid.x_step, grid.r_first + i * grid.r_step, method, &pairs);
                largest = worse_of(largest, cabs(image_pixel(&image, 0, i, j) - exact));
            }
        if ((double)pairs != pairs_count(&problem))
            fail_msg("seed %d: %lld pairs by definition, %.0f counted", (int)seed, pairs, pairs_count(&problem));
        total += (double)pairs;
        possible += (double)grid.x_count * grid.r_count * a.pings * a.receivers;
        image_free(&image);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
    print_message("%.0f of %.0f pairs summed, largest difference %.1e\n", total, possible, largest);
    assert_true(total > 0.05 * possible && total < 0.95 * possible); /* the cases do cut */
    assert_true(largest < 1e-9);
}

/* Grids and tracks of the invariant engine: odd sizes, one receiver, negative offsets, grids that begin off the ping
   raster, one ping, a sonar that sails backwards, records that end inside the image, pixels behind the track. */
static const struct invariant_case {
    const char *name;
    int pings, receivers, ratio, columns, rows;
    double step, first_offset, x_first, r_first, speed, limit;
    int samples;
    bool backwards;
} invariant_cases[] = {
    {"odd sizes", 13, 3, 7, 61, 23, 0.02, 0.04, -0.613, 19.87, 2.5, INFINITY, 400, false},
    {"one receiver", 31, 1, 3, 97, 11, 0.02, 0.04, -1.2, 20.0, 2.5, INFINITY, 400, false},
    {"negative offsets", 9, 4, 5, 40, 9, 0.02, -0.31, -0.45, 20.1, 2.5, INFINITY, 400, false},
    {"off the raster", 9, 4, 5, 41, 9, 0.02, 0.04, -0.4537, 20.1, 2.5, 0.03, 400, false},
    {"one ping", 1, 5, 1, 33, 9, 0.02, 0.04, -0.3, 20.1, 2.5, INFINITY, 400, false},
    {"backwards", 17, 2, 4, 50, 8, 0.02, 0.04, -0.5, 20.1, -2.5, 0.02, 400, true},
    {"short records", 17, 2, 4, 50, 200, 0.02, 0.04, -0.5, 18.1, 2.5, INFINITY, 60, false},
    {"fast, backwards", 17, 2, 4, 50, 200, 0.02, 0.04, -0.5, 18.1, -150, INFINITY, 60, true},
    {"far receivers, short records", 17, 4, 4, 50, 200, 0.02, -20, -0.5, 18.1, -2.5, INFINITY, 300, true},
    {"both sides of the track", 9, 2, 4, 30, 41, 0.02, 0.04, -0.5, -0.41, 2.5, 0.7, 300,
     false}, /* no pixel on a ping */
    {"many columns", 120, 2, 1, 301, 3, 0.02, 0.04, -3.1, 20.1, 2.5, 0.2, 400, false},
    {"many phases", 31, 2, 40, 403, 3, 0.02, 0.04, -3.1, 20.1, 2.5, 0.3, 400, false},  /* several groups of tables */
    {"slanting", 31, 2, 40, 403, 3, 0.02, 0.04, -3.1, 4.1, 2.5, INFINITY, 700, false}, /* a sample in two columns */
    {"coarse grid", 13, 2, 9, 150, 5, 0.07, 0.04, -3.1, 14.1, 2.5, 0.6, 400, false},
    {"coarser grid", 13, 2, 9, 150, 5, 0.3, 0.04, -3.1, 14.1, 2.5, 0.6, 400, false},
    {"one ping, very many columns", 1, 1, 1, 70001, 1, 1e-4, 0.04, -3.1, 20.1, 2.5, INFINITY, 400, false},
    {"long records", 31, 1, 3, 97, 3, 0.02, 0.04, -1.2, 20.0, 2.5, INFINITY, 2400,
     false}, /* fine samples in several passes */
};

static void make_invariant_case(const struct invariant_case *c, struct acquisition *a, struct grid *grid,
                                struct echoes *echoes)
{
    struct random random = random_seed(7, (uint64_t)c->columns);
    double spacing = c->ratio * c->step;
    *a = (struct acquisition){.sound_speed = 1500,
                              .fc = 150e3,
                              .fs = 30e3,
                              .bandwidth = 15e3,
                              .samples = c->samples,
                              .receivers = c->receivers,
                              .pings = c->pings,
                              .compressed = true,
                              .aperture_limit = c->limit};
    assert_int_equal(acquisition_allocate(a), STATUS_OK);
    for (int p = 0; p < a->pings; p++) {
        int place = c->backwards ? a->pings - 1 - p : p;
        a->t0[p] = fmax(0, floor(2 * c->r_first / 1500 * 30e3 - 20)) / 30e3;
        a->tx[p].x = (place - a->pings / 2) * spacing;
        a->velocity[p].x = c->speed;
        for (int m = 0; m < a->receivers; m++)
            a->rx[p * a->receivers + m].x = a->tx[p].x + c->first_offset + 0.04 * m;
    }
    *grid = (struct grid){c->x_first, c->step, c->columns, c->r_first, 0.025, c->rows};
    assert_int_equal(echoes_allocate(a, PRECISION_DOUBLE, echoes), STATUS_OK);
    for (int n = 0; n < a->samples * a->receivers * a->pings; n++)
        ((double complex *)echoes->samples)[n] = random_normal(&random);
}

static const char *const invariant_specs[] = {
    "bp_nearest:",          "bp_linear:beta=0,",     "bp_linear:beta=2,",
    "bp_linear:beta=8,",    "bp_sinc:taps=8,",       "bp_sinc:taps=6,window=kaiser,",
    "bp_zeropad:factor=8,", "bp_zeropad:factor=64,",
};

/* The invariant engine shows the exact path's image: 1e-10 in double, 3e-6 in float. The samples are noise, on which a
   nearest sample that is tied within rounding would show as an error of 1/sqrt(pairs); none of these cases has one. */
static void invariant_equals_exact(void **state)
{
    (void)state;
    double worst[2] = {0, 0};
    for (size_t k = 0; k < sizeof invariant_cases / sizeof *invariant_cases; k++) {
        struct acquisition a;
        struct grid grid;
        struct echoes echoes;
        make_invariant_case(&invariant_cases[k], &a, &grid, &echoes);
        struct problem problem = {&a, 1, &grid, PRECISION_DOUBLE};
        for (size_t m = 0; m < sizeof invariant_specs / sizeof *invariant_specs; m++)
            for (int p = 0; p < 2; p++) {
                struct image exact, invariant;
                char spec[96];
                snprintf(spec, sizeof spec, "%sprecision=double,exact=true", invariant_specs[m]);
                assert_int_equal(support_image(spec, problem, &echoes, &exact), STATUS_OK);
                snprintf(spec, sizeof spec, "%sprecision=%s,engine=invariant", invariant_specs[m],
                         p ? "double" : "float");
                if (support_image(spec, problem, &echoes, &invariant) != STATUS_OK)
                    fail_msg("%s: %s", invariant_cases[k].name, status_message());
                double difference = support_difference(&invariant, &exact);
                if (!(difference < (p ? 1e-10 : 3e-6)))
                    fail_msg("%s, %s: differs by %g", invariant_cases[k].name, spec, difference);
                worst[p] = worse_of(worst[p], difference);
                image_free(&exact);
                image_free(&invariant);
            }
        echoes_free(&echoes);
        acquisition_free(&a);
    }
    print_message("largest difference: %.1e float, %.1e double\n", worst[0], worst[1]);
}

/* An interpolator of no paper claims no paper's FLOPs. */
static void own_interpolator_claims_nothing(void **state)
{
    (void)state;
    struct acquisition a;
    struct grid grid;
    struct echoes echoes;
    random_case(1, &a, &grid, &echoes);
    struct problem problem = {&a, 1, &grid, PRECISION_FLOAT};
    const struct bp_options options = {.phase_limit = 1e-4};
    for (int claims = 0; claims < 2; claims++) {
        const struct interpolator own = {.upsample = 1, .steps = 1, .taps = 1, .in_papers = claims};
        void *plan;
        assert_int_equal(bp_plan(&problem, &own, &options, &plan), STATUS_OK);
        struct work work = bp_work(plan);
        assert_true((work.published[0].source != NULL) == claims && (work.published[1].source != NULL) == claims);
        bp_destroy(plan);
    }
    echoes_free(&echoes);
    acquisition_free(&a);
}

/* Rows on both sides of the track, where the delay is steepest between the first row and the last: a sample in two columns
   there, and none at either end. */
static void invariant_rows_cross_the_track(void **state)
{
    (void)state;
    static const struct {
        int pings, receivers, ratio, columns, rows, samples;
        double step, first_offset, r_first, r_step, speed, limit, t0;
    } cases[] = {
        {9, 4, 8, 41, 81, 4096, 0.1, 0.04, -20, 0.5, 2.5, INFINITY, 0},
        {9, 4, 8, 41, 81, 4096, 0.1, -0.14, -20.25, 0.5, -2.5, INFINITY, 0}, /* no row at 0; behind; backwards */
        {20, 1, 40, 520, 5, 2048, 0.5, 0, -10000, 5000, 2.5, INFINITY, 0},   /* tables wider than a row of sums */
        {9, 3, 8, 41, 21, 4096, 0.1, 0.04, -0.5, 0.05, 750, INFINITY, 0},
        {9, 3, 8, 41, 21, 500, 0.1, -0.3, -0.53, 0.05, -750, 0.3, 0.001},
        {1, 2, 1, 61, 11, 2000, 0.3, 0.04, -1, 0.2, 2.5, INFINITY, 0},
        {9, 3, 8, 41, 11, 2, 0.1, 0.04, -5, 1, 2.5, INFINITY, 0.003},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct acquisition a = {.sound_speed = 1500,
                                .fc = 150e3,
                                .fs = 60e3,
                                .bandwidth = 40e3,
                                .samples = cases[k].samples,
                                .receivers = cases[k].receivers,
                                .pings = cases[k].pings,
                                .compressed = true,
                                .aperture_limit = cases[k].limit};
        struct echoes echoes;
        struct random random = random_seed(8, k);
        assert_int_equal(acquisition_allocate(&a), STATUS_OK);
        for (int p = 0; p < a.pings; p++) {
            int place = cases[k].speed < 0 ? a.pings - 1 - p : p;
            a.t0[p] = cases[k].t0;
            a.tx[p].x = (place - a.pings / 2) * cases[k].ratio * cases[k].step + 0.003;
            a.velocity[p].x = cases[k].speed;
            for (int m = 0; m < a.receivers; m++)
                a.rx[p * a.receivers + m].x = a.tx[p].x + cases[k].first_offset + 0.04 * m;
        }
        assert_int_equal(echoes_allocate(&a, PRECISION_DOUBLE, &echoes), STATUS_OK);
        for (int n = 0; n < a.samples * a.receivers * a.pings; n++)
            ((double complex *)echoes.samples)[n] = random_normal(&random);
        struct grid grid = {-0.5 * cases[k].columns * cases[k].step,
                            cases[k].step,
                            cases[k].columns,
                            cases[k].r_first,
                            cases[k].r_step,
                            cases[k].rows};
        struct problem problem = {&a, 1, &grid, PRECISION_DOUBLE};
        for (size_t n = 0; n < 2 * sizeof invariant_specs / sizeof *invariant_specs; n++) {
            struct image exact, invariant;
            char spec[96];
            snprintf(spec, sizeof spec, "%sprecision=double,exact=true", invariant_specs[n / 2]);
            assert_int_equal(support_image(spec, problem, &echoes, &exact), STATUS_OK);
            snprintf(spec, sizeof spec, "%sprecision=%s,engine=invariant", invariant_specs[n / 2],
                     n % 2 ? "double" : "float");
            assert_int_equal(support_image(spec, problem, &echoes, &invariant), STATUS_OK);
            double difference = support_difference(&invariant, &exact);
            if (!(support_peak(&exact) > 0) || !(difference < (n % 2 ? 1e-10 : 3e-6)))
                fail_msg("case %zu, %s: differs by %g", k, spec, difference);
            image_free(&exact);
            image_free(&invariant);
        }
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* The engine that `auto` takes, by a plan alone. */
static const char *engine_of(const char *text, const struct problem *problem)
{
    static struct work work;
    struct spec spec;
    void *plan;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    if (spec.algorithm->plan(problem, spec.options, &plan) != STATUS_OK)
        fail_msg("%s: %s", text, status_message());
    work = spec.algorithm->work(plan);
    spec.algorithm->destroy(plan);
    spec_free(&spec);
    return work.engine;
}

/* Tables serve all pings alike: what jitters by more than they may err takes the general engine, be it t0 or a velocity. */
static void jitter_takes_the_general_engine(void **state)
{
    (void)state;
    static const struct {
        double t0, speed, across;
        const char *engine;
    } cases[] = {{0, 0, 0, "invariant"},   {1e-14, 1e-8, 1e-8, "invariant"}, {6e-9, 0, 0, "general"},
                 {2e-12, 0, 0, "general"}, {0, 5e-5, 0, "general"},          {0, 0, 5e-5, "general"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct acquisition a;
        struct grid grid;
        struct echoes echoes;
        make_invariant_case(&invariant_cases[0], &a, &grid, &echoes);
        for (int p = 1; p < a.pings; p += 2) {
            a.t0[p] += cases[k].t0;
            a.velocity[p].x += cases[k].speed;
            a.velocity[p].z += cases[k].across;
        }
        struct problem problem = {&a, 1, &grid, PRECISION_DOUBLE};
        assert_true(acquisition_is_straight(&a, NULL)); /* straight enough for range migration */
        assert_string_equal(engine_of("bp_nearest", &problem), cases[k].engine);
        struct image exact, image;
        assert_int_equal(support_image("bp_nearest:precision=double,exact=true", problem, &echoes, &exact), STATUS_OK);
        assert_int_equal(support_image("bp_nearest:precision=double", problem, &echoes, &image), STATUS_OK);
        assert_true(support_difference(&image, &exact) < 1e-6);
        image_free(&exact);
        image_free(&image);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* Tables of 30000 pings by 80000 samples are beyond 2^31 values; nobody asked for them. */
static void auto_falls_back(void **state)
{
    (void)state;
    struct acquisition a = {.sound_speed = 1500,
                            .fc = 150e3,
                            .fs = 30e3,
                            .bandwidth = 15e3,
                            .samples = 80000,
                            .receivers = 1,
                            .pings = 30000,
                            .compressed = true,
                            .aperture_limit = 0.05};
    assert_int_equal(acquisition_allocate(&a), STATUS_OK);
    for (int p = 0; p < a.pings; p++) {
        a.tx[p].x = a.rx[p].x = p * 0.04;
        a.velocity[p].x = 1;
    }
    struct grid grid = {-1, 0.02, 101, 100, 0.025, 4};
    struct problem problem = {&a, 1, &grid, PRECISION_FLOAT};
    struct spec spec;
    void *plan;
    assert_string_equal(engine_of("bp_nearest", &problem), "general");
    assert_string_equal(engine_of("bp_sinc", &problem), "general");
    assert_int_equal(spec_parse("bp_nearest:engine=invariant", &spec), STATUS_OK);
    assert_int_equal(spec.algorithm->plan(&problem, spec.options, &plan), STATUS_UNSUPPORTED);
    spec_free(&spec);
    acquisition_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(naive_sums),
        cmocka_unit_test(invariant_equals_exact),
        cmocka_unit_test(own_interpolator_claims_nothing),
        cmocka_unit_test(invariant_rows_cross_the_track),
        cmocka_unit_test(jitter_takes_the_general_engine),
        cmocka_unit_test(auto_falls_back),
    };
    return cmocka_run_group_tests_name("bp", tests, NULL, NULL);
}
