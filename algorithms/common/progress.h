/* Progress of long work, for a display: no result depends on it. And its end ahead of time. */
#ifndef SASBENCH_COMMON_PROGRESS_H
#define SASBENCH_COMMON_PROGRESS_H

#include <stdbool.h>

/* The next `steps` steps advance it from one share of all to another. For one thread. */
void progress_part(double from, double to, int steps);
/* A step begins; by any thread. False after progress_stop: the rest is left out, and the result is void. */
bool progress_step(void);
/* The share that is done, 0 without progress_part; by any thread. */
double progress_share(void);

/* Let all work that takes steps end without the rest (true), until it may go on again (false). By any thread, and by a
   signal's handler. */
void progress_stop(bool stop);
bool progress_stopped(void);

#endif
