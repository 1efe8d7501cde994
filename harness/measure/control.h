/* The scalar reference loop's time beside measurements of one problem. */
#ifndef SASBENCH_MEASURE_CONTROL_H
#define SASBENCH_MEASURE_CONTROL_H

#include "backprojection/pairs/turned.h"
#include "measure/scalar_loop.h"

enum { CONTROL_RUNS = 2 }; /* the loop's runs in turn; the faster one is free of most interruptions */

/* Made by control_begin, released by control_end, which accepts zeroes. The first measurement chooses the pairs. */
struct control {
    struct problem
        problem; /* once open, with turned grids turned back: the loop's rows and columns are along x and r only */
    struct turned_problem turned;
    const struct echoes *echoes;
    struct scalar_loop loop;
    bool open;
    double seconds[CONTROL_RUNS]; /* a pair's time, last measured */
    double measured;              /* seconds_now() at that time */
    double spent_s;               /* so far, on all measurements */
};

/* `echoes` are in float, whatever the problem's precision; they and what the problem points to are borrowed. */
struct control control_begin(const struct problem *problem, const struct echoes *echoes);
void control_end(struct control *control);
/* Time the loop into control->seconds; *least is the faster run. With `recent`, a measurement of the last second is
   used again. Errors: as problem_turn_back. */
enum status control_measure(struct control *control, bool recent, double *least);

#endif
