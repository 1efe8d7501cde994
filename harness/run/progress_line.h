/* The current work, on standard error. */
#ifndef SASBENCH_RUN_PROGRESS_LINE_H
#define SASBENCH_RUN_PROGRESS_LINE_H

#include <stdbool.h>

/* Begin to show it: on a terminal at once and every second, on the last line, with the seconds since and the share
   that is done (common/progress.h); elsewhere, where it is `logged`, on a line of its own after every minute without
   one. For one thread. */
void progress_line(bool logged, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* End, and remove it from the terminal: before any other output. */
void progress_line_clear(void);

#endif
