/* The command `baseline`: quality and work of the gate's scenes, measured anew. */
#include <stdio.h>

#include "gate/baseline.h"
#include "command/task.h"

enum status command_baseline(const struct task *task)
{
    const char *path = task->output ? task->output : BASELINE_PATH;
    enum status status = baseline_write(path);
    if (status == STATUS_OK)
        printf("%s is written; %s.\n", path,
               task->output ? "hold it against another by compare OLD NEW" : "review it with git diff");
    return status;
}
