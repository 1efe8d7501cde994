/* Progress of long work, for a display: no result depends on it. */
#ifndef SASBENCH_COMMON_PROGRESS_H
#define SASBENCH_COMMON_PROGRESS_H

/* The next `steps` steps advance it from one share of all to another. For one thread. */
void progress_part(double from, double to, int steps);
/* One step is done; by any thread. */
void progress_step(void);
/* The share that is done, 0 without progress_part; by any thread. */
double progress_share(void);

#endif
