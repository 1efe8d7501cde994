/* Conditions on a scene, whichever algorithm images it (scene.h). */
#include <math.h>

#include "contract/delay.h"
#include "scene/conjugated.h"

/* Recorded samples with a smaller imaginary part are a real signal that was never turned into baseband; rounding
   leaves less. */
static const double REAL_SHARE = 1e-9;

/* rad, as for the formulas of range migration; more blurs. */
static const double MOTION_MOST = 0.1;

static double imaginary_share(const struct scene *scene)
{
    const struct acquisition *a = &scene->acquisition;
    const size_t count = acquisition_samples(a);
    double largest = 0, imaginary = 0;
    for (size_t n = 0; n < count; n++) {
        imaginary = fmax(imaginary, fabs(cimag(scene->recorded[n])));
        largest = fmax(largest, fmax(fabs(creal(scene->recorded[n])), fabs(cimag(scene->recorded[n]))));
    }
    return largest > 0 ? imaginary / largest : 1;
}

enum { MOTION_PINGS = 2000, MOTION_NODES = 3 };

/* rad: two-way phase at fc. */
struct motion {
    double count, squares, most;
};

/* Phase changes of a pixel between stated and true places of the pings that see it, for the outermost receivers and
   a middle one. */
static void motion_add(const struct scene *scene, struct vector pixel, struct motion *motion)
{
    const struct acquisition *told = &scene->acquisition, *flown = scene->flown;
    const double c = told->sound_speed, sine = condition_beam_sine(told);
    const int step = 1 + told->pings / MOTION_PINGS;
    for (int p = 0; p < told->pings; p += step) {
        if (!condition_sees(told, sine, p, pixel))
            continue;
        for (int n = 0; n < 3; n++) {
            const size_t k = (size_t)p * (size_t)told->receivers + (size_t)(n * (told->receivers - 1) / 2);
            const double phase = 2 * M_PI * told->fc
                                 * (delay_exact(flown->tx[p], flown->rx[k], flown->velocity[p], pixel, c)
                                    - delay_exact(told->tx[p], told->rx[k], told->velocity[p], pixel, c));
            motion->count++;
            motion->squares += phase * phase;
            motion->most = fmax(motion->most, fabs(phase));
        }
    }
}

/* Over corners, edges and middle of every patch. */
static struct condition motion_condition(const struct scene *scene)
{
    struct motion motion = {0, 0, 0};
    for (int k = 0; k < scene->patch_count; k++)
        for (int n = 0; n < MOTION_NODES * MOTION_NODES; n++) {
            const struct grid *g = &scene->patches[k];
            const double u = n % MOTION_NODES / (MOTION_NODES - 1.0), w = n / MOTION_NODES / (MOTION_NODES - 1.0);
            motion_add(scene, grid_point(g, w * (g->r_count - 1), u * (g->x_count - 1)), &motion);
        }
    struct condition condition = {
        "motion",
        motion.count > 0 ? sqrt(motion.squares / motion.count) : 0,
        MOTION_MOST,
        false,
        SEVERITY_WARN,
        "motion errors unknown to the imager, which `error` leaves out: rms of the two-way phase (rad)",
        ""};
    condition_cure_add(&condition, "track.errors_known = true, or smaller errors; the most is %.3g rad", motion.most);
    return condition;
}

int scene_conditions(const struct scene *scene, struct condition list[SCENE_CONDITIONS])
{
    const struct problem problem = scene_problem(scene, PRECISION_DOUBLE);
    int count = conditions_scene(&problem, list);
    if (scene->recorded) {
        list[count++] = (struct condition){"imaginary",
                                           imaginary_share(scene),
                                           REAL_SHARE,
                                           true,
                                           SEVERITY_WARN,
                                           "the largest imaginary part of the echoes over the largest sample",
                                           "complex baseband, see docs/baseband.md"};
        list[count++] = conjugated_condition(scene);
    }
    if (scene->flown)
        list[count++] = motion_condition(scene);
    return count;
}
