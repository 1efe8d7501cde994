/* The command `check`: a scene's conditions and sensitivities before any work. */
#include "text/text_append.h"
#include "advise/check.h"

#include <stdio.h>
#include <string.h>

#include "command/task.h"
#include "run/batch.h"

enum status command_check(const struct task *task)
{
    struct scene *scene;
    static struct check_found found;
    char names[400] = "";
    int count = 0;
    if (!task->name_count && !task->echoes)
        return status_set(STATUS_INVALID, "check: a SCENE, or --echoes FILE.mat, is missing");
    enum status status = task_scenes("check", task, 0, NULL, &scene, &count);
    if (status != STATUS_OK) {
        scenes_free(scene, count);
        return status;
    }
    check_scene(scene, &found);
    for (int k = 0; status == STATUS_OK && k < task->spec_count; k++) {
        bool refused = false;
        status = check_algorithm(scene, &task->specs[k], &found, &refused);
        if (status == STATUS_OK && refused)
            text_append(names, sizeof names, "%s%s", *names ? ", " : "", task->specs[k].algorithm->name);
    }
    if (status == STATUS_OK)
        check_print(stdout, scene, &found, task->all);
    if (status == STATUS_OK && task->all)
        check_sensitivities_print(stdout, scene);
    if (status == STATUS_OK && *names)
        status = status_set(STATUS_FAILED, "check: %s cannot image %s", names, scene->name);
    scenes_free(scene, count);
    return status;
}
