/* Scene files that are refused, and how that is said. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/scene/scene_fixture.h"

/* Each is base_text with `find` replaced; the message names the file, the line (0: none), and has both texts. */
static const struct refusal {
    const char *find, *replace;
    int line;
    const char *key, *accepted;
} refusals[] = {
    {"fs = 30e3;", "fs = -3;", 2, "key 'sonar.fs' is -3,", "> 0 Hz"},
    {"fs = 30e3;", "fs = 0.0;", 2, "key 'sonar.fs' is 0.0,", "> 0 Hz"},
    {"fs = 30e3;", "fs = 1e999;", 2, "key 'sonar.fs' is inf,", "> 0 Hz"},
    {"fs = 30e3;", "fs = nan;", 2, "syntax error", "libconfig"},
    {"fs = 30e3;", "fs = \"30e3\";", 2, "key 'sonar.fs' is \"30e3\",", "a number > 0 Hz"},
    {"fs = 30e3;", "fs = [30e3];", 2, "key 'sonar.fs' is an array [ ... ] of 30000.0,", "a number > 0 Hz"},
    {"fs = 30e3;", "", 2, "key 'sonar.fs' is missing,", "a number > 0 Hz"},
    {"fs = 30e3;", "fs = 10e3;", 2, "key 'sonar.fs' is 10000.0,", "at least sonar.bandwidth (15000 Hz)"},
    {"fs = 30e3;", "fs = 30e3; fs = 40e3;", 2, "duplicate setting name", "each key once"},
    {"fs = 30e3;", "fs = 30e3; colour = \"red\";", 2, "key 'sonar.colour' is \"red\",",
     "left out: unknown, accepted are sound_speed, fc, fs, bandwidth"},
    {"fc = 150e3;", "", 2, "key 'sonar.fc' is missing,", "> 0 Hz"},
    {"fc = 150e3;", "fc = 150e15;", 0, "phase error", "at most"},
    {"fc = 150e3;", "sound_speed = 0; fc = 150e3;", 2, "key 'sonar.sound_speed' is 0,", "> 0 and <= 1000000000 m/s"},
    {"bandwidth = 15e3;", "bandwidth = true;", 2, "key 'sonar.bandwidth' is true,", "a number > 0 Hz"},
    {"sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };", "", 0, "key 'sonar' is missing,", "a group { ... }"},
    {"sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };", "sonar = 3;", 2, "key 'sonar' is 3,", "a group"},
    {"description = \"test\";", "description = 3;", 1, "key 'description' is 3,", "a text of one line"},
    {"description = \"test\";", "description = \"a\\nb\";", 1, "key 'description' is", "a text of one line"},
    {"description = \"test\";", "descriptoin = \"test\";", 1, "key 'descriptoin' is \"test\",", "left out: unknown"},
    {"description = \"test\";", "full_size = 1;", 1, "key 'full_size' is 1,", "true or false"},
    {"description = \"test\";", "aperture_limit = 1.5;", 1, "key 'aperture_limit' is 1.5,", "> 0 and <= 1"},
    {"description = \"test\";", "aperture_limit = -0.1;", 1, "key 'aperture_limit' is -0.1,", "> 0 and <= 1"},
    {"description = \"test\";", "base = 3;", 1, "key 'base' is 3,", "a group { ... }"},
    {"description = \"test\";", "base = { fish = 1; };", 1, "key 'base.fish' is 1,", "left out: unknown"},
    {"\"lfm\"", "\"chirp\"", 3, "key 'pulse.kind' is \"chirp\",", "one of \"lfm\", \"lfm_time\", \"flat\""},
    {"\"lfm\"", "1", 3, "key 'pulse.kind' is 1,", "one of \"lfm\""},
    {"\"lfm\"", "\"flat\"", 3, "key 'pulse.duration' is 0.002,", "left out with pulse.kind \"flat\""},
    {"duration = 2e-3;", "", 3, "key 'pulse.duration' is missing,", "> 0 s"},
    {"duration = 2e-3;", "duration = 0;", 3, "key 'pulse.duration' is 0,", "> 0 s"},
    {"duration = 2e-3;", "duration = 0.1;", 3, "key 'pulse.duration' is 0.1,", "no longer than the record"},
    {"duration = 2e-3;", "duration = 1e300;", 3, "key 'pulse.duration' is 1e+300,", "no longer than the record"},
    {"receivers = 4;", "receivers = 0;", 4, "key 'array.receivers' is 0,", "an integer from 1 to 2147483647"},
    {"receivers = 4;", "receivers = 4.0;", 4, "key 'array.receivers' is 4.0,", "an integer from 1"},
    {"receivers = 4;", "receivers = -1;", 4, "key 'array.receivers' is -1,", "an integer from 1"},
    {"receivers = 4;", "receivers = 5000000000L;", 4, "key 'array.receivers' is 5000000000,", "an integer from 1"},
    {"receivers = 4;", "receivers = 4294967300;", 4, "4294967300 is out of range", "an integer from -2147483648"},
    {"receivers = 4;", "receivers = 0x100000004;", 4, "0x100000004 is out of range", "an integer from"},
    {"receivers = 4;", "receivers = 99999999999999999999L;", 4, "is out of range", "up to 2^63"},
    {"receivers = 4;", "", 4, "key 'array.receivers' is missing,", "an integer from 1"},
    {"tx_length = 0.08;", "", 4, "key 'array.tx_length' is missing,", "with beam.kind \"txrx\" or a beam.truncation"},
    {"tx_length = 0.08;", "tx_length = -1;", 4, "key 'array.tx_length' is -1,", "> 0 and <= 1e+12 m"},
    {"rx_length = 0.04;", "", 4, "key 'array.rx_length' is missing,", "> 0 m with beam.kind \"txrx\""},
    {"pitch = 0.04;", "", 4, "key 'array.pitch' is missing,", "other than 0 m with 4 receivers"},
    {"speed = 2.5;", "speed = 1500;", 5, "key 'track.speed' is 1500,", "below sonar.sound_speed (1500 m/s)"},
    {"speed = 2.5;", "speed = -1e400;", 5, "key 'track.speed' is -inf,", "a number that is finite m/s"},
    {"pri = 0.064;", "pri = -1;", 5, "key 'track.pri' is -1,", "> 0 s"},
    {"pri = 0.064;", "pri = 1e308;", 5, "key 'track.pri' is 1e+308,", "of 6 pings at 2.5 m/s"},
    {"pings = 6;", "pings = 6.5;", 5, "key 'track.pings' is 6.5,", "an integer from 1"},
    {"pings = 6;", "pings = 2147483647;", 5, "key 'track.pings' is 2147483647,",
     "such that 2147483647 pings x 4 receivers are at most 67108864 records"},
    {"speed = 2.5; pri = 0.064; pings = 6; x_first = -0.32;",
     "speed = 0; spacing = 1e11; pri = 0.064; pings = 12; x_first = 0.0;", 5, "key 'track.spacing' is 1e+11,",
     "such that the last of 12 pings, at 1.1e+12 m, stays within"},
    {"receivers = 4;", "receivers = 1000000000;", 4, "key 'array.receivers' is 1000000000,",
     "such that 6 pings x 1000000000 receivers are at most 67108864 records"},
    {"samples = 256;", "samples = 1;", 6, "key 'record.samples' is 1,", "an integer from 2"},
    {"samples = 256;", "samples = 60;", 0, "no pixel meets any record", "must lie in the records'"},
    {"samples = 256;", "", 6, "key 'record.samples' is missing,", "an integer from 2"},
    {"first_sample = 720;", "first_sample = 720.0;", 6, "key 'record.first_sample' is 720.0,", "an integer"},
    {"first_sample = 720;", "first_sample = 7200;", 0, "no pixel meets any record", "0.24"},
    {"\"tx\"", "\"rx\"", 7, "key 'beam.truncation' is \"rx\",", "one of \"none\", \"tx\", \"mid\", \"doppler\""},
    {"limit = 0.443;", "", 7, "key 'beam.limit' is missing,", "a number > 0 with beam.truncation \"tx\""},
    {"limit = 0.443;", "limit = 0.0;", 7, "key 'beam.limit' is 0.0,", "> 0"},
    {"truncation = \"tx\";", "", 7, "key 'beam.limit' is 0.443,", "left out with beam.truncation \"none\""},
    {"limit = 0.443;", "limit = 0.443; per_frequency = 1;", 7, "key 'beam.per_frequency' is 1,", "true or false"},
    {"{ x = 0.1; r = 20.0; }", "", 8, "key 'targets.points' is a list ( ... ),", "at least one target"},
    {"{ x = 0.1; r = 20.0; }", "{ x = 0.1; r = 20.0; }, 3", 8, "key 'targets.points[1]' is 3,", "a group { ... }"},
    {"x = 0.1; r = 20.0;", "x = 0.1;", 8, "key 'targets.points[0].r' is missing,", "a number from -1e+12 to 1e+12 m"},
    {"r = 20.0;", "r = 1e13;", 8, "key 'targets.points[0].r' is 1e+13,", "from -1e+12 to 1e+12 m"},
    {"r = 20.0;", "r = 20.0; y = 3;", 8, "key 'targets.points[0].y' is 3,", "unknown, accepted are x, r, amplitude"},
    {"r = 20.0;", "r = 20.0; amplitude = [1, 2, 3];", 8, "key 'targets.points[0].amplitude' is an array",
     "a number or [re, im]"},
    {"r = 20.0;", "r = 20.0; amplitude = [1, 2.5];", 8, "mismatched element type in array", "arrays of one type"},
    {"r = 20.0;", "r = 20.0; amplitude = \"loud\";", 8, "key 'targets.points[0].amplitude' is \"loud\",", "[re, im]"},
    {"points = (", "fields = ( { x = [1, -1]; r = [1, 2]; count = 3; seed = 1; } ); points = (", 8,
     "key 'targets.fields[0].x' is an array [ ... ] of 1, -1,", "[min, max] with min <= max"},
    {"points = (", "fields = ( { x = [-1, 1]; r = [1, 2]; count = 3; } ); points = (", 8,
     "key 'targets.fields[0].seed' is missing,", "an integer from 0"},
    {"points = (", "fields = ( { x = [-1, 1]; r = [1, 2]; count = 20000000; seed = 1; } ); points = (", 8,
     "key 'targets.fields[0].count' is 20000000,", "an integer from 1 to 10000000"},
    {"points = (", "fields = ( { x = [-1, 1]; r = [1, 2]; count = 10000000; seed = 1; } ); points = (", 8,
     "key 'targets.fields[0].count' is 10000000,", "all targets are at most 10000000"},
    {"( { x = 0.1; r = 20.0; } )", "{ x = 0.1; r = 20.0; }", 8, "key 'targets.points' is a group", "a list ( ... )"},
    {"std = 0.1;", "std = -0.1;", 9, "key 'noise.std' is -0.1,", "a number from 0"},
    {"seed = 3;", "seed = 3.5;", 9, "key 'noise.seed' is 3.5,", "an integer from 0"},
    {"seed = 3;", "seed = -3;", 9, "key 'noise.seed' is -3,", "an integer from 0"},
    {"image = {", "image = { x = { first = 0; step = 1; count = 1; }; r = { first = 20; step = 1; count = 1; };", 10,
     "key 'image' is a group", "exactly one of `x` with `r`, `around_targets`, `patches`"},
    {IMAGE, "image = { };", 10, "key 'image' is a group", "exactly one of"},
    {IMAGE, "image = { x = { first = 0; step = 1; count = 1; }; };", 10, "key 'image.r' is missing,",
     "together with `x`"},
    {IMAGE, "image = { patches = (); };", 10, "key 'image.patches' is a list", "at least one patch"},
    {IMAGE,
     "image = { x = { first = 5; step = 0.1; count = 3; }; r = { first = 20; step = 1; count = 1; };"
     "reference = { half_x = 1; half_r = 1; }; };",
     10, "key 'image.reference' is a group", "holds a pixel of the image"},
    {IMAGE, "image = { x = { first = 5; step = 0.1; count = 0; }; r = { first = 20; step = 1; count = 1; }; };", 10,
     "key 'image.x.count' is 0,", "an integer from 1"},
    {IMAGE,
     "image = { x = { first = 5; step = 0.1; count = 2000000000; };"
     " r = { first = 20; step = 1; count = 2000000000; }; };",
     0, "2000000000 x 2000000000 pixels", "at most"},
    {"r_step = 0.025; }; };", "r_step = 0.025; }; reference = { half_x = 1; half_r = 1; }; };", 10,
     "key 'image.reference' is a group", "left out without `x` and `r`"},
    {"r_step = 0.025;", "r_step = 0;", 10, "key 'image.around_targets.r_step' is 0,", "> 0 m"},
    {"half_x = 0.2;", "half_x = 1e11;", 10, "key 'image.around_targets.half_x' is 1e+11,", "at most 1073741823 steps"},
    {"half_x = 0.2;", "half_x = -1;", 10, "key 'image.around_targets.half_x' is -1,", "from 0"},
    {"targets = { points = ( { x = 0.1; r = 20.0; } ); };", "", 0, "key 'targets.points' is missing,",
     "at least one target"},
    {"noise = {", "@include \"nosuch.cfg\"\nnoise = {", 9, "nosuch.cfg: No such file", "must be a readable file"},
    {"noise = {", "@include \".\"\nnoise = {", 9, "not a regular file", "must be a readable file"},
    {"noise = {", "base = {\n@include \"scene.cfg\"\n};\nnoise = {", 10, "nested too deep", "may include itself"},
    {"noise = {", "@include \"\"\nnoise = {", 9, "not a regular file", "must be a readable file"},
    {"noise = {", "@include nosuch\nnoise = {", 9, "@include nosuch is misplaced", "must be @include \"FILE\""},
    {"noise = {", "@include \"nosuch\nnoise = {", 9, "@include \"nosuch is misplaced", "must be @include \"FILE\""},
    {"noise = {", "base = { @include \"scene.cfg\"\n};\nnoise = {", 9, "is misplaced", "beginning of a line"},
    {"noise = {", "/* noise = {", 9, "/* noise = { std = 0.1; seed = 3; }; is not closed", "must end with */"},
    {"noise = {", "noise = {{", 9, "syntax error", "libconfig"},
    {"description = \"test\";", "description = \"test;", 1, "\"test; is not closed", "must end with \" on its line"},
    {"image = {", "image = { \"", 10, "is not closed", "must end with \""},
};

static void malformed_scenes_are_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(refusals); i++) {
        const struct refusal *refusal = &refusals[i];
        char *text = scene_varied(refusal->find, refusal->replace), place[300];
        struct scene scene;
        enum status status = scene_load_text(text, &scene);
        if (status != STATUS_INVALID) {
            fail_msg("'%s' gives status %d", refusal->replace, status);
        }
        snprintf(place, sizeof place, refusal->line ? "%s/scene.cfg:%d: " : "%s/scene.cfg: ", folder, refusal->line);
        if (strncmp(status_message(), place, strlen(place)) != 0) {
            fail_msg("'%s': the message does not begin with '%s': %s", refusal->replace, place, status_message());
        }
        assert_message_has(refusal->key, refusal->replace);
        assert_message_has(refusal->accepted, refusal->replace);
        assert_null(strchr(status_message(), '\n'));
        assert_true(!scene.name && !scene.targets && !scene.acquisition.tx);
        free(text);
    }
}

/* The last ping may lie as far out as a coordinate may. */
static void bounds_are_accepted(void **state)
{
    (void)state;
    static const char *const tracks[] = {"speed = 0; spacing = 1e11; pri = 0.064; pings = 11; x_first = 0.0;",
                                         "speed = 10.0; pri = 1e10; pings = 11; x_first = 0.0;"};
    for (size_t i = 0; i < COUNT_OF(tracks); i++) {
        char *text = scene_varied("speed = 2.5; pri = 0.064; pings = 6; x_first = -0.32;", tracks[i]);
        struct scene scene = scene_loaded(text);
        assert_true(scene.acquisition.tx[10].x == 1e12);
        scene_free(&scene);
        free(text);
    }
}

static void files_that_are_no_scenes_are_refused(void **state)
{
    (void)state;
    struct scene scene;
    assert_int_equal(scene_load("bp22/nosuch", SHIPPED, &scene), STATUS_INVALID);
    assert_message_has(SHIPPED "/bp22/nosuch.cfg: scene is not readable: No such file", "missing");
    assert_int_equal(scene_load("", SHIPPED, &scene), STATUS_INVALID);
    assert_int_equal(scene_load_text("", &scene), STATUS_INVALID);
    assert_message_has("key 'sonar' is missing", "empty");

    assert_int_equal(mkdir(path_of("other.cfg"), 0777), 0);
    assert_int_equal(scene_load(path_of("other.cfg"), SHIPPED, &scene), STATUS_INVALID);
    assert_message_has("not a regular file", "folder");
    assert_int_equal(rmdir(path_of("other.cfg")), 0);

    FILE *file = fopen(path_of("scene.cfg"), "wb"); /* a zero inside, as of a damaged disk */
    assert_non_null(file);
    assert_int_equal(fwrite(base_text, 1, strlen(base_text) + 1, file), strlen(base_text) + 1);
    fclose(file);
    assert_int_equal(scene_load(path_of("scene.cfg"), SHIPPED, &scene), STATUS_INVALID);
    assert_message_has("holds a zero byte", "zero");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(malformed_scenes_are_refused, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(bounds_are_accepted, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(files_that_are_no_scenes_are_refused, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
