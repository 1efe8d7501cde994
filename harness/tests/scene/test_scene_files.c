/* Scene files that include and vary others; their hashes and names. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/scene/scene_fixture.h"

static void one_scene_varies_another(void **state)
{
    (void)state;
    support_write("other.cfg", base_text);
    support_write("_part.cfg", "sonar = { fc = 100e3; bandwidth = 10e3; fs = 30e3; };\n");
    struct scene scene = scene_loaded("base = {\n  @include \"other.cfg\"\n};\n"
                                      "track = { speed = 1; pri = 0.1; pings = 3; };\n"
                                      "@include \"_part.cfg\"\n");
    assert_true(scene.acquisition.pings == 3 && scene.acquisition.tx[0].x == 0); /* x_first is not the base's */
    assert_true(scene.acquisition.fc == 100e3 && scene.acquisition.receivers == 4);
    assert_string_equal(scene.description, "test");
    uint64_t hash = scene.hash;
    scene_free(&scene);

    /* A variant of a variant, and the hash of the same content in one file. */
    support_write("third.cfg", "base = {\n@include \"other.cfg\"\n};\n@include \"_part.cfg\"\n"
                               "description = \"third\";\n");
    scene = scene_loaded("base = {\n@include \"third.cfg\"\n};\ntrack = { speed = 1; pri = 0.1; pings = 3; };\n");
    assert_true(scene.acquisition.pings == 3 && scene.acquisition.fc == 100e3 && scene.noise_seed == 3);
    assert_string_equal(scene.description, "third");
    assert_true(scene.hash == hash);
    scene_free(&scene);

    /* What an included file gets wrong is said with that file's name and line. */
    support_write("_part.cfg", "\nsonar = { fc = 100e3; bandwidth = 10e3; fs = -3; };\n");
    struct scene bad;
    assert_int_equal(scene_load_text("base = {\n@include \"other.cfg\"\n};\n@include \"_part.cfg\"\n", &bad),
                     STATUS_INVALID);
    assert_message_has(path_of("_part.cfg:2: key 'sonar.fs' is -3, must be a number > 0 Hz"), "included");
    char *text = scene_varied("fc = 150e3;", "fc = 150e3; colour = 3;");
    support_write("other.cfg", text);
    free(text);
    assert_int_equal(scene_load_text("base = {\n@include \"other.cfg\"\n};\n", &bad), STATUS_INVALID);
    assert_message_has(path_of("other.cfg:2: key 'base.sonar.colour' is 3, must be left out"), "base");
}

/* The hash of the scene file `name` with includes that are not beside it looked for in `directory`. */
static uint64_t hash_of_file(const char *name, const char *directory)
{
    struct scene scene;
    if (scene_load(name, directory, &scene) != STATUS_OK) {
        fail_msg("%s", status_message());
    }
    uint64_t hash = scene.hash;
    scene_free(&scene);
    return hash;
}

/* From a folder elsewhere: speckle and near themselves include ../bp22/_array.cfg. */
static void shipped_scenes_can_be_included(void **state)
{
    (void)state;
    char absolute[300];
    support_write("other.cfg", "@include \"study/speckle.cfg\"\n");
    snprintf(absolute, sizeof absolute, "@include \"%s\"\n", path_of("other.cfg"));
    assert_true(scene_hash_of(absolute) == hash_of_file("study/speckle", SHIPPED));
    assert_true(scene_hash_of("@include \"study/near.cfg\"\n") == hash_of_file("study/near", SHIPPED));
    struct scene scene;
    assert_int_equal(scene_load_text("@include \"study/near\"\n", &scene), STATUS_INVALID);
    assert_message_has(path_of("scene.cfg:1: @include of "), "no extension");
    assert_message_has("study/near: No such file", "no extension");
    assert_message_has("from " SHIPPED, "no extension");
    assert_int_equal(scene_load_text("@include \"/study/near.cfg\"\n", &scene), STATUS_INVALID);
    assert_message_has("@include of /study/near.cfg: No such file", "absolute");
}

/* The folder of the including file comes first, then the shipped scenes'; here that is the outer folder. */
static void includes_are_relative_to_their_file(void **state)
{
    (void)state;
    assert_int_equal(mkdir(path_of("sub"), 0777), 0);
    support_write("other.cfg", base_text);
    support_write("sub/deep.cfg", "base = {\n@include \"../other.cfg\"\n};\n@include \"_part.cfg\"");
    support_write("sub/_part.cfg", "sonar = { fc = 100e3; bandwidth = 10e3; fs = 30e3; };  # without a line's end");
    support_write("_part.cfg", "sonar = { fc = 200e3; bandwidth = 10e3; fs = 30e3; };\n");
    struct scene scene = scene_loaded("@include \"sub/deep.cfg\"\nnoise = { std = 7; };\n");
    assert_true(scene.acquisition.fc == 100e3 && scene.acquisition.pings == 6 && scene.noise_std == 7);
    scene_free(&scene);

    assert_int_equal(scene_load("sub/deep", folder, &scene), STATUS_OK);
    assert_true(scene.acquisition.fc == 100e3);
    scene_free(&scene);
    assert_int_equal(unlink(path_of("sub/_part.cfg")), 0);
    assert_int_equal(scene_load("sub/deep", folder, &scene), STATUS_OK);
    assert_true(scene.acquisition.fc == 200e3);
    scene_free(&scene);
    assert_int_equal(mkdir(path_of("sub/_part.cfg"), 0777), 0); /* no file, but there */
    assert_int_equal(scene_load("sub/deep", folder, &scene), STATUS_INVALID);
    assert_message_has("sub/_part.cfg: not a regular file", "folder");
    assert_int_equal(rmdir(path_of("sub/_part.cfg")), 0);
}

/* The first line of each file counts as 1, wherever it is included, and the lines after an include go on. */
static void errors_name_the_line_of_their_file(void **state)
{
    (void)state;
    assert_int_equal(mkdir(path_of("sub"), 0777), 0);
    support_write("other.cfg", base_text);
    const struct {
        const char *scene, *deep, *part, *message; /* scene.cfg includes sub/deep.cfg, and that sub/_part.cfg */
    } cases[] = {
        {"", "", "fc = -1;", "sub/_part.cfg:1: key 'sonar.fc' is -1,"},
        {"", "", "fc = {{", "sub/_part.cfg:1: syntax error"},
        {"", "", "fc = 1; fc = 2;", "sub/_part.cfg:1: duplicate setting name"},
        {"", "", "fc = 3000000000;", "sub/_part.cfg:1: 3000000000 is out of range"},
        {"", "", "fc = \"a", "sub/_part.cfg:1: \"a is not closed"},
        {"", "", "/* here", "sub/_part.cfg:1: /* here is not closed, must end with */ in its file"},
        {"", "", "@include \"nosuch.cfg\"", "sub/_part.cfg:1: @include of "},
        {"", "", "@include nosuch", "sub/_part.cfg:1: @include nosuch is misplaced"},
        {"", "fish = 1;", "", "sub/deep.cfg:5: key 'sonar.fish' is 1,"},
        {"", "fish = ;", "", "sub/deep.cfg:5: syntax error"},
        {"", "fish = 3000000000;", "", "sub/deep.cfg:5: 3000000000 is out of range"},
        {"fish = 1;", "", "", "scene.cfg:8: key 'fish' is 1,"},
        {"fish = ;", "", "", "scene.cfg:8: syntax error"},
        {"fish = \"", "", "", "scene.cfg:8: \" is not closed"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[300], expected[500];
        struct scene scene;
        support_write("sub/_part.cfg", cases[i].part);
        snprintf(text, sizeof text, "\n\n  @include \"_part.cfg\"  # at the end of deep's third line\n\n%s\n",
                 cases[i].deep);
        support_write("sub/deep.cfg", text);
        snprintf(text, sizeof text,
                 "base = {\n@include \"other.cfg\"\n};\nsonar = {\n@include \"sub/deep.cfg\"\n};"
                 "\n\n%s\n",
                 cases[i].scene);
        assert_int_equal(scene_load_text(text, &scene), STATUS_INVALID);
        snprintf(expected, sizeof expected, "%s/%s", folder, cases[i].message);
        if (strncmp(status_message(), expected, strlen(expected)) != 0) {
            fail_msg("case %zu: the message does not begin with '%s': %s", i, expected, status_message());
        }
    }
}

/* Files 0 to 9 each include the next, and scene.cfg the second or first: ten deep are accepted, eleven not. */
static void includes_have_bounds(void **state)
{
    (void)state;
    enum { LONG = 8 << 20 };
    struct scene scene;
    for (int i = 0; i < NESTED; i++) {
        char name[20], text[60];
        snprintf(name, sizeof name, "%d.cfg", i);
        snprintf(text, sizeof text, "@include \"%d.cfg\"\n", i + 1);
        support_write(name, text);
    }
    support_write("10.cfg", base_text);
    assert_true(scene_hash_of("@include \"1.cfg\"\n") == scene_hash_of(base_text));
    assert_int_equal(scene_load_text("@include \"0.cfg\"\n", &scene), STATUS_INVALID);
    assert_message_has(path_of("9.cfg:1: @include of 10.cfg is nested too deep"), "depth");

    char *comment = malloc(LONG + 1);
    assert_non_null(comment);
    memset(comment, '#', LONG);
    comment[LONG] = '\0';
    support_write("0.cfg", comment);
    free(comment);
    char nine[400] = "";
    for (int i = 0; i < 9; i++) {
        strcat(nine, "@include \"0.cfg\"\n");
    }
    assert_int_equal(scene_load_text(nine, &scene), STATUS_INVALID);
    assert_message_has("0.cfg: the scene is too long with this file, must have at most 67108864 bytes", "length");
}

/* Nothing but texts of a sane size is read, by whatever name it comes, nor waited for. */
static void only_regular_files_are_read(void **state)
{
    (void)state;
    char fifo[300], large[300], text[700];
    snprintf(fifo, sizeof fifo, "%s", path_of("fifo.cfg"));
    snprintf(large, sizeof large, "%s", path_of("large.cfg"));
    assert_int_equal(mkfifo(fifo, 0600), 0);
    support_write("large.cfg", "#");
    assert_int_equal(truncate(large, (off_t)3 << 30), 0);
    const struct {
        const char *path, *says;
    } files[] = {
        {fifo, "not a regular file"},
        {"/dev/zero", "not a regular file"},
        {"/dev/tty", "not a regular file"},
        {"/dev", "not a regular file"},
        {"/proc/kmsg", ""}, /* by who asks and what was logged: not permitted, or nothing there, or no file */
        {"/proc/self/status", "not a file of a disk"},
        {large, "has 3221225472 bytes, must have at most 67108864"},
    };
    struct scene scene;
    alarm(60);
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        snprintf(text, sizeof text, "# within\n@include \"%s\"\n", files[k].path);
        support_write("inner.cfg", text);
        assert_int_equal(scene_load_text(text, &scene), STATUS_INVALID);
        assert_message_has(files[k].path, "include");
        assert_message_has(files[k].says, "include");
        assert_int_equal(scene_load_text("@include \"inner.cfg\"\n", &scene), STATUS_INVALID);
        assert_message_has(path_of("inner.cfg:2: @include of "), "nested");
        assert_message_has(files[k].says, "nested");
    }
    assert_int_equal(scene_load(fifo, SHIPPED, &scene), STATUS_INVALID);
    assert_message_has("fifo.cfg: scene is not readable: not a regular file", "scene");
    assert_int_equal(scene_load(large, SHIPPED, &scene), STATUS_INVALID);
    assert_message_has("large.cfg: scene is not readable: has 3221225472 bytes", "scene");
    alarm(0);
}

static void hash_follows_the_content(void **state)
{
    (void)state;
    const char *const same[][2] = {
        {"sonar = {", "# a comment\nsonar = // another\n/* 99999999999 */ {"},
        {"fc = 150e3; bandwidth = 15e3;", "bandwidth: 15000, fc=150000.0"},
        {"test", "another description: it measures nothing"},
        {"half_x = 0.2;", "half_x = 2e-1"},
        {"sonar = {", "sonar = { sound_speed = 1500;"},
        {"points = (", "fields = (); points = ("},
    };
    const char *const other[][2] = {
        {"fc = 150e3", "fc = 150.001e3"},
        {"lfm", "lfm_time"},
        {"x_first = -0.32", "x_first = -0.33"},
        {"x = 0.1;", "x = 0.1000001;"},
        {"seed = 3", "seed = 4"},
        {"half_x = 0.2", "half_x = 0.22"},
        {"r = 20.0;", "r = 20.0; amplitude = [1.0, 0.1];"},
        {"limit = 0.443;", "limit = 0.443; per_frequency = true;"},
        {"{ x = 0.1; r = 20.0; }", "{ x = 0.1; r = 20.0; }, { x = 0.1; r = 20.0; }"},
    };
    uint64_t hash = scene_hash_of(base_text);
    for (size_t i = 0; i < COUNT_OF(same); i++) {
        char *text = scene_varied(same[i][0], same[i][1]);
        if (scene_hash_of(text) != hash) {
            fail_msg("'%s' changes the hash", same[i][1]);
        }
        free(text);
    }
    for (size_t i = 0; i < COUNT_OF(other); i++) {
        char *text = scene_varied(other[i][0], other[i][1]);
        if (scene_hash_of(text) == hash) {
            fail_msg("'%s' leaves the hash", other[i][1]);
        }
        free(text);
    }
}

static void names_are_found_below_the_folder(void **state)
{
    (void)state;
    char **names;
    int count;
    support_write("scene.cfg", base_text);
    support_write("_part.cfg", "");
    assert_int_equal(mkdir(path_of("sub"), 0777), 0);
    support_write("sub/deep.cfg", "");
    support_write("sub/.hidden.cfg", "");
    support_write("sub/text.txt", "");
    assert_int_equal(scene_names(folder, &names, &count), STATUS_OK);
    assert_int_equal(count, 2);
    assert_string_equal(names[0], "scene");
    assert_string_equal(names[1], "sub/deep");
    struct scene scene;
    assert_int_equal(scene_load(names[0], folder, &scene), STATUS_OK);
    assert_string_equal(scene.name, "scene");
    scene_free(&scene);
    scene_names_free(names, count);

    assert_int_equal(scene_names(path_of("nosuch"), &names, &count), STATUS_INVALID);
    assert_message_has("nosuch: not a readable folder", "names");
    assert_true(!names && count == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(one_scene_varies_another, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(shipped_scenes_can_be_included, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(includes_are_relative_to_their_file, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(errors_name_the_line_of_their_file, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(includes_have_bounds, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(only_regular_files_are_read, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(hash_follows_the_content, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(names_are_found_below_the_folder, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
