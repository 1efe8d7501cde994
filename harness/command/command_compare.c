/* The command `compare`. */
#include "gate/ab.h"
#include "gate/diff.h"
#include "command/task.h"

static enum status compare_sides(const struct task *task, struct diff *diff)
{
    const char *const *names = task->names;
    if (task->ab)
        return ab_run(names[0], names[1], names + 2, task->name_count - 2, task->specs, task->spec_count, &ab_usual,
                      diff);
    *diff = (struct diff){0};
    if (task->name_count > 2 || task->spec_count > 0)
        return status_set(STATUS_INVALID, "compare: '%s' is too much without --ab: sasbench compare OLD NEW",
                          task->name_count > 2 ? names[2] : "--algorithm");
    return diff_results(names[0], names[1], diff);
}

enum status command_compare(const struct task *task)
{
    struct diff diff;
    enum status status = compare_sides(task, &diff);
    if (status == STATUS_OK && task->markdown)
        status = diff_markdown(&diff, task->markdown);
    if (status == STATUS_OK && task->json)
        status = diff_json(&diff, task->json);
    if (status == STATUS_OK) {
        diff_print(&diff, stdout);
        status = diff_status(&diff);
    }
    diff_free(&diff);
    return status;
}
