/* Recorded echoes are scenes: what is measured on simulated echoes is measured on the same echoes out of a file. Two
   recorded sets go through `run` where they are there, and are skipped where not. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/csv.h"
#include "echoes/matfile.h"
#include "tests/command/program.h"

#define QUICK_IMAGE "image = { around_targets = { half_x = 0.6; half_r = 0.15; x_step = 0.02; r_step = 0.025; }; };\n"
#define QUICK_POINT "targets = { points = ( { x = 0.0; r = 20.0; } ); };\n"

static void csv_load(const char *name, struct csv *csv)
{
    if (csv_read(path_in(name), CSV_TAIL_KEEP, csv) != STATUS_OK)
        fail_msg("%s", status_message());
}

static double number_of(const struct csv *csv, int row, const char *column)
{
    double value = NAN;
    assert_true(csv_column(csv, column) >= 0);
    assert_true(csv_number(csv_cell(csv, row, csv_column(csv, column)), &value));
    return value;
}

static void assert_same_column(const struct csv *a, const struct csv *b, int row, const char *column)
{
    double first = number_of(a, row, column), second = number_of(b, row, column);
    if (!(fabs(first - second) <= 1e-7 * fabs(first) + 1e-12))
        fail_msg("row %d, %s: %g simulated, %g recorded", row + 1, column, first, second);
}

/* study/quick, and a scene that takes its echoes (good.mat) from their file. */
static void file_measures_as_the_scene_does(void **state)
{
    (void)state;
    static const char *const simulated[ARGUMENTS_MAX] = {"run", "study/quick", "-a", "bp_nearest", "-a", "rma_lbf",
                                                         "-a",  "bp_sinc",     "-o", "simulated"};
    static const char *const recorded[ARGUMENTS_MAX] = {"run", "sub/recorded.cfg", "-a", "bp_nearest", "-a", "rma_lbf",
                                                        "-a",  "bp_sinc",          "-o", "recorded"};
    static const char *const columns[] = {"flops",         "pairs",   "error",   "error_gain",
                                          "phase_rms_rad", "width_m", "pslr_db", "islr_db"};
    static const char *const target_columns[] = {"extent_m", "position_error_m", "phase_error_rad", "width_m"};
    struct csv rows[2], targets[2];
    assert_int_equal(system("mkdir -p \"$TMPDIR/sub\""), 0);
    text_write("sub/recorded.cfg", "echoes = \"../good.mat\";\n" QUICK_POINT QUICK_IMAGE);
    program_good(simulated);
    program_good(recorded);
    csv_load("simulated/measurements.csv", &rows[0]);
    csv_load("recorded/measurements.csv", &rows[1]);
    csv_load("simulated/targets.csv", &targets[0]);
    csv_load("recorded/targets.csv", &targets[1]);
    assert_int_equal(rows[1].row_count, 3);
    assert_int_equal(targets[1].row_count, targets[0].row_count);
    for (int row = 0; row < 3; row++) {
        assert_string_equal(csv_cell(&rows[1], row, csv_column(&rows[1], "scene")), "recorded");
        assert_string_equal(csv_cell(&rows[1], row, csv_column(&rows[1], "status")), "ok");
        for (size_t k = 0; k < COUNT_OF(columns); k++)
            assert_same_column(&rows[0], &rows[1], row, columns[k]);
    }
    for (int row = 0; row < targets[0].row_count; row++)
        for (size_t k = 0; k < COUNT_OF(target_columns); k++)
            assert_same_column(&targets[0], &targets[1], row, target_columns[k]);
    for (int k = 0; k < 2; k++) {
        csv_free(&rows[k]);
        csv_free(&targets[k]);
    }
    assert_int_equal(access(path_in("recorded/recorded-slices.png"), F_OK), 0);
}

static void echoes_alone_are_a_scene(void **state)
{
    (void)state;
    static const char *const run[ARGUMENTS_MAX] = {
        "run", "--echoes", "good.mat", "--grid", "-0.6:0.02:61,19.85:0.025:13", "-a", "bp_sinc", "-o", "alone"};
    static const char *const other[ARGUMENTS_MAX] = {
        "run", "--echoes", "good.mat", "--grid", "-0.6:0.02:61,19.85:0.025:12", "-a", "bp_sinc", "-o", "alone"};
    static const char *const check[ARGUMENTS_MAX] = {
        "check", "--echoes", "good.mat", "--grid", "-0.6:0.02:61,19.85:0.025:13", "-a", "bp_sinc"};
    struct csv first, again;
    program_good(run);
    csv_load("alone/measurements.csv", &first);
    assert_int_equal(first.row_count, 1);
    assert_string_equal(csv_cell(&first, 0, csv_column(&first, "scene")), "good");
    assert_true(number_of(&first, 0, "error") < 0.1);
    program_good(run); /* is there already */
    csv_load("alone/measurements.csv", &again);
    assert_string_equal(csv_cell(&again, 0, csv_column(&again, "run_s")),
                        csv_cell(&first, 0, csv_column(&first, "run_s")));
    csv_free(&again);
    struct outcome outcome = program_run(other); /* another image is another scene */
    assert_int_equal(outcome.status, 0);
    assert_non_null(strstr(outcome.err, "the scene good has changed"));
    outcome_free(&outcome);
    char *text = program_output(check);
    assert_non_null(strstr(text, "good: 1 of 1 algorithm takes this scene"));
    free(text);
    csv_free(&first);
}

static void assert_holds(const char *text, const char *part)
{
    if (!strstr(text, part))
        fail_msg("no '%s' in: %s", part, text);
}

/* The grid that `info` proposes, as an option. */
static void grid_proposed(const char *told, char grid[200])
{
    const char *proposed = strstr(told, "--grid=");
    assert_non_null(proposed);
    snprintf(grid, 200, "%.*s", (int)strcspn(proposed, "\n"), proposed);
}

/* The peak that `image` tells is at (x, 20) m. */
static void assert_peak(const char *told, double x_wanted)
{
    double x, r;
    const char *peak = strstr(told, "peak ");
    assert_non_null(peak);
    assert_int_equal(sscanf(peak, "peak %*f at (%lf, %lf) m", &x, &r), 2);
    assert_true(fabs(x - x_wanted) < 0.05 && fabs(r - 20) < 0.05);
}

/* Coordinates of a map projection keep their digits, and what `info` proposes is fine enough for `image`. */
static void far_recordings_are_told(void **state)
{
    (void)state;
    static const char *const simulate[ARGUMENTS_MAX] = {"simulate", "far.cfg", "-o", "far.mat"};
    static const char *const info[ARGUMENTS_MAX] = {"info", "far.mat"};
    char grid[200];
    text_write("far.cfg", "base = {\n@include \"study/quick.cfg\"\n};\nx_offset = 4000123.4;\n"
                          "track = { speed = 0.0; spacing = 0.15; pri = 0.064; pings = 80; x_first = -6.0; };\n"
                          "record = { first_sample = 120; samples = 1600; };\n" /* near rows need finer pixels */
                          "beam = { kind = \"rect\"; truncation = \"none\"; };\n"
                          "array = { receivers = 3; pitch = 0.1; };\n");
    program_good(simulate);
    char *told = program_output(info);
    assert_holds(told, "track        from (4000117.4, 0, 0) to (4000129.25, 0, 0) m");
    grid_proposed(told, grid);
    free(told);
    const char *const image[ARGUMENTS_MAX] = {"image", "--echoes", "far.mat", grid, "-a", "bp_sinc", "-o", "far.png"};
    struct outcome outcome = program_run(image);
    assert_int_equal(outcome.status, 0);
    assert_null(strstr(outcome.err, "pixel_"));
    assert_peak(outcome.out, 4000123.4);
    outcome_free(&outcome);
}

/* Nothing of a file is -0: here the grid about one ping just before the origin begins there. */
static void zeros_have_no_sign(void **state)
{
    (void)state;
    static const char *const simulate[ARGUMENTS_MAX] = {"simulate", "one.cfg", "-o", "one.mat"};
    static const char *const info[ARGUMENTS_MAX] = {"info", "one.mat"};
    char grid[200];
    text_write("one.cfg", "base = {\n@include \"study/quick.cfg\"\n};\narray = { receivers = 1; first_offset = -0.0; "
                          "tx_length = 0.1; rx_length = 0.1; };\n"
                          "track = { speed = 2.5; pri = 0.064; pings = 1; x_first = -1e-4; };\n");
    program_good(simulate);
    char *told = program_output(info);
    grid_proposed(told, grid);
    assert_int_equal(strncmp(grid, "--grid=0:", 9), 0);
    assert_null(strstr(told, "-0,"));
    assert_null(strstr(told, "-0 "));
    free(told);
}

/* What `info` proposes is imaged, drawn, shown again and told. */
static void files_are_told_and_shown(void **state)
{
    (void)state;
    static const char *const info[ARGUMENTS_MAX] = {"info", "good.mat"};
    char *told = program_output(info), grid[200];
    assert_holds(told, "good.mat: echoes, raw");
    assert_holds(told, "256 (fast time) x 8 (receivers) x 18 (pings)");
    assert_holds(told, "fc 150000 Hz, bandwidth 15000 Hz, fs 30000 Hz");
    assert_holds(told, "ranges of 18 to 24.375 m");
    assert_holds(told, "uniform and straight, 0.16 m from ping to ping");
    assert_null(strstr(told, "\nnoise "));
    grid_proposed(told, grid);
    free(told);
    const char *const image[ARGUMENTS_MAX] = {"image", "--echoes", "good.mat", grid, "-a", "bp_sinc", "-o", "seen.mat"};
    static const char *const show[ARGUMENTS_MAX] = {"show", "seen.mat", "--range", "40"};
    static const char *const about[ARGUMENTS_MAX] = {"info", "seen.mat"};
    static const char *const chosen[ARGUMENTS_MAX] = {"image",          "--scene", "study/quick", "-a",
                                                      "auto:error=0.1", "-o",      "seen.mat"};
    static const char *const drawn[ARGUMENTS_MAX] = {"image",   "--scene", "study/quick", "-a",
                                                     "bp_sinc", "-o",      "seen.svg"};
    char *line = program_output(image);
    assert_holds(line, "seen.mat: bp_sinc of good, ");
    assert_peak(line, 0);
    free(line);
    line = program_output(show);
    assert_holds(line, "seen.png: good.mat: bp_sinc:taps=8,window=none");
    free(line);
    line = program_output(about);
    assert_holds(line, "seen.mat: an image of good.mat by bp_sinc:taps=8,window=none");
    assert_holds(line, "\n  engine invariant, fc 150000 Hz, sound speed 1500 m/s\n  of the scene's content ");
    assert_holds(line, ", by commit ");
    assert_holds(line, ", on 20");
    assert_non_null(strstr(line, "peak "));
    free(line);
    line = program_output(chosen);
    assert_holds(line, "seen.mat: auto of study/quick chose bp_");
    free(line);
    line = program_output(show);
    assert_holds(line, "seen.png: study/quick: auto:error=0.1 chose bp_");
    assert_holds(line, "\n  engine bp_");
    free(line);
    program_good(drawn);
    assert_int_equal(access(path_in("seen.png"), F_OK), 0);
    assert_int_equal(access(path_in("seen.svg"), F_OK), 0);
}

static const char *const mistakes[] = {"warning", "wavelength", "narrow_band", "far_away", "conjugated", "imaginary"};

static void mistake_make(size_t mistake, struct acquisition *a, double complex *samples)
{
    const size_t count = (size_t)a->pings * (size_t)a->receivers * (size_t)a->samples;
    a->fc /= mistake == 1 ? 1e3 : 1;
    a->fs /= mistake == 2 ? 1e3 : 1;
    a->bandwidth /= mistake == 2 ? 1e3 : 1;
    for (int p = 0; p < a->pings; p++)
        a->t0[p] *= mistake == 3 ? 1e3 : 1;
    for (size_t n = 0; n < count && mistake > 3; n++)
        samples[n] = mistake == 4 ? conj(samples[n]) : creal(samples[n]);
}

/* kHz for Hz, ms for s, the other sign of the phase, a lost part: `info` warns, and only then. */
static void mistakes_are_told(void **state)
{
    (void)state;
    static const char *const info[ARGUMENTS_MAX] = {"info", "wrong.mat"};
    for (size_t k = 0; k < COUNT_OF(mistakes); k++) {
        struct acquisition a;
        struct echoes echoes;
        assert_int_equal(echo_file_read(path_in("good.mat"), &a, &echoes), STATUS_OK);
        mistake_make(k, &a, (double complex *)echoes.samples);
        assert_int_equal(echo_file_write(path_in("wrong.mat"), &echoes, NULL), STATUS_OK);
        echoes_free(&echoes);
        acquisition_free(&a);
        char *told = program_output(info);
        if (!strstr(told, mistakes[k]) != (k == 0))
            fail_msg("mistake %zu, '%s': %s", k, mistakes[k], told);
        free(told);
    }
}

/* Noise is measured, told, and planned with: taps that are fitted to the band have 0.2 here. */
static void noise_is_told(void **state)
{
    (void)state;
    static const char *const simulate[ARGUMENTS_MAX] = {"simulate", "noisy.cfg", "-o", "noisy.mat"};
    static const char *const info[ARGUMENTS_MAX] = {"info", "noisy.mat"};
    static const char *const run[ARGUMENTS_MAX] = {
        "run", "--echoes", "noisy.mat", "--grid=-0.5:0.02:51,19.8:0.02:21", "-a", "auto:error=1e-3", "-o", "noisy"};
    struct csv rows;
    text_write("noisy.cfg", "base = {\n@include \"study/quick.cfg\"\n};\npulse = { kind = \"flat\"; };\n"
                            "noise = { std = 1.0; seed = 4; };\n");
    program_good(simulate);
    char *told = program_output(info);
    assert_holds(told, "\nnoise        ");
    free(told);
    program_good(run);
    csv_load("noisy/measurements.csv", &rows);
    const double error = strtod(csv_cell(&rows, 0, csv_column(&rows, "error_gain")), NULL);
    print_message("%s: %g\n", csv_cell(&rows, 0, csv_column(&rows, "engine")), error);
    assert_true(error > 0 && error <= 1e-3);
    csv_free(&rows);
}

/* One sample is another: so is the scene. */
static void content_tells_scenes_apart(void **state)
{
    (void)state;
    const struct grid grid = {-0.6, 0.02, 61, 19.85, 0.025, 13, 0};
    struct scene scene;
    uint64_t hashes[3];
    for (int k = 0; k < 3; k++) {
        char path[700];
        snprintf(path, sizeof path, "%s", path_in(k == 0 ? "good.mat" : "copy.mat"));
        if (scene_from_echoes(path, &grid, "grid", true, &scene) != STATUS_OK)
            fail_msg("%s", status_message());
        hashes[k] = scene.hash;
        const struct echoes echoes = {&scene.acquisition, PRECISION_DOUBLE, scene.recorded, 0};
        scene.recorded[1000] += k * 1e-12;
        assert_int_equal(echo_file_write(path_in("copy.mat"), &echoes, &(struct echo_notes){.description = "other"}),
                         STATUS_OK);
        scene_free(&scene);
        if (k == 1)
            assert_true(hashes[0] == hashes[1]);
    }
    assert_true(hashes[1] != hashes[2]);
}

#define BAD                                                                                                            \
    {                                                                                                                  \
        "run", "bad.cfg", "-a", "bp_nearest", "-o", "bad"                                                              \
    }

static void mixtures_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says[SAYS_MAX];
    } scenes[] = {
        {"sonar = { fc = 1e5; };", {"bad.cfg:2: key 'sonar' is a group", "left out with `echoes`"}},
        {"track = { };", {"bad.cfg:2: key 'track' is a group", "left out with `echoes`"}},
        {"noise = { std = 1; };", {"key 'noise' is a group", "left out with `echoes`"}},
        {"x_offset = 1;", {"key 'x_offset' is 1", "left out with `echoes`"}},
        {"targets = { fields = ( { x = [0, 1]; r = [19, 21]; count = 3; seed = 1; } ); };",
         {"key 'targets.fields'", "left out with `echoes`"}},
        {"targets = { points = ( { x = 0; r = 20; amplitude = 2; } ); };",
         {"key 'targets.points[0].amplitude' is 2", "left out with `echoes`"}},
    };
    static const char *const wholes[][1 + SAYS_MAX] = {
        {"\n\nechoes = \"none.mat\";\n" QUICK_POINT QUICK_IMAGE,
         "bad.cfg:3: key 'echoes': ", "none.mat: cannot be read"},
        {"echoes = \"\";\n" QUICK_POINT QUICK_IMAGE, "key 'sonar' is missing", "or `echoes` name an echo file"},
        {"echoes = 3;\n" QUICK_POINT QUICK_IMAGE, "key 'echoes' is 3", "a text"},
        {"echoes = \"good.mat\";\n", "key 'image' is missing", "a group"},
        {"echoes = \"good.mat\";\nimage = { x = { first = 0; step = 1; count = 3; }; r = { first = 90; step = 1; count "
         "= 2; }; };",
         "no pixel meets any record"},
    };
    static const struct refusal usages[] = {
        {{"run", "--echoes", "good.mat", "-o", "r"}, {"good.mat: variable `image_grid` is missing; --grid"}},
        {{"run", "--grid", "0:1:1,20:1:1", "-o", "r"}, {"run: --grid 0:1:1,20:1:1 goes with --echoes"}},
        {{"run", "study/quick", "--echoes", "good.mat", "--grid", "0:1:1,20:1:1", "-o", "r"},
         {"'study/quick' and --echoes good.mat are both given"}},
        {{"run", "good.mat", "-o", "r"}, {"good.mat: is no scene file", "--echoes FILE.mat --grid GRID"}},
        {{"sweep", "--echoes", "none.mat", "--grid", "0:1:1,20:1:1", "-o", "r"}, {"none.mat: cannot be read"}},
        {{"check"}, {"check: a SCENE, or --echoes FILE.mat, is missing"}},
        {{"simulate", "rec.cfg", "-o", "x.mat"}, {"the echoes of rec are recorded"}},
    };
    static const char *const arguments[ARGUMENTS_MAX] = BAD;
    int failures = 0;
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        char text[600];
        snprintf(text, sizeof text, "echoes = \"good.mat\";\n%s\n%s", scenes[k].text, QUICK_IMAGE);
        text_write("bad.cfg", text);
        failures += !is_refused(arguments, scenes[k].says);
    }
    for (size_t k = 0; k < COUNT_OF(wholes); k++) {
        text_write("bad.cfg", wholes[k][0]);
        failures += !is_refused(arguments, wholes[k] + 1);
    }
    text_write("rec.cfg", "echoes = \"good.mat\";\n" QUICK_POINT QUICK_IMAGE);
    assert_int_equal(failures, 0);
    assert_all_refused(usages, COUNT_OF(usages));
}

/* What is recorded is not ours to ship: the folder SASBENCH_DATA. `error` and `peak` are measured, of the settings in
   their order; peaks of the exact interpolators are those of an independent program. */
enum { SETTINGS = 4 };
static const struct recording {
    const char *file, *targets, *image;
    double position_m, error[SETTINGS], peak;
} recordings[] = {
    {"pins_in_water.mat",
     "{ x = -0.0095; r = 0.0431; }, { x = 0.0107; r = 0.03815; }",
     "x = { first = -0.016; step = 1e-4; count = 320; }; r = { first = 0.03; step = 5e-5; count = 400; };"
     "reference = { half_x = 0.002; half_r = 0.001; };",
     1e-4,
     {9.1e-4, 3.4e-3, 2.4e-2, 2.4e-2},
     241},
    {"gotcha_4deg.mat",
     "{ x = 14.0; r = -16.2; }",
     "x = { first = -20.0; step = 0.2; count = 201; }; r = { first = -20.0; step = 0.2; count = 201; };"
     "reference = { half_x = 4.0; half_r = 4.0; };",
     0.2,
     {2e-3, 2.3e-2, 0.26, 0.41},
     85},
};

static void rows_check(const struct recording *recording, const struct csv *rows)
{
    assert_int_equal(rows->row_count, SETTINGS + 1);
    assert_true(number_of(rows, 0, "error") < 1e-6); /* reference in float */
    for (int k = 0; k < SETTINGS; k++) {
        const char *algorithm = csv_cell(rows, k + 1, csv_column(rows, "algorithm"));
        const double error = number_of(rows, k + 1, "error"), peak = number_of(rows, k + 1, "peak_over_median");
        print_message("%s, %s: error %.3g, peak %.4g times the median\n", recording->file, algorithm, error, peak);
        if (!(error <= 1.05 * recording->error[k]))
            fail_msg("%s: error %g, at most %g is expected", algorithm, error, recording->error[k]);
        if (k < 2 && !(fabs(peak - recording->peak) <= 0.01 * recording->peak))
            fail_msg("%s: peak %g times the median, %g is expected", algorithm, peak, recording->peak);
    }
}

static void recorded_sets_run(void **state)
{
    (void)state;
    static const char *const run[ARGUMENTS_MAX] = {
        "run", "set.cfg",    "-a", "reference", "-a", "bp_sinc:taps=16,window=kaiser",
        "-a",  "bp_zeropad", "-a", "bp_linear", "-a", "bp_nearest",
        "-o",  "set"};
    int there = 0;
    for (size_t n = 0; n < COUNT_OF(recordings); n++) {
        const struct recording *recording = &recordings[n];
        char path[4096], text[6000];
        struct csv rows, targets;
        if (!support_recording(recording->file, path, sizeof path)) {
            print_message("%s is not there: set SASBENCH_DATA to the folder of the recordings\n", path);
            continue;
        }
        there++;
        snprintf(text, sizeof text, "echoes = \"%s\"; targets = { points = ( %s ); }; image = { %s };\n", path,
                 recording->targets, recording->image);
        text_write("set.cfg", text);
        struct outcome outcome = program_run(run);
        assert_int_equal(outcome.status, 0);
        outcome_free(&outcome);
        csv_load("set/measurements.csv", &rows);
        csv_load("set/targets.csv", &targets);
        rows_check(recording, &rows);
        for (int row = 0; row < targets.row_count; row++) {
            const double off = number_of(&targets, row, "position_error_m");
            if (!(fabs(off) <= recording->position_m) && !isnan(off))
                fail_msg("row %d of the targets is %g m off", row + 1, off);
        }
        assert_true(isfinite(number_of(&targets, 0, "position_error_m")));
        csv_free(&rows);
        csv_free(&targets);
    }
    if (there == 0)
        skip();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(file_measures_as_the_scene_does),
        cmocka_unit_test(echoes_alone_are_a_scene),
        cmocka_unit_test(far_recordings_are_told),
        cmocka_unit_test(zeros_have_no_sign),
        cmocka_unit_test(files_are_told_and_shown),
        cmocka_unit_test(mistakes_are_told),
        cmocka_unit_test(noise_is_told),
        cmocka_unit_test(content_tells_scenes_apart),
        cmocka_unit_test(mixtures_are_refused),
        cmocka_unit_test(recorded_sets_run),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
