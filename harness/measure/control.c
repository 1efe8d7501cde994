/* The scalar reference loop's time (control.h). */
#include "measure/control.h"

#include <math.h>

static const double recent_s = 1;

struct control control_begin(const struct problem *problem, const struct echoes *echoes)
{
    return (struct control){.problem = *problem, .echoes = echoes, .measured = -INFINITY};
}

void control_end(struct control *control)
{
    scalar_loop_free(&control->loop);
    turned_free(&control->turned);
    *control = (struct control){.open = false};
}

static enum status control_open(struct control *control)
{
    enum status status = problem_turn_back(&control->problem, &control->turned, NULL);
    if (status == STATUS_OK)
        control->loop = scalar_loop_choose(&control->problem, control->echoes);
    control->open = status == STATUS_OK;
    return status;
}

enum status control_measure(struct control *control, bool recent, double *least)
{
    const double begin = seconds_now();
    enum status status = control->open ? STATUS_OK : control_open(control);
    if (status != STATUS_OK)
        return status;
    if (!recent || seconds_now() - control->measured > recent_s) {
        for (int k = 0; k < CONTROL_RUNS; k++)
            control->seconds[k] = scalar_loop_seconds(&control->loop);
        control->measured = seconds_now();
    }
    *least = fmin(control->seconds[0], control->seconds[1]);
    control->spent_s += seconds_now() - begin;
    return STATUS_OK;
}
