/* The command `scenes random`. */
#include <stdio.h>
#include <string.h>

#include "command/task.h"
#include "text/number.h"
#include "files/text_file.h"
#include "scene/random_scene.h"

enum status command_scenes(const struct task *task)
{
    const long long seed_most = 1000000000000000;
    long long seed;
    struct text_file file;
    if (strcmp(task->names[0], "random") != 0)
        return status_set(STATUS_INVALID, "scenes: '%s' is not accepted; accepted: random", task->names[0]);
    if (!task->seed)
        return status_set(STATUS_INVALID, "scenes: --seed N is missing, a whole number from 0 to 1e15");
    const char *end = whole_read(task->seed, 0, seed_most, &seed);
    if (!end || *end)
        return status_set(STATUS_INVALID, "scenes: --seed is '%s', must be a whole number from 0 to 1e15", task->seed);
    if (!task->output) {
        random_scene_write(stdout, (uint64_t)seed);
        return STATUS_OK;
    }
    if (!has_extension(task->output, ".cfg"))
        return status_set(STATUS_INVALID, "scenes: -o %s must end with .cfg", task->output);
    enum status status = text_file_open_named(task->output, &file);
    if (status != STATUS_OK)
        return status;
    random_scene_write(file.stream, (uint64_t)seed);
    return text_file_close(&file, STATUS_OK);
}
