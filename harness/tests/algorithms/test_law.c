/* The error laws of interpolators: their closed forms, and errors measured in scenes drawn from seeds. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "backprojection/scatter.h"
#include "measure/metrics.h"
#include "measure/session.h"
#include "measure/timing.h"
#include "tests/support.h"

/* What is forecast of a SPEC on a problem. */
static struct forecast forecast_of(const char *text, const struct problem *problem)
{
    struct forecast forecast;
    struct spec spec;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    assert_int_equal(spec.algorithm->forecast(problem, spec.options, &forecast), STATUS_OK);
    spec_free(&spec);
    return forecast;
}

/* Laws that can be written down, at rho = B/fs. */
static void closed_forms(void **state)
{
    (void)state;
    static const struct {
        const char *spec;
        double factor, power, low, high; /* factor rho^power times low to high */
    } laws[] = {
        {"bp_nearest", M_PI / 6, 1, 0.96, 1.01}, /* its first order */
        {"bp_zeropad:factor=4", M_PI / 24, 1, 0.99, 1.01}, {"bp_zeropad:factor=64", M_PI / 384, 1, 0.99, 1.01},
        {"bp_linear:beta=1024", 0.295, 2, 0.98, 1.1},      {"bp_sinc:taps=4", 0.40 / 4, 0, 0.5, 1.5},
        {"bp_sinc:taps=16", 0.40 / 16, 0, 0.5, 1.5},
    };
    struct acquisition a = support_acquisition(2, 1, 64);
    const struct grid grid = {0, 0.01, 4, 10, 0.01, 4};
    const struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
    for (size_t k = 0; k < sizeof laws / sizeof *laws; k++)
        for (double rho = 0.3; rho < 0.8; rho += 0.2) {
            a.bandwidth = rho * a.fs;
            const double error = forecast_of(laws[k].spec, &problem).error[CAUSE_INTERPOLATION];
            const double ratio = error / (laws[k].factor * pow(rho, laws[k].power));
            print_message("%-24s rho %.1f: %.3e, %.3f of the closed form\n", laws[k].spec, rho, error, ratio);
            if (!(ratio > laws[k].low && ratio < laws[k].high))
                fail_msg("%s at B/fs = %g: the law says %g, %g times its closed form", laws[k].spec, rho, error, ratio);
        }
    acquisition_free(&a);
}

static double predicted_over_measured(const struct session *session, const char *text, double *error)
{
    struct image image;
    struct spec spec;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    assert_int_equal(session_image(session, &spec, &image), STATUS_OK);
    struct problem problem = session_problem(session->scene, spec.algorithm, PRECISION_FLOAT);
    struct scatter scatter;
    const struct forecast whole = forecast_of(text, &problem);
    problem.scatter = scatter_find(&problem, &scatter) ? &scatter : NULL;
    const struct forecast forecast = forecast_of(text, &problem);
    const double predicted = forecast_error(&forecast);
    assert_true(predicted <= forecast_error(&whole) * (1 + 1e-12));
    *error = metrics_error(&image, &session->reference).error_gain;
    print_message("%s, B/fs %.2f, %-30s predicted %.2e, measured %.2e, ratio %.2f\n", session->scene->name,
                  session->scene->acquisition.bandwidth / session->scene->acquisition.fs, text, predicted, *error,
                  predicted / *error);
    image_free(&image);
    spec_free(&spec);
    return predicted / *error;
}

static const char *const interpolators[] = {
    "bp_nearest",         "bp_linear:beta=32",    "bp_zeropad:factor=4",
    "bp_sinc:taps=8",     "bp_farrow:degree=3",   "bp_sinc:taps=8,window=kaiser",
    "bp_farrow:degree=2", "bp_zeropad:factor=32", "bp_fitted:taps=4"};
enum { INTERPOLATORS = sizeof interpolators / sizeof *interpolators, SEEDS_MOST = 100 };

/* A random scene of which `count` points are all targets. */
static void points_scene(int seed, int count, struct scene *scene)
{
    support_random_scene(seed, scene);
    const struct grid *g = &scene->patches[0];
    assert_true(scene->target_count >= count);
    for (int n = 0; n < count; n++)
        scene->targets[n] = (struct target){g->x_first + fmod(0.3 + 0.618 * n, 1) * (g->x_count - 1) * g->x_step,
                                            g->r_first + fmod(0.4 + 0.382 * n, 1) * (g->r_count - 1) * g->r_step, 1};
    scene->point_count = scene->target_count = count;
}

/* The laws of all interpolators over what is measured, of seeds from `first` on; with `points` targets in place of the
   field where that is not 0. */
static void laws_compare(int first, int seeds, int points, double least)
{
    static double ratios[INTERPOLATORS * SEEDS_MOST];
    int below = 0, count = 0;
    for (int seed = first; seed < first + seeds; seed++) {
        struct scene scene;
        struct session session;
        if (points > 0)
            points_scene(seed, points, &scene);
        else
            support_random_scene(seed, &scene);
        assert_int_equal(session_open(&scene, &session), STATUS_OK);
        for (int k = 0; k < INTERPOLATORS; k++) {
            double error;
            const double ratio = predicted_over_measured(&session, interpolators[k], &error);
            if (!(ratio > least))
                fail_msg("seed %d, %s: an error of %g is predicted, %g measured", seed, interpolators[k], ratio * error,
                         error);
            below += ratio < 1 / 1.12;
            ratios[count++] = ratio;
        }
        session_close(&session);
        scene_free(&scene);
    }
    const double middle = median(ratios, count); /* sorts them */
    print_message("predicted over measured: %.2f to %.2f, median %.2f\n", ratios[0], ratios[count - 1], middle);
    if (below > count / 50)
        fail_msg("%d of %d errors are above what a planner counts on", below, count);
    if (!(middle > 1 && middle < 1.5))
        fail_msg("the median of predicted over measured errors is %g, must be from 1 to 1.5", middle);
}

/* A law is near what is measured, and seldom below it: of fields, and of points, whose delays are fewer. */
static void measured(void **state)
{
    (void)state;
    laws_compare(1001, 8, 0, 0.9);
}

static void measured_of_points(void **state)
{
    (void)state;
    laws_compare(6201, 8, 2, 0.8);
}

/* Noise has frequencies beyond the band of compressed echoes: settings that are called by their error keep it. */
static void noise_keeps_errors(void **state)
{
    (void)state;
    static const char *const specs[] = {"bp_factorised:error=1e-3,stages=0", "bp_factorised:error=1e-3,stages=1",
                                        "bp_factorised:error=1e-3,stages=2", "bp_farrow:degree=auto,error=1e-3"};
    static const int seeds[] = {7001, 7005, 7009};
    static const double levels[] = {0.05, 1};
    for (int k = 0; k < 6; k++) {
        struct scene scene;
        struct session session;
        support_noisy_scene(seeds[k / 2], levels[k % 2], &scene);
        assert_true(scene.acquisition.compressed);
        assert_int_equal(session_open(&scene, &session), STATUS_OK);
        for (size_t n = 0; n < sizeof specs / sizeof *specs; n++) {
            double error;
            assert_true(predicted_over_measured(&session, specs[n], &error) > 0.9);
            assert_true(error <= 1e-3);
        }
        session_close(&session);
        scene_free(&scene);
    }
}

/* Range migration's forecast is an estimate, too: of scenes that few and many pings see, near and far, whose records
   end near their rows. Of the second, azimuth alone says a quarter. */
static void range_migration(void **state)
{
    (void)state;
    static const int seeds[] = {5028, 5043, 5024, 5033, 5034, 5037, 5041, 5046, 5047, 5057, 5081, 5090};
    enum { SEEDS = sizeof seeds / sizeof *seeds };
    double ratios[SEEDS];
    for (int k = 0; k < SEEDS; k++) {
        struct scene scene;
        struct session session;
        double error;
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
    if (!(middle > 1 && middle < 2))
        fail_msg("the median of predicted over measured errors is %g, must be from 1 to 2", middle);
}

/* Of targets that are known it is near, and above what is measured. */
static void known_targets(void **state)
{
    (void)state;
    static const int seeds[] = {6200, 6210, 6213, 6216, 6234, 6239, 6252, 6255, 6257, 6258, 6283, 6317};
    enum { SEEDS = sizeof seeds / sizeof *seeds };
    double ratios[SEEDS];
    for (int k = 0; k < SEEDS; k++) {
        struct scene scene;
        struct session session;
        double error;
        points_scene(seeds[k], 1 + k % 3, &scene);
        assert_int_equal(session_open(&scene, &session), STATUS_OK);
        ratios[k] = predicted_over_measured(&session, "rma_delay", &error);
        if (!(ratios[k] > 0.9))
            fail_msg("seed %d: an error of %g is predicted, %g measured", seeds[k], ratios[k] * error, error);
        session_close(&session);
        scene_free(&scene);
    }
    const double middle = median(ratios, SEEDS); /* sorts them */
    print_message("predicted over measured: %.2f to %.2f, median %.2f\n", ratios[0], ratios[SEEDS - 1], middle);
    if (!(middle > 1 && middle < 1.5))
        fail_msg("the median of predicted over measured errors is %g, must be from 1 to 1.5", middle);
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

/* A chirp of 211 cycles of time and bandwidth has flanks up to half the sampling rate, where long taps fail that are
   exact inside the band: by it alone 2e-5 are predicted. */
static void flanks(void **state)
{
    (void)state;
    struct scene scene;
    struct session session;
    double error;
    points_scene(6290, 1, &scene);
    assert_false(scene.acquisition.compressed);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    const double ratio = predicted_over_measured(&session, "bp_sinc:window=kaiser_band,taps=32", &error);
    if (!(ratio > 0.9 && ratio < 2))
        fail_msg("an error of %g is predicted, %g measured", ratio * error, error);
    session_close(&session);
    scene_free(&scene);
}

/* The general engine's blocks are counted on pings that are met, however few of a long track they are: none of eight
   that lie evenly over this one is. */
static void few_pings_met(void **state)
{
    (void)state;
    static const char *const tracks[] = {"pings = 18; x_first = -1.52;", "pings = 1714; x_first = -272.88;"};
    double units[2], error[2];
    for (int k = 0; k < 2; k++) {
        struct scene scene;
        struct session session;
        char text[400];
        snprintf(text, sizeof text,
                 "base = {\n@include \"study/quick.cfg\"\n};\npulse = { kind = \"flat\"; };\naperture_limit = 0.06;\n"
                 "track = { speed = 2.5; pri = 0.064; %s };\n",
                 tracks[k]);
        support_write("track.cfg", text);
        support_scene(path_of("track.cfg"), &scene);
        assert_int_equal(session_open(&scene, &session), STATUS_OK);
        const struct problem problem = scene_problem(&scene, PRECISION_FLOAT);
        units[k] = forecast_of("bp_sinc:engine=general", &problem).units;
        predicted_over_measured(&session, "bp_sinc:engine=general", &error[k]);
        session_close(&session);
        scene_free(&scene);
    }
    if (!(units[0] > 0 && units[1] > 0.8 * units[0] && units[1] < 1.25 * units[0]))
        fail_msg("%g blocks are planned, %g of the same pings on a long track", units[0], units[1]);
    if (!(fabs(error[1] / error[0] - 1) < 1e-3))
        fail_msg("the error is %g, %g of the same pings on a long track", error[0], error[1]);
}

/* Records that end where pixels lie: taps read zeros beyond, padded records go on. */
static void cut_records(void **state)
{
    (void)state;
    static const char *const specs[] = {"bp_fitted:taps=12", "bp_fitted:taps=8,factor=2",
                                        "bp_sinc:taps=32,window=kaiser"};
    struct scene scene;
    struct session session;
    support_write(
        "cut.cfg",
        "sonar = { sound_speed = 1500.0; fc = 150e3; bandwidth = 15e3; fs = 30e3; };\n"
        "pulse = { kind = \"flat\"; };\n"
        "array = { tx_length = 0.02; rx_length = 0.02; receivers = 1; first_offset = 0.0; };\n"
        "track = { speed = 0.0; pri = 0.1; spacing = 0.01; pings = 6; x_first = -0.025; };\n"
        "record = { first_sample = 400; samples = 64; };\n"
        "beam = { kind = \"txrx\"; };\n"
        "targets = { points = ({ x = 0.0; r = 10.01; }, { x = 0.0; r = 10.27; }, { x = 0.0; r = 10.5; },\n"
        "                      { x = 0.0; r = 10.78; }, { x = 0.0; r = 11.02; }, { x = 0.0; r = 11.55; }); };\n"
        "image = { x = { first = -0.02; step = 0.01; count = 5; };\n"
        "          r = { first = 10.0; step = 0.0175; count = 90; }; };\n");
    support_scene(path_of("cut.cfg"), &scene);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    for (size_t k = 0; k < sizeof specs / sizeof *specs; k++) {
        double error;
        const double ratio = predicted_over_measured(&session, specs[k], &error);
        if (!(ratio > 0.9 && ratio < 6))
            fail_msg("%s: an error of %g is predicted, %g measured", specs[k], ratio * error, error);
    }
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
        cmocka_unit_test(closed_forms),
        cmocka_unit_test_setup_teardown(measured, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(measured_of_points, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(noise_keeps_errors, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(range_migration, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(known_targets, folder_make, folder_remove),
        cmocka_unit_test(judged_parts),
        cmocka_unit_test_setup_teardown(flanks, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(few_pings_met, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(cut_records, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(omega_k, folder_make, folder_remove),
    };
    return cmocka_run_group_tests_name("law", tests, NULL, NULL);
}
