/* Factorised back projection with a tree, which small scenes are not given by default: its errors against what is
   asked for, and the pixels that it sums from records, for noise of a flat spectrum, which comes from everywhere; bits,
   instruction sets, memory. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

#include "backprojection/factorised/factorised.h"
#include "backprojection/factorised/taps.h"
#include "measure/metrics.h"
#include "tests/allocations.h"
#include "tests/support.h"

enum { PINGS = 96, SAMPLES = 240 };

/* What is seen, and how. */
enum kind { STRAIGHT, CURVED, LIMITED, SQUINTED, SIDES, ENDED, TURNED, ENDFIRE, KINDS };
static const char *const names[KINDS] = {"straight",   "curved, 4 receivers", "aperture limit", "squinted limit",
                                         "both sides", "records end",         "turned",         "along x"};
static const struct grid grids[KINDS] = {
    {-1.0, 0.05, 41, 11.0, 0.03, 61, 0},  {-1.0, 0.05, 41, 11.0, 0.03, 61, 0},  {-1.0, 0.05, 41, 11.0, 0.03, 61, 0},
    {1.0, 0.05, 41, 11.0, 0.03, 61, 0},   {-0.6, 0.1, 13, -8.0, 0.125, 129, 0}, {-1.0, 0.05, 41, 7.5, 0.03, 61, 0},
    {3.0, 0.05, 41, 10.0, 0.03, 61, 0.3}, {11.0, 0.03, 61, -1.0, 0.05, 41, 0},
};

/* Places of the sonar; records whose bins up to the band's edge are noise. */
static void make(enum kind kind, struct acquisition *a, struct echoes *echoes)
{
    struct random random = random_seed(7, 1);
    static double complex turns[SAMPLES];
    const int receivers = kind == CURVED ? 4 : 1, edge = SAMPLES / 4 - 1;
    *a = support_acquisition(PINGS, receivers, SAMPLES);
    a->fc = 60e3;
    a->fs = 20e3;
    a->bandwidth = 10e3;
    a->aperture_limit = kind == LIMITED ? 0.1 : kind == SQUINTED ? 0.15 : INFINITY;
    a->echo_squint = kind == SQUINTED ? 0.15 : 0;
    for (int p = 0; p < PINGS; p++) {
        const double bend = kind == CURVED ? 0.3 * sin(0.08 * p) : 0, deep = kind == CURVED ? 0.2 * cos(0.05 * p) : 0;
        a->t0[p] = (kind == SIDES ? 0 : 200 + (kind == CURVED ? p % 3 : 0)) / a->fs;
        a->tx[p] = (struct vector){(p - PINGS / 2) * 0.05, bend, deep};
        a->velocity[p] = (struct vector){1.5, kind == CURVED ? 0.4 : 0, 0};
        for (int m = 0; m < receivers; m++)
            a->rx[p * receivers + m] = (struct vector){a->tx[p].x + 0.05 + 0.02 * m, bend + 0.01 * m, deep};
    }
    assert_int_equal(acquisition_check(a, names[kind]), STATUS_OK);
    assert_int_equal(echoes_allocate(a, PRECISION_DOUBLE, echoes), STATUS_OK);
    for (int n = 0; n < SAMPLES; n++)
        turns[n] = cexp(2 * M_PI * I * n / SAMPLES);
    double complex *s = (double complex *)echoes->samples;
    for (int record = 0; record < PINGS * receivers; record++) {
        double complex bins[SAMPLES];
        for (int k = -edge; k <= edge; k++)
            bins[(k + SAMPLES) % SAMPLES] = random_normal(&random);
        for (int n = 0; n < SAMPLES; n++, s++) {
            *s = 0;
            for (int k = -edge; k <= edge; k++) {
                const int bin = (k + SAMPLES) % SAMPLES;
                *s += bins[bin] * turns[bin * n % SAMPLES];
            }
        }
    }
}

static double error_of(const char *spec, struct problem problem, const struct echoes *echoes, const struct image *exact)
{
    struct image image;
    if (support_image(spec, problem, echoes, &image) != STATUS_OK)
        fail_msg("%s: %s", spec, status_message());
    const double error = metrics_error(&image, exact).error;
    image_free(&image);
    return error;
}

/* Errors stay below what is asked for, and not far: by a factor of ten at most. */
static void errors_are_as_asked_for(void **state)
{
    (void)state;
    static const double errors[] = {1e-1, 1e-2, 1e-3, 1e-4};
    for (int kind = 0; kind < KINDS; kind++) {
        struct acquisition a;
        struct echoes echoes;
        struct image exact;
        make((enum kind)kind, &a, &echoes);
        const struct problem problem = {&a, 1, &grids[kind], PRECISION_DOUBLE};
        assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
        for (int stages = 1; stages <= 3; stages++)
            for (size_t k = 0; k < sizeof errors / sizeof *errors; k++) {
                char spec[120];
                snprintf(spec, sizeof spec, "bp_factorised:stages=%d,base=4,factor=4,error=%g,precision=double", stages,
                         errors[k]);
                const double error = error_of(spec, problem, &echoes, &exact);
                print_message("%s, %s: error %.2e\n", names[kind], spec, error);
                if (!(error <= errors[k] && error >= errors[k] / 30))
                    fail_msg("%s, %s: error is %g", names[kind], spec, error);
            }
        image_free(&exact);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* Pixels are read from images, and all of them where nothing prevents it. */
static void images_are_read(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        struct acquisition a;
        struct echoes echoes;
        struct factorised *plan;
        make((enum kind)kind, &a, &echoes);
        const struct problem problem = {&a, 1, &grids[kind], PRECISION_DOUBLE};
        const struct tree_settings settings = {1e-2, 4, 4, 2};
        assert_int_equal(factorised_plan(&problem, &settings, &plan), STATUS_OK);
        const double all = (double)grids[kind].x_count * grids[kind].r_count * a.pings * a.receivers,
                     direct = plan->direct / all;
        print_message("%s: %.3g of the pairs are summed from records\n", names[kind], direct);
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
    make(CURVED, &a, &echoes);
    const struct grid *grid = &grids[CURVED];
    const struct problem problem = {&a, 1, grid, PRECISION_DOUBLE};
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
                                (size_t)grid->x_count * (size_t)grid->r_count * precision_size(image.precision));
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
    make(LIMITED, &a, &echoes);
    const struct problem problem = {&a, 1, &grids[LIMITED], PRECISION_DOUBLE};
    const struct tree_settings settings = {1e-2, 4, 4, 2};
    support_image_make(&grids[LIMITED], 1, PRECISION_DOUBLE, &image);
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

/* The taps' own error, against the exponential at random frequencies of the band. */
static void taps_have_their_error(void **state)
{
    (void)state;
    static const double errors[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5};
    struct random random = random_seed(11, 1);
    for (size_t k = 0; k < sizeof errors / sizeof *errors; k++) {
        enum { DRAWS = 20000 };
        struct polar_taps taps;
        double sum = 0;
        assert_int_equal(polar_taps_choose(errors[k], 1.1, &taps), STATUS_OK);
        for (int n = 0; n < DRAWS; n++) {
            const double nu = (random_uniform(&random) - 0.5) / taps.oversampling, u = random_uniform(&random) - 0.5;
            double complex value = 0;
            for (int t = 0; t < taps.taps; t++) {
                double weight = 0;
                for (int m = taps.branches - 1; m >= 0; m--)
                    weight = weight * u + taps.coefficients[m * taps.taps + t];
                value += weight * cexp(2 * M_PI * I * nu * (t - 0.5 * (taps.taps - 1)));
            }
            const double off = cabs(value - cexp(2 * M_PI * I * nu * u));
            sum += off * off / DRAWS;
        }
        print_message("%d taps, %.2f times oversampled, asked for %g: error %.2e, by the law %.2e\n", taps.taps,
                      taps.oversampling, errors[k], sqrt(sum), taps.error);
        assert_close(sqrt(sum) / taps.error, 1, 0.15);
        assert_true(taps.error <= errors[k] && taps.error > 0.5 * errors[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_are_as_asked_for), cmocka_unit_test(images_are_read),
        cmocka_unit_test(bits_and_precisions),     cmocka_unit_test(memory),
        cmocka_unit_test(taps_have_their_error),
    };
    return cmocka_run_group_tests_name("conformance_factorised", tests, NULL, NULL);
}
