/* The scalar reference loop (scalar_loop.h). It must stay as it is: every speed-up that was ever quoted is relative to
   it. */
#include "measure/scalar_loop.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>

enum { PAIRS = 1 << 20, RUN = 1024 };

/* A pixel and a record, by their numbers. */
struct choice {
    long long pair, pixel;
};

static double sample_position(const struct acquisition *a, const struct grid *grid, struct choice at, double *tau)
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

/* One pixel after another for each of 1024 evenly spaced pairs, as an image is formed; only those whose delay lies in
   the record, which are what an image sums. Returns how many were found. */
static int choose(const struct acquisition *a, const struct grid *grid, struct choice *chosen)
{
    long long pairs = (long long)a->pings * a->receivers, pixels = (long long)grid->x_count * grid->r_count;
    int count = 0;
    for (long long n = 0; n < PAIRS; n++) {
        struct choice at = {n / RUN * pairs / (PAIRS / RUN), n % RUN * pixels / RUN};
        double tau, position = sample_position(a, grid, at, &tau);
        if (position >= 0 && position < a->samples)
            chosen[count++] = at;
    }
    return count;
}

double control_seconds_per_pair(const struct problem *problem, const struct echoes *echoes)
{
    const struct acquisition *a = problem->acquisition;
    const struct grid *grid = &problem->patches[problem->patch_count / 2];
    const float *samples = echoes->samples;
    struct choice *chosen = malloc(PAIRS * sizeof *chosen);
    int count = chosen ? choose(a, grid, chosen) : 0;
    volatile float sink;
    float re = 0, im = 0;
    double start = seconds_now();
    for (int n = 0, k = 0; count > 0 && n < PAIRS; n++, k = k + 1 < count ? k + 1 : 0) {
        double tau, position = sample_position(a, grid, chosen[k], &tau);
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
    free(chosen);
    return count > 0 ? seconds / PAIRS : NAN;
}
