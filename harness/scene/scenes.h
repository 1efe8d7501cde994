/* Several scenes at once: those that a command names, or all shipped ones. */
#ifndef SASBENCH_SCENE_SCENES_H
#define SASBENCH_SCENE_SCENES_H

#include "scene/scene.h"

/* Scenes by name or path, or with given_count 0 all shipped ones that are not full_size, in *scenes [*count]. All
   are read before the first one runs, so that a fault in the last one shows at once. `command` begins a message.
   Errors: as scene_load, and STATUS_INVALID for a scene named twice; scenes already read must still be freed with
   scenes_free. */
enum status scenes_load(const char *command, int given_count, const char *const *given, struct scene **scenes,
                        int *count);
void scenes_free(struct scene *scenes, int count);

#endif
