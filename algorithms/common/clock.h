/* The clock behind seconds_now (algorithm.h). */
#ifndef SASBENCH_COMMON_CLOCK_H
#define SASBENCH_COMMON_CLOCK_H

double clock_monotonic(void); /* s, the system's */

/* From now on seconds_now is `clock`, in s. Call it before threads that time something. */
void clock_set(double (*clock)(void));

#endif
