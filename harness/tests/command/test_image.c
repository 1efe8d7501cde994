/* The command `image`: the error that it measures of its own image. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/csv.h"
#include "tests/command/program.h"

/* `image --verify` measures what `run` does: of few pixels all, of recorded echoes as of a scene's. */
static void errors_are_verified(void **state)
{
    (void)state;
    static const char *const verified[ARGUMENTS_MAX] = {"image",     "--scene", "study/quick", "-a",
                                                        "bp_linear", "-o",      "v.mat",       "--verify"};
    static const char *const measured[ARGUMENTS_MAX] = {"run", "study/quick", "-a", "bp_linear", "-o", "verified"};
    struct csv csv;
    char *told = program_output(verified);
    const char *error = strstr(told, "Relative error ");
    assert_non_null(error);
    assert_non_null(strstr(told, ", of all 793 pixels.\n"));
    program_good(measured);
    assert_int_equal(csv_read(path_in("verified/measurements.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    const double gained = strtod(csv_cell(&csv, 0, csv_column(&csv, "error_gain")), NULL);
    assert_true(fabs(strtod(error + 15, NULL) / gained - 1) < 5e-3); /* three digits are printed */
    csv_free(&csv);
    free(told);
}

/* study/quick with one amplitude. */
static const char quick_text[] =
    "sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\n"
    "pulse = { kind = \"lfm\"; duration = 2e-3; };\n"
    "array = { tx_length = 0.08; rx_length = 0.04; receivers = 8; first_offset = 0.04; pitch = 0.04; };\n"
    "track = { speed = 2.5; pri = 0.064; pings = 18; x_first = -1.52; };\n"
    "record = { first_sample = 720; samples = 256; };\n"
    "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.443; };\n"
    "targets = { points = ( { x = 0.0; r = 20.0; amplitude = %.17g; } ); };\n"
    "image = { around_targets = { half_x = 0.6; half_r = 0.15; x_step = 0.02; r_step = 0.025; }; };\n";

#define GRID "-.6:.02:61,19.85:.025:13"

/* extreme.cfg, and its recording. */
static void extreme_make(double amplitude)
{
    const char *const simulate[ARGUMENTS_MAX] = {"simulate", "extreme.cfg", "-o", "extreme.mat"};
    char text[2000];
    snprintf(text, sizeof text, quick_text, amplitude);
    text_write("extreme.cfg", text);
    program_good(simulate);
}

/* What `image --verify` says of a scene and of a recording of it with echoes of this amplitude, without a warning. */
static void error_of_amplitude(double amplitude, const char *algorithm, char of[2][300])
{
    extreme_make(amplitude);
    for (int k = 0; k < 2; k++) {
        const char *const verified[ARGUMENTS_MAX] = {"image",
                                                     k ? "--echoes" : "--scene",
                                                     k ? "extreme.mat" : "extreme.cfg",
                                                     "-a",
                                                     algorithm,
                                                     "--grid",
                                                     "-.6:.02:61,19.85:.025:13",
                                                     "-o",
                                                     "v.mat",
                                                     "--verify"};
        char *told = program_output(verified);
        snprintf(of[k], sizeof of[k], "%.*s", (int)strcspn(told, "\n"), told);
        assert_non_null(strstr(of[k], "Relative error "));
        free(told);
    }
}

/* A power of two changes no digit of an error and brings no warning, though samples lie at the ends of the range. */
static void extreme_echoes_are_measured(void **state)
{
    (void)state;
    static const char *const specs[] = {"bp_linear", "bp_linear:precision=double", "auto:error=1e-3"};
    static const double amplitudes[] = {0x1p990, 0x1p-990};
    char usual[2][300], extreme[2][300];
    for (size_t a = 0; a < COUNT_OF(specs); a++) {
        error_of_amplitude(1, specs[a], usual);
        for (size_t n = 0; n < COUNT_OF(amplitudes); n++) {
            error_of_amplitude(amplitudes[n], specs[a], extreme);
            for (int k = 0; k < 2; k++)
                assert_string_equal(extreme[k], usual[k]);
        }
    }
}

/* Tiles keep the samples' own unit. What a precision does not hold is refused before a file is made. */
static void extreme_tiles_are_refused(void **state)
{
    (void)state;
    static const struct refusal refusals[] = {
        {{"image", "--scene", "extreme.cfg", "-a", "bp_linear", "--tile", "20x5", "-o", "t.mat"},
         {"float does not hold", "precision=double"}},
        {{"image", "--echoes", "extreme.mat", "-a", "bp_linear", "--tile", "20x5", "-o", "t.mat", "--grid", GRID},
         {"the largest sample is 1.1e+30", "in float", "precision=double"}}};
    static const char *const tiled[ARGUMENTS_MAX] = {
        "image", "--echoes", "extreme.mat", "-a", "bp_linear:precision=double", "--tile", "20x5",
        "-o",    "t.mat",    "--grid",      GRID};
    static const char *const whole[ARGUMENTS_MAX] = {
        "image", "--echoes", "extreme.mat", "-a", "bp_linear:precision=double", "-o", "w.mat", "--grid", GRID};
    static const char *const compare[ARGUMENTS_MAX] = {"compare", "t.mat", "w.mat"};
    extreme_make(1e30);
    assert_all_refused(refusals, COUNT_OF(refusals));
    assert_int_not_equal(access(path_in("t.mat"), F_OK), 0);
    assert_int_not_equal(access(path_in("t.mat.tiles"), F_OK), 0);
    program_good(tiled);
    program_good(whole);
    char *told = program_output(compare);
    assert_int_equal(strncmp(told, "Relative error ", 15), 0);
    assert_true(strtod(told + 15, NULL) < 1e-12);
    free(told);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(errors_are_verified),
                                       cmocka_unit_test(extreme_echoes_are_measured),
                                       cmocka_unit_test(extreme_tiles_are_refused)};
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
