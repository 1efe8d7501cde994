/* The command `report`: a results folder as one page. */
#include "show/report.h"

#include <stdio.h>

#include "command/task.h"
#include "study/sweep_tables.h"

enum status command_report(const struct task *task)
{
    const char *directory = task->names[0];
    enum status status = STATUS_OK;
    if (sweep_is(directory))
        status = sweep_tables(directory, NULL, 0, NULL);
    if (status == STATUS_OK)
        status = report_write(directory);
    if (status == STATUS_OK)
        printf("%s/report.html and report.md\n", task->names[0]);
    return status;
}
