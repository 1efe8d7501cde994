/* What the tests of scenes share (scene_fixture.h). */
#include "tests/scene/scene_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

enum status scene_load_text(const char *text, struct scene *scene)
{
    support_write("scene.cfg", text);
    return scene_load(path_of("scene.cfg"), SHIPPED, scene);
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
