/* Scenes under other assumptions (assumptions.h). */
#include "papers/assumptions.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/paths.h"
#include "scene/simulate.h"

const struct assumptions assumption_sets[] = {
    {"nominal", "as the scenes say: 1500 m/s, .405 lambda/D"},
    {"c_1450", "sound speed 1450 m/s", .sound_speed = 1450},
    {"c_1550", "sound speed 1550 m/s", .sound_speed = 1550},
    {"cut_443", "beam cut at .443 lambda/D", .limit = 0.443, .truncation = TRUNCATION_MID},
    {"cut_500", "beam cut at .5 lambda/D", .limit = 0.5, .truncation = TRUNCATION_MID},
    {"cut_doppler", "beam cut by Doppler at .5", .limit = 0.5, .truncation = TRUNCATION_DOPPLER},
    {"off_bins", "targets half a range bin farther", .off_bins = true},
    {"off_pings", "pings half an along-track sample farther", .off_pings = true},
    {"taps_4", "sinc of 4 taps", .from = "taps=8", .to = "taps=4"},
    {"taps_16", "sinc of 16 taps", .from = "taps=8", .to = "taps=16"},
    {"by_null", "main lobe up to its nulls", .from = "pixel", .to = "null"},
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

/* The track moves by half of what lies between two phase centres, were they evenly spread. */
static void track_move(struct acquisition *a)
{
    const double way = (a->tx[a->pings - 1].x - a->tx[0].x) / fmax(1, a->pings - 1) / a->receivers / 2;
    for (int p = 0; p < a->pings; p++) {
        a->tx[p].x += way;
        for (int m = 0; m < a->receivers; m++)
            a->rx[(size_t)p * a->receivers + m].x += way;
    }
}

/* Does it change anything? SQ18 and PF05 print sound speed, beam and targets. */
static bool assume(struct scene *scene, const struct assumptions *set)
{
    struct acquisition *a = &scene->acquisition;
    const double old_bin = a->sound_speed / (2 * a->fs);
    bool changed = set->off_pings;
    if (set->off_pings) {
        track_move(a);
        if (scene->flown)
            track_move(scene->flown);
    }
    if (strncmp(scene->name, "sq18/", 5) == 0 || strncmp(scene->name, "pf05/", 5) == 0)
        return changed;
    if (set->sound_speed > 0) {
        changed |= a->sound_speed != set->sound_speed;
        a->sound_speed = set->sound_speed;
    }
    if (set->limit > 0 && scene->beam.kind == BEAM_RECT) {
        changed |= scene->beam.limit != set->limit || scene->beam.truncation != set->truncation;
        scene->beam.limit = set->limit;
        scene->beam.truncation = set->truncation;
    }
    a->echo_sine = beam_sine(scene);
    const double bin = a->sound_speed / (2 * a->fs);
    for (int k = 0; k < scene->point_count; k++) {
        double r = scene->targets[k].r, bins = r / old_bin;
        bool on_bin = fabs(bins - floor(bins + 0.5)) < 1e-6;
        double place = on_bin && bin != old_bin ? floor(r / bin + 0.5) * bin : r;
        changed |= target_move(scene, k, place - r + (set->off_bins ? bin / 2 : 0));
    }
    return changed;
}

/* The set that a name ends in, "@cut_500", or the chosen one; NULL: there is no such set. */
static const struct assumptions *set_of(const char *name)
{
    const char *at = strchr(name, '@');
    const struct assumptions *set = at ? assumption_sets : chosen;
    while (at && set->name && strcmp(set->name, at + 1) != 0)
        set++;
    return set->name ? set : NULL;
}

bool assumed_scene_exists(const char *name)
{
    char path[4200];
    snprintf(path, sizeof path, "%s/%.*s.cfg", data_path(DATA_SCENES), (int)strcspn(name, "@"), name);
    return *name && access(path, R_OK) == 0 && set_of(name);
}

enum status assumed_scene_load(const char *name, struct scene *scene)
{
    char plain[200];
    const struct assumptions *set = set_of(name);
    if (!set)
        return status_set(STATUS_INVALID, "%s: no such assumptions", name);
    snprintf(plain, sizeof plain, "%.*s", (int)strcspn(name, "@"), name);
    enum status status = scene_load(plain, data_path(DATA_SCENES), scene);
    if (status != STATUS_OK || set == assumption_sets || !assume(scene, set))
        return status;
    const size_t size = strlen(scene->name) + strlen(set->name) + 2;
    char *assumed = malloc(size);
    if (!assumed) {
        scene_free(scene);
        return status_set(STATUS_FAILED, "no memory for the scene %s", name);
    }
    snprintf(assumed, size, "%s@%s", scene->name, set->name);
    free(scene->name);
    scene->name = assumed;
    scene->hash ^= (uint64_t)(set - assumption_sets) * 0x9e3779b97f4a7c15u;
    return STATUS_OK;
}

const char *assumed_text(const char *text)
{
    static char kept[64][200];
    char assumed[sizeof *kept];
    const char *at = chosen->from ? strstr(text, chosen->from) : NULL;
    int k = 0;
    if (!at)
        return text;
    snprintf(assumed, sizeof assumed, "%.*s%s%s", (int)(at - text), text, chosen->to, at + strlen(chosen->from));
    while (k < 63 && *kept[k] && strcmp(kept[k], assumed) != 0)
        k++;
    return strcpy(kept[k], assumed);
}

const char *assumed_scene_name(const char *name)
{
    static struct kept {
        const struct assumptions *assumptions;
        char plain[80], assumed[80];
    } kept[1024];
    enum { KEPT = sizeof kept / sizeof *kept };
    struct scene scene;
    int k = 0;
    if (set_of(name) == assumption_sets)
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
