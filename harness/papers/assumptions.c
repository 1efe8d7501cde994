/* Scenes under other assumptions (assumptions.h). */
#include "papers/assumptions.h"

#include <math.h>

#include "data/paths.h"
#include "scene/simulate.h"

const struct assumptions assumption_sets[] = {
    {"nominal", "as the scenes say: 1500 m/s, .405 lambda/D", 0, 0, TRUNCATION_NONE, false},
    {"c_1450", "sound speed 1450 m/s", 1450, 0, TRUNCATION_NONE, false},
    {"c_1550", "sound speed 1550 m/s", 1550, 0, TRUNCATION_NONE, false},
    {"cut_443", "beam cut at .443 lambda/D", 0, 0.443, TRUNCATION_MID, false},
    {"cut_500", "beam cut at .5 lambda/D", 0, 0.5, TRUNCATION_MID, false},
    {"cut_doppler", "beam cut by Doppler at .5", 0, 0.5, TRUNCATION_DOPPLER, false},
    {"off_bins", "targets half a range bin farther", 0, 0, TRUNCATION_NONE, true},
    {.name = NULL},
};
static const struct assumptions *chosen = assumption_sets;

void assumptions_choose(const struct assumptions *assumptions)
{
    chosen = assumptions;
}

/* A target moves with the patch around it; those of one patch for many, and scatterers, stay. */
static void target_move(struct scene *scene, int k, double r)
{
    if (scene->patch_count != scene->point_count)
        return;
    scene->patches[k].r_first += r - scene->targets[k].r;
    scene->targets[k].r = r;
}

enum status assumed_scene_load(const char *name, struct scene *scene)
{
    enum status status = scene_load(name, SCENE_DIRECTORY, scene);
    if (status != STATUS_OK || chosen == assumption_sets)
        return status;
    struct acquisition *a = &scene->acquisition;
    const double old_bin = a->sound_speed / (2 * a->fs);
    if (chosen->sound_speed > 0)
        a->sound_speed = chosen->sound_speed;
    if (chosen->limit > 0 && scene->beam.kind == BEAM_RECT) {
        scene->beam.limit = chosen->limit;
        scene->beam.truncation = chosen->truncation;
    }
    a->echo_sine = beam_sine(scene);
    const double bin = a->sound_speed / (2 * a->fs);
    for (int k = 0; k < scene->point_count; k++) {
        double r = scene->targets[k].r, bins = r / old_bin;
        bool on_bin = fabs(bins - floor(bins + 0.5)) < 1e-6;
        if (on_bin && bin != old_bin)
            r = floor(r / bin + 0.5) * bin;
        target_move(scene, k, chosen->off_bins ? r + bin / 2 : r);
    }
    scene->hash ^= (uint64_t)(chosen - assumption_sets) * 0x9e3779b97f4a7c15u;
    return STATUS_OK;
}
