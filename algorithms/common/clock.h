/* The clock behind seconds_now (algorithm.h). */
#ifndef SASBENCH_COMMON_CLOCK_H
#define SASBENCH_COMMON_CLOCK_H

/* s, the system's. Threads of an algorithm take their stages' shares by it: seconds_now may be for one thread only. */
double clock_monotonic(void);

struct stages;
/* Add seconds to a stage by its name; to the last one where there is no room for another. */
void stages_add(struct stages *stages, const char *name, double seconds);
/* The threads' time in each stage, as shares of the time that passed. */
void stages_share(struct stages *stages, int count, const char *const *names, const double *seconds);

/* Replace seconds_now by `clock`, in s. Call it before any thread measures time. */
void clock_set(double (*clock)(void));

#endif
