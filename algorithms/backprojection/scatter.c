#include "backprojection/scatter.h"

#include <math.h>
#include <stdlib.h>

#include "backprojection/pairs/echo_pairs.h"
#include "common/turns.h"

enum {
    TONES = 4,     /* targets, each at one frequency */
    MOST = 600000, /* pairs of a pixel and a record, of all of them */
    POWERS = 8     /* of two, up to the last order */
};
/* Those of whole samples, of finer grids, and of steps between samples (beta + 1). */
static const int orders[SCATTER_ORDERS] = {1,  2,  3,  4,  5,  6,  7,  8,  9,  12, 16,
                                           17, 18, 24, 32, 33, 34, 48, 64, 66, 96, 128};
/* Other targets may have more than those that stand for them, and side lobes reach everywhere: measured. */
static const double SHARE = 1.5, FLOOR = 2e-4;

struct tone {
    double x, r;      /* m */
    double frequency; /* Hz */
    double weight;
};

struct energies {
    double image, scattered[SCATTER_ORDERS];
};

static void tones_fill(const struct problem *problem, int count, struct tone tones[TONES])
{
    const struct acquisition *a = problem->acquisition;
    const double most = problem_amplitude_most(problem);
    for (int n = 0; n < count; n++) {
        const double even = fmod(0.3 + n * 0.618, 1), other = fmod(0.5 + n * 0.755, 1);
        tones[n] = (struct tone){.frequency = a->fc + (fmod(0.2 + n * 0.57, 1) - 0.5) * a->bandwidth, .weight = 1};
        if (problem->target_count > 0) {
            const struct target *target = &problem->targets[(long long)n * problem->target_count / count];
            tones[n].x = target->x;
            tones[n].r = target->r;
            tones[n].weight = most > 0 ? square(target->amplitude / most) : 0;
        } else {
            const struct grid *g = &problem->patches[n % problem->patch_count];
            const struct vector at = grid_point(g, even * g->r_count - 0.5, other * g->x_count - 0.5);
            tones[n].x = at.x;
            tones[n].r = at.y;
        }
    }
}

/* Of a pixel, the sums over its pairs: of order 0, and of the others, of either sign. */
struct sums {
    double frequency; /* Hz */
    double complex image, scattered[SCATTER_ORDERS][2];
};

static void pair_add(void *context, const struct echo_pair *pair, double delay, double q)
{
    struct sums *sums = context;
    const double complex main = pair->amplitude * turns(sums->frequency * (delay - pair->delay));
    double complex powers[POWERS];
    powers[0] = turns(q);
    for (int k = 1; k < POWERS; k++)
        powers[k] = product(powers[k - 1], powers[k - 1]);
    sums->image += main;
    for (int k = 0; k < SCATTER_ORDERS; k++) {
        double complex turn = 1;
        for (int bit = 0; bit < POWERS; bit++)
            if (orders[k] >> bit & 1)
                turn = product(turn, powers[bit]);
        sums->scattered[k][0] += product(main, turn);
        sums->scattered[k][1] += product(main, conj(turn));
    }
}

static void pixel_add(const struct acquisition *a, const struct tone *tone, const struct echo_pair *echoes,
                      struct vector place, struct energies *energies)
{
    struct sums sums = {.frequency = tone->frequency};
    echo_pairs_visit(a, echoes, place, pair_add, &sums);
    energies->image += tone->weight * square(sums.image);
    for (int k = 0; k < SCATTER_ORDERS; k++)
        energies->scattered[k] += tone->weight * (square(sums.scattered[k][0]) + square(sums.scattered[k][1])) / 2;
}

/* The pixels of a tone's row, to which other rows are other delays: by Parseval's theorem the energies of all rows are
   those of all frequencies. */
static void tone_add(const struct problem *problem, const struct tone *tone, const struct echo_pair *echoes,
                     struct energies *energies)
{
    const struct grid *grids;
    const int count = problem_judged(problem, &grids);
    for (int k = 0; k < count; k++) {
        const struct grid *g = &grids[k];
        const double row = (grid_coordinates(g, tone->x, tone->r).y - g->r_first) / g->r_step;
        if (fabs(row - (g->r_count - 1) / 2.0) <= g->r_count / 2.0)
            for (int j = 0; j < g->x_count; j++)
                pixel_add(problem->acquisition, tone, echoes, grid_point(g, row, j), energies);
    }
}

/* How many tones the time allows. */
static int tones_count(const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    const struct grid *grids;
    const int count = problem_judged(problem, &grids);
    double columns = 0;
    for (int k = 0; k < count; k++)
        columns += grids[k].x_count;
    return (int)fmin(MOST / (columns * a->pings * a->receivers), TONES);
}

bool scatter_find(const struct problem *problem, struct scatter *scatter)
{
    const struct acquisition *a = problem->acquisition;
    struct energies sum = {.image = 0};
    struct tone tones[TONES];
    const int count = echoes_known(problem) ? tones_count(problem) : 0;
    struct echo_pair *echoes = count > 0 ? malloc((size_t)a->pings * (size_t)a->receivers * sizeof *echoes) : NULL;
    if (!echoes)
        return false;
    tones_fill(problem, count, tones);
    for (int n = 0; n < count; n++) {
        echo_pairs_fill(a, (struct vector){tones[n].x, tones[n].r, 0}, echoes);
        tone_add(problem, &tones[n], echoes, &sum);
    }
    free(echoes);
    scatter->most = 0;
    for (int k = 0; k < SCATTER_ORDERS && sum.image > 0; k++) {
        scatter->share[k] = fmin(SHARE * sum.scattered[k] / sum.image + FLOOR, 1);
        scatter->most = fmax(scatter->most, scatter->share[k]);
    }
    return sum.image > 0;
}

double scatter_share(const struct scatter *scatter, int order)
{
    for (int k = 0; k < SCATTER_ORDERS; k++)
        if (orders[k] == order)
            return scatter->share[k];
    return scatter->most;
}
