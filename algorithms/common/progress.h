/* How far a long work is, for a display: no result depends on it. */
#ifndef SASBENCH_COMMON_PROGRESS_H
#define SASBENCH_COMMON_PROGRESS_H

/* The `steps` to come take it from one share of all to another. For one thread. */
void progress_part(double from, double to, int steps);
/* One of them is done; by any thread. */
void progress_step(void);
/* The share that is done, 0 where nobody says; by any thread. */
double progress_share(void);

#endif
