#include "run/interruption.h"

#include <signal.h>
#include <stddef.h>
#include <time.h>

static const int numbers[] = {SIGINT, SIGTERM};
enum { NUMBERS = sizeof numbers / sizeof *numbers };

static struct sigaction before[NUMBERS];
static volatile sig_atomic_t noted;
static struct timespec first; /* when it was noted */

static void restore(void)
{
    for (int k = 0; k < NUMBERS; k++)
        sigaction(numbers[k], &before[k], NULL);
}

/* A terminal signals the supervisor as well, which hands it on: what comes at once is the same signal. */
static void note(int number)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (!noted) {
        first = now;
        noted = number;
    } else if ((double)(now.tv_sec - first.tv_sec) + 1e-9 * (double)(now.tv_nsec - first.tv_nsec) > 1) {
        restore();
        raise(number);
    }
}

void interruption_hold(void)
{
    struct sigaction action = {.sa_handler = note, .sa_flags = SA_RESTART};
    noted = 0;
    for (int k = 0; k < NUMBERS; k++) {
        sigaction(numbers[k], NULL, &before[k]);
        if (before[k].sa_handler != SIG_IGN)
            sigaction(numbers[k], &action, NULL);
    }
}

bool interruption_seen(void)
{
    return noted != 0;
}

void interruption_end(void)
{
    restore();
    if (noted)
        raise(noted);
}
