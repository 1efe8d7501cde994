/* The command `report`: a results folder as one page. */
#include "report/report.h"

#include <stdio.h>

#include "command/task.h"
#include "files/folder.h"
#include "sweep/sweep_tables.h"

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
        printf("%s/report.html\n", directory);
    folder_leave(lock);
    return status;
}
