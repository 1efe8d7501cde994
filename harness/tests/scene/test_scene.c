/* Scene files: what the shipped ones hold, how keys arrive. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "contract/delay.h"
#include "scene/simulate.h"
#include "tests/algorithms/reference_numbers.h"
#include "tests/scene/scene_fixture.h"

/* Every point, of the target area where there is one, is seen over its whole beam (the first and last ping hold nothing
   of it) and lies in the records. */
static void check_coverage(const struct scene *scene)
{
    const struct acquisition *a = &scene->acquisition;
    const bool on_rail = strncmp(scene->name, "study/rail", 10) == 0; /* its ends are the aperture's */
    double widest_hz = a->fc - (scene->beam.per_frequency ? a->bandwidth / 2 : 0);
    for (int t = 0; t < scene->point_count; t++) {
        struct vector p = {scene->targets[t].x, scene->targets[t].r, 0};
        int seen = 0;
        if (a->area.half_x > 0 && !(fabs(p.x - a->area.x) < a->area.half_x && fabs(p.y - a->area.r) < a->area.half_r)) {
            continue;
        }
        for (int ping = 0; ping < a->pings; ping++) {
            for (int m = 0; m < a->receivers; m++) {
                double tau =
                    delay_exact(a->tx[ping], a->rx[ping * a->receivers + m], a->velocity[ping], p, a->sound_speed);
                if (support_beam_weight(scene, ping, m, p, tau, widest_hz) == 0) {
                    continue;
                }
                seen++;
                double q = (tau - a->t0[ping]) * a->fs;
                const bool cut = !on_rail && (ping == 0 || ping == a->pings - 1);
                if (cut || !(q >= 50 && q <= a->samples - a->pulse_length - 50)) {
                    fail_msg("%s: target %d is seen at ping %d of %d, sample %g of %d", scene->name, t, ping, a->pings,
                             q, a->samples);
                }
            }
        }
        assert_true(seen > 0);
    }
}

static void shipped_scenes_load(void **state)
{
    (void)state;
    char **names;
    int count;
    assert_int_equal(scene_names(SHIPPED, &names, &count), STATUS_OK);
    assert_true(count >= 17);
    for (int i = 0; i < count; i++) {
        struct scene scene;
        if (scene_load(names[i], SHIPPED, &scene) != STATUS_OK) {
            fail_msg("%s", status_message());
        }
        assert_string_equal(scene.name, names[i]);
        assert_true(strlen(scene.description) > 10);
        assert_true(i == 0 || strcmp(names[i - 1], names[i]) < 0);
        assert_null(strstr(names[i], "/_"));
        double pixels = 0, pairs = (double)scene.acquisition.pings * scene.acquisition.receivers;
        const struct grid *compared = scene.reference_count > 0 ? scene.reference_patches : scene.patches;
        for (int k = 0; k < (scene.reference_count > 0 ? scene.reference_count : scene.patch_count); k++) {
            pixels += (double)grid_pixels(&compared[k]);
        }
        assert_true(scene.full_size || pixels * pairs < 1e8); /* the exact image stays a matter of seconds */
        if (strncmp(names[i], "extreme/", 8) != 0) {
            check_coverage(&scene);
        }
        scene_free(&scene);
    }
    scene_names_free(names, count);
}

static void reference_scenes_have_the_reference_geometry(void **state)
{
    (void)state;
    const double target[4][2] = {{90, 0}, {74, 6}, {260, 16}, {50, 2.5}};
    const int active_pairs[4] = {520, 425, 1442, 1188};
    assert_int_equal(COUNT_OF(reference_scenes), 4);
    for (int i = 0; i < 4; i++) {
        const struct reference_scene *expected = &reference_scenes[i];
        struct scene scene;
        assert_int_equal(scene_load(expected->scene, SHIPPED, &scene), STATUS_OK);
        const struct acquisition *a = &scene.acquisition;
        assert_int_equal(scene.target_count, 1);
        assert_true(scene.targets[0].r == target[i][0] && scene.targets[0].x == target[i][1]);
        struct vector p = {scene.targets[0].x, scene.targets[0].r, 0};
        int active = 0;
        for (int k = 0; k < a->pings * a->receivers; k++) {
            double tau = delay_exact(a->tx[k / a->receivers], a->rx[k], a->velocity[0], p, a->sound_speed);
            active += support_beam_weight(&scene, k / a->receivers, k % a->receivers, p, tau, a->fc) != 0;
        }
        assert_int_equal(active, active_pairs[i]);
        for (int k = 0; k < 3; k++) {
            int ping = expected->delays[k].ping, m = expected->delays[k].receiver;
            double tau = delay_exact(a->tx[ping], a->rx[ping * a->receivers + m], a->velocity[ping], p, a->sound_speed);
            assert_true(fabs(tau - expected->delays[k].tau) < 1e-12);
            assert_true(fabs(support_beam_weight(&scene, ping, m, p, tau, a->fc) - expected->delays[k].weight) < 1e-12);
        }
        scene_free(&scene);
    }
}

static void full_size_scenes_have_their_papers_sizes(void **state)
{
    (void)state;
    struct scene full, limited;
    assert_int_equal(scene_load("bp22/full", SHIPPED, &full), STATUS_OK);
    assert_int_equal(scene_load(SHIPPED "/bp22/full_limited.cfg", SHIPPED, &limited), STATUS_OK);
    assert_string_equal(limited.name, "bp22/full_limited");
    assert_true(full.full_size && limited.full_size);
    assert_int_equal(full.patches[0].x_count, 2880);
    assert_int_equal(full.patches[0].r_count, 4800);
    assert_int_equal(full.reference_count, 6);
    assert_true(isinf(full.acquisition.aperture_limit));
    assert_true(limited.acquisition.aperture_limit == 0.125);
    assert_true(full.hash != limited.hash);
    assert_memory_equal(&full.patches[0], &limited.patches[0], sizeof full.patches[0]);
    scene_free(&full);
    scene_free(&limited);
}

static void keys_arrive(void **state)
{
    (void)state;
    struct scene scene = scene_loaded(base_text);
    const struct acquisition *a = &scene.acquisition;
    assert_string_equal(scene.name, "scene");
    assert_string_equal(scene.description, "test");
    assert_true(a->sound_speed == 1500 && a->fc == 150e3 && a->bandwidth == 15e3 && a->fs == 30e3);
    assert_true(a->tx_length == 0.08 && a->rx_length == 0.04 && isinf(a->aperture_limit));
    assert_true(a->pings == 6 && a->receivers == 4 && a->samples == 256);
    assert_true(!a->compressed && a->pulse_length == 60 && fabs(cabs(a->pulse[59]) - 1) < 1e-12);
    for (int p = 0; p < 6; p++) {
        double x = -0.32 + p * 2.5 * 0.064;
        assert_true(fabs(a->t0[p] - 0.024) < 1e-15);
        assert_true(fabs(a->tx[p].x - x) < 1e-12 && a->tx[p].y == 0 && a->tx[p].z == 0);
        assert_true(a->velocity[p].x == 2.5 && a->velocity[p].y == 0 && a->velocity[p].z == 0);
        for (int m = 0; m < 4; m++) {
            assert_true(fabs(a->rx[p * 4 + m].x - (x - 0.06 + 0.04 * m)) < 1e-12);
        }
    }
    assert_true(scene.pulse_kind == PULSE_LFM && scene.pulse_duration == 2e-3);
    assert_true(scene.beam.kind == BEAM_TXRX && scene.beam.truncation == TRUNCATION_TX && scene.beam.limit == 0.443);
    assert_true(!scene.beam.per_frequency && !scene.full_size);
    assert_true(scene.noise_std == 0.1 && scene.noise_seed == 3);
    assert_true(scene.point_count == 1 && scene.target_count == 1 && scene.targets[0].amplitude == 1);
    const struct grid *grid = &scene.patches[0];
    assert_true(scene.patch_count == 1 && grid->x_count == 21 && grid->r_count == 9);
    assert_true(fabs(grid->x_first + 10 * grid->x_step - 0.1) < 1e-12);
    assert_true(fabs(grid->r_first + 4 * grid->r_step - 20) < 1e-12);
    assert_true(scene.reference_count == 0 && !scene.reference_patches);
    scene_free(&scene);
}

static void choices_and_defaults_arrive(void **state)
{
    (void)state;
    struct scene scene = scene_loaded(
        "full_size = true; aperture_limit = 0.5;\n"
        "sonar = { sound_speed = 340; fc = 40000; bandwidth = 5000L; fs = 10e3; };\n"
        "pulse = { kind = \"flat\"; };\n"
        "array = { receivers = 1; };\n"
        "track = { speed = -1; pri = 0.5; pings = 2; };\n"
        "record = { first_sample = -5; samples = 100; };\n"
        "targets = { points = ( { x = 0; r = -1; amplitude = (3, -4.5); }, { x = 1; r = 1; amplitude = -2; } );\n"
        "            fields = ( { x = [-1, 1]; r = (0.5, 1); count = 5; seed = 8; },\n"
        "                       { x = [2, 2]; r = [1, 1]; count = 2; seed = 9; } ); };\n"
        "image = { patches = (\n"
        " { x = { first = -1; step = 0.5; count = 3; }; r = { first = -1; step = 1; count = 2; }; },\n"
        " { x = { first = 0; step = 1; count = 1; }; r = { first = 1; step = 1; count = 1; }; } ); };\n");
    const struct acquisition *a = &scene.acquisition;
    assert_true(scene.full_size && a->aperture_limit == 0.5 && a->sound_speed == 340 && a->bandwidth == 5000);
    assert_true(a->compressed && a->pulse_length == 0 && !a->pulse && scene.pulse_kind == PULSE_FLAT);
    assert_true(a->tx[1].x == -0.5 && a->velocity[1].x == -1);
    assert_true(a->tx[0].x == 0 && a->rx[0].x == 0 && a->t0[0] == -5 / 10e3 && a->tx_length == 0);
    assert_true(scene.beam.kind == BEAM_RECT && scene.beam.truncation == TRUNCATION_NONE);
    assert_true(scene.noise_std == 0 && *scene.description == '\0');
    assert_true(scene.point_count == 2 && scene.target_count == 9);
    assert_true(creal(scene.targets[0].amplitude) == 3 && cimag(scene.targets[0].amplitude) == -4.5);
    assert_true(scene.targets[1].amplitude == -2 && scene.targets[0].r == -1);
    assert_true(scene.targets[7].x == 2 && scene.targets[8].r == 1);
    assert_true(scene.patch_count == 2 && scene.patches[0].x_count == 3 && scene.patches[1].r_first == 1);
    scene_free(&scene);
}

/* Values of another implementation of the generator, seed 1, and the moments of many draws. */
static void fields_can_be_repeated(void **state)
{
    (void)state;
    struct scene scene;
    assert_int_equal(scene_load("study/speckle", SHIPPED, &scene), STATUS_OK);
    assert_int_equal(scene.target_count, 40);
    assert_true(fabs(scene.targets[0].x - 0.38702427802045847) < 1e-12);
    assert_true(fabs(scene.targets[0].r - 100.32570673594209) < 1e-12);
    assert_true(cabs(scene.targets[0].amplitude - (0.2579231448960499 - 0.6997092155067307 * I)) < 1e-12);
    assert_true(fabs(scene.targets[1].x + 0.28197467629579354) < 1e-12);
    assert_true(cabs(scene.targets[1].amplitude - (-0.3077237362204419 + 1.2890287949588786 * I)) < 1e-12);
    scene_free(&scene);

    char *text = scene_varied("points = ( { x = 0.1; r = 20.0; } );",
                              "points = ( { x = 0; r = 20.0; } ); fields = "
                              "( { x = [-2, 4]; r = [19, 21]; count = 20000; seed = 5; } );");
    scene = scene_loaded(text);
    double complex mean = 0;
    double energy = 0, x = 0, r_square = 0;
    for (int i = 1; i < scene.target_count; i++) {
        const struct target *target = &scene.targets[i];
        assert_true(target->x >= -2 && target->x <= 4 && target->r >= 19 && target->r <= 21);
        mean += target->amplitude / 20000;
        energy += creal(target->amplitude * conj(target->amplitude)) / 20000;
        x += target->x / 20000;
        r_square += (target->r - 20) * (target->r - 20) / 20000;
    }
    assert_true(cabs(mean) < 0.03 && fabs(energy - 1) < 0.03);
    assert_true(fabs(x - 1) < 0.05 && fabs(r_square - 1.0 / 3) < 0.01);
    scene_free(&scene);
    free(text);
}

static void reference_patches_are_cut_from_the_grid(void **state)
{
    (void)state;
    char *text = scene_varied("around_targets = { half_x = 0.2; half_r = 0.1; x_step = 0.02; r_step = 0.025; };",
                              "x = { first = 0.03; step = 0.05; count = 40; };"
                              "r = { first = 19.5; step = 0.25; count = 7; };"
                              "reference = { half_x = 0.2; half_r = 0.5; };");
    struct scene scene = scene_loaded(text);
    const struct grid *cut = scene.reference_patches;
    assert_true(scene.patch_count == 1 && scene.patches[0].x_count == 40 && scene.reference_count == 1);
    assert_true(cut->x_first == 0.03 && cut->x_step == 0.05 && cut->x_count == 6); /* 1 - 4 < 0 to 1 + 4 */
    assert_true(cut->r_first == 19.5 && cut->r_step == 0.25 && cut->r_count == 5);
    scene_free(&scene);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shipped_scenes_load),
        cmocka_unit_test(reference_scenes_have_the_reference_geometry),
        cmocka_unit_test(full_size_scenes_have_their_papers_sizes),
        cmocka_unit_test_setup_teardown(keys_arrive, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(choices_and_defaults_arrive, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(fields_can_be_repeated, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(reference_patches_are_cut_from_the_grid, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
