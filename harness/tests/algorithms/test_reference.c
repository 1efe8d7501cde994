/* Delays, exact images and every method's image against the numbers of an independent implementation. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "contract/delay.h"
#include "metrics/metrics.h"
#include "scene/simulate.h"
#include "tests/algorithms/reference_numbers.h"
#include "tests/support.h"

enum { SCENES = sizeof reference_scenes / sizeof *reference_scenes };

static struct scene scenes[SCENES];
static struct scene heard[SCENES];   /* the same without the pings that do not hear the target; borrows all arrays */
static struct echoes echoes[SCENES]; /* of heard */

/* Does any receiver of the ping hear the target? */
static bool ping_sees_target(const struct scene *scene, int ping)
{
    const struct acquisition *a = &scene->acquisition;
    struct vector p = {scene->targets[0].x, scene->targets[0].r, 0};
    for (int m = 0; m < a->receivers; m++) {
        double tau = delay_exact(a->tx[ping], a->rx[ping * a->receivers + m], a->velocity[ping], p, a->sound_speed);
        if (support_beam_weight(scene, ping, m, p, tau, a->fc) > 0)
            return true;
    }
    return false;
}

/* Echoes that are all zero add nothing, and take most of the time. */
static void narrow(const struct scene *scene, struct scene *out)
{
    int first = 0, end = scene->acquisition.pings;
    while (!ping_sees_target(scene, first))
        first++;
    while (!ping_sees_target(scene, end - 1))
        end--;
    *out = *scene;
    out->acquisition.pings = end - first;
    out->acquisition.t0 += first;
    out->acquisition.tx += first;
    out->acquisition.rx += (size_t)first * (size_t)scene->acquisition.receivers;
    out->acquisition.velocity += first;
}

static int load(void **state)
{
    (void)state;
    for (int k = 0; k < SCENES; k++) {
        support_scene(reference_scenes[k].scene, &scenes[k]);
        scenes[k].acquisition.samples = 8192; /* twice the scene's: see long_records_image */
        narrow(&scenes[k], &heard[k]);
        support_echoes(&heard[k], &echoes[k]);
    }
    return 0;
}

static int unload(void **state)
{
    (void)state;
    for (int k = 0; k < SCENES; k++) {
        echoes_free(&echoes[k]);
        scene_free(&scenes[k]);
    }
    return 0;
}

static void delays_and_weights(void **state)
{
    (void)state;
    for (int k = 0; k < SCENES; k++)
        for (int n = 0; n < 3; n++) {
            const struct acquisition *a = &scenes[k].acquisition;
            int ping = reference_scenes[k].delays[n].ping, receiver = reference_scenes[k].delays[n].receiver;
            struct vector p = {scenes[k].targets[0].x, scenes[k].targets[0].r, 0};
            double tau =
                delay_exact(a->tx[ping], a->rx[ping * a->receivers + receiver], a->velocity[ping], p, a->sound_speed);
            assert_true(fabs(tau - reference_scenes[k].delays[n].tau) < 1e-15);
            double weight = support_beam_weight(&scenes[k], ping, receiver, p, tau, a->fc);
            assert_true(fabs(weight - reference_scenes[k].delays[n].weight) < 1e-10);
        }
}

/* Largest difference from `exact` over patch pixels in row-major order, relative to `peak`. */
static double deviation(const struct image *image, int patch, const double *exact, double peak)
{
    double worst = 0;
    const struct grid *grid = &image->patches[patch];
    for (int i = 0; i < grid->r_count; i++)
        for (int j = 0; j < grid->x_count; j++, exact += 2)
            worst = worse_of(worst, cabs(image_pixel(image, patch, i, j) - (exact[0] + I * exact[1])) / peak);
    return worst;
}

static double sum_of_weights(const struct reference_scene *numbers)
{
    double peak = 0;
    for (int j = 0; j < 81; j++)
        peak = worse_of(peak, hypot(numbers->azimuth.exact[2 * j], numbers->azimuth.exact[2 * j + 1]));
    return peak;
}

/* The published values are of sinc(B t), a simulated flat record repeats itself after N/fs: away from the target the
   two differ as (t fs/N)^2. Range slices and scattered pixels therefore get long records, one ping at a time. */
static void add_image(const struct scene *scene, int patch_count, const struct grid *patches, struct image *sum)
{
    struct echoes pings;
    struct image image;
    struct problem problem = problem_make(&scene->acquisition, patch_count, patches, PRECISION_DOUBLE);
    support_echoes(scene, &pings);
    assert_int_equal(support_image("reference:precision=double", problem, &pings, &image), STATUS_OK);
    for (int k = 0; k < patch_count; k++)
        for (int n = 0; n < patches[k].x_count * patches[k].r_count; n++)
            ((double complex **)sum->pixels)[k][n] += ((double complex **)image.pixels)[k][n];
    image_free(&image);
    echoes_free(&pings);
}

static void long_records_image(const struct scene *scene, int patch_count, const struct grid *patches,
                               struct image *sum)
{
    enum { LONG = 27000 };
    struct scene one = *scene;
    const struct acquisition *a = &scene->acquisition;
    int before = (LONG - a->samples) / 2;
    assert_int_equal(image_allocate(patch_count, patches, PRECISION_DOUBLE, sum), STATUS_OK);
    for (int p = 0; p < a->pings; p++) {
        double t0 = a->t0[p] - before / a->fs;
        one.acquisition.pings = 1;
        one.acquisition.samples = LONG;
        one.acquisition.t0 = &t0;
        one.acquisition.tx = a->tx + p;
        one.acquisition.rx = a->rx + (size_t)p * (size_t)a->receivers;
        one.acquisition.velocity = a->velocity + p;
        add_image(&one, patch_count, patches, sum);
    }
}

static void exact_images(void **state)
{
    (void)state;
    for (int k = 0; k < SCENES; k++) {
        const struct reference_scene *numbers = &reference_scenes[k];
        struct grid slice = {numbers->azimuth.x_first, numbers->azimuth.x_step, 81, numbers->azimuth.r, 1, 1};
        struct grid patches[17] = {{numbers->range.x, 1, 1, numbers->range.r_first, numbers->range.r_step, 25}};
        for (int n = 0; n < 16; n++)
            patches[1 + n] = (struct grid){numbers->pixels.x[n], 1, 1, numbers->pixels.r[n], 1, 1};
        struct problem problem = problem_make(&heard[k].acquisition, 1, &slice, PRECISION_DOUBLE);
        struct image azimuth, others;
        double peak = sum_of_weights(numbers);
        assert_int_equal(support_image("reference:precision=double", problem, &echoes[k], &azimuth), STATUS_OK);
        long_records_image(&heard[k], 17, patches, &others);
        double along = deviation(&azimuth, 0, numbers->azimuth.exact, peak);
        double across = deviation(&others, 0, numbers->range.exact, peak), elsewhere = 0;
        for (int n = 0; n < 16; n++)
            elsewhere = worse_of(elsewhere, deviation(&others, 1 + n, numbers->pixels.exact + 2 * n, peak));
        print_message("%s: exact values within %.1e (azimuth), %.1e (range), %.1e (pixels) of the peak\n",
                      numbers->scene, along, across, elsewhere);
        assert_true(along < 1e-8 && across < 1e-8 && elsewhere < 1e-8);
        image_free(&azimuth);
        image_free(&others);
    }
}

static void method_slices(void **state)
{
    (void)state;
    for (int k = 0; k < SCENES; k++) {
        const struct reference_scene *numbers = &reference_scenes[k];
        struct grid slice = {numbers->azimuth.x_first, numbers->azimuth.x_step, 81, numbers->azimuth.r, 1, 1};
        struct problem problem = problem_make(&heard[k].acquisition, 1, &slice, PRECISION_DOUBLE);
        double peak = sum_of_weights(numbers);
        int methods = k < 2 ? 7 : 6; /* the last, factor 32, takes long transforms: two scenes do */
        for (int m = 0; m < methods; m++) {
            char spec[80];
            struct image image;
            snprintf(spec, sizeof spec, "%s%sprecision=double", numbers->methods[m].spec,
                     strchr(numbers->methods[m].spec, ':') ? "," : ":");
            assert_int_equal(support_image(spec, problem, &echoes[k], &image), STATUS_OK);
            double worst = deviation(&image, 0, numbers->methods[m].slice, peak);
            print_message("%s %s: within %.1e of the peak\n", numbers->scene, numbers->methods[m].spec, worst);
            assert_up_to(worst, 1e-8, "%s, %s: of the peak", numbers->scene, spec);
            image_free(&image);
        }
    }
}

static void slice_metrics(void **state)
{
    (void)state;
    for (int k = 0; k < SCENES; k++) {
        const struct reference_metrics *expected = &reference_scenes[k].metrics;
        struct problem problem =
            problem_make(&heard[k].acquisition, heard[k].patch_count, heard[k].patches, PRECISION_DOUBLE);
        struct image image;
        assert_int_equal(support_image("reference:precision=double", problem, &echoes[k], &image), STATUS_OK);
        struct slice_metrics m = metrics_slice(&image, &heard[k].acquisition, &heard[k].targets[0], AXIS_AZIMUTH);
        print_message("%s: PSLR %.3f (%.3f) ISLR %.3f (%.3f) 3db %.3f (%.3f) width %.3f (%.3f) mm %s\n",
                      reference_scenes[k].scene, m.pslr_db[DEFINITION_NULL], expected->pslr_db,
                      m.islr_db[DEFINITION_NULL], expected->islr_null_db, m.islr_db[DEFINITION_3DB],
                      expected->islr_3db_db, 1e3 * m.width_m, 1e3 * expected->width_m, m.reason);
        assert_true(fabs(m.pslr_db[DEFINITION_NULL] - expected->pslr_db) < 0.02);
        assert_true(fabs(m.islr_db[DEFINITION_NULL] - expected->islr_null_db) < 0.02);
        assert_true(fabs(m.islr_db[DEFINITION_3DB] - expected->islr_3db_db) < 0.02);
        assert_true(fabs(m.width_m / expected->width_m - 1) < 0.005);
        image_free(&image);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(delays_and_weights),
        cmocka_unit_test(exact_images),
        cmocka_unit_test(method_slices),
        cmocka_unit_test(slice_metrics),
    };
    return cmocka_run_group_tests_name("reference", tests, load, unload);
}
