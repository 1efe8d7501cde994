/* What is being done, on standard error. */
#ifndef SASBENCH_RUN_PROGRESS_LINE_H
#define SASBENCH_RUN_PROGRESS_LINE_H

#include <stdbool.h>

/* Begin to say it: on a terminal at once and every second, on the last line, with the seconds since and the share that
   is done (common/progress.h); elsewhere, where it is `logged`, on a line of its own whenever a minute has passed
   without one. For one thread. */
void progress_line(bool logged, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* End, and take it from the terminal: before anything else is printed. */
void progress_line_clear(void);

#endif
