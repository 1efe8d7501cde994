/* At a single frequency, as in tone.h. Some columns and targets stand for all. By Parseval's theorem the image of a
   target, seen from pings with the amplitudes a, has the energy  sum of a^2 lambda r/(2 spacing cos^3 theta)  over all
   columns. */
#include "range_migration/aliases.h"

#include <math.h>

#include "range_migration/tone.h"

enum {
    COLUMNS = 48,
    KNOWN = 16, /* targets, at most */
    ROWS = 4,   /* of targets that stand for all, and as many columns of them */
    PARTS = 8   /* of the image, at most */
};

struct energies {
    double image, lost;
};

/* Is what a ping `at` ahead of a pixel sees kept by omega-k or summed by back projection, and not both? */
static bool differs(const struct rma_view *view, double at, double row, double frequency)
{
    const struct acquisition *a = view->problem->acquisition;
    const double way = hypot(at, row), sampled = a->sound_speed / frequency / (4 * view->spacing);
    const bool summed = fabs(at * cos(a->echo_squint) + row * sin(a->echo_squint)) <= a->aperture_limit * way;
    return summed != (fabs(at / way + view->slope) <= sampled);
}

/* The energy of echoes of a target at the pixels of `part` on one of the track's columns: the share of it that its
   pings have there. */
static double column_lost(const struct rma_view *view, const struct target *target, const struct grid *part, double x,
                          double frequency)
{
    const struct acquisition *a = view->problem->acquisition;
    double complex sum = 0;
    double all = 0, inside = 0;
    for (int p = 0; p < a->pings; p++) {
        const double u = view->x_low + p * view->spacing - target->x, at = u + target->x - x;
        const double row = tone_row(target->r, u, at), beyond = hypot(at, target->r) - hypot(u, target->r);
        if (!differs(view, at, row, frequency))
            continue;
        const double seen = condition_amplitude(a, target->r, u);
        sum += seen * turns(2 * frequency / a->sound_speed * beyond);
        all += seen * seen;
        inside += grid_holds(part, x, row) ? seen * seen : 0;
    }
    return all > 0 ? creal(sum * conj(sum)) * inside / all : 0;
}

static double image_energy(const struct rma_view *view, const struct target *target)
{
    const struct acquisition *a = view->problem->acquisition;
    double sum = 0;
    for (int p = 0; p < a->pings; p++) {
        const double u = view->x_low + p * view->spacing - target->x, way = hypot(u, target->r);
        sum += pow(condition_amplitude(a, target->r, u), 2) * pow(way / target->r, 3);
    }
    return sum * a->sound_speed / a->fc * target->r / (2 * view->spacing);
}

static void target_add(const struct rma_view *view, const struct target *target, const struct grid *part,
                       struct energies *energies)
{
    const struct acquisition *a = view->problem->acquisition;
    const double weight = pow(cabs(target->amplitude), 2);
    double first, last;
    grid_columns(part, &first, &last);
    const double step = (last - first) / COLUMNS;
    for (int k = 0; k < COLUMNS && step > 0; k++) {
        const double frequency = a->fc + (fmod(0.5 + k * 0.618, 1) - 0.5) * a->bandwidth;
        energies->lost += weight * step * column_lost(view, target, part, first + (k + 0.5) * step, frequency);
    }
    if (grid_holds(part, target->x, target->r))
        energies->image += weight * image_energy(view, target);
}

/* Those that stand for all, evenly over the part and half of it more to each side. */
static void even_add(const struct rma_view *view, const struct grid *part, struct energies *energies)
{
    for (int k = 0; k < ROWS * ROWS; k++) {
        const double row = 2 * (k / ROWS + 0.5) / ROWS - 0.5, column = 2 * (k % ROWS + 0.5) / ROWS - 0.5;
        const struct vector at = grid_point(part, row * part->r_count - 0.5, column * part->x_count - 0.5);
        const struct target target = {at.x, at.y, 1};
        if (target.r > 0)
            target_add(view, &target, part, energies);
    }
}

double aliases_error(const struct rma_view *view)
{
    const struct problem *problem = view->problem;
    const bool judges = problem->target_count > 0 && problem->judged_count > 0;
    const struct grid *list = judges ? problem->judged : problem->patches;
    const int all = judges ? problem->judged_count : problem->patch_count, parts = all < PARTS ? all : PARTS;
    const int targets = problem->target_count < KNOWN ? problem->target_count : KNOWN;
    struct energies energies = {0, 0};
    for (int k = 0; k < parts; k++) {
        const struct grid *part = &list[(long long)k * all / parts];
        for (int n = 0; n < targets; n++)
            target_add(view, &problem->targets[(long long)n * problem->target_count / targets], part, &energies);
        if (targets == 0)
            even_add(view, part, &energies);
    }
    return energies.image > 0 ? sqrt(energies.lost / energies.image) : 0;
}
