/* Several scenes at once (scenes.h). */
#include "scene/scenes.h"

#include <stdlib.h>
#include <string.h>

#include "files/paths.h"

void scenes_free(struct scene *scenes, int count)
{
    for (int k = 0; k < count; k++)
        scene_free(&scenes[k]);
    free(scenes);
}

enum status scenes_load(const char *command, int given_count, const char *const *given, struct scene **scenes,
                        int *count)
{
    char **names = NULL;
    int name_count = 0;
    enum status status = STATUS_OK;
    if (given_count == 0)
        status = scene_names(data_path(DATA_SCENES), &names, &name_count);
    const char *const *list = given_count ? given : (const char *const *)names;
    int total = given_count ? given_count : name_count;
    *count = 0;
    *scenes = calloc((size_t)total + 1, sizeof **scenes);
    if (status == STATUS_OK && !*scenes)
        status = status_set(STATUS_FAILED, "no memory for %d scenes", total);
    for (int k = 0; k < total && status == STATUS_OK; k++) {
        status = scene_load(list[k], data_path(DATA_SCENES), &(*scenes)[*count]);
        for (int before = 0; before < *count && status == STATUS_OK; before++) {
            if (strcmp((*scenes)[before].path, (*scenes)[*count].path) == 0) {
                status =
                    status_set(STATUS_INVALID, "%s: scene %s is given twice, must be named once", command, list[k]);
            } else if (strcmp((*scenes)[before].name, (*scenes)[*count].name) == 0) {
                status = scenes_tell_apart(&(*scenes)[before], &(*scenes)[*count]);
                before = -1; /* the longer names may collide with others */
            }
            if (status != STATUS_OK)
                scene_free(&(*scenes)[*count]);
        }
        if (status != STATUS_OK)
            break;
        if (given_count == 0 && (*scenes)[*count].full_size)
            scene_free(&(*scenes)[*count]);
        else
            ++*count;
    }
    scene_names_free(names, name_count);
    return status;
}
