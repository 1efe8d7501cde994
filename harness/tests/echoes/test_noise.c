/* The share of noise in echoes: measured beyond their band, and stated by scenes. */
#include <math.h>
#include <stdio.h>

#include "echoes/echo_data.h"
#include "scene/random.h"
#include "echoes/matfile.h"
#include "echoes/noise.h"
#include "scene/simulate.h"
#include "tests/support.h"

static double measured(const struct echoes *echoes)
{
    double share;
    assert_int_equal(noise_measure(echoes, &share), STATUS_OK);
    return share;
}

static double stated_of(const struct scene *scene)
{
    return noise_of_targets(&scene->acquisition, scene->target_count, scene->targets, scene->noise_std);
}

/* Noise alone, echoes of the whole band alone, and both of the same energy; at any size. */
static void known_shares(void **state)
{
    (void)state;
    struct acquisition a = support_acquisition(8, 4, 256);
    struct echoes echoes;
    assert_int_equal(echoes_allocate(&a, PRECISION_DOUBLE, &echoes), STATUS_OK);
    double complex *samples = (double complex *)echoes.samples;
    static const double shares[] = {0, 0.01, 0.5, 1}, sizes[] = {1e-150, 1, 1e150};
    for (int k = 0; k < 12; k++) {
        struct random random = random_seed(5, 0);
        const double noise = sqrt(shares[k % 4] * a.fs / a.bandwidth / 256), echo = sqrt(1 - shares[k % 4]);
        for (int n = 0; n < 8 * 4; n++)
            for (int i = 0; i < 256; i++) { /* an echo's energy is fs/B */
                const double z = M_PI * (i - 120.3 - n) * a.bandwidth / a.fs;
                samples[n * 256 + i] = sizes[k / 4] * (noise * random_normal(&random) + echo * sin(z) / z);
            }
        const double share = measured(&echoes);
        print_message("share %g: %g measured\n", shares[k % 4], share);
        assert_true(share >= 0.8 * shares[k % 4] && share <= fmin(1.2 * shares[k % 4] + 1e-4, 1));
    }
    a.bandwidth = a.fs; /* nothing to measure */
    assert_true(measured(&echoes) == 0);
    a.bandwidth = a.fs / 2;
    for (int i = 0; i < 8 * 4 * 256; i++)
        samples[i] = 0;
    assert_true(measured(&echoes) == 0);
    echoes_free(&echoes);
    acquisition_free(&a);
}

/* What a scene states is about what its echoes have. */
static void scenes_state_it(void **state)
{
    (void)state;
    static const int seeds[] = {7001, 7009, 7002, 7014}; /* two of compressed echoes, two of raw ones */
    static const double levels[] = {0, 0.2, 2};
    struct scene scene;
    struct echoes echoes;
    support_scene("study/quick", &scene);
    assert_true(stated_of(&scene) == 0);
    scene_free(&scene);
    for (int n = 0; n < 12; n++) {
        support_random_scene(seeds[n / 3], &scene);
        scene.noise_std = levels[n % 3];
        support_echoes(&scene, &echoes);
        const double stated = stated_of(&scene), share = measured(&echoes);
        print_message("%s, std %g: %g stated, %g measured\n", scene.acquisition.compressed ? "compressed" : "raw",
                      levels[n % 3], stated, share);
        assert_true(share < 2 * stated + 1e-9);
        if (scene.acquisition.compressed || stated > 0.1) /* less is hidden by the pulse's flanks */
            assert_true(stated < 1 && share > 0.5 * stated);
        echoes_free(&echoes);
        scene_free(&scene);
    }
}

/* Of recorded echoes it is what is measured, whether a scene names them or not. */
static void recorded_have_it(void **state)
{
    (void)state;
    struct scene scene, recorded;
    struct echoes echoes;
    support_random_scene(7001, &scene);
    scene.noise_std = 0.2;
    support_echoes(&scene, &echoes);
    const double share = measured(&echoes);
    assert_int_equal(echo_file_write(path_of("noisy.mat"), &echoes, &(struct echo_notes){.description = ""}),
                     STATUS_OK);
    FILE *file = fopen(path_of("recorded.cfg"), "w");
    assert_non_null(file);
    fputs("echoes = \"noisy.mat\";\nimage = { x = { first = -1.0; step = 0.1; count = 20; }; "
          "r = { first = 22.734; step = 0.01; count = 9; }; };\n",
          file);
    fclose(file);
    support_scene(path_of("recorded.cfg"), &recorded);
    print_message("%g recorded, %g measured\n", recorded.acquisition.noise, share);
    assert_true(share > 0.05 && fabs(recorded.acquisition.noise - share) < 1e-3 * share);
    echoes_free(&echoes);
    scene_free(&recorded);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_shares),
        cmocka_unit_test_setup_teardown(scenes_state_it, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(recorded_have_it, folder_make, folder_remove),
    };
    return cmocka_run_group_tests_name("noise", tests, NULL, NULL);
}
