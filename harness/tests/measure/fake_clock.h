/* A clock that goes as it is told. The program's calls of the system that measure time are linked to these
   (meson.build, `timed`), so that every figure made of times can be asserted to the last digit. */
#ifndef SASBENCH_TEST_FAKE_CLOCK_H
#define SASBENCH_TEST_FAKE_CLOCK_H

#include <stdbool.h>

#include "contract/algorithm.h"

enum { FAKE_PAIRS = 262144 }; /* that a run of the scalar reference loop sums */

/* All in ns. */
extern struct fake_clock {
    bool on;               /* else the system's own */
    long long now;         /* the monotonic clock */
    long long tick;        /* by which each reading of it advances it */
    long long waited;      /* threads were ready to run and had no processor */
    long long system;      /* of the processors, the system's */
    const double *control; /* s: what the runs of the scalar reference loop take, one after the other */
    int controls;          /* of them so far */
} fake;

/* On, from a time of its own, and with nothing waited. The wall clock jumps whenever it is read. */
void fake_clock_begin(void);
/* Time passes. */
void fake_clock_pass(double seconds);

/* --- An algorithm whose runs take what they are told --- */

enum { RUNS_TOLD = 8 };
extern struct told {
    double seconds[RUNS_TOLD]; /* of one run after the other; from the first 0 on as the one before */
    double clearing_s;         /* of the first run, the system's */
    double waited;             /* threads without a processor in each run */
    double pairs;
    double processors; /* kept busy */
    bool keeps;        /* the first image is returned again */
    bool busy;         /* look at the clock until the time is over */
} told;
extern int runs_done;                  /* since it was set to 0 */
extern const struct algorithm telling; /* planning takes 4 ms */

#endif
