/* One scene ready for imaging: its echoes and its exact image. */
#ifndef SASBENCH_MEASURE_SESSION_H
#define SASBENCH_MEASURE_SESSION_H

#include "choice/choice.h"
#include "measure/control.h"
#include "measure/darkness.h"
#include "results/measurement.h"
#include "scene/scene.h"
#include "imaging/spec.h"

/* Wall time, s. */
struct spent {
    double echoes, reference, planning, imaging, control;
};

/* What a SPEC that leaves the choice to the harness became on a scene. */
struct chosen {
    struct spec asked;
    struct choice choice; /* without the image */
    enum status status;   /* STATUS_UNSUPPORTED where nothing fits; the rest is then not to be used */
    char message[600];    /* why */
    struct spec spec;
    double seconds; /* that choosing took beyond forming the chosen image once */
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
    struct chosen *chosen;  /* [chosen_count] so far, by session_chosen */
    int chosen_count;
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

/* What the SPEC leaves to choose, chosen once; NULL where it names its algorithm, or where memory is missing, with a
   message. It moves when another is chosen. */
const struct chosen *session_chosen(struct session *session, const struct spec *spec);
/* The SPEC itself, or the one chosen for it. Errors: STATUS_UNSUPPORTED where nothing fits, as choice_make. */
enum status session_resolve(struct session *session, const struct spec *spec, const struct spec **resolved);

/* The finished image of a SPEC, formed once and freed with image_free. Errors: as imaging_form, session_resolve. */
enum status session_image(struct session *session, const struct spec *spec, struct image *image);

#endif
