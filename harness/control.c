/* The control loop (control.h). It must stay as it is: every speed-up that was ever quoted is relative to it. */
#include "control.h"

#include <complex.h>
#include <math.h>

enum { PAIRS = 1 << 20 };

double control_seconds_per_pair(const struct problem *problem, const struct echoes *echoes)
{
    const struct acquisition *a = problem->acquisition;
    const struct grid *grid = &problem->patches[problem->patch_count / 2];
    const float *samples = echoes->samples;
    const double pi = 3.14159265358979323846, c = a->sound_speed;
    long long pairs = (long long)a->pings * a->receivers, pixels = (long long)grid->x_count * grid->r_count;
    volatile float sink;
    float re = 0, im = 0;
    double start = seconds_now();
    for (long long n = 0; n < PAIRS; n++) {
        /* One pixel after another for each of 1024 evenly spaced pairs, as an image is formed. */
        long long pair = (n >> 10) * pairs / (PAIRS >> 10), pixel = (n & 1023) * pixels / 1024;
        int ping = (int)(pair / a->receivers);
        struct vector tx = a->tx[ping], rx = a->rx[pair], v = a->velocity[ping];
        double x = grid->x_first + (double)(pixel % grid->x_count) * grid->x_step;
        double r = grid->r_first + (double)(pixel / grid->x_count) * grid->r_step;
        double t = sqrt((tx.x - x) * (tx.x - x) + (tx.y - r) * (tx.y - r) + tx.z * tx.z) / c;
        double bx = rx.x - x + v.x * t, by = rx.y - r + v.y * t, bz = rx.z + v.z * t;
        double e = c * c - (v.x * v.x + v.y * v.y + v.z * v.z), q = bx * v.x + by * v.y + bz * v.z;
        double tau = t + (q + sqrt(q * q + e * (bx * bx + by * by + bz * bz))) / e;
        double position = (tau - a->t0[ping]) * a->fs + 0.5;
        if (!(position >= 0 && position < a->samples))
            continue;
        const float *s = samples + 2 * (pair * a->samples + (long long)position);
        double cycles = a->fc * tau, phase = 2 * pi * (cycles - floor(cycles));
        float wr = (float)cos(phase), wi = (float)sin(phase);
        re += s[0] * wr - s[1] * wi;
        im += s[0] * wi + s[1] * wr;
    }
    double seconds = seconds_now() - start;
    sink = re + im;
    (void)sink;
    return seconds / PAIRS;
}
