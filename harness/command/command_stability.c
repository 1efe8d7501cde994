/* The command `stability`: images at the ends of the range of numbers. */
#include "stability/stability.h"

#include "command/task.h"

enum status command_stability(const struct task *task)
{
    const struct stability_request request = {.scene_count = task->name_count,
                                              .spec_count = task->spec_count,
                                              .scenes = task->names,
                                              .specs = task->specs,
                                              .directory = task->output ? task->output : "results/stability",
                                              .quick = task->quick,
                                              .shard = task->shard};
    return stability_run(&request, STABILITY_EXPECTED);
}
