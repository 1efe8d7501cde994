/* The command `bench`: how near the engines come to the machine's limits. */
#include "bench/bench.h"

#include "command/task.h"

enum status command_bench(const struct task *task)
{
    return bench_run(task->output ? task->output : "results/bench", task->names, task->name_count);
}
