/* Assumptions of our scenes where the papers print nothing, changed one at a time: which verdicts depend on them? */
#ifndef SASBENCH_PAPERS_ASSUMPTIONS_H
#define SASBENCH_PAPERS_ASSUMPTIONS_H

#include "scene/scene.h"

/* One set of assumptions; the first, "nominal", changes nothing. */
struct assumptions {
    const char *name, *title;
    double sound_speed;              /* m/s; 0: the scene's. Targets on range bins move to the nearest new one */
    double limit;                    /* of the beam's truncation, in lambda/D_tx; 0: the scene's */
    enum truncation_kind truncation; /* kind of truncation that the limit belongs to */
    bool off_bins;                   /* move targets and their patches by half a range bin */
    bool off_pings;                  /* move the track by half the spacing of the phase centres */
    const char *from, *to;           /* part of a SPEC, or the definition of a slice, that another replaces; NULL */
};
extern const struct assumptions assumption_sets[]; /* name NULL ends */

/* Load a shipped scene under the current assumptions, which are nominal at first, or under those that its name ends
   in: "bp22/table3@c_1450". Where they change it, its name becomes that, and its hash another. Errors: as scene_load,
   of an unknown set, and STATUS_FAILED without memory. */
enum status assumed_scene_load(const char *name, struct scene *scene);
/* Is it a scene below scenes/, or one with a set behind it? */
bool assumed_scene_exists(const char *name);
/* The scene's name under its assumptions: its own where they change nothing, or where it cannot be loaded. It stays
   valid. */
const char *assumed_scene_name(const char *name);
/* A SPEC, or a slice's definition, under the current assumptions: the text itself where they change nothing. It stays
   valid. */
const char *assumed_text(const char *text);
void assumptions_choose(const struct assumptions *assumptions);

#endif
