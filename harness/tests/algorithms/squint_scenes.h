/* The scenes of SQ18 and PF05 as the tests of omega-k use them: monostatic, stop and hop, hard-edged beam, flat
   spectrum. */
#ifndef SASBENCH_TEST_SQUINT_SCENES_H
#define SASBENCH_TEST_SQUINT_SCENES_H

#include "tests/support.h"

/* What the two papers' sonars differ in. */
struct squint_sonar {
    double fc, fs, bandwidth, length, x_first; /* Hz, Hz, Hz, m, m */
    int samples, first_sample, pings;
    double speed; /* m/s while the pulse travels: 0 for stop and hop */
};
extern const struct squint_sonar sonar_sq18, sonar_pf05;

/* Freed with squint_scene_free. SQ18's five targets about the beam's axis, or PF05's nine with the target area. */
void scene_sq18(const struct squint_sonar *sonar, double squint_rad, struct scene *scene);
void scene_pf05(struct scene *scene);
void squint_scene_free(struct scene *scene);

/* Square patches of `half` pixels to either side of each target, in axes turned by angle_rad. */
void patches_around(const struct scene *scene, double angle_rad, double step_m, int half, struct grid *patches);

/* What the simulator divides a flat spectrum by: bins of a record in the band, those at +-B/2 for one half. */
double spectrum_sum(const struct acquisition *acquisition);

/* S(X of the ping, f) = sum of a exp(-j K_R R) over the targets in the beam, from the simulated echoes. */
double complex echo_spectrum(const struct scene *scene, const struct echoes *echoes, int ping, double f_hz);

/* The exact image, compressed echoes at exact delays and bins at +-B/2 for a whole one: pings with |sin phi - sin
   squint| <= gate only. */
void exact_image(const struct scene *scene, const struct echoes *echoes, double gate, struct image *image);

/* A scene with its echoes, and the exact image of patches of 0.56 m about the targets in axes turned by angle_rad.
   Freed with free_imaged. */
struct imaged {
    struct scene scene;
    struct echoes echoes;
    struct grid patches[9];
    struct problem problem;
    struct image exact;
};
void make_imaged(const struct squint_sonar *sonar, double squint_rad, double angle_rad, struct imaged *out);
void free_imaged(struct imaged *imaged);

#endif
