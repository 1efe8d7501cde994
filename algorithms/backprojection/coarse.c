#include "backprojection/coarse.h"

#include <math.h>
#include <stdlib.h>

#include "backprojection/pairs/echo_pairs.h"
#include "common/turns.h"
#include "contract/condition.h"

enum {
    TARGETS = 6,
    PAIRS_MOST = 6000000, /* that are summed in all, and rows */
    FINER_MOST = 1000     /* columns or rows, for one */
};

struct column {
    double fc;
    double complex sum;
};

static void pair_add(void *context, const struct echo_pair *pair, double delay, double q)
{
    (void)q;
    struct column *column = context;
    column->sum += pair->amplitude * turns(column->fc * (delay - pair->delay));
}

/* The means of a target's energy over a grid's columns, or rows, and over as many times more that are `finer`. */
struct means {
    double shown, fine;
};

static struct means along_x(const struct acquisition *a, const struct echo_pair *pairs, const struct grid *g,
                            double row, int finer)
{
    struct means means = {0};
    const int count = (g->x_count - 1) * finer + 1;
    for (int j = 0; j < count; j++) {
        struct column column = {.fc = a->fc};
        echo_pairs_visit(a, pairs, grid_point(g, row, (double)j / finer), pair_add, &column);
        means.fine += square(column.sum) / count;
        means.shown += j % finer == 0 ? square(column.sum) / g->x_count : 0;
    }
    return means;
}

static struct means along_r(const struct acquisition *a, const struct grid *g, double row, int finer)
{
    struct means means = {0};
    const int count = (g->r_count - 1) * finer + 1;
    for (int i = 0; i < count; i++) {
        const double z = M_PI * 2 * a->bandwidth / a->sound_speed * ((double)i / finer - row) * g->r_step;
        /* Side lobes by their mean: a pulse's own have no zeros where those of a flat band are. */
        const double energy = fabs(z) < M_PI / 2 ? pow(condition_sinc(z / M_PI), 2) : 1 / (2 * z * z);
        means.fine += energy / count;
        means.shown += i % finer == 0 ? energy / g->r_count : 0;
    }
    return means;
}

static int finer_of(double step, double resolution)
{
    return (int)fmin(ceil(step / resolution), FINER_MOST);
}

/* Adds the energy of a target that a grid holds, unless that takes too long. */
static void grid_add(const struct problem *problem, const struct target *target, const struct echo_pair *pairs,
                     const struct grid *g, double cell_x, double cell_r, double *left, struct means *sum)
{
    const struct acquisition *a = problem->acquisition;
    const struct vector at = grid_coordinates(g, target->x, target->r);
    const double row = (at.y - g->r_first) / g->r_step;
    const int columns = finer_of(g->x_step, cell_x), rows = finer_of(g->r_step, cell_r);
    *left -= (double)a->pings * a->receivers * columns * g->x_count + (double)rows * g->r_count;
    if (*left < 0)
        return;
    const struct means x = along_x(a, pairs, g, row, columns);
    const struct means r = along_r(a, g, row, rows);
    const double pixels = (double)g->x_count * g->r_count * square(target->amplitude);
    sum->shown += pixels * x.shown * r.shown;
    sum->fine += pixels * x.fine * r.fine;
}

double coarse_factor(const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    const double cell_x = a->sound_speed / (4 * a->fc * fmin(condition_seen_sine(a), 1));
    const double cell_r = a->sound_speed / (2 * a->bandwidth), pairs = (double)a->pings * a->receivers;
    const struct grid *grids;
    const int count = problem_judged(problem, &grids);
    const int targets = problem->target_count < TARGETS ? problem->target_count : TARGETS;
    double left = PAIRS_MOST;
    struct means sum = {0};
    bool near = true;
    for (int k = 0; k < count; k++)
        near = near && grids[k].x_step <= cell_x && grids[k].r_step <= cell_r;
    if (near || targets == 0 || pairs > PAIRS_MOST || !echoes_known(problem))
        return 1;
    struct echo_pair *echoes = malloc((size_t)pairs * sizeof *echoes);
    for (int n = 0; n < targets && echoes; n++) {
        const struct target *target = &problem->targets[(long long)n * problem->target_count / targets];
        echo_pairs_fill(a, (struct vector){target->x, target->r, 0}, echoes);
        for (int k = 0; k < count; k++)
            if (grid_holds(&grids[k], target->x, target->r))
                grid_add(problem, target, echoes, &grids[k], cell_x, cell_r, &left, &sum);
    }
    free(echoes);
    return sum.shown > 0 && sum.fine > sum.shown ? sqrt(sum.fine / sum.shown) : 1;
}
