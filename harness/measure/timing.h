/* Timing of one algorithm on one problem. */
#ifndef SASBENCH_MEASURE_TIMING_H
#define SASBENCH_MEASURE_TIMING_H

#include "backprojection/pairs/turned.h"
#include "imaging/spec.h"
#include "measure/scalar_loop.h"

enum { CONTROL_RUNS = 2 }; /* the loop's runs in turn; the faster one is free of most interruptions */

/* The scalar reference loop's time beside measurements of one problem. Made by control_begin, released by control_end,
   which accepts zeroes. The first measurement chooses the pairs. */
struct control {
    struct problem
        problem; /* once open, with turned grids turned back: the loop's rows and columns are along x and r only */
    struct turned_problem turned;
    const struct echoes *echoes;
    struct scalar_loop loop;
    bool open;
    double seconds[CONTROL_RUNS]; /* a pair's time, last measured */
    double measured;              /* seconds_now() at that time */
};

/* `echoes` are in float, whatever the problem's precision; they and what the problem points to are borrowed. */
struct control control_begin(const struct problem *problem, const struct echoes *echoes);
void control_end(struct control *control);

struct timing {
    double plan_s;             /* s, planning, once */
    double run_s, run_min_s;   /* s, median and minimum of the timed runs */
    double run_q1_s, run_q3_s; /* s, quartiles; NAN for less than 4 runs */
    double waited;    /* mean number of threads that were ready to run without a processor; NAN: not measured */
    double drift;     /* the scalar reference loop's time after the runs over its time before them, less 1 */
    double spent_s;   /* on all runs, warm-up included */
    int runs;         /* timed runs; 1 when the first run is so long that it counts */
    double control_s; /* s, the scalar reference loop's time for all pairs of the problem, measured beside the runs */
    struct stages stages; /* of the median run */
    struct work work;
};

/* Runs of several rounds. Other settings run between the rounds, so that a disturbed minute does not hit one setting
   alone. Zeroed at first. */
enum { TIMING_ROUNDS = 3, TIMING_RUNS = 1000, TIMING_CONTROLS = 2 * CONTROL_RUNS * TIMING_ROUNDS };
struct timing_samples {
    int runs, controls;
    double seconds[TIMING_RUNS];
    struct stages stages[TIMING_RUNS];
    double control[TIMING_CONTROLS]; /* s a pair of the scalar reference loop */
    double waited, elapsed;          /* s */
};

/* The effort of a time. EFFORT_WHOLE: a run to warm up, then repeated until five runs and half a second are timed;
   long runs are repeated less (three at least, and no new run begins after 3 s; a first run of 10 s or more is the
   only one). EFFORT_BRIEF, where hundreds are measured: five runs and 0.04 s (two at least, and no new one after
   0.15 s; a first run of 0.04 s or more counts, and one of 0.3 s or more is the only one). A first run never counts
   if the system took more than a quarter of it to find and clear memory. */
enum effort { EFFORT_NONE, EFFORT_BRIEF, EFFORT_WHOLE };

/* Plan and run as often as the effort requires; it must not be EFFORT_NONE. Every other run images the negated
   echoes, which detects an image kept from an earlier run; the echoes are restored. The control is timed before the
   runs, unless it just was, and after them; EFFORT_BRIEF omits the latter. With `samples` this is one of
   TIMING_ROUNDS rounds, each a part of EFFORT_WHOLE, where a first run of 0.5 s or more counts; times are of all runs
   so far. *image is the finished one
   (imaging_finish), freed by the caller. Errors: as imaging_open, imaging_execute, imaging_finish, problem_turn_back,
   and STATUS_FAILED for a time that is not above 0, an image of the negated echoes that is not the negated image,
   and more processors than threads; *image is then empty. */
enum status timing_measure(const struct spec *spec, const struct problem *problem, struct echoes *echoes,
                           struct control *control, enum effort effort, struct timing_samples *samples,
                           struct image *image, struct timing *timing);

/* From now on seconds_now, and with it the stages of algorithms, excludes the time in which this thread was ready to
   run but other work had the processor (sleep still counts). Only this thread may read the time from then on. No
   effect where the system does not report that time. */
void seconds_skip_waiting(void);

/* The quartiles' distance over the median beyond which a time is marked noisy. */
#define TIMING_NOISY 0.1
double timing_spread(const struct timing *timing); /* of this time; NAN for less than 4 runs */

/* Both sort the values; NAN when count is 0. quantile: the value below which `share` of them lie, linear between
   two. */
double median(double *values, int count);
double quantile(double *values, int count, double share);

#endif
