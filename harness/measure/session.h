/* One scene ready for imaging: its echoes, its exact image, and what another image of it is worth beside that. */
#ifndef SASBENCH_MEASURE_SESSION_H
#define SASBENCH_MEASURE_SESSION_H

#include "measure/results.h"
#include "scene/scene.h"
#include "measure/spec.h"

/* Made by session_open, released by session_close. */
struct session {
    const struct scene *scene; /* borrowed, outlives the session */
    struct echoes echoes[2];   /* by enum precision */
    struct image reference;    /* double, on the patches where images are compared; no patches without one */
    char no_reference[512];    /* why there is none: refused, or no memory; else empty */
};

/* Simulate the echoes and form the exact image; where there can be none, images are measured without their errors. Errors:
   STATUS_FAILED for memory or the simulation, STATUS_INVALID as scene_simulate; *session then needs no close. */
enum status session_open(const struct scene *scene, struct session *session);
void session_close(struct session *session);

/* What an algorithm images: the scene's patches, or, when it is exact and so too slow for a whole swath, only what is
   compared. Points into the scene. */
struct problem session_problem(const struct scene *scene, const struct algorithm *algorithm, enum precision precision);

/* Plan and execute once, into *image, allocated here and freed with image_free; *work (may be NULL) is the plan's.
   Errors: what plan or execute return, and STATUS_FAILED without memory; *image is then empty. */
enum status session_image(const struct session *session, const struct spec *spec, struct image *image,
                          struct work *work);

/* A row before anything is measured: numbers undefined, status ok. Texts are borrowed. */
struct measurement measurement_empty(const char *scene, const char *algorithm, const char *options,
                                     enum precision precision);

/* Errors of a finite image and the medians over the targets into *row, its targets' rows into *targets, malloc'ed
   [*count], which the caller frees. `reason` receives why something is undefined, for each field that is; else it is left
   alone. Errors: STATUS_FAILED without memory. */
enum status session_quality(const struct session *session, const struct image *image, struct measurement *row,
                            char *reason, size_t reason_size, struct target_row **targets, int *count);

#endif
