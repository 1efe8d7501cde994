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
    char names[400] = "";
    int count = 0;
    int specs = 0, refusals = 0;
    static struct check_told told;
    FILE *stream = task->all ? stdout : NULL;
    if (!task->name_count && !task->echoes)
        return status_set(STATUS_INVALID, "check: a SCENE, or --echoes FILE.mat with --grid GRID, is missing");
    enum status status = task_scenes("check", task, 0, NULL, &scene, &count);
    if (status != STATUS_OK) {
        scenes_free(scene, count);
        return status;
    }
    if (task->all) {
        printf("%s\n", scene->name);
        check_sensitivities_print(stdout, scene);
    }
    check_scene(stream, scene, &told);
    for (int k = 0; status == STATUS_OK && (task->spec_count > 0 ? k < task->spec_count : algorithms[k] != NULL); k++) {
        struct spec own = {0};
        bool refused = false;
        if (task->spec_count == 0)
            status = spec_parse(algorithms[k]->name, &own);
        const struct spec *spec = task->spec_count > 0 ? &task->specs[k] : &own;
        if (status == STATUS_OK)
            status = check_algorithm(stream, scene, spec, &told, &refused);
        specs++;
        refusals += refused;
        if (status == STATUS_OK && refused)
            text_append(names, sizeof names, "%s%s", *names ? ", " : "", spec->algorithm->name);
        spec_free(&own);
    }
    if (status == STATUS_OK && !task->all)
        check_answer_print(stdout, scene, &told, specs, refusals);
    if (status == STATUS_OK && *names)
        status = status_set(STATUS_FAILED, "check: %s cannot image %s", names, scene->name);
    scenes_free(scene, count);
    return status;
}
