/* The command `reproduce`: what the papers print and claim, beside ours. */
#include "claims/reproduce.h"

#include "command/task.h"

enum status command_reproduce(const struct task *task)
{
    return papers_reproduce(task->names, task->name_count, task->output ? task->output : "results/reproduce",
                            task->shard);
}
