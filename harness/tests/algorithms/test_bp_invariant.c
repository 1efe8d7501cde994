/* The invariant engine against the exact path: odd grids and tracks, rows on both sides of the track, when it is
   taken. */
#include <math.h>
#include <omp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "backprojection/invariant/invariant_plan.h"
#include "contract/delay.h"
#include "common/isa.h"
#include "scene/random.h"
#include "tests/support.h"

/* Grids and tracks of the invariant engine: odd sizes, one receiver, negative offsets, grids that begin off the ping
   raster, one ping, a sonar that sails backwards, records that end inside the image, pixels behind the track. */
static const struct invariant_case {
    const char *name;
    int pings, receivers, ratio, columns, rows;
    double step, first_offset, x_first, r_first, speed, limit;
    int samples;
    bool backwards;
    double r_step; /* m; 0: 0.025 */
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
    {"many residues", 31, 2, 40, 403, 3, 0.02, 0.04, -3.1, 20.1, 2.5, 0.3, 400, false}, /* several groups of tables */
    {"slanting", 31, 2, 40, 403, 3, 0.02, 0.04, -3.1, 4.1, 2.5, INFINITY, 700, false},  /* a sample in two columns */
    {"coarse grid", 13, 2, 9, 150, 5, 0.07, 0.04, -3.1, 14.1, 2.5, 0.6, 400, false},
    {"coarser grid", 13, 2, 9, 150, 5, 0.3, 0.04, -3.1, 14.1, 2.5, 0.6, 400, false},
    {"one ping, very many columns", 1, 1, 1, 70001, 1, 1e-4, 0.04, -3.1, 20.1, 2.5, INFINITY, 400, false},
    {"long records", 31, 1, 3, 97, 3, 0.02, 0.04, -1.2, 20.0, 2.5, INFINITY, 6000, false,
     70}, /* all of them are read: fine samples in several passes */
};

static void make_invariant_case(const struct invariant_case *c, struct acquisition *a, struct grid *grid,
                                struct echoes *echoes)
{
    struct random random = random_seed(7, (uint64_t)c->columns);
    double spacing = c->ratio * c->step;
    *a = support_acquisition(c->pings, c->receivers, c->samples);
    a->aperture_limit = c->limit;
    for (int p = 0; p < a->pings; p++) {
        int place = c->backwards ? a->pings - 1 - p : p;
        a->t0[p] = fmax(0, floor(2 * c->r_first / 1500 * 30e3 - 20)) / 30e3;
        a->tx[p].x = (place - a->pings / 2) * spacing;
        a->velocity[p].x = c->speed;
        for (int m = 0; m < a->receivers; m++)
            a->rx[p * a->receivers + m].x = a->tx[p].x + c->first_offset + 0.04 * m;
    }
    *grid = (struct grid){c->x_first, c->step, c->columns, c->r_first, c->r_step > 0 ? c->r_step : 0.025, c->rows};
    support_noise(a, &random, echoes);
}

static const char *const invariant_specs[] = {
    "bp_nearest:",
    "bp_linear:beta=0,",
    "bp_linear:beta=2,",
    "bp_linear:beta=8,",
    "bp_linear:beta=8,preemphasis=on,",
    "bp_sinc:taps=8,",
    "bp_sinc:taps=6,window=kaiser,",
    "bp_zeropad:factor=8,",
    "bp_zeropad:factor=64,",
    "bp_farrow:degree=2,",
    "bp_farrow:degree=5,",
    "bp_farrow:degree=7,factor=2,",
    "bp_fitted:taps=2,factor=2,",
    "bp_fitted:taps=6,",
    "bp_fitted:taps=8,factor=4,",
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
        struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
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

/* The last of the cases above does take several passes, in which entries of other passes are left out. */
static void long_records_take_several_passes(void **state)
{
    (void)state;
    const size_t last = sizeof invariant_cases / sizeof *invariant_cases - 1;
    for (int precision = 0; precision < 2; precision++) {
        struct acquisition a;
        struct grid grid;
        struct echoes echoes;
        struct spec spec;
        void *plan;
        make_invariant_case(&invariant_cases[last], &a, &grid, &echoes);
        struct problem problem = problem_make(&a, 1, &grid, (enum precision)precision);
        assert_int_equal(spec_parse("bp_zeropad:factor=64,engine=invariant", &spec), STATUS_OK);
        assert_int_equal(algorithm_plan(spec.algorithm, &problem, spec.options, &plan), STATUS_OK);
        const struct invariant *in = ((const struct bp *)plan)->state;
        assert_true(in->passes > 1);
        spec.algorithm->destroy(plan);
        spec_free(&spec);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* Rows on both sides of the track, where the delay is steepest between the first row and the last: a sample in two
   columns there, and none at either end. */
static const struct crossing {
    int pings, receivers, ratio, columns, rows, samples;
    double step, first_offset, r_first, r_step, speed, limit, t0;
} crossings[] = {
    {9, 4, 8, 41, 81, 4096, 0.1, 0.04, -20, 0.5, 2.5, INFINITY, 0},
    {9, 4, 8, 41, 81, 4096, 0.1, -0.14, -20.25, 0.5, -2.5, INFINITY, 0}, /* no row at 0; behind; backwards */
    {20, 1, 40, 520, 5, 2048, 0.5, 0, -10000, 5000, 2.5, INFINITY, 0},   /* tables wider than a row of sums */
    {9, 3, 8, 41, 21, 4096, 0.1, 0.04, -0.5, 0.05, 750, INFINITY, 0},
    {9, 3, 8, 41, 21, 500, 0.1, -0.3, -0.53, 0.05, -750, 0.3, 0.001},
    {1, 2, 1, 61, 11, 2000, 0.3, 0.04, -1, 0.2, 2.5, INFINITY, 0},
    {9, 3, 8, 41, 11, 2, 0.1, 0.04, -5, 1, 2.5, INFINITY, 0.003},
};

static void make_crossing(const struct crossing *c, struct acquisition *a, struct grid *grid, struct echoes *echoes)
{
    struct random random = random_seed(8, (uint64_t)(c - crossings));
    *a = support_acquisition(c->pings, c->receivers, c->samples);
    a->fs = 60e3;
    a->bandwidth = 40e3;
    a->aperture_limit = c->limit;
    for (int p = 0; p < a->pings; p++) {
        int place = c->speed < 0 ? a->pings - 1 - p : p;
        a->t0[p] = c->t0;
        a->tx[p].x = (place - a->pings / 2) * c->ratio * c->step + 0.003;
        a->velocity[p].x = c->speed;
        for (int m = 0; m < a->receivers; m++)
            a->rx[p * a->receivers + m].x = a->tx[p].x + c->first_offset + 0.04 * m;
    }
    *grid = (struct grid){-0.5 * c->columns * c->step, c->step, c->columns, c->r_first, c->r_step, c->rows};
    support_noise(a, &random, echoes);
}

static void rows_cross_the_track(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof crossings / sizeof *crossings; k++) {
        struct acquisition a;
        struct grid grid;
        struct echoes echoes;
        make_crossing(&crossings[k], &a, &grid, &echoes);
        struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
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

static void weights_flat(const struct interpolator *in, double fraction, double *w)
{
    (void)in;
    for (int t = 0; t < 8; t++)
        w[t] = 1 + fraction;
}

/* Residues are summed together whose samples of one shift fit the table of weights; a plan that took more of them,
   where the delay is steep, would end the program and not write beyond the table. */
static void spread_is_asserted(void **state)
{
    (void)state;
    struct acquisition a;
    struct grid grid;
    struct echoes echoes;
    make_crossing(&crossings[0], &a, &grid, &echoes);
    const struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
    const struct interpolator kernel = {.upsample = 1, .taps = 8, .first = -3, .weights = weights_flat};
    const struct bp_options options = {.engine = BP_ENGINE_INVARIANT, .phase_limit = 1e-4};
    for (int wrong = 0; wrong < 2; wrong++) {
        int ended;
        fflush(NULL);
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) { /* of the parent's threads it has one */
            struct image image;
            struct stages stages;
            void *plan;
            struct rlimit no_core = {0, 0};
            setrlimit(RLIMIT_CORE, &no_core);
            omp_set_num_threads(1);
            signal(SIGABRT, SIG_DFL);
            if (bp_plan(&problem, &kernel, &options, &plan) != STATUS_OK
                || image_allocate(1, &grid, PRECISION_DOUBLE, &image) != STATUS_OK)
                _exit(2);
            const struct bp *bp = plan;
            struct invariant *invariant = bp->state;
            if (wrong)
                invariant->rasters[0].together = BP_TOGETHER;
            else if (invariant->rasters[0].together >= BP_TOGETHER)
                _exit(3);
            stages_begin(&stages);
            bp_execute(plan, &echoes, &image, &stages);
            _exit(0);
        }
        assert_int_equal(waitpid(child, &ended, 0), child);
        if (wrong)
            assert_true(WIFSIGNALED(ended) && WTERMSIG(ended) == SIGABRT);
        else
            assert_true(WIFEXITED(ended) && WEXITSTATUS(ended) == 0);
    }
    echoes_free(&echoes);
    acquisition_free(&a);
}

/* The engine that `auto` takes, by a plan alone. */
static const char *engine_of(const char *text, const struct problem *problem)
{
    static struct work work;
    struct spec spec;
    void *plan;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    if (algorithm_plan(spec.algorithm, problem, spec.options, &plan) != STATUS_OK)
        fail_msg("%s: %s", text, status_message());
    work = spec.algorithm->work(plan);
    spec.algorithm->destroy(plan);
    spec_free(&spec);
    return work.engine;
}

/* Tables serve all pings alike: what jitters by more than they may err takes the general engine, be it t0 or a
   velocity. */
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
        struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        assert_true(acquisition_is_straight(&a, NULL)); /* straight enough for range migration */
        assert_string_equal(engine_of("bp_nearest", &problem), cases[k].engine);
        struct image exact, image;
        assert_int_equal(support_image("bp_nearest:precision=double,exact=true", problem, &echoes, &exact), STATUS_OK);
        assert_int_equal(support_image("bp_nearest:precision=double", problem, &echoes, &image), STATUS_OK);
        assert_up_to(support_difference(&image, &exact), 1e-6, "bp_nearest against exact delays, case %zu", k);
        image_free(&exact);
        image_free(&image);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* Tables of 30000 pings by 76800 samples that rows read are beyond 2^31 values; nobody asked for them. */
static void auto_falls_back(void **state)
{
    (void)state;
    struct acquisition a = support_acquisition(30000, 1, 80000);
    a.aperture_limit = 0.05;
    for (int p = 0; p < a.pings; p++) {
        a.tx[p].x = a.rx[p].x = p * 0.04;
        a.velocity[p].x = 1;
    }
    struct grid grid = {-1, 0.02, 101, 20, 640, 4};
    struct problem problem = problem_make(&a, 1, &grid, PRECISION_FLOAT);
    struct spec spec;
    void *plan;
    assert_string_equal(engine_of("bp_nearest", &problem), "general");
    assert_string_equal(engine_of("bp_sinc", &problem), "general");
    assert_int_equal(spec_parse("bp_nearest:engine=invariant", &spec), STATUS_OK);
    assert_int_equal(algorithm_plan(spec.algorithm, &problem, spec.options, &plan), STATUS_UNSUPPORTED);
    spec_free(&spec);
    acquisition_free(&a);
}

static double uniform(struct random *random, double low, double high)
{
    return low + (high - low) * random_uniform(random);
}

/* A polynomial through exact delays of a piece as long as it may be, at all speeds, offsets and distances: it errs
   by no more than what its length was asked for, and by not much less where the track lies nearest. */
static void pieces_keep_their_error(void **state)
{
    (void)state;
    const double c = 1500, error = 1e-6;
    struct random random = random_seed(20, 0);
    struct piece_fit fit;
    double largest = 0;
    piece_fit_make(&fit);
    for (int n = 0; n < 300; n++) {
        const double mach = n % 3 ? uniform(&random, 0, n % 3 == 1 ? 0.125 : 2e-3) : 0, r = uniform(&random, 1, 300);
        const double offset = n % 2 ? uniform(&random, -2, 2) : 0, middle = n % 4 < 2 ? 0 : uniform(&random, -3, 3) * r;
        const double half = piece_half(piece_reach(mach, error), r);
        double q[PIECE_POWERS], power[PIECE_POWERS] = {0}, worst = 0;
#define PATH(u)                                                                                                        \
    (c                                                                                                                 \
     * delay_exact((struct vector){(u), 0, 0}, (struct vector){(u) + offset, 0, 0}, (struct vector){mach * c, 0, 0},   \
                   (struct vector){0, r, 0}, c))
        for (int k = 0; k < PIECE_POWERS; k++)
            q[k] = PATH(middle + half * fit.node[k]);
        for (int k = 0; k < PIECE_POWERS; k++)
            for (int m = 0; m < PIECE_POWERS; m++)
                power[m] += (q[k] - q[0]) * fit.power[k][m];
        for (int i = -200; i <= 200; i++) {
            double value = 0;
            for (int m = PIECE_POWERS - 1; m >= 0; m--)
                value = value * (i / 200.0) + power[m];
            worst = worse_of(worst, fabs(value + q[0] - PATH(middle + half * i / 200)));
        }
#undef PATH
        if (!(worst <= error))
            fail_msg("case %d, mach %g, r %g, offset %g, at %g: errs by %g m of %g", n, mach, r, offset, middle, worst,
                     error);
        largest = worse_of(largest, worst);
    }
    print_message("largest error over the bound: %.2f\n", largest / error);
    assert_true(largest > 0.2 * error);
}

/* Polynomials do stand for the delays of a row, and exact=true keeps the roots: else nothing above would test them. */
static void exact_keeps_the_roots(void **state)
{
    (void)state;
    struct acquisition a;
    struct grid grid;
    struct echoes echoes;
    double difference[2];
    make_invariant_case(&invariant_cases[0], &a, &grid, &echoes);
    struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
    for (int n = 0; n < 2; n++) {
        struct image image, roots;
        assert_int_equal(
            support_image("bp_sinc:precision=double,engine=invariant,exact=true", problem, &echoes, &roots), STATUS_OK);
        assert_int_equal(support_image(n ? "bp_sinc:precision=double,engine=invariant,exact=true"
                                         : "bp_sinc:precision=double,engine=invariant,phase_limit=1e-5",
                                       problem, &echoes, &image),
                         STATUS_OK);
        difference[n] = support_difference(&image, &roots);
        image_free(&image);
        image_free(&roots);
    }
    print_message("by polynomials: %.1e; by roots: %.1e\n", difference[0], difference[1]);
    assert_true(difference[1] == 0);
    if (isa_choose() > ISA_BASELINE)
        assert_true(difference[0] > 0 && difference[0] < 1e-11);
    echoes_free(&echoes);
    acquisition_free(&a);
}

/* A spacing that misses whole steps by a hair: the cure says the step that tables take, and the spacing. */
static void steps_are_told_that_tables_take(void **state)
{
    (void)state;
    struct acquisition a = support_acquisition(18, 1, 400);
    struct grid grid = {-0.6, 0.02, 61, 20, 0.025, 9, 0};
    const struct problem problem = problem_make(&a, 1, &grid, PRECISION_FLOAT);
    double step = 0, spacing = 0;
    for (int p = 0; p < a.pings; p++)
        a.tx[p].x = a.rx[p].x = p * 0.1600007;
    const struct condition off = invariant_condition(&problem, SEVERITY_INFORM);
    assert_false(condition_holds(&off));
    const char *cure = strstr(off.cure, "steps of");
    assert_non_null(cure);
    assert_int_equal(sscanf(cure, "steps of %lf m in place of 0.02 m, or pings %lf m apart", &step, &spacing), 2);
    assert_close(spacing, 0.16, 1e-15);
    grid.x_step = step;
    const struct condition even = invariant_condition(&problem, SEVERITY_INFORM);
    assert_true(condition_holds(&even));
    acquisition_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(invariant_equals_exact),
        cmocka_unit_test(long_records_take_several_passes),
        cmocka_unit_test(rows_cross_the_track),
        cmocka_unit_test(spread_is_asserted),
        cmocka_unit_test(pieces_keep_their_error),
        cmocka_unit_test(exact_keeps_the_roots),
        cmocka_unit_test(jitter_takes_the_general_engine),
        cmocka_unit_test(auto_falls_back),
        cmocka_unit_test(steps_are_told_that_tables_take),
    };
    return cmocka_run_group_tests_name("bp_invariant", tests, NULL, NULL);
}
