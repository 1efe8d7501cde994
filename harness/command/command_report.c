/* The command `report`: a results folder as one page, or several as a site. */
#include "report/report.h"
#include "report/site.h"

#include <stdio.h>

#include "command/task.h"
#include "files/folder.h"
#include "sweep/sweep_tables.h"

static enum status report_site(const struct task *task)
{
    if (!task->output)
        return status_set(STATUS_INVALID, "report: -o OUT is missing: the folder of the site");
    const enum status status = site_write(task->name_count, task->names, task->output);
    if (status == STATUS_OK)
        printf("%s/index.html\n", task->output);
    return status;
}

enum status command_report(const struct task *task)
{
    const char *directory = task->names[0];
    if (task->site)
        return report_site(task);
    if (task->name_count > 1 || task->output)
        return status_set(STATUS_INVALID, "report: %s goes with --site; without it one folder is accepted",
                          task->output ? "-o" : task->names[1]);
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
