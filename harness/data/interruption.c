#include "data/interruption.h"

#include <signal.h>
#include <stddef.h>

static const int numbers[] = {SIGINT, SIGTERM};
enum { NUMBERS = sizeof numbers / sizeof *numbers };

static struct sigaction before[NUMBERS];
static volatile sig_atomic_t noted;

static void restore(void)
{
    for (int k = 0; k < NUMBERS; k++)
        sigaction(numbers[k], &before[k], NULL);
}

static void note(int number)
{
    noted = number;
    restore();
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
