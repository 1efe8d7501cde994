/* Scene files: text.c assembles the text, keys.c reads its keys, contents.c makes the scene. All keys:
   scenes/README.md. */
#define _GNU_SOURCE /* asprintf */
#include "scene/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "text/suggestion.h"
#include "scene/contents.h"
#include "scene/names.h"

static enum status file_read(struct reading *reading, const char *scene_directory)
{
    enum status status = scene_text_read(reading->path, scene_directory, &reading->text);
    if (status != STATUS_OK) {
        return status;
    }
    config_t config;
    config_init(&config);
    config_set_auto_convert(&config, CONFIG_TRUE);
    if (config_read_string(&config, reading->text.text)) {
        status = scene_fill(reading, config_root_setting(&config));
    } else {
        char place[320];
        place_format(reading, (unsigned)config_error_line(&config), place, sizeof place);
        status = status_set(STATUS_INVALID,
                            "%s: %s; must be libconfig text, each key once in its group, arrays of "
                            "one type, numbers with a decimal point",
                            place, config_error_text(&config));
    }
    config_destroy(&config);
    free(reading->poses);
    scene_text_free(&reading->text);
    return status;
}

/* The error of a name below the scenes that does not exist: suggests a near one, or a SPEC. */
static enum status unknown_name(const char *scene, const char *path, const char *scene_directory)
{
    char algorithm[40];
    snprintf(algorithm, sizeof algorithm, "%.*s", (int)strcspn(scene, ":"), scene);
    if (algorithm_find(algorithm)) {
        return status_set(STATUS_INVALID,
                          "%.300s: there is no such scene; an algorithm stands behind its option: "
                          "--algorithm %.200s",
                          path, scene);
    }
    struct suggestion suggestion = suggestion_begin(scene);
    char **names = NULL, meant[SUGGESTION_TEXT];
    int count = 0;
    enum status status = scene_names(scene_directory, &names, &count);
    for (int k = 0; k < count; k++) {
        suggestion_offer(&suggestion, names[k]);
    }
    const bool near = suggestion.count > 0;
    suggestion_text(&suggestion, meant);
    scene_names_free(names, count);
    return status == STATUS_OK && near
               ? status_set(STATUS_INVALID,
                            "%.300s: there is no such scene%s The path of a .cfg file, or the name of a "
                            "shipped scene without .cfg, is accepted",
                            path, meant)
               : STATUS_OK;
}

enum status scene_load(const char *scene, const char *scene_directory, struct scene *out)
{
    const size_t length = strlen(scene);
    *out = (struct scene){0};
    if (length > 4 && strcmp(scene + length - 4, ECHO_EXTENSION) == 0) {
        return status_set(STATUS_INVALID,
                          "%s: is no scene file; recorded echoes are named by --echoes FILE.mat --grid GRID", scene);
    }
    char *path;
    if ((scene_has_extension(scene) ? asprintf(&path, "%s", scene)
                                    : asprintf(&path, "%s/%s%s", scene_directory, scene, SCENE_EXTENSION))
        < 0)
        return status_set(STATUS_FAILED, "%s: out of memory for the scene", scene);
    struct reading reading = {.path = path, .scene = {.hash = HASH_BEGIN}};
    enum status status = scene_names_fill(&reading.scene, path, scene_directory);
    if (status == STATUS_OK && !scene_has_extension(scene) && access(path, F_OK) != 0) {
        status = unknown_name(scene, path, scene_directory);
    }
    if (status == STATUS_OK) {
        status = file_read(&reading, scene_directory);
    }
    if (status == STATUS_OK) {
        *out = reading.scene;
    } else {
        scene_free(&reading.scene);
    }
    free(path);
    return status;
}

void scene_free(struct scene *scene)
{
    acquisition_free(&scene->acquisition);
    free(scene->recorded);
    free(scene->recording.path);
    if (scene->flown) {
        acquisition_free(scene->flown);
        free(scene->flown);
    }
    free(scene->name);
    free(scene->path);
    free(scene->description);
    free(scene->targets);
    free(scene->patches);
    free(scene->reference_patches);
    *scene = (struct scene){0};
}

struct echo_notes scene_notes(const struct scene *scene)
{
    return (struct echo_notes){.description = scene->description,
                               .patch_count = scene->patch_count,
                               .patches = scene->patches,
                               .target_count = scene->point_count,
                               .targets = scene->targets};
}

struct problem scene_problem(const struct scene *scene, enum precision precision)
{
    return problem_make(&scene->acquisition, scene->patch_count, scene->patches, precision);
}
