/* Exact images of one target, straight from the formulas. */
#ifndef SASBENCH_TEST_EXACT_IMAGE_H
#define SASBENCH_TEST_EXACT_IMAGE_H

#include "tests/support.h"

/* A straight scene with a flat spectrum: the echo of a pair is w exp(-j 2 pi carrier_hz tau) sinc(B (t - tau)). */
struct exact_scene {
    double bandwidth, speed, pri;
    int receivers;
    double rx_length, pitch; /* the first receiver lies one pitch ahead of the transmitter */
    double tx_length;
    int pings;
    double x_first, target_r, target_x;
    bool element_beams, cut_at_midpoint;
    double cut; /* of |sin theta| lambda/D_tx */
    /* The numbers to be met, computed by an independent program: azimuth slice +-3 m. */
    double x_step, pslr_db, islr_null_db, islr_3db_db, width_m, peak;
};

static const double carrier_hz = 150e3, sound_m_s = 1500; /* Hz, m/s */

/* The pairs that see the target, with their delay and weight. */
struct exact_pair {
    struct vector tx, rx, velocity;
    double tau, weight;
};

/* malloc'ed. */
struct exact_pair *exact_pairs(const struct exact_scene *s, int *count);
double complex exact_value(const struct exact_scene *s, const struct exact_pair *pairs, int count, double x, double r);

extern const struct exact_scene scene_a, scene_b, scene_c, scene_d;

double sinc(double z);
/* Image a target; *image is allocated. */
void exact_image(const struct exact_scene *s, const struct grid *grid, enum precision precision, struct image *image);
struct acquisition acquisition_of(const struct exact_scene *s);

#endif
