/* The scenes that conformance images. */
#ifndef SASBENCH_CONFORMANCE_CONFORMANCE_SCENES_H
#define SASBENCH_CONFORMANCE_CONFORMANCE_SCENES_H

#include "contract/algorithm.h"
#include "scene/scene.h"

struct setting {
    const char *name;
    int pings, receivers;
    double first_offset, speed, fs, r, r_first; /* target and first image row, m */
    bool raw, empty;
    double bound; /* of the relative error: nearest neighbour's; at fs = B every short kernel loses much of the band */
    enum trait promise; /* which makes the scene: an algorithm with this trait may not refuse it */
    double angle;       /* rad: of the image's axes */
    enum {
        PLACE_USUAL,
        PLACE_BACKWARD, /* the track runs towards -x */
        PLACE_ENDS,     /* pixels at and beyond both ends of the record */
        PLACE_PATCHES   /* a second patch, of other steps */
    } place;
};

enum { SETTINGS = 21, RAW = 1, MONOSTATIC = 12 };
extern const struct setting settings[SETTINGS];

/* A scene of one or two patches. Errors: STATUS_FAILED without memory. */
enum status make_scene(const struct setting *setting, struct scene *scene, struct grid grids[2]);

#endif
