/* Exact images of one target (exact_image.h). */
#include "tests/metrics/exact_image.h"

#include <math.h>
#include <stdlib.h>

#include "contract/delay.h"

const struct exact_scene scene_a = {15e3,
                                    2.5,
                                    0.32,
                                    40,
                                    0.04,
                                    0.04,
                                    0.08,
                                    25,
                                    -9.5863,
                                    90,
                                    0,
                                    false,
                                    false,
                                    0.443,
                                    0.02,
                                    -13.306375854280315,
                                    -10.41435956461415,
                                    -4.355839965091554,
                                    0.0383694168274542,
                                    520};
const struct exact_scene scene_b = {20e3,
                                    2.5,
                                    0.2,
                                    25,
                                    0.04,
                                    0.04,
                                    0.08,
                                    29,
                                    -0.9863,
                                    74,
                                    6,
                                    true,
                                    false,
                                    0.443,
                                    0.02,
                                    -16.263073439530086,
                                    -13.989989549264855,
                                    -5.105523566410879,
                                    0.04118278745544757,
                                    368.064119483484};
const struct exact_scene scene_c = {20e3,
                                    3,
                                    0.44,
                                    66,
                                    0.04,
                                    0.04,
                                    0.08,
                                    31,
                                    -3.7863,
                                    260,
                                    16,
                                    false,
                                    true,
                                    0.443,
                                    0.02,
                                    -13.371362664810466,
                                    -10.68692946729094,
                                    -4.454299346451544,
                                    0.039951849404120665,
                                    1442};
const struct exact_scene scene_d = {20e3,
                                    3,
                                    0.44,
                                    132,
                                    0.02,
                                    0.02,
                                    0.04,
                                    15,
                                    -6.7263,
                                    50,
                                    2.5,
                                    false,
                                    false,
                                    0.443,
                                    0.01,
                                    -13.2787200518272,
                                    -10.571800017815299,
                                    -4.40437231411396,
                                    0.01872631694402438,
                                    1188};

double sinc(double z)
{
    return z == 0 ? 1 : sin(M_PI * z) / (M_PI * z);
}

struct exact_pair *exact_pairs(const struct exact_scene *s, int *count)
{
    struct exact_pair *pairs = malloc(sizeof *pairs * (size_t)s->pings * (size_t)s->receivers);
    assert_non_null(pairs);
    struct vector p = {s->target_x, s->target_r, 0};
    double lambda = sound_m_s / carrier_hz;
    *count = 0;
    for (int ping = 0; ping < s->pings; ping++) {
        for (int m = 0; m < s->receivers; m++) {
            double x_t = s->x_first + ping * s->speed * s->pri;
            struct exact_pair pair = {{x_t, 0, 0}, {x_t + (m + 1) * s->pitch, 0, 0}, {s->speed, 0, 0}, 0, 1};
            pair.tau = delay_exact(pair.tx, pair.rx, pair.velocity, p, sound_m_s);
            double u = x_t - p.x, u_rx = pair.rx.x + s->speed * pair.tau - p.x, mid = 0.5 * (u + u_rx);
            double sin_t = u / hypot(u, p.y), sin_r = u_rx / hypot(u_rx, p.y);
            double sin_cut = s->cut_at_midpoint ? mid / hypot(mid, p.y) : sin_t;
            if (fabs(sin_cut) > s->cut * lambda / s->tx_length)
                continue;
            if (s->element_beams)
                pair.weight = sinc(s->tx_length * sin_t / lambda) * sinc(s->rx_length * sin_r / lambda);
            pairs[(*count)++] = pair;
        }
    }
    return pairs;
}

double complex exact_value(const struct exact_scene *s, const struct exact_pair *pairs, int count, double x, double r)
{
    struct vector p = {x, r, 0};
    double complex sum = 0;
    for (int k = 0; k < count; k++) {
        double tau = delay_exact(pairs[k].tx, pairs[k].rx, pairs[k].velocity, p, sound_m_s), lag = tau - pairs[k].tau;
        double phase = 2 * M_PI * carrier_hz * lag, value = pairs[k].weight * sinc(s->bandwidth * lag);
        sum += value * (cos(phase) + I * sin(phase));
    }
    return sum;
}

void exact_image(const struct exact_scene *s, const struct grid *grid, enum precision precision, struct image *image)
{
    int count;
    struct exact_pair *pairs = exact_pairs(s, &count);
    support_image_make(grid, 1, precision, image);
    for (int i = 0; i < grid->r_count; i++)
        for (int j = 0; j < grid->x_count; j++)
            support_pixel_set(
                image, 0, i, j,
                exact_value(s, pairs, count, grid->x_first + j * grid->x_step, grid->r_first + i * grid->r_step));
    free(pairs);
}

struct acquisition acquisition_of(const struct exact_scene *s)
{
    return (struct acquisition){
        .sound_speed = sound_m_s, .fc = carrier_hz, .bandwidth = s->bandwidth, .tx_length = s->tx_length};
}
