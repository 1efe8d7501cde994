/* The clock and the stage times of algorithm.h. */
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "algorithm.h"

static int waits = -1; /* Linux's account of the thread, when waiting is left out */

void seconds_skip_waiting(void)
{
    waits = open("/proc/thread-self/schedstat", O_RDONLY | O_CLOEXEC);
}

/* Its second number: ns that the thread was ready to run and had no processor. */
static long long waited_ns(void)
{
    char text[80];
    long long waited = 0;
    ssize_t length = waits >= 0 ? pread(waits, text, sizeof text - 1, 0) : 0;
    text[length > 0 ? length : 0] = '\0';
    sscanf(text, "%*d %lld", &waited);
    return waited;
}

double seconds_now(void)
{
    struct timespec now;
    long long waited;
    do { /* again when the processor was lost between the two clocks */
        waited = waited_ns();
        clock_gettime(CLOCK_MONOTONIC, &now);
    } while (waited_ns() != waited);
    return (double)now.tv_sec + 1e-9 * (double)(now.tv_nsec - waited);
}

void stages_begin(struct stages *stages)
{
    *stages = (struct stages){.mark = seconds_now()};
}

void stages_end(struct stages *stages, const char *name)
{
    double now = seconds_now(), seconds = now - stages->mark;
    int last = (int)(sizeof stages->stage / sizeof stages->stage[0]) - 1, i = 0;
    stages->mark = now;
    while (i < stages->count && strcmp(stages->stage[i].name, name) != 0)
        i++;
    if (i > last)
        i = last; /* a contributor with more stages sees the rest summed in the last one */
    else if (i == stages->count)
        stages->stage[stages->count++].name = name;
    stages->stage[i].seconds += seconds;
}
