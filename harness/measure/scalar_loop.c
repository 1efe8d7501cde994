/* The scalar reference loop (scalar_loop.h). Do not change it: every speed-up ever quoted is relative to it. */
#include "measure/scalar_loop.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>

enum { PAIRS = 1 << 18, RUN = 1024 };

/* Indices of a pixel and a record. */
struct scalar_pair {
    long long pair, pixel;
};

static double sample_position(const struct acquisition *a, const struct grid *grid, struct scalar_pair at, double *tau)
{
    const double c = a->sound_speed;
    int ping = (int)(at.pair / a->receivers);
    struct vector tx = a->tx[ping], rx = a->rx[at.pair], v = a->velocity[ping];
    double x = grid->x_first + (double)(at.pixel % grid->x_count) * grid->x_step;
    double r = grid->r_first + (double)(at.pixel / grid->x_count) * grid->r_step;
    double t = sqrt((tx.x - x) * (tx.x - x) + (tx.y - r) * (tx.y - r) + tx.z * tx.z) / c;
    double bx = rx.x - x + v.x * t, by = rx.y - r + v.y * t, bz = rx.z + v.z * t;
    double e = c * c - (v.x * v.x + v.y * v.y + v.z * v.z), q = bx * v.x + by * v.y + bz * v.z;
    double square = bx * bx + by * by + bz * bz, root = sqrt(q * q + e * square);
    *tau = t + (q >= 0 ? (q + root) / e : square / (root - q));
    return (*tau - a->t0[ping]) * a->fs + 0.5;
}

/* One pixel after another for each of 256 evenly spaced pairs, as an image is formed; only pairs whose delay lies in
   the record, as an image sums them. Returns their number. */
static int choose(const struct acquisition *a, const struct grid *grid, struct scalar_pair *chosen)
{
    long long pairs = (long long)a->pings * a->receivers, pixels = (long long)grid->x_count * grid->r_count;
    int count = 0;
    for (long long n = 0; n < PAIRS; n++) {
        struct scalar_pair at = {n / RUN * pairs / (PAIRS / RUN), n % RUN * pixels / RUN};
        double tau, position = sample_position(a, grid, at, &tau);
        if (position >= 0 && position < a->samples)
            chosen[count++] = at;
    }
    return count;
}

struct scalar_loop scalar_loop_choose(const struct problem *problem, const struct echoes *echoes)
{
    struct scalar_loop loop = {.acquisition = problem->acquisition,
                               .grid = &problem->patches[problem->patch_count / 2],
                               .samples = echoes->samples,
                               .pairs = malloc(PAIRS * sizeof *loop.pairs)};
    loop.count = loop.pairs ? choose(loop.acquisition, loop.grid, loop.pairs) : 0;
    return loop;
}

void scalar_loop_free(struct scalar_loop *loop)
{
    free(loop->pairs);
    *loop = (struct scalar_loop){.count = 0};
}

double scalar_loop_seconds(const struct scalar_loop *loop)
{
    const struct acquisition *a = loop->acquisition;
    const struct scalar_pair *chosen = loop->pairs;
    const float *samples = loop->samples;
    const int count = loop->count;
    volatile float sink;
    float re = 0, im = 0;
    double start = seconds_now();
    for (int n = 0, k = 0; count > 0 && n < PAIRS; n++, k = k + 1 < count ? k + 1 : 0) {
        double tau, position = sample_position(a, loop->grid, chosen[k], &tau);
        if (!(position >= 0 && position < a->samples))
            continue;
        const float *s = samples + 2 * (chosen[k].pair * a->samples + (long long)position);
        double cycles = a->fc * tau, phase = 2 * M_PI * (cycles - floor(cycles));
        float wr = (float)cos(phase), wi = (float)sin(phase);
        re += s[0] * wr - s[1] * wi;
        im += s[0] * wi + s[1] * wr;
    }
    double seconds = seconds_now() - start;
    sink = re + im;
    (void)sink;
    return count > 0 ? seconds / PAIRS : NAN;
}
