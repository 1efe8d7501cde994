/* Nearest-neighbour back projection with one fault at a time: its callbacks. */
#ifndef SASBENCH_TEST_CONFORMANCE_PLANTED_H
#define SASBENCH_TEST_CONFORMANCE_PLANTED_H

#include "backprojection/bp.h"

struct options {
    struct bp_options bp;
    double scale;
};
extern const struct param by_hand[], unread[];

#define PLAN(name) enum status name(const struct problem *problem, const void *method, const void *options, void **plan)
PLAN(plan_good);
PLAN(plan_leaks);
PLAN(plan_unlimited);
PLAN(plan_without_y);
PLAN(plan_without_z);
PLAN(plan_along_x);
PLAN(plan_one_t0);
PLAN(plan_straight_only);
PLAN(plan_without_reason);
PLAN(plan_half_made);
PLAN(plan_static);
PLAN(plan_maps);
PLAN(plan_unturned);
PLAN(plan_forward);

#define EXECUTE(name)                                                                                                  \
    enum status name(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
EXECUTE(execute_allocates);
EXECUTE(execute_plans);
EXECUTE(execute_races);
EXECUTE(execute_last_pixel);
EXECUTE(execute_nan);
EXECUTE(execute_exits);
EXECUTE(execute_adds);
EXECUTE(execute_gain);
EXECUTE(execute_first_patch);
EXECUTE(execute_threads);
EXECUTE(execute_past_end);
EXECUTE(execute_ahead);
EXECUTE(execute_maps);
EXECUTE(execute_memoised);
EXECUTE(execute_known);
EXECUTE(execute_static);
EXECUTE(execute_shared);

enum status forecast_perfect(const struct problem *problem, const void *method, const void *options,
                             struct forecast *forecast);
int conditions_false(const struct problem *problem, const void *method, const void *options, struct condition *list,
                     int room);

#endif
