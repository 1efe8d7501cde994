/* Scenes and echo files that are refused: each with exit status 2 and one line that names the key or variable; nothing
   is written. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <matio.h>

#include "tests/command/program.h"

/* --- Bad scenes ------------------------------------------------------------------------------------------------ */

static void scene_write(const char *name, const char *find, const char *replace)
{
    const char *at = strstr(scene_text, find);
    if (!at)
        fail_msg("no '%s' in the scene", find);
    FILE *file = fopen(path_in(name), "w");
    assert_non_null(file);
    fprintf(file, "%.*s%s%s", (int)(at - scene_text), scene_text, replace, at + strlen(find));
    assert_int_equal(fclose(file), 0);
}

static const struct {
    const char *find, *replace, *says[SAYS_MAX];
} scenes[] = {
    {"sonar = { fc = 150e3;", "sonar = {", {"bad.cfg:1: key 'sonar.fc' is missing", "> 0 Hz"}},
    {"image =", "picture =", {"bad.cfg", "picture", "accepted are"}},
    {"pings = 12", "pings = 12; pongs = 3", {"bad.cfg:4: key 'track.pongs'", "accepted are speed, pri, "}},
    {"fc = 150e3", "fc = 0", {"key 'sonar.fc' is 0", "a number > 0 Hz"}},
    {"fc = 150e3", "fc = -150e3", {"key 'sonar.fc' is -150000", "a number > 0 Hz"}},
    {"fc = 150e3", "fc = 1e999", {"key 'sonar.fc' is inf", "a number > 0 Hz"}},
    {"fc = 150e3", "fc = nan", {"bad.cfg:1:", "must be libconfig text"}},
    {"fc = 150e3", "fc = 150,5e3", {"bad.cfg:1:", "numbers with a decimal point"}},
    {"fc = 150e3; bandwidth = 15e3; fs = 30e3", "fc = 150; bandwidth = 15; fs = 30", {"meets any record", "fs in Hz"}},
    {"fc = 150e3", "fc = \"high\"", {"key 'sonar.fc' is \"high\"", "a number > 0 Hz"}},
    {"fc = 150e3", "fc = 1e15", {"bad.cfg", "phase error"}},
    {"fs = 30e3", "fs = 10e3", {"key 'sonar.fs' is 10000", "at least sonar.bandwidth (15000 Hz)"}},
    {"bandwidth = 15e3", "bandwidth = 0.0", {"key 'sonar.bandwidth' is 0", "a number > 0 Hz"}},
    {"fs = 30e3", "fs = 30e3; sound_speed = 0", {"key 'sonar.sound_speed' is 0", "> 0"}},
    {"\"lfm\"", "\"chirp\"", {"key 'pulse.kind' is \"chirp\"", "\"lfm\", \"lfm_time\", \"flat\""}},
    {"duration = 2e-3", "duration = 1.0", {"key 'pulse.duration' is 1.0", "no longer than the record"}},
    {"duration = 2e-3; ", "", {"key 'pulse.duration' is missing", "> 0 s"}},
    {"receivers = 4", "receivers = 0", {"key 'array.receivers' is 0", "an integer from 1"}},
    {"receivers = 4", "receivers = 4.5", {"key 'array.receivers' is 4.5", "an integer"}},
    {"pitch = 0.04", "pitch = 0", {"key 'array.pitch' is 0", "other than 0 m"}},
    {"tx_length = 0.08", "tx_length = -1", {"key 'array.tx_length' is -1", "> 0 and <= 1e+12 m"}},
    {"speed = 2.5", "speed = 1500", {"key 'track.speed' is 1500", "below sonar.sound_speed (1500 m/s)"}},
    {"speed = 2.5", "speed = -2000.0", {"key 'track.speed' is -2000", "below sonar.sound_speed"}},
    {"pri = 0.032", "pri = 0", {"key 'track.pri' is 0", "> 0 s"}},
    {"pings = 12", "pings = 0", {"key 'track.pings' is 0", "an integer from 1"}},
    {"pings = 12", "pings = -12", {"key 'track.pings' is -12", "an integer from 1"}},
    {"pings = 12", "pings = true", {"key 'track.pings' is true", "an integer from 1"}},
    {"pings = 12", "pings = 99999999999", {"bad.cfg:4: 99999999999 is out of range", "an integer from"}},
    {"pings = 12", "pings = 2000000000", {"key 'track.pings' is 2000000000", "at most"}},
    {"samples = 256", "samples = 1", {"key 'record.samples' is 1", "an integer from 2"}},
    {"first_sample = 720; ", "", {"bad.cfg:5: key 'record.first_sample' is missing", "an integer"}},
    {"\"tx\"", "\"rx\"", {"key 'beam.truncation' is \"rx\"", "\"tx\", \"mid\", \"doppler\""}},
    {"limit = 0.443", "limit = 0", {"key 'beam.limit' is 0", "a number > 0"}},
    {"r = 20.0", "r = 1e13", {"key 'targets.points[0].r' is 1e+13", "from -1e+12 to 1e+12"}},
    {"r = 20.0", "r = 2000.0", {"bad.cfg: no pixel meets any record", "must lie in the records' 0.024 to"}},
    {"( { x = 0.0; r = 20.0; } )", "()", {"key 'targets.points'", "at least one target"}},
    {"std = 0.0", "std = -1", {"bad.cfg:8: key 'noise.std' is -1", "from 0 to"}},
    {"std = 0.0", "std = 1e999", {"key 'noise.std' is inf"}},
    {"seed = 3", "seed = -3", {"key 'noise.seed' is -3", "an integer from 0"}},
    {"x_step = 0.02", "x_step = 0.0", {"x_step' is 0", "> 0 m"}},
    {"half_x = 0.3", "half_x = 1e12", {"half_x' is 1e+12", "at most"}},
    {"0.025; };", "0.025; }; patches = ();", {"key 'image'", "exactly one of"}},
    {"sonar", "aperture_limit = 2; sonar", {"key 'aperture_limit' is 2", "> 0 and <= 1"}},
    {"sonar", "@include \"missing.cfg\"\nsonar", {"bad.cfg:1: @include", "must be a readable file"}},
    {"30e3; };", "30e3;", {"bad.cfg:10:", "must be libconfig text"}},
    {"\"lfm\"", "\"lfm", {"bad.cfg:2: ", "\"lfm", "not closed"}},
    {"fs = 30e3", "fs = 30e3; fs = 40e3", {"bad.cfg:1:", "each key once"}},
};

static void bad_scenes_are_refused(void **state)
{
    (void)state;
    static const char *const arguments[ARGUMENTS_MAX] = {"simulate", "bad.cfg", "-o", "x.mat"};
    static const char *const good[ARGUMENTS_MAX] = {"simulate", "scene.cfg", "-o", "x.mat"};
    int failures = 0;
    program_good(good); /* what is refused below is refused for its fault */
    remove(path_in("x.mat"));
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        scene_write("bad.cfg", scenes[k].find, scenes[k].replace);
        failures += !is_refused(arguments, scenes[k].says);
    }
    remove(path_in("bad.cfg"));
    assert_int_equal(failures, 0);
}

/* --- Bad echo files -------------------------------------------------------------------------------------------- */

/* A variable of an echo file, all its numbers `value`. */
struct item {
    const char *name;
    size_t dims[3]; /* dims[0] 0: left out */
    double value;
    enum { REAL, COMPLEX, TEXT } kind;
};

enum { VALUES_MAX = 64 * 2 * 3 };

static const struct item items[] = {
    {"samples", {64, 2, 3}, 1, COMPLEX}, {"compressed", {1, 1, 1}, 1, REAL},   {"fs", {1, 1, 1}, 30e3, REAL},
    {"fc", {1, 1, 1}, 150e3, REAL},      {"bandwidth", {1, 1, 1}, 15e3, REAL}, {"sound_speed", {1, 1, 1}, 1500, REAL},
    {"t0", {1, 1, 1}, 0.026, REAL},      {"tx", {3, 3, 1}, 0, REAL},           {"rx", {3, 2, 3}, 0, REAL},
    {"velocity", {3, 1, 1}, 0, REAL},
};

static void item_write(mat_t *mat, const struct item *item)
{
    static double values[VALUES_MAX];
    size_t dims[3] = {item->dims[0], item->dims[1], item->dims[2]};
    for (size_t k = 0; k < VALUES_MAX; k++)
        values[k] = item->value;
    char text[] = "sas";
    mat_complex_split_t parts = {values, values};
    matvar_t *variable = NULL;
    if (item->kind == TEXT)
        variable = Mat_VarCreate(item->name, MAT_C_CHAR, MAT_T_UTF8, 2, (size_t[]){1, 3}, text, 0);
    else
        variable =
            Mat_VarCreate(item->name, MAT_C_DOUBLE, MAT_T_DOUBLE, dims[2] == 1 ? 2 : 3, dims,
                          item->kind == COMPLEX ? (void *)&parts : values, item->kind == COMPLEX ? MAT_F_COMPLEX : 0);
    assert_non_null(variable);
    assert_int_equal(Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(variable);
}

/* The items with one in place of that of its name, or beside them. */
static void items_write(const char *name, const struct item *other)
{
    char format[] = "sas-echoes 1";
    mat_t *mat = Mat_CreateVer(path_in(name), NULL, MAT_FT_MAT5);
    assert_non_null(mat);
    if (strcmp(other->name, "format") != 0) {
        matvar_t *variable =
            Mat_VarCreate("format", MAT_C_CHAR, MAT_T_UTF8, 2, (size_t[]){1, strlen(format)}, format, 0);
        assert_int_equal(Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE), 0);
        Mat_VarFree(variable);
    }
    for (size_t k = 0; k < COUNT_OF(items); k++)
        if (strcmp(items[k].name, other->name) != 0)
            item_write(mat, &items[k]);
    if (other->dims[0] > 0)
        item_write(mat, other);
    Mat_Close(mat);
}

static const struct {
    struct item item;
    const char *says[SAYS_MAX];
} files[] = {
    {{"format", {0}, 0, TEXT}, {"`format` is missing", "\"sas-echoes 1\" is needed"}},
    {{"format", {1, 3, 1}, 0, TEXT}, {"`format` is \"sas\"", "\"sas-echoes 1\" is needed"}},
    {{"format", {1, 1, 1}, 1, REAL}, {"`format` is numeric", "\"sas-echoes 1\" is needed"}},
    {{"samples", {0}, 0, COMPLEX}, {"`samples` is missing", "[N x M x P]"}},
    {{"samples", {1, 3, 1}, 0, TEXT}, {"`samples` is text", "[N x M x P]"}},
    {{"samples", {64, 2, 3}, NAN, COMPLEX}, {"`samples` at (1, 1, 1) is nan", "finite"}},
    {{"samples", {64, 2, 3}, INFINITY, COMPLEX}, {"`samples` at (1, 1, 1) is inf", "finite"}},
    {{"samples", {1, 2, 3}, 1, COMPLEX}, {"number of samples is 1", "at least 2"}},
    {{"samples", {64, 3, 2}, 1, COMPLEX}, {"`samples` is [64 x 3 x 2]", "2 receivers and 3 pings", "[N x M x P]"}},
    {{"samples", {64, 1, 3}, 1, COMPLEX}, {"`samples` is [64 x 1 x 3]", "2 receivers and 3 pings", "[N x M x P]"}},
    {{"compressed", {1, 1, 1}, 2, REAL}, {"`compressed` is 2", "0 (raw) or 1"}},
    {{"compressed", {1, 1, 1}, 0, REAL}, {"`pulse` is missing", "[K x 1]"}},
    {{"pulse", {8, 1, 1}, 1, COMPLEX}, {"pulse has 8 samples", "compressed echoes have none"}},
    {{"pulse", {4, 4, 1}, 1, COMPLEX}, {"`pulse` is [4 x 4 x 1]", "[K x 1]"}},
    {{"fs", {0}, 0, REAL}, {"`fs` is missing", "a scalar in Hz"}},
    {{"fs", {2, 1, 1}, 30e3, REAL}, {"`fs` is [2 x 1 x 1]", "a scalar in Hz"}},
    {{"fs", {1, 3, 1}, 0, TEXT}, {"`fs` is text", "a scalar in Hz"}},
    {{"fs", {1, 1, 1}, 30e3, COMPLEX}, {"`fs` is complex", "a scalar in Hz"}},
    {{"fs", {1, 1, 1}, 10e3, REAL}, {"bandwidth is 15000 Hz", "at most fs = 10000 Hz"}},
    {{"fs", {1, 1, 1}, NAN, REAL}, {"fs is nan Hz", "> 0"}},
    {{"fc", {1, 1, 1}, 0, REAL}, {"fc is 0 Hz", "> 0"}},
    {{"bandwidth", {1, 1, 1}, -15e3, REAL}, {"bandwidth is -15000 Hz", "> 0"}},
    {{"sound_speed", {1, 1, 1}, INFINITY, REAL}, {"sound_speed is inf m/s", "finite"}},
    {{"t0", {1, 2, 1}, 0.026, REAL}, {"`t0` is [1 x 2 x 1]", "[1 x P]"}},
    {{"t0", {1, 1, 1}, NAN, REAL}, {"t0 of ping 1 is nan s", "finite"}},
    {{"t0", {1, 1, 1}, 1e9, REAL}, {"phase error", "at most 0.001"}},
    {{"t0", {1, 1, 1}, 1, REAL}, {"no pixel meets any record"}},
    {{"tx", {2, 3, 1}, 0, REAL}, {"`tx` is [2 x 3 x 1]", "[3 x P]"}},
    {{"tx", {3, 3, 1}, INFINITY, REAL}, {"tx of ping 1 is (inf", "finite"}},
    {{"rx", {3, 2, 1}, 0, REAL}, {"`rx` is [3 x 2 x 1]", "[3 x M x P]"}},
    {{"rx", {3, 2, 3}, NAN, REAL}, {"rx 1 of ping 1 is (nan", "finite"}},
    {{"velocity", {3, 2, 1}, 0, REAL}, {"`velocity` is [3 x 2 x 1]", "[3 x 1] or [3 x P]"}},
    {{"velocity", {3, 1, 1}, 1500, REAL}, {"velocity of ping 1", "below sound_speed = 1500 m/s"}},
    {{"beam_limit", {1, 1, 1}, 0, REAL}, {"`beam_limit` is 0", "(0, 1]"}},
    {{"beam_limit", {1, 1, 1}, 1.5, REAL}, {"`beam_limit` is 1.5", "(0, 1]"}},
    {{"tx_length", {1, 1, 1}, -1, REAL}, {"tx_length is -1 m", ">= 0"}},
};

static void bad_echoes_are_refused(void **state)
{
    (void)state;
    static const struct refusal refusal = {ECHOES("bad.mat"), {"bad.mat"}};
    static const struct item whole = {"beam_limit", {1, 1, 1}, 0.5, REAL};
    int failures = 0;
    items_write("bad.mat", &whole);
    program_good(refusal.arguments); /* what is refused below is refused for its fault */
    remove(path_in("x.mat"));
    for (size_t k = 0; k < COUNT_OF(files); k++) {
        items_write("bad.mat", &files[k].item);
        failures += !is_refused(refusal.arguments, files[k].says);
    }
    remove(path_in("bad.mat"));
    assert_int_equal(failures, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_scenes_are_refused),
        cmocka_unit_test(bad_echoes_are_refused),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
