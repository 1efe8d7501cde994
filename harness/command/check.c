/* The command `check`: a scene's conditions and sensitivities before any work. */
#include "study/check.h"

#include <stdio.h>
#include <string.h>

#include "command/task.h"

enum status command_check(const struct task *task)
{
    struct scene scene;
    char names[400] = "";
    enum status status = scene_load(task->names[0], SCENE_DIRECTORY, &scene);
    if (status != STATUS_OK)
        return status;
    printf("%s\n", scene.name);
    check_sensitivities_print(stdout, &scene);
    for (int k = 0; status == STATUS_OK && (task->spec_count > 0 ? k < task->spec_count : algorithms[k] != NULL); k++) {
        struct spec own = {0};
        bool refused = false;
        if (task->spec_count == 0)
            status = spec_parse(algorithms[k]->name, &own);
        const struct spec *spec = task->spec_count > 0 ? &task->specs[k] : &own;
        if (status == STATUS_OK)
            status = check_algorithm(stdout, &scene, spec, &refused);
        if (status == STATUS_OK && refused) {
            size_t used = strlen(names);
            snprintf(names + used, sizeof names - used, "%s%s", used ? ", " : "", spec->algorithm->name);
        }
        spec_free(&own);
    }
    if (status == STATUS_OK && *names)
        status = status_set(STATUS_FAILED, "check: %s cannot image %s", names, scene.name);
    scene_free(&scene);
    return status;
}
