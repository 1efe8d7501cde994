/* The command `report`: a results folder as one page. */
#include "show/report.h"

#include <stdio.h>

#include "command/task.h"

enum status command_report(const struct task *task)
{
    enum status status = report_write(task->names[0]);
    if (status == STATUS_OK)
        printf("%s/report.html and report.md\n", task->names[0]);
    return status;
}
