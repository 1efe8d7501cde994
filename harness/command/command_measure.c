/* The command `measure`, which `compare --ab` starts; not for the terminal. */
#include "gate/ab_worker.h"

#include "command/task.h"

enum status command_measure(const struct task *task)
{
    (void)task;
    return ab_worker_serve();
}
