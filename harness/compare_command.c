/* The command `compare`. */
#include "compare.h"
#include "task.h"

enum status command_compare(const struct task *task)
{
    struct compare compare;
    enum status status = compare_results(task->names[0], task->names[1], &compare);
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
