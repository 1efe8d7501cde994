#include "common/progress.h"

#include <stdatomic.h>

static struct {
    _Atomic double from, to;
    atomic_int steps, done;
} part;
static atomic_bool stopped;

void progress_part(double from, double to, int steps)
{
    part.steps = 0; /* nothing is between the old ends and the new ones */
    part.from = from;
    part.to = to;
    part.done = 0;
    part.steps = steps;
}

bool progress_step(void)
{
    atomic_fetch_add_explicit(&part.done, 1, memory_order_relaxed);
    return !progress_stopped();
}

void progress_stop(bool stop)
{
    stopped = stop;
}

bool progress_stopped(void)
{
    return atomic_load_explicit(&stopped, memory_order_relaxed);
}

double progress_share(void)
{
    const int steps = part.steps, done = part.done;
    const double from = part.from;
    return from + (steps > 0 ? (part.to - from) * (done < steps ? done : steps) / steps : 0);
}
