/* What can be said of a scene before any work: the conditions of each algorithm, and how sensitive the image is to what
   is known of sound speed, carrier, range, speed and positions. */
#ifndef SASBENCH_ADVISE_CHECK_H
#define SASBENCH_ADVISE_CHECK_H

#include <stdio.h>

#include "measure/spec.h"
#include "scene/scene.h"

/* Print what is known to be wrong with a scene, and what any image of it shows, before any work. `proposed`: its pixels
   are no one's, but follow from what the scene says. */
void check_warnings(FILE *stream, const struct scene *scene, bool proposed);
/* Conditions that were found, all zero at first. */
struct check_told {
    struct {
        struct condition condition;
        int algorithms; /* that have it, by `names`; empty for one of the scene */
        char names[300];
    } list[100];
    int count;
    char unplanned[2000]; /* lines: why plans are refused whose conditions hold */
};

/* Print the conditions of the scene by itself; NULL: only find them. */
void check_scene(FILE *stream, const struct scene *scene, struct check_told *told);

/* Print (NULL: only find) the conditions of one SPEC on a scene, those that hold too, and whether its plan can be made. Those that `told`
   has with the same figures are only named; it takes the rest. *refused is set where no plan can be made. Errors:
   STATUS_FAILED without memory. */
enum status check_algorithm(FILE *stream, const struct scene *scene, const struct spec *spec, struct check_told *told,
                            bool *refused);
/* How many of the SPECs take the scene, and what does not hold or is near its limit. */
void check_answer_print(FILE *stream, const struct scene *scene, const struct check_told *told, int specs, int refused);

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
