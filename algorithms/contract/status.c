#include "contract/status.h"

#include <omp.h>
#include <stdarg.h>
#include <stdio.h>

/* The message of a thread; the workers' last message, for the thread that waits for them. */
static _Thread_local char message[1024];
static char of_workers[sizeof message];

enum status status_set(enum status status, const char *format, ...)
{
    /* The arguments may point into the old message, so the new one is built beside it. */
    char text[sizeof message];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    snprintf(message, sizeof message, "%s", text);
#pragma omp critical(status_of_workers)
    snprintf(of_workers, sizeof of_workers, "%s", omp_in_parallel() ? text : "");
    return status;
}

const char *status_message(void)
{
    if (!omp_in_parallel()) {
#pragma omp critical(status_of_workers)
        if (*of_workers) {
            snprintf(message, sizeof message, "%s", of_workers);
            *of_workers = '\0';
        }
    }
    return message;
}
