/* The conditions of a scene and its algorithms before any work, and the image's sensitivity to errors of sound speed,
   carrier, range, speed and positions. */
#ifndef SASBENCH_ADVISE_CHECK_H
#define SASBENCH_ADVISE_CHECK_H

#include <stdio.h>

#include "imaging/spec.h"
#include "scene/scene.h"

/* Print, before any work, the conditions that a scene violates and their effects on any image of it. `proposed`: no
   user chose its pixels; they follow from the rest of the scene. */
void check_warnings(FILE *stream, const struct scene *scene, bool proposed);
/* The conditions of a scene and of algorithms on it, each once. */
struct check_found {
    struct {
        struct condition condition;
        int algorithms; /* with this condition, by `names`; empty for one of the scene by itself */
        char names[300];
    } list[100];
    int count, specs, refused; /* conditions; algorithms, those that refuse the scene */
    char unplanned[2000];      /* lines: reasons of plans that are refused although all conditions are met */
};

/* Begin with the conditions of the scene by itself. */
void check_scene(const struct scene *scene, struct check_found *found);
/* Add the conditions of one SPEC; *refused is set where no plan can be made. Errors: STATUS_FAILED without memory. */
enum status check_algorithm(const struct scene *scene, const struct spec *spec, struct check_found *found,
                            bool *refused);
/* Print how many can image the scene, then the conditions that are violated or near their limit, or `all`, with the
   cure. */
void check_print(FILE *stream, const struct scene *scene, const struct check_found *found, bool all);

/* The effect of a small error of one quantity on a pair of ping and receiver. */
struct sensitivity {
    const char *quantity; /* "sound speed" */
    const char *change;   /* "a relative error of 1e-5" */
    double kappa;         /* rad for a relative error of 1, for positions rad/m: the amplification factor */
    double phase;         /* rad: of the strongest pair, by the change */
    double spread;        /* rad: from one end of the aperture to the other; it blurs */
    double shift_m;       /* m in range: the shift by the phase that all pairs share */
};
enum { SENSITIVITIES = 5 };
/* For the point halfway between the scene's outermost pixels. */
void check_sensitivities(const struct scene *scene, struct sensitivity list[SENSITIVITIES]);
void check_sensitivities_print(FILE *stream, const struct scene *scene);

#endif
