/* What the tests of scenes share (scene_fixture.h). */
#include "tests/scene/scene_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* One group a line, so that every refusal can be checked for its line. */
const char *const base_text =
    "description = \"test\";\n"
    "sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\n"
    "pulse = { kind = \"lfm\"; duration = 2e-3; };\n"
    "array = { tx_length = 0.08; rx_length = 0.04; receivers = 4; first_offset = -0.06; pitch = 0.04; };\n"
    "track = { speed = 2.5; pri = 0.064; pings = 6; x_first = -0.32; };\n"
    "record = { first_sample = 720; samples = 256; };\n"
    "beam = { kind = \"txrx\"; truncation = \"tx\"; limit = 0.443; };\n"
    "targets = { points = ( { x = 0.1; r = 20.0; } ); };\n"
    "noise = { std = 0.1; seed = 3; };\n" IMAGE "\n";

char scene_folder[256];

const char *scene_path(const char *name)
{
    static char path[400];
    snprintf(path, sizeof path, "%s/%s", scene_folder, name);
    return path;
}

const char *scene_path_numbered(int i)
{
    char name[20];
    snprintf(name, sizeof name, "%d.cfg", i);
    return scene_path(name);
}

void scene_write(const char *name, const char *text)
{
    FILE *file = fopen(scene_path(name), "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

enum status scene_load_text(const char *text, struct scene *scene)
{
    scene_write("scene.cfg", text);
    return scene_load(scene_path("scene.cfg"), SHIPPED, scene);
}

struct scene scene_loaded(const char *text)
{
    struct scene scene;
    if (scene_load_text(text, &scene) != STATUS_OK) {
        fail_msg("%s", status_message());
    }
    return scene;
}

/* base_text with its first `find` replaced. */
char *scene_varied(const char *find, const char *replace)
{
    const char *at = strstr(base_text, find);
    if (!at) {
        fail_msg("no '%s' in the base scene", find);
    }
    char *text = malloc(strlen(base_text) + strlen(replace) + 1);
    assert_non_null(text);
    sprintf(text, "%.*s%s%s", (int)(at - base_text), base_text, replace, at + strlen(find));
    return text;
}

uint64_t scene_hash_of(const char *text)
{
    struct scene scene = scene_loaded(text);
    uint64_t hash = scene.hash;
    scene_free(&scene);
    return hash;
}

void assert_message_has(const char *part, const char *what)
{
    if (!strstr(status_message(), part)) {
        fail_msg("%s: '%s' is not in the message: %s", what, part, status_message());
    }
}

int scene_folder_make(void **state)
{
    (void)state;
    const char *temporary = getenv("TMPDIR");
    snprintf(scene_folder, sizeof scene_folder, "%s/sasbench-scene-XXXXXX", temporary ? temporary : "/tmp");
    return mkdtemp(scene_folder) ? 0 : -1;
}

int scene_folder_remove(void **state)
{
    (void)state;
    const char *const files[] = {"scene.cfg",    "other.cfg",     "third.cfg",       "_part.cfg",
                                 "sub/deep.cfg", "sub/_part.cfg", "sub/.hidden.cfg", "sub/text.txt",
                                 "fifo.cfg",     "large.cfg",     "inner.cfg"};
    for (size_t i = 0; i < COUNT_OF(files); i++) {
        unlink(scene_path(files[i]));
    }
    for (int i = 0; i <= NESTED; i++) {
        unlink(scene_path_numbered(i));
    }
    rmdir(scene_path("sub"));
    return rmdir(scene_folder);
}
