/* The acquisition and the targets of a scene, from its keys; patches.c makes the image. */
#include "scene/contents.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/random.h"
#include "echoes/noise.h"
#include "scene/simulate.h"

enum status scene_out_of_memory(const struct reading *reading)
{
    return status_set(STATUS_FAILED, "%s: out of memory for the scene", reading->path);
}

static enum status acquisition_fill(struct reading *reading)
{
    struct scene *scene = &reading->scene;
    struct acquisition *a = &scene->acquisition;
    a->compressed = scene->pulse_kind == PULSE_FLAT;
    a->pulse_length = a->compressed ? 0 : pulse_length_lfm(scene->pulse_duration, a->fs);
    enum status status = acquisition_allocate(a);
    if (status != STATUS_OK) {
        return status;
    }
    if (!a->compressed) {
        pulse_lfm(a->bandwidth, scene->pulse_duration, a->fs, a->pulse_length, a->pulse);
    }
    for (int p = 0; p < a->pings; p++) {
        a->t0[p] = reading->first_sample / a->fs + reading->time_offset_s;
    }
    a->echo_squint = reading->squint_deg * M_PI / 180;
    a->area.x += a->area.half_x > 0 ? reading->x_offset_m : 0;
    a->echo_sine = beam_sine(scene);
    a->echo_tapers = scene->beam.kind == BEAM_TXRX;
    a->noisy = scene->noise_std > 0;
    status = track_fill(reading);
    return status == STATUS_OK ? acquisition_check(a, reading->path) : status;
}

/* Uniform positions and complex normal amplitudes with E|a|^2 = 1. The order of the draws (x, r, amplitude) is part
   of the scene format (scenes/README.md). */
static void field_draw(const struct scatter_field *field, struct target *targets)
{
    struct random random = random_seed(field->seed, 0);
    for (int i = 0; i < field->count; i++) {
        targets[i].x = field->x_m[0] + (field->x_m[1] - field->x_m[0]) * random_uniform(&random);
        targets[i].r = field->r_m[0] + (field->r_m[1] - field->r_m[0]) * random_uniform(&random);
        targets[i].amplitude = random_normal(&random);
    }
}

static enum status targets_fill(struct reading *reading)
{
    struct scene *scene = &reading->scene;
    int points = reading->points ? config_setting_length(reading->points) : 0;
    int field_count = reading->fields ? config_setting_length(reading->fields) : 0;
    struct scatter_field *fields = calloc((size_t)field_count + 1, sizeof *fields);
    if (!fields) {
        return scene_out_of_memory(reading);
    }
    enum status status = STATUS_OK;
    long long total = points;
    for (int f = 0; f < field_count && status == STATUS_OK; f++) {
        config_setting_t *setting = config_setting_get_elem(reading->fields, (unsigned)f);
        status = group_read(reading, setting, "targets.fields", &fields[f]);
        total += fields[f].count;
        if (status == STATUS_OK && total > SCATTERERS_MAX) {
            status = refuse(reading, setting, "targets.fields", "count", "such that all targets are at most %d",
                            SCATTERERS_MAX);
        }
    }
    if (status == STATUS_OK) {
        scene->targets = calloc((size_t)total + 1, sizeof *scene->targets);
        status = scene->targets ? STATUS_OK : scene_out_of_memory(reading);
    }
    for (; scene->point_count < points && status == STATUS_OK; scene->point_count++) {
        status = group_read(reading, config_setting_get_elem(reading->points, (unsigned)scene->point_count),
                            "targets.points", &scene->targets[scene->point_count]);
        scene->targets[scene->point_count].x += reading->x_offset_m;
    }
    scene->target_count = scene->point_count;
    for (int f = 0; f < field_count && status == STATUS_OK; f++) {
        fields[f].x_m[0] += reading->x_offset_m;
        fields[f].x_m[1] += reading->x_offset_m;
        field_draw(&fields[f], scene->targets + scene->target_count);
        scene->target_count += fields[f].count;
    }
    free(fields);
    return status;
}

enum status scene_fill(struct reading *reading, config_setting_t *root)
{
    enum status status = groups_read(reading, root);
    if (status == STATUS_OK && !*reading->echoes) {
        status = track_read(reading);
    }
    if (status == STATUS_OK) {
        status = keys_check(reading);
    }
    if (status == STATUS_OK) {
        status = *reading->echoes ? recorded_fill(reading) : acquisition_fill(reading);
    }
    if (status == STATUS_OK) {
        status = targets_fill(reading);
    }
    if (status == STATUS_OK && !*reading->echoes) { /* with recorded echoes it is measured */
        struct scene *scene = &reading->scene;
        scene->acquisition.noise =
            noise_of_targets(&scene->acquisition, scene->target_count, scene->targets, scene->noise_std);
    }
    if (status == STATUS_OK) {
        status = image_fill(reading);
    }
    if (status == STATUS_OK) {
        reading->scene.description = strdup(reading->description);
        status = reading->scene.description ? STATUS_OK : scene_out_of_memory(reading);
    }
    return status;
}
