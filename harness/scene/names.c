/* Names of scenes: the path below scenes/, or the name of a file elsewhere. */
#include "scene/names.h"

#include <fts.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "text/shown_text.h"

bool scene_has_extension(const char *path)
{
    size_t length = strlen(path), extension = strlen(SCENE_EXTENSION);
    return length > extension && strcmp(path + length - extension, SCENE_EXTENSION) == 0;
}

/* The part of DIR/bp22/table3.cfg below DIR without extension; NULL for a path elsewhere. */
static char *name_below(const char *path, const char *directory)
{
    size_t length = strlen(directory);
    return strncmp(path, directory, length) == 0 && path[length] == '/'
               ? strndup(path + length + 1, strlen(path) - length - 1 - strlen(SCENE_EXTENSION))
               : NULL;
}

/* The last `parts` parts of a full path without extension. */
static char *name_of(const char *full_path, int parts)
{
    const char *end = full_path + strlen(full_path), *begin = end, *last = strrchr(full_path, '.');
    for (; begin > full_path && (begin[-1] != '/' || --parts > 0);)
        begin--;
    if (last > begin && (strcmp(last, SCENE_EXTENSION) == 0 || strcmp(last, ECHO_EXTENSION) == 0))
        end = last;
    return strndup(begin, (size_t)(end - begin));
}

static bool has_controls(const char *text)
{
    uint32_t code;
    while (*text && control_length(text, &code) == 0) {
        text++;
    }
    return *text;
}

enum status scene_names_fill(struct scene *scene, const char *path, const char *directory)
{
    char *full_directory = realpath(directory, NULL);
    scene->path = realpath(path, NULL);
    if (!scene->path) {
        scene->path = strdup(path); /* reading it reports the error */
    }
    if (scene->path && full_directory && scene_has_extension(scene->path)) {
        scene->name = name_below(scene->path, full_directory);
    }
    scene->shipped = scene->name != NULL;
    if (scene->path && !scene->name) {
        scene->name = name_of(scene->path, 1);
    }
    free(full_directory);
    if (scene->path && has_controls(scene->path)) { /* tables and pictures would show it */
        return status_set(STATUS_INVALID, "%s: the path of the scene holds control characters, must be plain text",
                          path);
    }
    return scene->path && scene->name ? STATUS_OK : status_set(STATUS_FAILED, "%s: out of memory for the scene", path);
}

enum status scenes_tell_apart(struct scene *a, struct scene *b)
{
    int parts = 1;
    for (const char *c = a->name; *c; c++) {
        parts += *c == '/';
    }
    while (strcmp(a->name, b->name) == 0) {
        parts++;
        struct scene *const both[] = {a, b};
        for (int k = 0; k < 2; k++) {
            char *longer = both[k]->shipped ? strdup(both[k]->name) : name_of(both[k]->path, parts);
            if (!longer) {
                return status_set(STATUS_FAILED, "%s: out of memory for the scene", both[k]->name);
            }
            free(both[k]->name);
            both[k]->name = longer;
        }
    }
    return STATUS_OK;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

enum status scene_names(const char *scene_directory, char ***names, int *count)
{
    *names = NULL;
    *count = 0;
    char *roots[] = {(char *)scene_directory, NULL};
    struct stat about;
    FTS *tree = stat(scene_directory, &about) == 0 && S_ISDIR(about.st_mode)
                    ? fts_open(roots, FTS_LOGICAL | FTS_NOCHDIR | FTS_NOSTAT, NULL)
                    : NULL;
    if (!tree) {
        return status_set(STATUS_INVALID, "%s: not a readable folder; must be the folder of the scenes",
                          scene_directory);
    }
    bool memory = true;
    for (FTSENT *entry = fts_read(tree); entry && memory; entry = fts_read(tree)) {
        bool is_scene =
            (entry->fts_info == FTS_F || entry->fts_info == FTS_NSOK) && scene_has_extension(entry->fts_name);
        if (entry->fts_info == FTS_D && entry->fts_level == 1 && strcmp(entry->fts_name, SCENES_EXTREME) == 0) {
            fts_set(tree, entry, FTS_SKIP);
        }
        if (!is_scene || strchr("_.", entry->fts_name[0])) {
            continue;
        }
        char **longer = realloc(*names, ((size_t)*count + 1) * sizeof **names);
        memory = longer != NULL;
        if (memory) {
            *names = longer;
            longer[*count] = name_below(entry->fts_path, scene_directory);
            memory = longer[*count] != NULL;
            *count += memory;
        }
    }
    fts_close(tree);
    if (!memory) {
        scene_names_free(*names, *count);
        *names = NULL;
        *count = 0;
        return status_set(STATUS_FAILED, "%s: out of memory for the names of scenes", scene_directory);
    }
    if (*count > 0) {
        qsort(*names, (size_t)*count, sizeof **names, compare_names);
    }
    return STATUS_OK;
}

void scene_names_free(char **names, int count)
{
    for (int i = 0; i < count; i++) {
        free(names[i]);
    }
    free(names);
}
