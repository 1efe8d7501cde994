/* The scenes that a command line asks for. */
#include <stdlib.h>

#include "command/task.h"
#include "run/batch.h"

enum status echoes_scene(const struct task *task, struct scene *scene)
{
    struct grid grid;
    const enum status status = task->grid ? grid_parse(task->grid, &grid) : STATUS_OK;
    if (status != STATUS_OK)
        return status;
    return scene_from_echoes(task->echoes, task->grid ? &grid : NULL, task->grid ? task->grid : task->echoes,
                             !image_is_tiled(task), scene);
}

enum status task_scenes(const char *command, const struct task *task, int usual_count, const char *const *usual,
                        struct scene **scenes, int *count)
{
    *scenes = NULL;
    *count = 0;
    if (task->grid && !task->echoes)
        return status_set(STATUS_INVALID, "%s: --grid %s goes with --echoes FILE.mat; a scene has its own image",
                          command, task->grid);
    if (!task->echoes)
        return scenes_load(command, task->name_count ? task->name_count : usual_count,
                           task->name_count ? task->names : usual, scenes, count);
    if (task->name_count)
        return status_set(STATUS_INVALID, "%s: '%s' and --echoes %s are both given; one of the two is accepted",
                          command, task->names[0], task->echoes);
    *scenes = calloc(1, sizeof **scenes);
    if (!*scenes)
        return status_set(STATUS_FAILED, "%s: no memory for a scene", command);
    enum status status = echoes_scene(task, *scenes);
    *count = status == STATUS_OK;
    return status;
}
