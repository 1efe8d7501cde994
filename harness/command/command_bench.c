/* The command `bench`: how near the engines come to the machine's limits. */
#include "bench/bench.h"

#include "command/task.h"

enum status command_bench(const struct task *task)
{
    const char *directory = task->output ? task->output : "results/bench";
    return task->name_count > 0 ? bench_specs(directory, task->names, task->name_count)
                                : bench_goals(BENCH_FOLDER, directory);
}
