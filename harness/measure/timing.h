/* Timing of one algorithm on one problem. */
#ifndef SASBENCH_MEASURE_TIMING_H
#define SASBENCH_MEASURE_TIMING_H

#include "measure/control.h"
#include "imaging/spec.h"

struct timing {
    double plan_s;             /* s, planning, once */
    double run_s, run_min_s;   /* s, median and minimum of the timed runs */
    double run_q1_s, run_q3_s; /* s, quartiles; NAN for less than 4 runs */
    double waited;             /* threads that were ready to run and had no processor, on the average; NAN: unknown */
    double drift;              /* the scalar reference loop's time after the runs over that before, less 1 */
    double spent_s;            /* on all runs, also to warm up */
    int runs;                  /* timed runs; 1 when a run is so long that the first counts */
    double control_s;          /* s, the scalar reference loop's time for all pairs of the problem, measured beside */
    struct stages stages;      /* of the median run */
    struct work work;
};

/* Runs of several rounds, between which others run, so that no setting has a bad minute to itself; zeroed at first. */
enum { TIMING_ROUNDS = 3, TIMING_RUNS = 1000, TIMING_CONTROLS = 2 * CONTROL_RUNS * TIMING_ROUNDS };
struct timing_samples {
    int runs, controls;
    double seconds[TIMING_RUNS];
    struct stages stages[TIMING_RUNS];
    double control[TIMING_CONTROLS]; /* s a pair of the scalar reference loop */
    double waited, elapsed;          /* s */
};

/* How much is put into a time. EFFORT_WHOLE: a run to warm up, then repeated until five runs and half a second are
   timed; long runs are repeated less (three at least, and no new run begins after 3 s; a first run of 10 s or more is
   the only one). EFFORT_BRIEF, where hundreds are measured: five runs and 0.04 s (two at least, and no new one after
   0.15 s; a first run of 0.04 s or more counts, and one of 0.3 s or more is the only one). A first run of which the
   system had more than a quarter, to find and clear memory, never counts. */
enum effort { EFFORT_NONE, EFFORT_BRIEF, EFFORT_WHOLE };

/* Plan and run as often as the effort says, which is not EFFORT_NONE. Every other run images the negated echoes, so
   that a kept image is found out; the echoes are then as they were. The control is timed before, unless it just was,
   and after, which is left out alike by EFFORT_BRIEF. With `samples` this is one of TIMING_ROUNDS rounds, each a
   part of EFFORT_WHOLE; times are of all runs so far. *image is the finished one (imaging_finish), freed by the
   caller. Errors: as imaging_open, imaging_execute, imaging_finish, control_measure, and STATUS_FAILED for a time that
   is not above 0, an image of the negated echoes that is not the negated image, and more processors than threads;
   *image is then empty. */
enum status timing_measure(const struct spec *spec, const struct problem *problem, struct echoes *echoes,
                           struct control *control, enum effort effort, struct timing_samples *samples,
                           struct image *image, struct timing *timing);

/* From now on seconds_now, and with it the stages of algorithms, leaves out the time in which this thread was ready to
   run and other work had the processor (what the thread sleeps still counts). Only this thread may ask for the time
   from then on. Where the system does not tell that, nothing changes. */
void seconds_skip_waiting(void);

/* The quartiles' distance over the median beyond which a time is told to be noisy. */
#define TIMING_NOISY 0.1
double timing_spread(const struct timing *timing); /* of these times; NAN for less than 4 runs */

/* Both sort the values; NAN when count is 0. The value below which `share` of them lie, linear between two. */
double median(double *values, int count);
double quantile(double *values, int count, double share);

#endif
