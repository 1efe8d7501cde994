/* One scene ready for imaging: its echoes and its exact image. */
#ifndef SASBENCH_MEASURE_SESSION_H
#define SASBENCH_MEASURE_SESSION_H

#include "choice/choice.h"
#include "measure/darkness.h"
#include "results/measurement.h"
#include "scene/scene.h"
#include "imaging/spec.h"
#include "measure/timing.h"

/* Wall time, s. */
struct spent {
    double planning, imaging;
};

/* What session_chosen made of a SPEC that leaves the choice to the harness. */
struct chosen {
    struct spec asked;
    struct choice choice; /* without the image */
    enum status status;   /* STATUS_UNSUPPORTED where no setting meets the budget; do not use the rest then */
    char message[600];    /* why */
    struct spec spec;
};

/* Made by session_open, released by session_close. */
struct session {
    const struct scene *scene; /* borrowed, outlives the session */
    double memory; /* bytes; above 0: images are formed tile by tile, and there are no echoes and no `reference` */
    struct echoes echoes[2]; /* by enum precision; extreme echoes are divided by one power of two, and images keep it */
    struct image reference;  /* double, on the patches where images are compared; without patches where there is none */
    struct image flown;      /* the same by the true track; without patches where the stated track is the true one */
    char no_reference[512];  /* why there is no exact image: refused, or no memory; else empty */
    /* [condition_count] of the scene by itself and its exact image */
    struct condition conditions[SCENE_CONDITIONS + DARKNESS_CONDITIONS];
    int condition_count;
    struct control control; /* its times beside those of the algorithms */
    struct spent spent;     /* so far */
    struct chosen *chosen;  /* [chosen_count] made so far by session_chosen */
    int chosen_count;
};

/* Make the echoes (scene_echoes) and form the exact image; without an exact image, images are measured without their
   errors. Errors: STATUS_FAILED for memory or the simulation, STATUS_INVALID as scene_simulate; *session then needs
   no close. */
enum status session_open(const struct scene *scene, struct session *session);
/* Of a recording whose echoes stay in their file. Errors are then measured on some pixels of each tile. */
void session_open_tiled(const struct scene *scene, double memory, struct session *session);
void session_close(struct session *session);

/* What an algorithm images: the scene's patches. An exact algorithm, too slow for a whole swath, images only the
   pixels that are compared. Points into the scene. */
struct problem session_problem(const struct scene *scene, const struct algorithm *algorithm, enum precision precision);

/* The choice for a SPEC, made once. NULL where the SPEC names its algorithm, in tiles, or, with a message, without
   memory. The next choice moves it. */
const struct chosen *session_chosen(struct session *session, const struct spec *spec);
/* The SPEC itself, or the one chosen for it. Errors: STATUS_UNSUPPORTED where no setting meets the budget, as
   choice_make. */
enum status session_resolve(struct session *session, const struct spec *spec, const struct spec **resolved);

/* The finished image of a SPEC, formed once and freed with image_free. Errors: as imaging_form, session_resolve. */
enum status session_image(struct session *session, const struct spec *spec, struct image *image);

#endif
