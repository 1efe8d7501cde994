/* How a scene gets its name. Used within scene/ only. */
#ifndef SASBENCH_SCENE_NAMES_H
#define SASBENCH_SCENE_NAMES_H

#include "scene/scene.h"

#define SCENE_EXTENSION ".cfg"
#define ECHO_EXTENSION  ".mat"

bool scene_has_extension(const char *path);

/* Path, name and shipped of the scene whose file is at `path`. A scene has one name, however its path is written.
   Errors: STATUS_INVALID for control characters in the path, STATUS_FAILED without memory; scene_free then frees the
   rest. */
enum status scene_names_fill(struct scene *scene, const char *path, const char *directory);

#endif
