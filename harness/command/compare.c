/* The command `compare`. */
#include "gate/ab.h"
#include "gate/diff.h"
#include "command/task.h"

static enum status compare_any(const struct task *task, struct compare *compare)
{
    const char *const *names = task->names;
    if (task->ab)
        return ab_compare(names[0], names[1], names + 2, task->name_count - 2, task->specs, task->spec_count, &ab_usual,
                          compare);
    *compare = (struct compare){0};
    if (task->name_count > 2 || task->spec_count > 0)
        return status_set(STATUS_INVALID, "compare: '%s' is too much without --ab: sasbench compare OLD NEW",
                          task->name_count > 2 ? names[2] : "--algorithm");
    return compare_results(names[0], names[1], compare);
}

enum status command_compare(const struct task *task)
{
    struct compare compare;
    enum status status = compare_any(task, &compare);
    if (status == STATUS_OK && task->markdown)
        status = compare_markdown(&compare, task->markdown);
    if (status == STATUS_OK && task->json)
        status = compare_json(&compare, task->json);
    if (status == STATUS_OK) {
        compare_print(&compare, stdout);
        status = compare_judge(&compare);
    }
    compare_free(&compare);
    return status;
}
