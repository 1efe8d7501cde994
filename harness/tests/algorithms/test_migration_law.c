/* What is forecast of range migration and omega-k, beside errors measured in shipped scenes and in scenes drawn from
   seeds. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "metrics/metrics.h"
#include "measure/session.h"
#include "measure/timing.h"
#include "tests/algorithms/predictions.h"
#include "tests/support.h"

enum { SEEDS = 12 };

/* Of random scenes, with `points` those of up to three targets in place of the field: each forecast is 0.9 or more of
   what is measured, the median from 1 to `most`. */
static void seeds_compare(const int seeds[SEEDS], bool points, double most)
{
    double ratios[SEEDS];
    for (int k = 0; k < SEEDS; k++) {
        struct scene scene;
        struct session session;
        double error;
        if (points)
            points_scene(seeds[k], 1 + k % 3, &scene);
        else
            support_random_scene(seeds[k], &scene);
        assert_int_equal(session_open(&scene, &session), STATUS_OK);
        ratios[k] = predicted_over_measured(&session, "rma_delay", &error);
        if (!(ratios[k] > 0.9))
            fail_msg("seed %d: an error of %g is predicted, %g measured", seeds[k], ratios[k] * error, error);
        session_close(&session);
        scene_free(&scene);
    }
    const double middle = median(ratios, SEEDS); /* sorts them */
    print_message("predicted over measured: %.2f to %.2f, median %.2f\n", ratios[0], ratios[SEEDS - 1], middle);
    if (!(middle > 1 && middle < most))
        fail_msg("the median of predicted over measured errors is %g, must be from 1 to %g", middle, most);
}

/* Range migration's forecast is an estimate, too: of scenes that few and many pings see, near and far, whose records
   end near their rows. Of the second, azimuth alone says a quarter. */
static void range_migration(void **state)
{
    (void)state;
    static const int seeds[SEEDS] = {5028, 5043, 5024, 5033, 5034, 5037, 5041, 5046, 5047, 5057, 5081, 5090};
    seeds_compare(seeds, false, 2);
}

/* Of targets that are known it is near, and above what is measured. */
static void known_targets(void **state)
{
    (void)state;
    static const int seeds[SEEDS] = {6200, 6210, 6213, 6216, 6234, 6239, 6252, 6255, 6257, 6258, 6283, 6317};
    seeds_compare(seeds, true, 1.5);
}

/* A scene that says where errors count is planned there: near the targets of a swath range migration is right by a
   hundredth of what it lacks in the columns that only echoes from outside of the focused beam reach. */
static void judged_parts(void **state)
{
    (void)state;
    struct scene scene;
    struct session session;
    double error;
    support_scene("study/swath", &scene);
    const struct problem all = problem_make(&scene.acquisition, 1, scene.patches, PRECISION_FLOAT);
    const struct forecast anywhere = forecast_of("rma_delay", &all);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    const double ratio = predicted_over_measured(&session, "rma_delay", &error);
    if (!(ratio > 0.9 && ratio < 4 && forecast_error(&anywhere) > 10 * ratio * error))
        fail_msg("an error of %g is predicted, %g of targets anywhere, %g measured", ratio * error,
                 forecast_error(&anywhere), error);
    session_close(&session);
    scene_free(&scene);
}

/* Scenes of one receiver: shipped, and those that omega-k's forecast was once far off on: pings beyond the
   aperture limit within the wavenumbers that are sampled, records that end near the rows, flanks of a short chirp, a
   field about a turned patch, targets seen far ahead on rows along the track. */
static const char *const omega_k_scenes[] = {
    "base = {\n@include \"sq18/picture.cfg\"\n};\n",
    "base = {\n@include \"sq18/squint_45.cfg\"\n};\n",
    "base = {\n@include \"gate/squint.cfg\"\n};\n",
    "sonar = { fc = 300e3; bandwidth = 59.9e3; fs = 139.7e3; };\npulse = { kind = \"flat\"; };\n"
    "array = { tx_length = 0.06742; rx_length = 0.06742; receivers = 1; };\n"
    "track = { speed = 0; pri = 0.1; spacing = 0.0147954; pings = 600; x_first = -4.4312; };\n"
    "record = { first_sample = 5934; samples = 1940; };\naperture_limit = 0.0844858;\n"
    "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.5; squint = 45; };\n"
    "targets = { points = ( { x = 26.05; r = 25.12; }, { x = 25.02; r = 25.97; } ); };\n"
    "image = { angle = 45; x = { first = -1.19; step = 0.0119; count = 200; };\n"
    "r = { first = 35.96; step = 0.0036; count = 80; }; };\n",
    "sonar = { fc = 30e3; bandwidth = 2181.4; fs = 5183; };\npulse = { kind = \"flat\"; };\n"
    "array = { tx_length = 0.47324; rx_length = 0.47324; receivers = 1; };\n"
    "track = { speed = 2.5; pri = 0.045339; pings = 97; x_first = -5.4407; };\n"
    "record = { first_sample = 256; samples = 241; };\naperture_limit = 0.11028;\n"
    "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.5; squint = 45; };\n"
    "targets = { points = ( { x = 37.36; r = 35.02; }, { x = 33.6; r = 35.11; } ); };\n"
    "image = { x = { first = 29.31; step = 0.1311; count = 80; }; r = { first = 31.53; step = 0.17; count = 36; }; "
    "};\n",
    "sonar = { fc = 150e3; bandwidth = 6820; fs = 14683; };\npulse = { kind = \"flat\"; };\n"
    "array = { tx_length = 0.1135; rx_length = 0.1135; receivers = 1; };\n"
    "track = { speed = 0; pri = 0.1; spacing = 0.01936; pings = 129; x_first = -1.239; };\n"
    "record = { first_sample = 557; samples = 170; };\n"
    "beam = { kind = \"txrx\"; truncation = \"tx\"; limit = 0.5; };\n"
    "targets = { points = ( { x = -0.48; r = 31.22; }, { x = 0.0268; r = 30.6; }, { x = 0.4; r = 30.77; } ); };\n"
    "image = { x = { first = -1.079; step = 0.027; count = 80; }; r = { first = 29.76; step = 0.03; count = 80; }; "
    "};\n",
    "sonar = { fc = 300e3; bandwidth = 12510; fs = 15601; };\npulse = { kind = \"lfm\"; duration = 0.002; };\n"
    "array = { tx_length = 0.0865; rx_length = 0.0865; receivers = 1; };\n"
    "track = { speed = 0; pri = 0.1; spacing = 0.01583; pings = 433; x_first = -3.42; };\n"
    "record = { first_sample = 1759; samples = 352; };\n"
    "beam = { kind = \"txrx\"; truncation = \"tx\"; limit = 0.5; };\n"
    "targets = { points = ( { x = -0.13; r = 93.27; }, { x = 0.171; r = 90.86; }, { x = 0.284; r = 92.96; } ); };\n"
    "image = { x = { first = -0.835; step = 0.0209; count = 80; }; r = { first = 89.15; step = 0.0352; count = "
    "200; }; "
    "};\n",
    "sonar = { fc = 300e3; bandwidth = 9470; fs = 12988; };\npulse = { kind = \"lfm\"; duration = 0.008; };\n"
    "array = { tx_length = 0.09627; rx_length = 0.09627; receivers = 1; };\n"
    "track = { speed = 0; pri = 0.1; spacing = 0.0198; pings = 396; x_first = -3.91; };\n"
    "record = { first_sample = 1038; samples = 298; };\naperture_limit = 0.0631;\n"
    "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.6; squint = -35; };\n"
    "targets = { fields = ( { x = [-38.56, -36.13]; r = [52.23, 54.43]; count = 40; seed = 1; } ); };\n"
    "image = { angle = -35; x = { first = -1.07; step = 0.0268; count = 80; };\n"
    "r = { first = 64.51; step = 0.0393; count = 30; }; };\n",
    "sonar = { fc = 30e3; bandwidth = 959.3; fs = 1835.5; };\npulse = { kind = \"lfm\"; duration = 0.002; };\n"
    "array = { tx_length = 0.5942; rx_length = 0.5942; receivers = 1; };\n"
    "track = { speed = 0; pri = 0.1; spacing = 0.1107; pings = 145; x_first = -7.97; };\n"
    "record = { first_sample = 172; samples = 204; };\n"
    "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.5; squint = 30; };\n"
    "targets = { points = ( { x = 52.16; r = 86.37; }, { x = 57.11; r = 85.31; } ); };\n"
    "image = { x = { first = 30.46; step = 0.173; count = 200; }; r = { first = 72.47; step = 0.2563; count = 80; "
    "}; "
    "};\n"};
static void omega_k(void **state)
{
    (void)state;
    enum { SCENES = sizeof omega_k_scenes / sizeof *omega_k_scenes, TAPS = 3 };
    double ratios[SCENES * TAPS];
    for (int k = 0; k < SCENES; k++) {
        struct scene scene;
        struct session session;
        double error;
        support_write("omega_k.cfg", omega_k_scenes[k]);
        support_scene(path_of("omega_k.cfg"), &scene);
        assert_int_equal(session_open(&scene, &session), STATUS_OK);
        for (int i = 0; i < TAPS; i++) {
            char text[40];
            snprintf(text, sizeof text, "wk_squint:taps=%d", 4 + 2 * i);
            double *ratio = ratios + k * TAPS + i;
            *ratio = predicted_over_measured(&session, text, &error);
            if (!(*ratio > 0.8))
                fail_msg("scene %d, %s: an error of %g is predicted, %g measured", k, text, *ratio * error, error);
        }
        session_close(&session);
        scene_free(&scene);
    }
    const double middle = median(ratios, SCENES * TAPS); /* sorts them */
    print_message("predicted over measured: %.2f to %.2f, median %.2f\n", ratios[0], ratios[SCENES * TAPS - 1], middle);
    if (!(middle > 1 && middle < 2.5 && ratios[SCENES * TAPS - 1] < 6))
        fail_msg("the median of predicted over measured errors is %g, must be from 1 to 2.5, the most %g, at most 6",
                 middle, ratios[SCENES * TAPS - 1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(range_migration, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(known_targets, folder_make, folder_remove),
        cmocka_unit_test(judged_parts),
        cmocka_unit_test_setup_teardown(omega_k, folder_make, folder_remove),
    };
    return cmocka_run_group_tests_name("migration_law", tests, NULL, NULL);
}
