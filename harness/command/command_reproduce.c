/* The command `reproduce`: what the papers print and claim, beside ours. */
#include "claims/reproduce.h"

#include "command/task.h"

enum status command_reproduce(const struct task *task)
{
    return papers_reproduce(&(struct reproduction){.ids = task->names,
                                                   .count = task->name_count,
                                                   .directory = task->output ? task->output : "results/reproduce",
                                                   .shard = task->shard,
                                                   .quick = task->quick,
                                                   .docs = task->docs});
}
