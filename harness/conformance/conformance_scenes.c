#include "conformance/conformance_scenes.h"

#include <math.h>
#include <stdlib.h>

#include "scene/simulate.h"

const struct setting settings[SETTINGS] = {
    {"ordinary", 8, 6, 0.04, 2.5, 30e3, 30, 29.75, false, false, 0.15, 0},
    {"raw", 8, 6, 0.04, 2.5, 30e3, 30, 29.75, true, false, 0.15, 0},
    {"empty", 8, 6, 0.04, 2.5, 30e3, 30, 29.75, true, true, 0, 0},
    {"one ping", 1, 6, 0.04, 2.5, 30e3, 30, 29.75, true, false, 0.15, 0},
    {"one receiver", 24, 1, 0.04, 2.5, 30e3, 30, 29.75, true, false, 0.15, 0},
    {"one pair", 1, 1, 0, 2.5, 30e3, 30, 29.75, false, false, 0.15, 0},
    {"negative offsets", 8, 6, -0.24, 2.5, 30e3, 30, 29.75, true, false, 0.15, 0},
    {"v/c = 0.05", 8, 6, 0.04, 75, 30e3, 30, 29.75, true, false, 0.15, 0},
    {"stop and hop", 8, 6, 0.04, 0, 30e3, 30, 29.75, true, false, 0.15, 0},
    {"pixels on the track", 8, 6, 0.04, 2.5, 30e3, 0.5, 0, false, false, 0.3, 0},
    {"fs = B", 8, 6, 0.04, 2.5, 15e3, 30, 29.75, false, false, 0.7, 0},
    {"curved track in space", 8, 6, 0.04, 2.5, 30e3, 30, 29.75, false, false, 0.15, TRAIT_ANY_TRACK},
    {"monostatic", 48, 1, 0, 2.5, 30e3, 30, 29.75, true, false, 0.18, 0},
    {"aperture limit", 8, 6, 0.04, 2.5, 30e3, 30, 29.75, false, false, 0.15, TRAIT_APERTURE_LIMIT},
    {"turned image", 8, 6, 0.04, 2.5, 30e3, 30, 29.75, true, false, 0.15, 0, 0.02},
    {"turned grid", 8, 6, 0.04, 2.5, 30e3, 30, 29.75, false, false, 0.15, 0, -0.4},
    {"towards -x", 8, 6, -0.04, -2.5, 30e3, 30, 29.75, true, false, 0.15, 0, 0, PLACE_BACKWARD},
    {"towards -x, one receiver", 48, 1, 0, -2.5, 30e3, 30, 29.75, true, false, 0.18, 0, 0, PLACE_BACKWARD},
    {"ends of the record", 8, 6, 0.04, 2.5, 30e3, 30, 29.5, false, false, 0.15, 0, 0, PLACE_ENDS},
    {"both sides of r = 0", 8, 6, 0.04, 2.5, 30e3, 0.4, -0.2, false, false, 0.3, 0},
    {"two patches", 8, 6, 0.04, 2.5, 30e3, 30, 29.75, true, false, 0.19, 0, 0, PLACE_PATCHES},
};

/* A track that bends across and in depth by many wavelengths, on which the array turns as well; velocity and time of
   the first sample change from ping to ping. */
static void bend(struct acquisition *a)
{
    for (int p = 0; p < a->pings; p++) {
        const double y = 0.3 * sin(0.9 * p), z = 2 + 0.4 * cos(1.1 * p);
        a->t0[p] += p % 3 / a->fs;
        a->tx[p] = (struct vector){a->tx[p].x, y, z};
        a->velocity[p] = (struct vector){2.5, 1.5 + 0.1 * p, 6 - 0.2 * p};
        for (int m = 0; m < a->receivers; m++) {
            struct vector *rx = &a->rx[p * a->receivers + m];
            rx->y = y + 0.03 * m;
            rx->z = z - 0.1 * m;
        }
    }
}

enum status make_scene(const struct setting *setting, struct scene *scene, struct grid grids[2])
{
    double spacing = 0.02 * (setting->receivers > 1 ? setting->receivers : 2), duration = 2e-3;
    const bool ends = setting->place == PLACE_ENDS, backward = setting->place == PLACE_BACKWARD;
    int samples = ends ? 40 : setting->fs > 20e3 ? 1024 : 512;
    double first = floor(fmax(0, 2 * setting->r / 1500 * setting->fs - samples / 4));
    /* Where element beams would see nothing. */
    bool straight_down = setting->r < 1 || setting->promise == TRAIT_ANY_TRACK || fabs(setting->angle) > 0.1;
    *scene = (struct scene){.pulse_kind = setting->raw ? PULSE_LFM : PULSE_FLAT,
                            .pulse_duration = duration,
                            .beam = {straight_down ? BEAM_RECT : BEAM_TXRX, TRUNCATION_NONE, 0, false},
                            .patch_count = setting->place == PLACE_PATCHES ? 2 : 1,
                            .patches = grids};
    struct acquisition *a = &scene->acquisition;
    *a = (struct acquisition){.sound_speed = 1500,
                              .fc = 150e3,
                              .fs = setting->fs,
                              .bandwidth = 15e3,
                              .samples = samples,
                              .receivers = setting->receivers,
                              .pings = setting->pings,
                              .tx_length = 0.08,
                              .rx_length = 0.04,
                              .aperture_limit = INFINITY,
                              .compressed = !setting->raw,
                              .pulse_length = setting->raw ? pulse_length_lfm(duration, setting->fs) : 0};
    scene->targets = calloc(1, sizeof *scene->targets);
    if (!scene->targets || acquisition_allocate(a) != STATUS_OK)
        return status_set(STATUS_FAILED, "no memory for the scene");
    for (int p = 0; p < a->pings; p++) {
        a->t0[p] = first / a->fs;
        a->tx[p].x = (p - (a->pings - 1) / 2.0) * (backward ? -spacing : spacing);
        a->velocity[p].x = setting->speed;
        for (int m = 0; m < a->receivers; m++)
            a->rx[p * a->receivers + m].x = a->tx[p].x + setting->first_offset + (backward ? -0.04 : 0.04) * m;
    }
    if (setting->promise == TRAIT_ANY_TRACK)
        bend(a);
    if (setting->promise == TRAIT_APERTURE_LIMIT)
        a->aperture_limit = 0.008; /* 0.24 m of an aperture of 0.84 m to either side */
    if (setting->raw)
        pulse_lfm(a->bandwidth, duration, a->fs, a->pulse_length, a->pulse);
    grids[0] = (struct grid){-0.24, 0.02, 25, setting->r_first, 0.025, 21, setting->angle};
    grids[1] = (struct grid){-0.1, 0.03, 14, setting->r_first + 0.1, 0.015, 17, setting->angle};
    if (ends)
        grids[0].r_step = 0.075;
    scene->target_count = scene->point_count = !setting->empty;
    const struct vector place = grid_point(grids, (setting->r - grids->r_first) / grids->r_step, 0.251 / grids->x_step);
    if (setting->receivers == 1 && backward)
        a->area = (struct target_area){place.x, place.y, 0.5, 0.5};
    scene->targets[0] = (struct target){place.x, place.y, 1};
    return acquisition_check(a, setting->name);
}
