/* What can be said of a scene before any work: the conditions of each algorithm, and how sensitive the image is to what
   is known of sound speed, carrier, range, speed and positions. */
#ifndef SASBENCH_ADVISE_CHECK_H
#define SASBENCH_ADVISE_CHECK_H

#include <stdio.h>

#include "imaging/spec.h"
#include "scene/scene.h"

/* Print what is known to be wrong with a scene, and what any image of it shows, before any work. `proposed`: its pixels
   are no one's, but follow from what the scene says. */
void check_warnings(FILE *stream, const struct scene *scene, bool proposed);
/* The conditions of a scene and of algorithms on it, each once. */
struct check_found {
    struct {
        struct condition condition;
        int algorithms; /* that have it, by `names`; empty for one of the scene by itself */
        char names[300];
    } list[100];
    int count, specs, refused; /* conditions; algorithms, those that refuse the scene */
    char unplanned[2000];      /* lines: why plans are refused whose conditions hold */
};

/* Begin with the conditions of the scene by itself. */
void check_scene(const struct scene *scene, struct check_found *found);
/* Add those of one SPEC; *refused is set where no plan can be made. Errors: STATUS_FAILED without memory. */
enum status check_algorithm(const struct scene *scene, const struct spec *spec, struct check_found *found,
                            bool *refused);
/* How many take the scene, then what does not hold or is near its limit, with the cure, or `all`. */
void check_print(FILE *stream, const struct scene *scene, const struct check_found *found, bool all);

/* What a small error of one quantity does to a pair of ping and receiver. */
struct sensitivity {
    const char *quantity; /* "sound speed" */
    const char *change;   /* "a relative error of 1e-5" */
    double kappa;         /* rad for a relative error of 1, for positions rad/m: the amplification factor */
    double phase;         /* rad: of the strongest pair, by the change */
    double spread;        /* rad: from one end of the aperture to the other: what blurs */
    double shift_m;       /* m in range: what the phase that all pairs share looks like */
};
enum { SENSITIVITIES = 5 };
/* For the point halfway between the scene's outermost pixels. */
void check_sensitivities(const struct scene *scene, struct sensitivity list[SENSITIVITIES]);
void check_sensitivities_print(FILE *stream, const struct scene *scene);

#endif
