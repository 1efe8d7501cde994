/* Simulated echoes against closed forms: the weight of the beam, the noise. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "contract/delay.h"
#include "echoes/echo_data.h"
#include "scene/random.h"
#include "scene/simulate.h"
#include "tests/scene/scene_fixture.h"

/* The echoes of base_text with `find` replaced, and noise of `std`. */
static struct echoes echoes_of(const char *find, const char *replace, double std, struct scene *scene)
{
    struct echoes echoes;
    char *text = scene_varied(find, replace);
    *scene = scene_loaded(text);
    scene->noise_std = std;
    if (scene_simulate(scene, &echoes) != STATUS_OK)
        fail_msg("%s", status_message());
    free(text);
    return echoes;
}

/* The beam's weights by their definition, at many frequencies at once, from a carrier of 0: on the axis, beside it, far
   beyond any aperture, and where the arguments are not finite. */
static void weights_by_definition(void **state)
{
    (void)state;
    enum { COUNT = 37 };
    const struct scene scene = {.acquisition = {.sound_speed = 1500, .tx_length = 0.5, .rx_length = 0.3},
                                .beam = {.kind = BEAM_TXRX, .truncation = TRUNCATION_NONE, .limit = NAN}};
    double offset[COUNT], weight[COUNT], worst = 0;
    for (double sine = 1e-15; sine < 1; sine *= 7)
        for (double scale = 1; scale < 1e7; scale *= 100) {
            const struct beam_angles angles = {sine, -0.5 * sine, 0};
            for (int k = 0; k < COUNT; k++)
                offset[k] = scale * (20e3 + 700.0 * k) * (k % 2 ? 1 : -1);
            beam_weights(&scene, &angles, offset, COUNT, weight);
            for (int k = 0; k < COUNT; k++) {
                const double tx = M_PI * offset[k] / 1500 * 0.5 * sine, rx = M_PI * offset[k] / 1500 * 0.15 * sine;
                worst = fmax(worst, fabs(weight[k] - sin(tx) / tx * sin(rx) / rx));
            }
        }
    print_message("weights within %.1e\n", worst);
    assert_true(worst < 2e-15);
    const struct beam_angles axis = {0, 0, 0}, beside = {1, 1, 1};
    offset[0] = 0;
    offset[1] = 1e300;
    offset[2] = INFINITY;
    beam_weights(&scene, &axis, offset, 2, weight);
    assert_true(weight[0] == 1 && weight[1] == 1);
    beam_weights(&scene, &beside, offset, 3, weight);
    assert_true(weight[0] == 1 && weight[1] == 0 && weight[2] == 0);
}

/* Sampled chirps: each is the weight of its pair times the chirp at n/fs - tau, and nothing elsewhere. */
static void sampled_chirps_are_weighted(void **state)
{
    (void)state;
    struct scene scene;
    struct echoes echoes = echoes_of("\"lfm\"; duration = 2e-3; };", "\"lfm_time\"; duration = 2e-3; };", 0, &scene);
    const struct acquisition *a = &scene.acquisition;
    const double complex *samples = echoes.samples;
    double least = 1, greatest = 0;
    for (int k = 0; k < a->pings * a->receivers; k++) {
        const int ping = k / a->receivers;
        const struct vector p = {scene.targets[0].x, scene.targets[0].r, 0};
        const double tau = delay_exact(a->tx[ping], a->rx[k], a->velocity[ping], p, a->sound_speed);
        const double weight = support_beam_weight(&scene, ping, k % a->receivers, p, tau, a->fc);
        least = fmin(least, weight);
        greatest = fmax(greatest, weight);
        for (int n = 0; n < a->samples; n++) {
            const double t = a->t0[ping] + n / a->fs - tau, u = t - 1e-3;
            const bool inside = t >= 0 && t < 2e-3;
            const double complex wanted =
                inside ? weight * cexp(2 * M_PI * I * (15e3 / (2 * 2e-3) * u * u - a->fc * tau)) : 0;
            assert_close(cabs(samples[k * a->samples + n] - wanted), 0, 1e-9);
        }
    }
    assert_true(least < 0.95 && greatest > 0.99); /* the beam does taper */
    echoes_free(&echoes);
    scene_free(&scene);
}

/* Noise is added, std times the numbers of the record's own stream. */
static void noise_is_that_of_the_stream(void **state)
{
    (void)state;
    struct scene scene;
    struct echoes noisy = echoes_of("", "", 0.25, &scene), plain;
    const struct acquisition *a = &scene.acquisition;
    scene.noise_std = 0;
    assert_int_equal(scene_simulate(&scene, &plain), STATUS_OK);
    for (int k = 0; k < a->pings * a->receivers; k++) {
        struct random random = random_seed(3, (uint64_t)k);
        for (int n = 0; n < a->samples; n++) {
            const int at = k * a->samples + n;
            const double complex added =
                ((const double complex *)noisy.samples)[at] - ((const double complex *)plain.samples)[at];
            assert_close(cabs(added - 0.25 * random_normal(&random)), 0, 1e-12);
        }
    }
    echoes_free(&noisy);
    echoes_free(&plain);
    scene_free(&scene);
}

struct failing {
    struct simulation *simulation;
    int fails; /* at this ping */
};

static enum status pings_make(void *with, int first, int count, double complex *samples)
{
    const struct failing *f = with;
    return first + count > f->fails ? status_set(STATUS_FAILED, "planted")
                                    : simulation_pings(f->simulation, first, count, samples);
}

/* A file that is written some pings at a time has the bits of one written whole, whatever the power of two of the
   samples; a source that fails leaves none. */
static void blocks_are_the_whole(void **state)
{
    (void)state;
    static const char *const targets[] = {"r = 20.0; }", "r = 20.0; amplitude = 1e200; }"};
    static const int most[] = {1, 4, 6, 100};
    for (size_t n = 0; n < 2 * (sizeof most / sizeof *most); n++) {
        struct scene scene;
        struct simulation *simulation;
        struct acquisition a, b;
        struct echoes made = echoes_of("r = 20.0; }", targets[n % 2], 0.25, &scene), whole, blocks;
        const struct echo_notes notes = scene_notes(&scene);
        assert_true((made.exponent != 0) == (n % 2 == 1));
        assert_int_equal(echo_file_write(path_of("whole.mat"), &made, &notes), STATUS_OK);
        assert_int_equal(simulation_open(&scene, 1, &simulation), STATUS_OK);
        struct failing from = {simulation, scene.acquisition.pings};
        const struct sample_source source = {simulation_exponent(simulation), pings_make, &from};
        remove(path_of("blocks.mat"));
        for (from.fails = 5; from.fails <= 6; from.fails++) {
            assert_int_equal(echo_file_blocks(path_of("blocks.mat"), &scene.acquisition, &source, most[n / 2], &notes),
                             from.fails < 6 ? STATUS_FAILED : STATUS_OK);
            assert_int_equal(support_exists("blocks.mat"), from.fails == 6);
        }
        simulation_close(simulation);
        assert_int_equal(echo_file_read(path_of("whole.mat"), &a, &whole), STATUS_OK);
        assert_int_equal(echo_file_read(path_of("blocks.mat"), &b, &blocks), STATUS_OK);
        assert_true(a.pings == b.pings && a.receivers == b.receivers && a.samples == b.samples);
        assert_int_equal(whole.exponent, blocks.exponent);
        assert_memory_equal(whole.samples, blocks.samples,
                            (size_t)(a.pings * a.receivers * a.samples) * sizeof(double complex));
        acquisition_free(&a);
        acquisition_free(&b);
        echoes_free(&whole);
        echoes_free(&blocks);
        echoes_free(&made);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_by_definition),
        cmocka_unit_test_setup_teardown(sampled_chirps_are_weighted, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(noise_is_that_of_the_stream, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(blocks_are_the_whole, folder_make, folder_remove),
    };
    return cmocka_run_group_tests_name("simulate", tests, NULL, NULL);
}
