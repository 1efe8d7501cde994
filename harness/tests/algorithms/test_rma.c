/* Range migration against numbers of an independent implementation, against exact images over whole swaths, and
   against itself by other ways of computing. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fftw3.h>

#include "contract/delay.h"
#include "metrics/metrics.h"
#include "range_migration/rma_engine.h"
#include "scene/simulate.h"
#include "tests/algorithms/rma_numbers.h"
#include "tests/algorithms/rma_scenes.h"

static const double speed = RMA_SPEED, pri = 0.44;

/* ---- the five scenes of the independent implementation ---- */

/* A chirp centred on the delay, sampled in time, compressed in frequency on the band alone. */
static void compress_lfm(const struct rma_numbers *n, struct scene *scene, struct echoes *echoes)
{
    const struct acquisition *a = &scene->acquisition;
    const double duration = 5e-3, rate = a->bandwidth / duration;
    const int count = a->samples;
    double complex *replica = fftw_malloc((size_t)count * sizeof *replica), *s = (double complex *)echoes->samples;
    for (int k = 0; k < count; k++) {
        double t = (k < (count + 1) / 2 ? k : k - count) / a->fs;
        replica[k] = fabs(t) <= duration / 2 ? cexp(I * M_PI * rate * t * t) : 0;
    }
    fftw_plan transform = fftw_plan_dft_1d(count, replica, replica, FFTW_FORWARD, FFTW_ESTIMATE);
    fftw_execute(transform);
    fftw_destroy_plan(transform);
    double energy = 0;
    for (int k = 0; k < count; k++)
        if (k <= n->bins / 2 || k >= count - n->bins / 2)
            energy += creal(replica[k]) * creal(replica[k]) + cimag(replica[k]) * cimag(replica[k]);
    for (int p = 0; p < a->pings * a->receivers; p++) {
        double complex *record = s + (size_t)p * (size_t)count;
        fftw_plan forward = fftw_plan_dft_1d(count, record, record, FFTW_FORWARD, FFTW_ESTIMATE);
        fftw_plan inverse = fftw_plan_dft_1d(count, record, record, FFTW_BACKWARD, FFTW_ESTIMATE);
        memset(record, 0, (size_t)count * sizeof *record);
        for (int t = 0; t < scene->target_count; t++) {
            struct vector at = {scene->targets[t].x, scene->targets[t].r, 0};
            double tau = delay_exact(a->tx[p / a->receivers], a->rx[p], a->velocity[0], at, a->sound_speed);
            double weight = support_beam_weight(scene, p / a->receivers, p % a->receivers, at, tau, a->fc);
            for (int k = 0; k < count; k++) {
                double u = a->t0[0] + k / a->fs - tau;
                if (fabs(u) <= duration / 2)
                    record[k] +=
                        weight * scene->targets[t].amplitude * cexp(I * M_PI * (rate * u * u - 2 * a->fc * tau));
            }
        }
        fftw_execute(forward);
        for (int k = 0; k < count; k++)
            record[k] *= k <= n->bins / 2 || k >= count - n->bins / 2 ? conj(replica[k]) / energy : 0;
        fftw_execute(inverse);
        fftw_destroy_plan(forward);
        fftw_destroy_plan(inverse);
    }
    fftw_free(replica);
}

static void make_numbers(const struct rma_numbers *n, struct scene *scene, struct echoes *echoes)
{
    make_scene(&(struct rma_track){n->pings, n->receivers, n->samples, n->samples * n->df, n->t0, speed * n->t_first,
                                   speed * pri, n->rx_length},
               scene);
    scene->acquisition.tx_length = n->tx_length;
    scene->beam.limit = n->limit;
    scene->beam.per_frequency = n->per_frequency;
    scene->target_count = n->targets;
    scene->targets = calloc((size_t)n->targets, sizeof *scene->targets);
    for (int t = 0; t < n->targets; t++)
        scene->targets[t] = (struct target){n->target[t].x, n->target[t].r, n->target[t].re + I * n->target[t].im};
    if (n->lfm) {
        assert_int_equal(echoes_allocate(&scene->acquisition, PRECISION_DOUBLE, echoes), STATUS_OK);
        compress_lfm(n, scene, echoes);
    } else {
        assert_int_equal(scene_simulate(scene, echoes), STATUS_OK);
    }
}

/* The azimuth slice through the first target of a scene of numbers, 401 points to either side: a patch of its own. */
enum { HALF = 400, COUNT = 2 * HALF + 1, IMAGE = 0, SLICE = 1 };

static struct slice_metrics slice_of(const struct image *image, double step)
{
    double power[COUNT];
    for (int j = 0; j < COUNT; j++)
        power[j] = pow(cabs(image_pixel(image, SLICE, 0, j)), 2);
    return metrics_of_power(power, COUNT, -HALF * step, step, 0);
}

/* Errors against back projection, azimuth offset and PSLR are those of the independent range migrations. */
static void independent_numbers(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof rma_numbers / sizeof *rma_numbers; k++) {
        const struct rma_numbers *n = &rma_numbers[k];
        struct scene scene;
        struct echoes echoes;
        struct image exact, image;
        struct grid patches[2] = {
            [IMAGE] = {n->x_first, n->x_step, 24, n->r_first, n->r_step, 16},
            [SLICE] = {n->target[0].x - HALF * n->slice_step, n->slice_step, COUNT, n->target[0].r, 1, 1}};
        make_numbers(n, &scene, &echoes);
        struct problem problem = problem_make(&scene.acquisition, 1, patches, PRECISION_DOUBLE), both = problem;
        both.patch_count = 2;
        form("reference:precision=double", problem, &echoes, &exact);
        double worst = 0, peak = support_peak(&exact);
        for (int j = 0; j < 24; j++)
            for (int i = 0; i < 16; i++) {
                double complex value = n->bp[2 * (j * 16 + i)] + I * n->bp[2 * (j * 16 + i) + 1];
                worst = worse_of(worst, cabs(image_pixel(&exact, 0, i, j) - value) / peak);
            }
        print_message("%s: back projection within %.1e of the peak\n", n->name, worst);
        assert_up_to(worst, 1e-4, "%s: back projection, of the peak", n->name);
        for (int m = 0; m < 5; m++) {
            char spec[120];
            snprintf(spec, sizeof spec, "%sblocks=1,stolt=16,precision=double", n->method[m].spec);
            form(spec, both, &echoes, &image);
            double error = patch_error(&image, &exact, IMAGE);
            struct slice_metrics slice = slice_of(&image, n->slice_step);
            double offset = slice.position_error_m + n->target[0].x - n->method[m].x_peak;
            double pslr = slice.pslr_db[DEFINITION_NULL] - n->method[m].pslr_db;
            print_message("    %-66s error %.5f (%.5f), azimuth %+.4f mm, PSLR %+.4f dB\n", spec, error,
                          n->method[m].l2, 1e3 * offset, pslr);
            assert_up_to(fabs(error / n->method[m].l2 - 1), 0.2, "%s, %s: error, relatively off", n->name, spec);
            assert_up_to(fabs(offset), 5e-5, "%s, %s: azimuth (m)", n->name, spec);
            assert_up_to(fabs(pslr), 0.03, "%s, %s: PSLR (dB)", n->name, spec);
            image_free(&image);
        }
        image_free(&exact);
        echoes_free(&echoes);
        free_scene(&scene);
    }
}

/* ---- the whole chain ---- */

enum { TARGETS = 6 };

/* A swath of 20 m, targets off the blocks' centres. */
static const double swath_targets[TARGETS] = {91.3, 94.1, 97.9, 101.2, 104.7, 108.6};
static const struct grid swath = {-0.14, 0.02, 15, 90, 0.04, 501};

static void make_swath(struct scene *scene, struct echoes *echoes)
{
    make_scene(&(struct rma_track){14, 66, 1280, 24e3, 80 / 750.0, -6.5 * speed * pri, speed * pri, 0.04}, scene);
    add_targets(scene, TARGETS, swath_targets);
    assert_int_equal(scene_simulate(scene, echoes), STATUS_OK);
}

/* Blocks of 5 m that blend and eight taps: within 1 % of the exact image, and far better by the cubic blend. */
static void short_swath(void **state)
{
    (void)state;
    struct scene scene;
    struct echoes echoes;
    struct image exact;
    make_swath(&scene, &echoes);
    struct problem problem = problem_make(&scene.acquisition, 1, &swath, PRECISION_DOUBLE);
    form("reference:precision=double", problem, &echoes, &exact);
    assert_true(swath_error("rma_lbf:blocks=5,spacing=uniform", problem, &echoes, &exact) <= 0.01);
    assert_true(swath_error("rma_numeric:blocks=5,spacing=uniform", problem, &echoes, &exact) <= 0.01);
    assert_true(swath_error("rma_lbf:blocks=4,spacing=uniform", problem, &echoes, &exact) <= 0.01);
    assert_true(swath_error("rma_lbf:blocks=5", problem, &echoes, &exact) <= 0.002);
    /* What makes it so good: without any of it the error is several times larger. */
    assert_true(swath_error("rma_lbf:blocks=4,spacing=uniform,blend=off", problem, &echoes, &exact) > 0.02);
    assert_true(swath_error("rma_lbf:blocks=1", problem, &echoes, &exact) > 0.05);
    assert_true(swath_error("rma_pca:blocks=4", problem, &echoes, &exact) > 0.01);
    image_free(&exact);
    echoes_free(&echoes);
    free_scene(&scene);
}

/* The same pixels on columns that one transform gives, fewer or more than wavenumbers, and on columns that take a
   chirp (11 divides their number). */
static void columns(void **state)
{
    (void)state;
    static const double targets[] = {36.4};
    static const int parts[] = {1, 5, 10, 11}; /* of 0.1 m: columns */
    struct grid grids[4];
    struct scene scene;
    struct echoes echoes;
    struct image image;
    make_scene(&(struct rma_track){8, 40, 600, 24e3, 0.044, -2.8, 0.8, 0.04}, &scene);
    add_targets(&scene, 1, targets);
    assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
    for (int k = 0; k < 4; k++)
        grids[k] = (struct grid){-0.1, 0.1 / parts[k], 2 * parts[k] + 1, 36.3, 0.1, 3};
    form("rma_lbf:precision=double", problem_make(&scene.acquisition, 4, grids, PRECISION_DOUBLE), &echoes, &image);
    for (int k = 1; k < 4; k++)
        for (int n = 0; n < 9; n++) {
            double complex value = image_pixel(&image, k, n / 3, n % 3 * parts[k]);
            assert_true(cabs(value - image_pixel(&image, 0, n / 3, n % 3)) < 1e-9 * support_peak(&image));
        }
    image_free(&image);
    echoes_free(&echoes);
    free_scene(&scene);
}

static void recurrences(void **state)
{
    (void)state;
    static const char *const methods[] = {"lbf", "pca", "wu", "numeric"};
    static const struct grid grid = {-0.1, 0.05, 5, 34.5, 0.25, 5};
    struct scene scene;
    struct echoes echoes;
    const double r[] = {35.1};
    make_scene(&(struct rma_track){3, 37, 300, 24e3, 30 / 750.0, -0.74, 0.74, 0.04},
               &scene); /* two whole groups and a part of one */
    add_targets(&scene, 1, r);
    assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
    struct problem problem = problem_make(&scene.acquisition, 1, &grid, PRECISION_DOUBLE);
    for (int k = 0; k < 4; k++) {
        char spec[100], other[120];
        struct image image;
        snprintf(spec, sizeof spec, "rma_%s:blocks=2,precision=double", methods[k]);
        snprintf(other, sizeof other, "%s,phases=libm", spec);
        form(other, problem, &echoes, &image);
        assert_up_to(swath_error(spec, problem, &echoes, &image), 1e-5, "%s against libm", spec);
        image_free(&image);
    }
    echoes_free(&echoes);
    free_scene(&scene);
}

/* 40 to 300 m in 40 blocks equally spaced in 1/r: 2 % from 80 to 280 m; and in as many as Eq. (13) asks for at pi/4,
   where the phases inside a block differ so much that the blend's own error shows. More blocks converge. The array is
   as long as LBF21's, its elements are twice as long to save time. */
static void long_swath(void **state)
{
    (void)state;
    static const double targets[] = {83, 131, 197, 277};
    struct scene scene;
    struct echoes echoes;
    struct image exact, image;
    struct grid patches[6] = {{0, 1, 1, 40, 1, 1}, {0, 1, 1, 300, 1, 1}};
    make_scene(&(struct rma_track){16, 33, 12800, 24e3, 0.032, -7.5 * speed * pri, speed * pri, 0.08},
               &scene); /* 24 to 424 m */
    scene.acquisition.tx_length = 0.16;
    add_targets(&scene, 4, targets);
    assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
    for (int t = 0; t < 4; t++)
        patches[2 + t] = (struct grid){scene.targets[t].x - 0.16, 0.02, 17, targets[t] - 0.15, 0.03, 11};
    struct problem problem = problem_make(&scene.acquisition, 6, patches, PRECISION_DOUBLE);
    form("reference:precision=double", problem, &echoes, &exact);
    static const struct {
        const char *spec;
        double bound;
    } runs[] = {{"rma_lbf", 0.03}, {"rma_lbf:blocks=40", 0.02}, {"rma_lbf:blocks=160", 0.002}};
    for (size_t k = 0; k < sizeof runs / sizeof *runs; k++) {
        form(runs[k].spec, problem, &echoes, &image);
        for (int t = 0; t < 4; t++) {
            double error = patch_error(&image, &exact, 2 + t);
            print_message("    %s at %g m: %.4f\n", runs[k].spec, targets[t], error);
            assert_up_to(error, runs[k].bound, "error of %s at %g m", runs[k].spec, targets[t]);
        }
        image_free(&image);
    }
    image_free(&exact);
    echoes_free(&echoes);
    free_scene(&scene);
}

/* Eq. (13) at pi/4: 16 blocks in 1/r against some 118 of equal width, from 40 to 300 m. */
static void block_counts(void **state)
{
    (void)state;
    struct scene scene;
    struct grid patches[2] = {{0, 1, 1, 40, 1, 1}, {0, 1, 1, 300, 1, 1}};
    make_scene(&(struct rma_track){2, 66, 12800, 24e3, 0.032, 0, speed * pri, 0.04}, &scene);
    struct problem problem = problem_make(&scene.acquisition, 2, patches, PRECISION_DOUBLE);
    struct work inverse = support_work("rma_lbf:blend=off", problem);
    struct work uniform = support_work("rma_lbf:blend=off,spacing=uniform", problem);
    print_message("%s, %s; skipped: %s\n", inverse.engine, uniform.engine, inverse.skipped);
    assert_string_equal(inverse.engine, "2 of 16 blocks");
    int needed, count;
    assert_int_equal(sscanf(uniform.engine, "%d of %d", &needed, &count), 2);
    assert_in_range(count, 112, 124);
    assert_non_null(strstr(inverse.skipped, "14 blocks without rows"));
    assert_true(inverse.published[1].flops > 5 * inverse.published[0].flops);
    free_scene(&scene);
}

/* As LBF21 prints its chain, the conversion takes half of psi_i away and nothing else (Eqs. (11), (12)); focusing and
   the turn of rows take psi (Eqs. (4), (15) to (17)). */
static void printed_chain(void **state)
{
    (void)state;
    struct scene scene;
    struct grid grid = {0, 1, 1, 40, 1, 80, 0};
    struct rma *rma;
    make_scene(&(struct rma_track){2, 66, 12800, 24e3, 0.032, 0, speed * pri, 0.04}, &scene);
    struct problem problem = problem_make(&scene.acquisition, 1, &grid, PRECISION_DOUBLE);
    const struct rma_options options = {.blocks = 16, .variant = RMA_PRINTED};
    const struct rma_method method = rma_choose(algorithm_find("rma_lbf")->method, &options);
    assert_int_equal(rma_count(&problem, &method, &options, &rma), STATUS_OK);
    const double c = rma->setting.sound_speed, fc = rma->setting.fc, v = speed;
    double worst = 0;
    for (int n = 0; n < 3 * 3 * 3 * 3; n++) {
        const int receiver = 32 * (n / 27);
        const double r = 40 + 130 * (n / 9 % 3), nu = 12.5 * (n / 3 % 3 - 1), f = fc + 10e3 * (n % 3 - 1);
        const double s = sqrt(f * f - c * nu / 2 * (c * nu / 2)), cosine = sqrt(1 - pow(c * nu / (2 * fc), 2));
        const double d = rma->offset[receiver], delta = d + 2 * r * v / (c * cosine);
        const double psi = -2 * M_PI * v * nu * r / (c * cosine) + 4 * M_PI / c * r * s;
        const double psi_i = -2 * M_PI * nu * d + M_PI / c * delta * delta * s * s * s / (f * f * r);
        const double bulk = r * spectrum_monostatic(&rma->monostatic, f, nu) / (2 * M_PI) + r * rma_offset(rma, nu);
        worst = worse_of(worst, fabs(2 * M_PI * rma_correction(rma, receiver, r, f, nu) - psi_i / 2));
        worst = worse_of(worst, fabs(2 * M_PI * bulk - psi));
    }
    print_message("printed chain: %.1e rad\n", worst);
    assert_true(worst < 1e-9); /* rounding of 4e5 rad */
    rma_destroy(rma);
    free_scene(&scene);
}

/* ---- odd geometries ---- */

/* Error against the exact image of a small scene with one target. */
static double small_error(const char *spec, struct scene *scene, double half_x)
{
    struct echoes echoes;
    struct image exact;
    const double r[] = {40.2};
    struct grid grid = {-half_x, 0.02, (int)(half_x / 0.01) + 1, 39.9, 0.05, 13};
    add_targets(scene, 1, r);
    assert_int_equal(scene_simulate(scene, &echoes), STATUS_OK);
    struct problem problem = problem_make(&scene->acquisition, 1, &grid, PRECISION_DOUBLE);
    form("reference:precision=double", problem, &echoes, &exact);
    double error = swath_error(spec, problem, &echoes, &exact);
    image_free(&exact);
    echoes_free(&echoes);
    return error;
}

/* v PRI != M d/2: the ghosts at k lambda r/(2 v PRI) are the exact image's own. */
static void ghosts(void **state)
{
    (void)state;
    struct scene scene;
    make_scene(&(struct rma_track){16, 20, 400, 24e3, 0.048, -3.75, 0.5, 0.04}, &scene);
    assert_true(small_error("rma_lbf:precision=double", &scene, 0.6) < 0.012);
    struct echoes echoes;
    struct image image;
    double away = 0.01 * 40.2 / (2 * 0.5);
    struct grid grid = {scene.targets[0].x, away, 2, 40.2, 1, 1};
    struct problem problem = problem_make(&scene.acquisition, 1, &grid, PRECISION_DOUBLE);
    assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
    form("rma_lbf:precision=double", problem, &echoes, &image);
    double ghost = cabs(image_pixel(&image, 0, 0, 1)) / cabs(image_pixel(&image, 0, 0, 0));
    print_message("    ghost %.1f dB at %.2f m\n", 20 * log10(ghost), away);
    assert_true(ghost > 0.05);
    image_free(&image);
    echoes_free(&echoes);
    free_scene(&scene);
}

/* A receiver at the transmitter leaves nothing to convert; the record says so. */
static void one_receiver(void **state)
{
    (void)state;
    struct scene scene;
    make_scene(&(struct rma_track){300, 1, 400, 24e3, 0.048, -3.7, 0.025, 0.04}, &scene);
    assert_true(small_error("rma_lbf:precision=double", &scene, 0.2) < 0.01);
    struct grid grid = {0, 0.02, 3, 40, 0.5, 9};
    struct problem problem = problem_make(&scene.acquisition, 1, &grid, PRECISION_FLOAT);
    assert_non_null(strstr(support_work("rma_lbf", problem).skipped, "conversion"));
    free_scene(&scene);
}

/* Unevenly spaced receivers, pings in falling order, a platform that stops or sails backwards. */
static void odd_tracks(void **state)
{
    (void)state;
    static const char *const specs[] = {"rma_lbf:precision=double", "rma_delay:precision=double"};
    for (int odd = 0; odd < 8; odd++) {
        struct scene scene;
        make_scene(
            &(struct rma_track){20, 20, 400, 24e3, 0.048, odd % 4 == 1 ? 3.8 : -3.8, odd % 4 == 1 ? -0.4 : 0.4, 0.04},
            &scene);
        struct acquisition *a = &scene.acquisition;
        for (int p = 0; p < a->pings; p++) {
            a->velocity[p].x = odd % 4 == 2 ? 0 : odd % 4 == 3 ? -3 : 3;
            for (int m = 0; odd % 4 == 0 && m < a->receivers; m++)
                a->rx[p * a->receivers + m].x += m % 2 ? 0.003 : 0;
        }
        assert_true(small_error(specs[odd / 4], &scene, 0.2) < 0.01);
        free_scene(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(independent_numbers),
        cmocka_unit_test(short_swath),
        cmocka_unit_test(recurrences),
        cmocka_unit_test(long_swath),
        cmocka_unit_test(block_counts),
        cmocka_unit_test(printed_chain),
        cmocka_unit_test(ghosts),
        cmocka_unit_test(one_receiver),
        cmocka_unit_test(odd_tracks),
        cmocka_unit_test(columns),
    };
    return cmocka_run_group_tests_name("rma", tests, NULL, NULL);
}
