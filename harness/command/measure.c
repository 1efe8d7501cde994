/* The command `measure`, which `compare --ab` starts; not for the terminal. */
#include "gate/worker.h"

#include "command/task.h"

enum status command_measure(const struct task *task)
{
    (void)task;
    return worker_serve();
}
