/* The scenes of the conformance test. */
#ifndef SASBENCH_TEST_CONFORMANCE_SCENES_H
#define SASBENCH_TEST_CONFORMANCE_SCENES_H

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
};

enum { SETTINGS = 15, RAW = 1, MONOSTATIC = 12 };
extern const struct setting settings[SETTINGS];

/* A scene whose only patch is *grid. */
void make_scene(const struct setting *setting, struct scene *scene, struct grid *grid);
void free_scene(struct scene *scene);

#endif
