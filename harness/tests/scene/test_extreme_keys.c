/* Keys that extreme scenes need: ping spacing apart from speed, an offset of all coordinates, an offset of all times, a
   beam that is cut at a sine. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "files/paths.h"
#include "scene/simulate.h"
#include "tests/support.h"

static const char base[] = "base = {\n@include \"extreme/_base.cfg\"\n};\n";

static enum status load(const char *text, struct scene *scene)
{
    char whole[1000];
    snprintf(whole, sizeof whole, "%s%s", base, text);
    support_write("scene.cfg", whole);
    return scene_load(path_of("scene.cfg"), data_path(DATA_SCENES), scene);
}

static struct scene loaded(const char *text)
{
    struct scene scene;
    if (load(text, &scene) != STATUS_OK)
        fail_msg("%s: %s", text, status_message());
    return scene;
}

static void spacing_stands_apart_from_speed(void **state)
{
    (void)state;
    struct scene scene = loaded("track = { speed = 0.0; pri = 0.32; spacing = -0.7; pings = 11; x_first = 3.0; };\n");
    const struct acquisition *a = &scene.acquisition;
    struct straight_track track;
    assert_true(a->velocity[3].x == 0 && a->tx[10].x == 3.0 + 10 * -0.7);
    assert_close(a->rx[10 * 40 + 39].x, 3.0 - 7 + 0.04 + 39 * 0.04, 1e-12);
    assert_true(acquisition_is_straight(a, &track));
    assert_close(track.spacing, -0.7, 1e-15);
    scene_free(&scene);
}

static void offsets_move_all(void **state)
{
    (void)state;
    struct scene plain = loaded("targets = { points = ( { x = 0.25; r = 100.0; } ); fields = ( { x = [0, 1]; r = [99, "
                                "101]; count = 3; seed = 1; } ); };\n");
    struct scene moved = loaded("targets = { points = ( { x = 0.25; r = 100.0; } ); fields = ( { x = [0, 1]; r = [99, "
                                "101]; count = 3; seed = 1; } ); };\nx_offset = 1024.0;\n"
                                "record = { first_sample = 3890; samples = 256; time_offset = 0.5e-3; };\n");
    struct scene whole = loaded("x_offset = 1024.0;\nimage = { x = { first = -1.0; step = 0.5; count = 3; }; "
                                "r = { first = 99.0; step = 0.5; count = 5; }; };\n");
    for (int p = 0; p < 41; p++)
        assert_true(moved.acquisition.tx[p].x == plain.acquisition.tx[p].x + 1024);
    assert_true(moved.targets[0].x == 1024.25 && moved.targets[0].r == 100);
    for (int k = 0; k < 4; k++)
        assert_close(moved.targets[k].x, plain.targets[k].x + 1024, 1e-12);
    assert_close(moved.patches[0].x_first, plain.patches[0].x_first + 1024, 1e-12);
    assert_true(whole.patches[0].x_first == 1023 && whole.patches[0].r_first == 99);
    assert_true(moved.acquisition.t0[0] == plain.acquisition.t0[0] + 0.5e-3);
    assert_true(plain.hash != moved.hash);
    scene_free(&plain);
    scene_free(&moved);
    scene_free(&whole);
}

static void beam_is_cut_at_a_sine(void **state)
{
    (void)state;
    struct scene scene = loaded("array = { receivers = 1; };\nbeam = { kind = \"rect\"; truncation = \"sine\"; limit = "
                                "0.1; };\n");
    const struct acquisition *a = &scene.acquisition;
    struct vector p = {a->tx[20].x + 100.137 * 0.0999 / sqrt(1 - 0.0999 * 0.0999), 100.137, 0};
    assert_true(support_beam_weight(&scene, 20, 0, p, 0.13, a->fc) == 1 && beam_sine(&scene) == 0.1);
    p.x = a->tx[20].x - 100.137 * 0.1001 / sqrt(1 - 0.1001 * 0.1001);
    assert_true(support_beam_weight(&scene, 20, 0, p, 0.13, a->fc) == 0 && a->echo_sine == 0.1);
    scene_free(&scene);
}

static void bad_values_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } bad[] = {
        {"track = { speed = 0.0; pri = 0.32; spacing = 0.0; pings = 11; };",
         "key 'track.spacing' is 0.0, must be a number other than 0 m"},
        {"track = { speed = 0.0; pri = 0.32; spacing = 2e12; pings = 1; };",
         "key 'track.spacing' is 2e+12, must be a number from -1e+12 to 1e+12 m"},
        {"track = { speed = 0.0; pri = 0.32; spacing = 1e12; pings = 3; };",
         "such that the last of 3 pings, at 2e+12 m, stays within +-1e+12 m"},
        {"track = { speed = 0.0; pri = 0.32; spacing = \"1\"; pings = 3; };",
         "key 'track.spacing' is \"1\", must be a number"},
        {"x_offset = 2e12;", "key 'x_offset' is 2e+12, must be a number from -1e+12 to 1e+12 m"},
        {"x_offset = true;", "key 'x_offset' is true, must be a number"},
        {"x_offset = 1e12;\ntrack = { speed = 2.5; pri = 0.32; pings = 3; x_first = 1.0; };", "within +-1e+12 m"},
        {"record = { first_sample = 0; samples = 256; time_offset = 1e999; };",
         "key 'record.time_offset' is inf, must be a number that is finite"},
        {"record = { first_sample = 3890; samples = 256; time_offset = -1e12; };", "phase error"},
        {"beam = { truncation = \"sine\"; };",
         "key 'beam.limit' is missing, must be a number > 0 with beam.truncation \"sine\""},
        {"beam = { truncation = \"sine\"; limit = 1.5; };", "key 'beam.limit' is 1.5, must be a sine, > 0 and <= 1"},
    };
    struct scene scene;
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        assert_int_equal(load(bad[k].text, &scene), STATUS_INVALID);
        if (!strstr(status_message(), bad[k].says))
            fail_msg("'%s' is not in: %s", bad[k].says, status_message());
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(spacing_stands_apart_from_speed, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(offsets_move_all, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(beam_is_cut_at_a_sine, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(bad_values_are_refused, folder_make, folder_remove),
    };
    return cmocka_run_group_tests_name("extreme_keys", tests, NULL, NULL);
}
