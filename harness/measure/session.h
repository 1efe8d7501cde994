/* One scene ready for imaging: its echoes and its exact image. */
#ifndef SASBENCH_MEASURE_SESSION_H
#define SASBENCH_MEASURE_SESSION_H

#include "measure/control.h"
#include "measure/darkness.h"
#include "results/measurement.h"
#include "scene/scene.h"
#include "measure/spec.h"

/* Wall time, s. */
struct spent {
    double echoes, reference, planning, imaging, control;
};

/* Made by session_open, released by session_close. */
struct session {
    const struct scene *scene; /* borrowed, outlives the session */
    struct echoes echoes[2];   /* by enum precision; extreme ones divided by one power of two, which images keep */
    struct image reference;    /* double, on the patches where images are compared; no patches without one */
    char no_reference[512];    /* why there is none: refused, or no memory; else empty */
    /* [condition_count] of the scene by itself and its exact image */
    struct condition conditions[SCENE_CONDITIONS + DARKNESS_CONDITIONS];
    int condition_count;
    struct control control; /* beside what is timed */
    struct spent spent;     /* so far, but for the control */
};

/* Make the echoes (scene_echoes) and form the exact image; where there can be none, images are measured without their
   errors. Errors: STATUS_FAILED for memory or the simulation, STATUS_INVALID as scene_simulate; *session then needs no
   close. */
enum status session_open(const struct scene *scene, struct session *session);
void session_close(struct session *session);
/* Add what was spent on it. */
void session_spent(const struct session *session, struct spent *sum);

/* What an algorithm images: the scene's patches, or, when it is exact and so too slow for a whole swath, only what is
   compared. Points into the scene. */
struct problem session_problem(const struct scene *scene, const struct algorithm *algorithm, enum precision precision);

/* The finished image of a SPEC, formed once and freed with image_free. Errors: as imaging_form. */
enum status session_image(const struct session *session, const struct spec *spec, struct image *image);

#endif
