#include "backprojection/pairs/echo_pairs.h"

#include <math.h>

#include "contract/delay.h"
#include "contract/condition.h"

bool echoes_known(const struct problem *problem)
{
    const struct acquisition *a = problem->acquisition;
    return condition_beam_known(a) || (problem->target_count > 0 && !a->noisy && a->echo_sine > 0);
}

void echo_pairs_fill(const struct acquisition *a, struct vector target, struct echo_pair *pairs)
{
    for (int p = 0; p < a->pings; p++) {
        const double u = a->tx[p].x - target.x, r = hypot(target.y - a->tx[p].y, a->tx[p].z);
        for (int m = 0; m < a->receivers; m++) {
            const struct vector rx = a->rx[(size_t)p * (size_t)a->receivers + (size_t)m];
            *pairs++ = (struct echo_pair){delay_exact(a->tx[p], rx, a->velocity[p], target, a->sound_speed),
                                          condition_pair_amplitude(a, r, u, rx.x - a->tx[p].x)};
        }
    }
}

void echo_pairs_visit(const struct acquisition *a, const struct echo_pair *pairs, struct vector pixel,
                      echo_pair_visit *visit, void *context)
{
    for (int p = 0; p < a->pings; p++, pairs += a->receivers) {
        const double u = a->tx[p].x - pixel.x, r = hypot(pixel.y - a->tx[p].y, a->tx[p].z);
        if (!(fabs(u * cos(a->echo_squint) + r * sin(a->echo_squint)) <= a->aperture_limit * hypot(u, r)))
            continue;
        for (int m = 0; m < a->receivers; m++) {
            if (pairs[m].amplitude == 0)
                continue;
            const struct vector rx = a->rx[(size_t)p * (size_t)a->receivers + (size_t)m];
            const double delay = delay_exact(a->tx[p], rx, a->velocity[p], pixel, a->sound_speed);
            const double q = (delay - a->t0[p]) * a->fs;
            if (q >= 0 && q <= a->samples - 1)
                visit(context, &pairs[m], delay, q);
        }
    }
}
