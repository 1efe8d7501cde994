/* The scalar reference loop's time beside measurements of one problem. */
#ifndef SASBENCH_MEASURE_CONTROL_H
#define SASBENCH_MEASURE_CONTROL_H

#include "backprojection/pairs/turned.h"
#include "measure/scalar_loop.h"

enum { CONTROL_RUNS = 2 }; /* of the loop, one after the other: the faster one is free of most interruptions */

/* Made by control_begin, ended by control_end, which accepts zeroes. The pairs are chosen when it is first measured. */
struct control {
    struct problem
        problem; /* with no grid turned, once it is open: the loop knows rows and columns along x and r only */
    struct turned_problem turned;
    const struct echoes *echoes;
    struct scalar_loop loop;
    bool open;
    double seconds[CONTROL_RUNS]; /* of a pair, when it was last measured */
    double measured;              /* seconds_now() then */
    double spent_s;               /* on all of it so far */
};

/* `echoes`: in float, whatever the problem's precision; borrowed, as what the problem points to is. */
struct control control_begin(const struct problem *problem, const struct echoes *echoes);
void control_end(struct control *control);
/* Time it into control->seconds; with `recent`, what was measured within the last second is taken again. *least is the
   faster one. Errors: as problem_turn_back. */
enum status control_measure(struct control *control, bool recent, double *least);

#endif
