#include "status.h"

#include <stdarg.h>
#include <stdio.h>

static _Thread_local char message[1024];

enum status status_set(enum status status, const char *format, ...)
{
    /* The arguments may point into the old message, so the new one is built beside it. */
    char text[sizeof message];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    snprintf(message, sizeof message, "%s", text);
    return status;
}

const char *status_message(void)
{
    return message;
}
