/* Scenes that the tests of range migration vary. */
#ifndef SASBENCH_TEST_RMA_SCENES_H
#define SASBENCH_TEST_RMA_SCENES_H

#include "tests/support.h"

#define RMA_SPEED 3.0 /* m/s */

struct rma_track {
    int pings, receivers, samples;
    double fs, t0;                  /* Hz, s */
    double x_first, spacing, pitch; /* m */
};

/* A straight track at 3 m/s with 150 kHz and 20 kHz bandwidth, compressed records, receivers from the transmitter
   on. */
void make_scene(const struct rma_track *track, struct scene *scene);
void free_scene(struct scene *scene);
/* Targets at about x = 0 and the ranges given. */
void add_targets(struct scene *scene, int count, const double *r);
/* One SPEC's image of a problem; the test fails where that fails. */
void form(const char *spec, struct problem problem, const struct echoes *echoes, struct image *image);
/* Its error against an exact image, printed. */
double swath_error(const char *spec, struct problem problem, const struct echoes *echoes, const struct image *exact);
/* Complex relative L2 of one patch. */
double patch_error(const struct image *image, const struct image *exact, int patch);

#endif
