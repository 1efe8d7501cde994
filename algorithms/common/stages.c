/* The clock and the stage times of algorithm.h. */
#include <string.h>
#include <time.h>

#include "contract/algorithm.h"
#include "common/clock.h"

double clock_monotonic(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double (*clock_now)(void) = clock_monotonic;

void clock_set(double (*clock)(void))
{
    clock_now = clock;
}

double seconds_now(void)
{
    return clock_now();
}

void stages_begin(struct stages *stages)
{
    *stages = (struct stages){.mark = seconds_now()};
}

void stages_add(struct stages *stages, const char *name, double seconds)
{
    int last = (int)(sizeof stages->stage / sizeof stages->stage[0]) - 1, i = 0;
    while (i < stages->count && strcmp(stages->stage[i].name, name) != 0)
        i++;
    if (i > last)
        i = last;
    else if (i == stages->count)
        stages->stage[stages->count++].name = name;
    stages->stage[i].seconds += seconds;
}

void stages_end(struct stages *stages, const char *name)
{
    const double now = seconds_now(), seconds = now - stages->mark;
    stages->mark = now;
    stages_add(stages, name, seconds);
}

void stages_share(struct stages *stages, int count, const char *const *names, const double *seconds)
{
    double sum = 0, passed = seconds_now() - stages->mark;
    for (int k = 0; k < count; k++)
        sum += seconds[k];
    for (int k = 0; k < count; k++)
        if (seconds[k] > 0) {
            stages->mark = seconds_now() - passed * seconds[k] / sum;
            stages_end(stages, names[k]);
        }
}
