/* The command `report`: a results folder as one page. */
#include "show/report.h"

#include <stdio.h>

#include "command/task.h"
#include "data/folder.h"
#include "study/sweep_tables.h"

enum status command_report(const struct task *task)
{
    const char *directory = task->names[0];
    int lock;
    enum status status = folder_take(directory, &lock);
    if (status == STATUS_OK && sweep_is(directory))
        status = sweep_tables(directory, NULL, 0, NULL);
    if (status == STATUS_OK)
        status = report_write(directory);
    if (status == STATUS_OK)
        printf("%s/report.html and report.md\n", directory);
    folder_leave(lock);
    return status;
}
