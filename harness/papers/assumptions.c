/* Scenes under other assumptions (assumptions.h). */
#include "papers/assumptions.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/paths.h"
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

/* A target moves with its patch and the compared pixels; scatterers, and a patch shared by many targets, stay. */
static bool target_move(struct scene *scene, int k, double way)
{
    if (scene->patch_count != scene->point_count || way == 0)
        return false;
    scene->patches[k].r_first += way;
    if (scene->reference_count == scene->point_count)
        scene->reference_patches[k].r_first += way;
    scene->targets[k].r += way;
    return true;
}

/* Does it change anything? */
static bool assume(struct scene *scene)
{
    struct acquisition *a = &scene->acquisition;
    const double old_bin = a->sound_speed / (2 * a->fs);
    bool changed = false;
    if (chosen->sound_speed > 0) {
        changed |= a->sound_speed != chosen->sound_speed;
        a->sound_speed = chosen->sound_speed;
    }
    if (chosen->limit > 0 && scene->beam.kind == BEAM_RECT) {
        changed |= scene->beam.limit != chosen->limit || scene->beam.truncation != chosen->truncation;
        scene->beam.limit = chosen->limit;
        scene->beam.truncation = chosen->truncation;
    }
    a->echo_sine = beam_sine(scene);
    const double bin = a->sound_speed / (2 * a->fs);
    for (int k = 0; k < scene->point_count; k++) {
        double r = scene->targets[k].r, bins = r / old_bin;
        bool on_bin = fabs(bins - floor(bins + 0.5)) < 1e-6;
        double place = on_bin && bin != old_bin ? floor(r / bin + 0.5) * bin : r;
        changed |= target_move(scene, k, place - r + (chosen->off_bins ? bin / 2 : 0));
    }
    return changed;
}

/* SQ18 and PF05 print the values that the sets change. */
static bool is_printed(const char *name)
{
    return strncmp(name, "sq18/", 5) == 0 || strncmp(name, "pf05/", 5) == 0;
}

enum status assumed_scene_load(const char *name, struct scene *scene)
{
    enum status status = scene_load(name, SCENE_DIRECTORY, scene);
    if (status != STATUS_OK || chosen == assumption_sets || is_printed(name) || !assume(scene))
        return status;
    const size_t size = strlen(scene->name) + strlen(chosen->name) + 2;
    char *assumed = malloc(size);
    if (!assumed) {
        scene_free(scene);
        return status_set(STATUS_FAILED, "no memory for the scene %s", name);
    }
    snprintf(assumed, size, "%s@%s", scene->name, chosen->name);
    free(scene->name);
    scene->name = assumed;
    scene->hash ^= (uint64_t)(chosen - assumption_sets) * 0x9e3779b97f4a7c15u;
    return STATUS_OK;
}

const char *assumed_scene_name(const char *name)
{
    static struct kept {
        const struct assumptions *assumptions;
        char plain[80], assumed[80];
    } kept[512];
    enum { KEPT = sizeof kept / sizeof *kept };
    struct scene scene;
    int k = 0;
    if (chosen == assumption_sets)
        return name;
    while (k < KEPT - 1 && kept[k].assumptions && (kept[k].assumptions != chosen || strcmp(kept[k].plain, name) != 0))
        k++;
    if (kept[k].assumptions == chosen && strcmp(kept[k].plain, name) == 0)
        return kept[k].assumed;
    if (assumed_scene_load(name, &scene) != STATUS_OK)
        return name;
    kept[k].assumptions = chosen;
    snprintf(kept[k].plain, sizeof kept[k].plain, "%s", name);
    snprintf(kept[k].assumed, sizeof kept[k].assumed, "%s", scene.name);
    scene_free(&scene);
    return kept[k].assumed;
}
