/* Scenes at the ends of what numbers, memory and names can be: they work, or say why not. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support.h"

#include "run/batch.h"
#include "measure/scalar_loop.h"
#include "measure/timing.h"
#include "metrics/metrics.h"
#include "text/number.h"
#include "measure/outcome.h"
#include "scene/simulate.h"

#define SCENES SASBENCH_ROOT "/scenes"

/* study/quick, compressed, by parts that the tests vary. */
struct parts {
    const char *track, *record, *beam, *targets, *image;
};
static const struct parts plain = {
    "speed = 2.5; pri = 0.064; pings = 18; x_first = -1.52;", "first_sample = 720; samples = 256;", "kind = \"rect\";",
    "{ x = 0.0; r = 20.0; }",
    "x = { first = -0.6; step = 0.02; count = 61; }; r = { first = 19.9; step = 0.025; count = 9; };"};

static const char *scene_write(const char *name, const struct parts *parts)
{
    char text[2000];
    snprintf(text, sizeof text,
             "sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\npulse = { kind = \"flat\"; };\n"
             "array = { tx_length = 0.08; rx_length = 0.04; receivers = 8; first_offset = 0.04; pitch = 0.04; };\n"
             "track = { %s };\nrecord = { %s };\nbeam = { %s };\ntargets = { points = ( %s ); };\nimage = { %s };\n",
             parts->track, parts->record, parts->beam, parts->targets, parts->image);
    support_write(name, text);
    return path_of(name);
}

static struct scene scene_of(const char *name, const struct parts *parts)
{
    struct scene scene;
    enum status status = scene_load(scene_write(name, parts), SCENES, &scene);
    if (status != STATUS_OK)
        print_error("%s\n", status_message());
    assert_int_equal(status, STATUS_OK);
    return scene;
}

static void assert_says(const char *text, const char *part)
{
    if (!strstr(text, part))
        print_error("'%s' is not in: %s\n", part, text);
    assert_non_null(strstr(text, part));
}

/* --- A target on the element ----------------------------------------------------------------------------------- */

static void target_on_the_element_is_seen_from_broadside(void **state)
{
    (void)state;
    struct parts parts = plain;
    parts.track = "speed = 2.5; pri = 0.032; pings = 9; x_first = -0.32;";
    parts.record = "first_sample = 0; samples = 512;";
    parts.beam = "kind = \"txrx\";";
    parts.targets = "{ x = 0.0; r = 0.0; }, { x = 0.0; r = 3.0; }";
    parts.image = "x = { first = -0.2; step = 0.02; count = 21; }; r = { first = 2.9; step = 0.025; count = 9; };";
    struct scene scene = scene_of("on.cfg", &parts);
    struct echoes echoes;
    struct image image;
    struct problem problem = problem_make(&scene.acquisition, scene.patch_count, scene.patches, PRECISION_DOUBLE);
    /* On the transmitter the receiver, 0.04 m ahead, has its fourth null; on a receiver, at 4 nulls of its own,
       likewise. */
    assert_close(support_beam_weight(&scene, 4, 0, scene.acquisition.tx[4], 0, 150e3), 0, 1e-9);
    assert_close(support_beam_weight(&scene, 4, 0, scene.acquisition.rx[4 * 8], 0, 150e3), 0, 1e-9);
    support_echoes(&scene, &echoes);
    const double complex *samples = echoes.samples;
    for (int k = 0; k < 9 * 8 * 512; k++)
        assert_true(isfinite(creal(samples[k])) && isfinite(cimag(samples[k])));
    assert_int_equal(support_image("bp_sinc:precision=double", problem, &echoes, &image), STATUS_OK);
    assert_true(image_is_finite(&image));
    image_free(&image);
    echoes_free(&echoes);
    scene_free(&scene);
}

/* --- Amplitudes beyond float ----------------------------------------------------------------------------------- */

/* x86's flush-to-zero and denormals-are-zero, for this thread. */
static void flush_to_zero(bool on)
{
#ifdef __SSE__
    unsigned flags = 0x8040, state = __builtin_ia32_stmxcsr();
    __builtin_ia32_ldmxcsr(on ? state | flags : state & ~flags);
#else
    (void)on;
#endif
}

static void amplitude_measured(const char *amplitude, double value, bool flush)
{
    static const char *const specs[] = {"bp_nearest", "bp_sinc", "bp_zeropad", "bp_farrow", "bp_fitted", "rma_lbf"};
    char targets[100];
    struct parts parts = plain;
    snprintf(targets, sizeof targets, "{ x = 0.0; r = 20.0; amplitude = %s; }", amplitude);
    struct scene unit = scene_of("unit.cfg", &parts);
    parts.targets = targets;
    struct scene scene = scene_of("scaled.cfg", &parts);
    struct problem problem = problem_make(&unit.acquisition, unit.patch_count, unit.patches, PRECISION_FLOAT);
    struct echoes echoes, scaled_echoes;
    support_echoes(&unit, &echoes);
    support_echoes(&scene, &scaled_echoes);
    for (size_t k = 0; k < sizeof specs / sizeof *specs; k++) {
        struct image image, scaled;
        assert_int_equal(support_image(specs[k], problem, &echoes, &image), STATUS_OK);
        flush_to_zero(flush);
        assert_int_equal(support_image(specs[k], problem, &scaled_echoes, &scaled), STATUS_OK);
        flush_to_zero(false);
        double peak = support_peak(&image), largest = 0;
        for (int i = 0; i < unit.patches[0].r_count; i++)
            for (int j = 0; j < unit.patches[0].x_count; j++) {
                double complex off = image_pixel(&scaled, 0, i, j) / value - image_pixel(&image, 0, i, j);
                largest = fmax(largest, cabs(off));
            }
        if (!(largest <= 2e-6 * peak))
            print_error("amplitude %s, %s: off by %g of the peak\n", amplitude, specs[k], largest / peak);
        assert_true(largest <= 2e-6 * peak);
        image_free(&image);
        image_free(&scaled);
    }
    echoes_free(&echoes);
    echoes_free(&scaled_echoes);
    scene_free(&unit);
    scene_free(&scene);
}

static void any_amplitude_gives_the_same_image(void **state)
{
    (void)state;
    amplitude_measured("1e-36", 1e-36, false);
    amplitude_measured("1e-44", 1e-44, false);
    amplitude_measured("1e-100", 1e-100, false);
    amplitude_measured("1e38", 1e38, false);
    amplitude_measured("1e100", 1e100, false);
    amplitude_measured("1e-300", 1e-300, false);
    amplitude_measured("1e300", 1e300, false);
    amplitude_measured("1e-36", 1e-36, true);
    amplitude_measured("1e-42", 1e-42, true);
    amplitude_measured("1.0", 1, true);
}

static void amplitudes_have_bounds(void **state)
{
    (void)state;
    static const char *const bad[] = {"1e-301", "1e301", "[1e-301, 1e-301]", "-1e-305"};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char targets[100];
        struct parts parts = plain;
        struct scene scene;
        snprintf(targets, sizeof targets, "{ x = 0.0; r = 20.0; amplitude = %s; }", bad[k]);
        parts.targets = targets;
        assert_int_equal(scene_load(scene_write("bad.cfg", &parts), SCENES, &scene), STATUS_INVALID);
        assert_says(status_message(), "key 'targets.points[0].amplitude'");
        assert_says(status_message(), "0 or of magnitude >= 1e-300");
    }
    struct parts parts = plain;
    parts.targets = "{ x = 0.0; r = 20.0; amplitude = [1.0, 1e-200]; }, { x = 0.1; r = 20.0; amplitude = 0; }";
    struct scene scene = scene_of("good.cfg", &parts);
    assert_int_equal(scene.point_count, 2);
    scene_free(&scene);
}

/* A power of two, undone: not one bit is lost, whatever the precision. */
static void scale_is_undone_exactly(void **state)
{
    (void)state;
    struct acquisition a = {.samples = 3, .receivers = 1, .pings = 1};
    double complex samples[3] = {0x1.8p1000 + 0x1p990 * I, -0x1p980, 0};
    struct echoes from = {&a, PRECISION_DOUBLE, samples, 0}, to;
    assert_int_equal(echoes_convert(&from, PRECISION_FLOAT, &to), STATUS_OK);
    assert_int_equal(to.exponent, 1001);
    const float complex *small = to.samples;
    assert_true(small[0] == 0.75f + 0x1p-11f * I && small[1] == -0x1p-21f && small[2] == 0);
    const struct grid grid = {0, 1, 3, 0, 1, 1};
    struct image image;
    assert_int_equal(image_allocate(1, &grid, PRECISION_FLOAT, &image), STATUS_OK);
    memcpy(image.pixels[0], to.samples, 3 * sizeof *small);
    assert_int_equal(image_scale(&image, to.exponent), STATUS_OK);
    assert_true(image.precision == PRECISION_DOUBLE && image_pixel(&image, 0, 0, 0) == samples[0]
                && image_pixel(&image, 0, 0, 1) == samples[1] && image_pixel(&image, 0, 0, 2) == 0);
    image_free(&image);
    echoes_free(&to);
}

/* --- Coordinates large against the step ------------------------------------------------------------------------ */

static void coordinates_far_from_zero_are_on_the_raster(void **state)
{
    (void)state;
    struct parts parts = plain;
    parts.track = "speed = 2.5; pri = 0.064; pings = 18; x_first = 3999998.48;";
    parts.targets = "{ x = 4000000.0; r = 20.0; }";
    parts.image =
        "x = { first = 3999999.9984; step = 0.0001; count = 33; }; r = { first = 20.0; step = 0.025; count = 1; };";
    struct scene scene = scene_of("far.cfg", &parts);
    struct session session;
    struct spec spec;
    struct outcome outcome;
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    assert_int_equal(spec_parse("bp_nearest", &spec), STATUS_OK);
    outcome_measure(&session, &spec, EFFORT_NONE, NULL, &outcome);
    assert_string_equal(outcome.row.status, "ok");
    assert_true(outcome.row.error > 0 && outcome.row.error < 0.5 && outcome.row.phase_rms_rad < 0.5);
    assert_says(outcome.reason, "target 1: the main lobe does not fall to half its peak"); /* 3 mm of image */
    outcome_free(&outcome);
    spec_free(&spec);
    session_close(&session);
    scene_free(&scene);
}

/* --- A scene without an exact image, or without echoes ---------------------------------------------------------- */

static struct results results_of(const char *name, const struct parts *parts, enum status wanted)
{
    static const char *const specs[] = {"reference", "bp_nearest", "rma_lbf"};
    struct spec parsed[3];
    struct scene scene = scene_of(name, parts);
    struct batch batch;
    struct results results;
    char out[400];
    for (int k = 0; k < 3; k++)
        assert_int_equal(spec_parse(specs[k], &parsed[k]), STATUS_OK);
    snprintf(out, sizeof out, "%s", path_of("out"));
    assert_int_equal(batch_open(out, 3, false, &batch), STATUS_OK);
    enum status status = batch_scene(&batch, &scene, 3, parsed);
    assert_int_equal(batch_close(&batch, status), wanted);
    assert_int_equal(results_read(path_of("out/measurements.csv"), &results), STATUS_OK);
    assert_int_equal(results.csv.row_count, 3);
    for (int k = 0; k < 3; k++)
        spec_free(&parsed[k]);
    scene_free(&scene);
    return results;
}

static void refused_reference_is_a_row(void **state)
{
    (void)state;
    struct parts parts = plain;
    parts.track = "speed = 2.5; pri = 0.032; pings = 2;";
    parts.record = "first_sample = 0; samples = 2200000;";
    struct results results = results_of("long.cfg", &parts, STATUS_OK);
    const struct measurement *rows = results.measurements;
    assert_string_equal(rows[0].status, "unsupported");
    assert_says(rows[0].reason, "2200000 samples");
    for (int k = 1; k < 3; k++) {
        assert_string_equal(rows[k].status, "ok");
        assert_true(rows[k].run_s > 0 && isnan(rows[k].error));
        assert_says(rows[k].reason, "no errors, for there is no exact image: records of 2200000 samples");
    }
    results_free(&results);
}

static void echoes_without_memory_are_failed_rows(void **state)
{
    (void)state;
    struct parts parts = plain;
    parts.track = "speed = 2.5; pri = 0.032; pings = 2000000;";
    parts.record = "first_sample = 0; samples = 4000;"; /* 2 TB */
    parts.image = "x = { first = 0.0; step = 0.02; count = 3; }; r = { first = 20.0; step = 0.025; count = 3; };";
    struct results results = results_of("huge.cfg", &parts, STATUS_FAILED);
    for (int k = 0; k < 3; k++) {
        assert_string_equal(results.measurements[k].status, "failed");
        assert_says(results.measurements[k].reason, "no memory for the echoes of huge");
        assert_says(results.measurements[k].reason, "GB are needed");
    }
    results_free(&results);
}

/* --- Names ------------------------------------------------------------------------------------------------------ */

static void scenes_are_named_by_their_file(void **state)
{
    (void)state;
    struct scene *scenes;
    int count;
    char first[600], dotted[600], second[600], third[600];
    mkdir(path_of("a"), 0777);
    mkdir(path_of("b"), 0777);
    snprintf(first, sizeof first, "%s", scene_write("a/my.cfg", &plain));
    snprintf(dotted, sizeof dotted, "%s", path_of("a/../a/./my.cfg"));
    snprintf(second, sizeof second, "%s", scene_write("b/my.cfg", &plain));
    snprintf(third, sizeof third, "%s", scene_write("b/other \"one\" ü.cfg", &plain));
    const char *const twice[] = {first, dotted}, *const shipped[] = {"study/quick", "study/../study/quick"};
    const char *const all[] = {first, second, third, "study/quick"};
    assert_int_equal(scenes_load("run", 2, twice, &scenes, &count), STATUS_INVALID);
    assert_says(status_message(), "is given twice");
    scenes_free(scenes, count);
    assert_int_equal(scenes_load("run", 2, shipped, &scenes, &count), STATUS_INVALID);
    assert_says(status_message(), "is given twice");
    scenes_free(scenes, count);
    assert_int_equal(scenes_load("run", 4, all, &scenes, &count), STATUS_OK);
    assert_string_equal(scenes[0].name, "a/my");
    assert_string_equal(scenes[1].name, "b/my");
    assert_string_equal(scenes[2].name, "other \"one\" ü");
    assert_string_equal(scenes[3].name, "study/quick");
    scenes_free(scenes, count);
    struct scene scene = scene_of("b/my.cfg", &plain);
    assert_string_equal(scene.name, "my");
    scene_free(&scene);
    assert_int_equal(scene_load(scene_write("b/two\nlines.cfg", &plain), SCENES, &scene), STATUS_INVALID);
    assert_says(status_message(), "control characters");
}

/* --- Places beyond the bound ------------------------------------------------------------------------------------ */

static void all_pings_and_receivers_are_bounded(void **state)
{
    (void)state;
    struct scene scene;
    struct parts parts = plain;
    parts.track = "speed = 2.5; pri = 1e300; pings = 18; x_first = -1.52;";
    assert_int_equal(scene_load(scene_write("bad.cfg", &parts), SCENES, &scene), STATUS_INVALID);
    assert_says(status_message(), "bad.cfg:4: key 'track.pri' is 1e+300");
    assert_says(status_message(), "within +-1e+12 m");
    parts.track = "speed = -2.5; pri = 1e12; pings = 2;";
    assert_int_equal(scene_load(scene_write("bad.cfg", &parts), SCENES, &scene), STATUS_INVALID);
    assert_says(status_message(), "key 'track.pri' is 1e+12");
}

/* --- The scalar reference loop
   ------------------------------------------------------------------------------------------- */

/* A pair costs what it costs, however many others lie outside the record. */
static void control_counts_what_it_sums(void **state)
{
    (void)state;
    struct parts parts = plain;
    parts.image = "x = { first = -0.6; step = 0.02; count = 61; }; r = { first = 18.1; step = 0.004; count = 400; };";
    struct scene inside = scene_of("inside.cfg", &parts);
    parts.image = "x = { first = -0.6; step = 0.02; count = 61; }; r = { first = 10.0; step = 0.25; count = 400; };";
    struct scene outside = scene_of("outside.cfg", &parts);
    struct echoes echoes;
    double least[2] = {INFINITY, INFINITY};
    seconds_skip_waiting();
    assert_int_equal(echoes_allocate(&inside.acquisition, PRECISION_FLOAT, &echoes), STATUS_OK);
    for (int round = 0; round < 7; round++)
        for (int k = 0; k < 2; k++) {
            const struct scene *scene = k ? &outside : &inside;
            struct problem problem = problem_make(&scene->acquisition, 1, scene->patches, PRECISION_FLOAT);
            struct scalar_loop loop = scalar_loop_choose(&problem, &echoes);
            least[k] = fmin(least[k], scalar_loop_seconds(&loop));
            scalar_loop_free(&loop);
        }
    if (!(least[1] > 0.6 * least[0] && least[1] < 1.7 * least[0]))
        print_error("%g s inside, %g s outside\n", least[0], least[1]);
    assert_true(least[1] > 0.6 * least[0] && least[1] < 1.7 * least[0]);
    struct grid nowhere = {0, 1, 5, 1e5, 1, 5};
    struct problem problem = problem_make(&inside.acquisition, 1, &nowhere, PRECISION_FLOAT);
    struct scalar_loop none = scalar_loop_choose(&problem, &echoes);
    assert_true(isnan(scalar_loop_seconds(&none)));
    scalar_loop_free(&none);
    echoes_free(&echoes);
    scene_free(&inside);
    scene_free(&outside);
}

/* --- Numbers ---------------------------------------------------------------------------------------------------- */

static void numbers_are_plain_decimal(void **state)
{
    (void)state;
    static const char *const bad[] = {"",          " 1", "+",   ".",  "-.",  "0x10",  "nan", "inf",
                                      "-infinity", "e5", ".e5", "1e", "1e+", "1e999", "0X1", ",5"};
    static const struct {
        const char *text, *rest;
        double value;
    } good[] = {{"1.5:", ":", 1.5}, {"-.5e-3", "", -0.5e-3}, {"1.", "", 1},
                {"1,5", ",5", 1},   {"+7e2,", ",", 700},     {"1e-999", "", 0}};
    double value = 3;
    long long whole = 3;
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        assert_null(number_read(bad[k], &value));
    for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
        const char *rest = number_read(good[k].text, &value);
        assert_non_null(rest);
        assert_string_equal(rest, good[k].rest);
        assert_true(value == good[k].value);
    }
    assert_null(whole_read(" 5", 0, 9, &whole));
    assert_null(whole_read("10", 0, 9, &whole));
    assert_null(whole_read("99999999999999999999", 0, 9, &whole));
    assert_null(whole_read("-", -9, 9, &whole));
    assert_string_equal(whole_read("-7x", -9, 9, &whole), "x");
    assert_int_equal(whole, -7);
    struct grid grid;
    static const char *const grids[] = {"0x0:0x1p-5:5,20:0.1:5", "0:0.1:0x5,20:0.1:5", " 0:0.1:5,20:0.1:5",
                                        "0:inf:5,20:0.1:5",      "0:0.1:5,20:0.1:5 ",  "0:0,1:5,20:0.1:5"};
    for (size_t k = 0; k < sizeof grids / sizeof *grids; k++)
        assert_int_equal(grid_parse(grids[k], &grid), STATUS_INVALID);
    assert_int_equal(grid_parse("-0.5:.02:51,19.5:25e-3:41", &grid), STATUS_OK);
    assert_true(grid.x_step == 0.02 && grid.r_step == 0.025 && grid.r_count == 41);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(target_on_the_element_is_seen_from_broadside, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(any_amplitude_gives_the_same_image, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(amplitudes_have_bounds, folder_make, folder_remove),
        cmocka_unit_test(scale_is_undone_exactly),
        cmocka_unit_test_setup_teardown(coordinates_far_from_zero_are_on_the_raster, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(refused_reference_is_a_row, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(echoes_without_memory_are_failed_rows, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(scenes_are_named_by_their_file, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(all_pings_and_receivers_are_bounded, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(control_counts_what_it_sums, folder_make, folder_remove),
        cmocka_unit_test(numbers_are_plain_decimal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
