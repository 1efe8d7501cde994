/* The command `merge`: results folders of shards as one. */
#include <stdio.h>

#include "command/task.h"
#include "text/text_append.h"
#include "files/folder.h"
#include "results/merge.h"
#include "show/plot.h"
#include "show/table.h"

enum status command_merge(const struct task *task)
{
    static struct merged merged[KINDS_OF_MACHINES];
    char text[9000];
    int count, undrawn = 0;
    if (!task->output)
        return status_set(STATUS_INVALID, "merge: -o DIR is missing: the folder of all rows");
    enum status status = results_merge(task->name_count, task->names, task->output, merged, &count);
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        snprintf(text, sizeof text, "%.4000s: %d cells of %d folders, measured on %s", merged[k].directory,
                 merged[k].cells, merged[k].folders, merged[k].machine);
        table_text(stdout, 0, text);
    }
    if (count > 1 && status == STATUS_OK)
        table_text(stdout, 0, "Each kind of machine has its folder: times of different ones are not compared.");
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        snprintf(text, sizeof text, "%.4000s/measurements.csv", merged[k].directory);
        if (!place_is_file(text)) /* of `stability` */
            continue;
        status = plot_results(merged[k].directory, NULL, &undrawn);
        snprintf(text, sizeof text, "Next: %s report ", program_called());
        text_append_word(text, sizeof text, merged[k].directory);
        if (status == STATUS_OK)
            table_text(stdout, 0, text);
    }
    return status == STATUS_OK && undrawn > 0 ? status_set(STATUS_FAILED, "%d pictures could not be drawn", undrawn)
                                              : status;
}
