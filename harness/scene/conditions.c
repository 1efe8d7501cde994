/* What a scene must fulfil whichever algorithm images it (scene.h). */
#include <math.h>

#include "scene/conjugated.h"

/* Recorded samples of a real signal were never turned into baseband; rounding leaves less of an imaginary part. */
static const double REAL_SHARE = 1e-9;

static double imaginary_share(const struct scene *scene)
{
    const struct acquisition *a = &scene->acquisition;
    const size_t count = (size_t)a->pings * (size_t)a->receivers * (size_t)a->samples;
    double largest = 0, imaginary = 0;
    for (size_t n = 0; n < count; n++) {
        imaginary = fmax(imaginary, fabs(cimag(scene->recorded[n])));
        largest = fmax(largest, fmax(fabs(creal(scene->recorded[n])), fabs(cimag(scene->recorded[n]))));
    }
    return largest > 0 ? imaginary / largest : 1;
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
    return count;
}
