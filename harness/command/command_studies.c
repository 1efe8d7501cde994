/* Commands that hand their arguments to one study: `baseline`, `bench`, `phase`, `reproduce`, `stability`. */
#include <stdio.h>

#include "bench/bench.h"
#include "claims/reproduce.h"
#include "command/task.h"
#include "files/paths.h"
#include "gate/baseline.h"
#include "papers/phase.h"
#include "stability/stability.h"

enum status command_baseline(const struct task *task)
{
    const char *path = task->output ? task->output : data_path(DATA_BASELINE);
    enum status status = baseline_write(path);
    if (status == STATUS_OK)
        printf("%s is written; %s.\n", path,
               task->output ? "hold it against another by compare OLD NEW" : "review it with git diff");
    return status;
}

enum status command_bench(const struct task *task)
{
    const char *directory = task->output ? task->output : "results/bench";
    return task->name_count > 0 ? bench_specs(directory, task->names, task->name_count)
                                : bench_goals(data_path(DATA_BENCH), directory);
}

enum status command_phase(const struct task *task)
{
    if (task->at && (task->name_count || task->output))
        return status_set(STATUS_INVALID,
                          "phase: --at %s prints to standard output; neither a scene nor -o is "
                          "accepted",
                          task->at);
    if (task->at)
        return phase_points_print(task->at);
    const char *directory = task->output ? task->output : "results/phase";
    return task->name_count ? phase_scene_study(task->names[0], directory, false) : phase_study(directory, false);
}

enum status command_reproduce(const struct task *task)
{
    return papers_reproduce(&(struct reproduction){.ids = task->names,
                                                   .count = task->name_count,
                                                   .directory = task->output ? task->output : "results/reproduce",
                                                   .shard = task->shard,
                                                   .quick = task->quick,
                                                   .docs = task->docs});
}

enum status command_stability(const struct task *task)
{
    const struct stability_request request = {.scene_count = task->name_count,
                                              .spec_count = task->spec_count,
                                              .scenes = task->names,
                                              .specs = task->specs,
                                              .directory = task->output ? task->output : "results/stability",
                                              .quick = task->quick,
                                              .shard = task->shard};
    return stability_run(&request, data_path(DATA_STABILITY));
}
