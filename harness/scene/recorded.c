/* Scenes of recorded echoes: a scene file that names an echo file, or an echo file alone. */
#define _GNU_SOURCE /* asprintf */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "common/memory.h"
#include "echoes/echo_data.h"
#include "echoes/noise.h"
#include "scene/contents.h"
#include "echoes/matfile.h"
#include "scene/names.h"
#include "scene/simulate.h"

/* Hash everything in the echo file: the same content gives the same hash. */
static void recording_hash(const struct scene *scene, uint64_t *hash)
{
    const struct acquisition *a = &scene->acquisition;
    const size_t pings = (size_t)a->pings, records = pings * (size_t)a->receivers;
    const struct {
        const void *bytes;
        size_t count;
    } parts[] = {
        {&a->sound_speed, sizeof a->sound_speed},
        {&a->fc, sizeof a->fc},
        {&a->fs, sizeof a->fs},
        {&a->bandwidth, sizeof a->bandwidth},
        {&a->samples, sizeof a->samples},
        {&a->receivers, sizeof a->receivers},
        {&a->pings, sizeof a->pings},
        {a->t0, pings * sizeof *a->t0},
        {a->tx, pings * sizeof *a->tx},
        {a->rx, records * sizeof *a->rx},
        {a->velocity, pings * sizeof *a->velocity},
        {&a->pri, a->pri > 0 ? sizeof a->pri : 0}, /* a file without it keeps the hash of earlier versions */
        {&a->tx_length, sizeof a->tx_length},
        {&a->rx_length, sizeof a->rx_length},
        {&a->echo_sine, sizeof a->echo_sine},
        {&a->echo_squint, sizeof a->echo_squint},
        {&a->echo_tapers, sizeof a->echo_tapers},
        {&a->aperture_limit, sizeof a->aperture_limit},
        {&a->area, sizeof a->area},
        {&a->compressed, sizeof a->compressed},
        {a->pulse, (size_t)a->pulse_length * sizeof *a->pulse},
        {scene->recorded, scene->recorded ? records * (size_t)a->samples * sizeof *scene->recorded : 0},
    };
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
        hash_add(hash, parts[k].bytes, parts[k].count);
    }
}

static enum status recording_read(const char *path, struct scene *scene)
{
    struct echoes echoes;
    enum status status = echo_file_read(path, &scene->acquisition, &echoes);
    if (status == STATUS_OK) {
        scene->recorded = (double complex *)echoes.samples;
    }
    return status;
}

char *path_beside(const struct reading *reading, const config_setting_t *setting, const char *name)
{
    const char *from = line_path(reading, config_setting_source_line(setting));
    const char *slash = *name == '/' ? NULL : strrchr(from, '/');
    char *path;
    return asprintf(&path, "%.*s%s", slash ? (int)(slash - from) + 1 : 0, from, name) < 0 ? NULL : path;
}

enum status recorded_fill(struct reading *reading)
{
    struct scene *scene = &reading->scene;
    const config_setting_t *setting = key_member(reading->root, "echoes");
    const double aperture_limit = scene->acquisition.aperture_limit;
    const struct target_area area = scene->acquisition.area;
    char *path = path_beside(reading, setting, reading->echoes);
    if (!path) {
        return scene_out_of_memory(reading);
    }
    enum status status = recording_read(path, scene);
    free(path);
    if (status != STATUS_OK) {
        char place[320];
        place_format(reading, config_setting_source_line(setting), place, sizeof place);
        return status_set(status, "%s: key 'echoes': %s", place, status_message());
    }
    if (isfinite(aperture_limit)) {
        scene->acquisition.aperture_limit = aperture_limit;
    }
    if (reading->area) {
        scene->acquisition.area = area;
    }
    recording_hash(scene, &scene->hash);
    return STATUS_OK;
}

/* Read all but the samples. Measurements on samples use some pings only. */
static enum status recording_open(const char *path, struct scene *scene)
{
    struct acquisition *a = &scene->acquisition;
    struct recording_file *recording = &scene->recording;
    struct stat file;
    enum status status = echo_file_open(path, a, &recording->exponent);
    if (status != STATUS_OK)
        return status;
    recording->pings = a->pings;
    const size_t each = (size_t)a->receivers * (size_t)a->samples,
                 size = size_product((size_t)a->pings, each, sizeof(double complex), 1);
    bool *read = calloc((size_t)a->pings, sizeof *read);
    void *samples = size > 0 ? memory_sparse(size, false) : NULL;
    recording->path = strdup(path);
    if (!read || !samples || !recording->path || stat(path, &file) != 0)
        status = status_set(STATUS_FAILED, "%s: out of memory for the scene", path);
    if (status == STATUS_OK) {
        noise_pings(a, read);
        status = echo_file_read_pings(
            path, a,
            &(struct pings){a->pings, read, PRECISION_DOUBLE, recording->exponent, each, samples, &recording->largest});
    }
    if (status == STATUS_OK)
        status = noise_measure(&(struct echoes){a, PRECISION_DOUBLE, samples, 0}, &a->noise);
    memory_sparse_free(samples);
    free(read);
    if (status != STATUS_OK)
        return status;
    recording->bytes = (double)file.st_size;
    const long long told[] = {file.st_size, file.st_mtim.tv_sec, file.st_mtim.tv_nsec};
    hash_add(&scene->hash, told, sizeof told);
    return status;
}

/* The file's own image, unless `grid` is given, and its targets. */
static enum status notes_take(const char *path, const struct grid *grid, struct scene *scene)
{
    struct echo_notes notes;
    enum status status = echo_notes_read(path, &notes);
    if (status != STATUS_OK)
        return status;
    scene->patches = notes.patches;
    scene->patch_count = notes.patch_count;
    scene->targets = notes.targets;
    scene->target_count = scene->point_count = notes.target_count;
    if (grid) {
        scene->patch_count = 1;
        scene->patches[0] = *grid;
    }
    if (scene->patch_count == 0)
        return status_set(STATUS_INVALID,
                          "%s: variable `image_grid` is missing; --grid xmin:xstep:xcount,rmin:rstep:rcount is needed; "
                          "`info` prints one to begin with",
                          path);
    for (int k = 0; k < scene->patch_count; k++)
        if (grid_check(&scene->patches[k], path) != STATUS_OK)
            return STATUS_INVALID;
    return STATUS_OK;
}

static enum status from_echoes(const char *path, const struct grid *grid, const char *place, bool whole,
                               struct scene *scene)
{
    enum status status = scene_names_fill(scene, path, "");
    if (status == STATUS_OK) {
        status = (whole ? recording_read : recording_open)(path, scene);
    }
    if (status != STATUS_OK) {
        return status;
    }
    status = notes_take(path, grid, scene);
    if (status != STATUS_OK) {
        return status;
    }
    recording_hash(scene, &scene->hash);
    for (int k = 0; k < scene->patch_count; k++) {
        const struct grid *g = &scene->patches[k];
        const double lengths[] = {g->x_first, g->x_step, g->r_first, g->r_step, g->angle_rad};
        const int counts[] = {g->x_count, g->r_count};
        hash_add(&scene->hash, lengths, sizeof lengths);
        hash_add(&scene->hash, counts, sizeof counts);
    }
    for (int k = 0; k < scene->target_count; k++) {
        const struct target *t = &scene->targets[k];
        const double numbers[] = {t->x, t->r, creal(t->amplitude), cimag(t->amplitude)};
        hash_add(&scene->hash, numbers, sizeof numbers);
    }
    scene->description = strdup("recorded echoes");
    if (!scene->description) {
        return status_set(STATUS_FAILED, "%s: out of memory for the scene", path);
    }
    return grid_meets_records(&scene->acquisition, scene->patch_count, scene->patches, place);
}

enum status scene_from_echoes(const char *path, const struct grid *grid, const char *place, bool whole,
                              struct scene *out)
{
    *out = (struct scene){.hash = HASH_BEGIN};
    enum status status = from_echoes(path, grid, place, whole, out);
    if (status != STATUS_OK) {
        scene_free(out);
    }
    return status;
}

/* The scene's pings of a file. */
static enum status file_echoes(const struct scene *scene, struct echoes *echoes)
{
    const struct acquisition *a = &scene->acquisition;
    const struct recording_file *file = &scene->recording;
    const size_t each = (size_t)a->receivers * (size_t)a->samples, pings = (size_t)file->pings;
    const size_t size = size_product(pings, each, sizeof(double complex), 1);
    double complex *samples = size > 0 ? memory_sparse(size, false) : NULL;
    bool *read = calloc(pings, sizeof *read);
    double largest = 0;
    enum status status = STATUS_OK;
    if (!samples || !read)
        status = status_set(STATUS_FAILED, "%s: out of memory for its echoes", file->path);
    for (int p = 0; p < a->pings && status == STATUS_OK; p++)
        read[file->first + p] = true;
    if (status == STATUS_OK)
        status = echo_file_read_pings(
            file->path, a,
            &(struct pings){file->pings, read, PRECISION_DOUBLE, file->exponent, each, samples, &largest});
    if (status == STATUS_OK) {
        const struct echoes part = {a, PRECISION_DOUBLE, samples + (size_t)file->first * each, 0};
        status = echoes_convert(&part, PRECISION_DOUBLE, echoes);
    }
    memory_sparse_free(samples);
    free(read);
    return status;
}

enum status scene_echoes(const struct scene *scene, struct echoes *echoes)
{
    if (scene->recording.path)
        return file_echoes(scene, echoes);
    if (!scene->recorded) {
        return scene_simulate(scene, echoes);
    }
    const struct echoes recorded = {&scene->acquisition, PRECISION_DOUBLE, scene->recorded, 0};
    return echoes_convert(&recorded, PRECISION_DOUBLE, echoes);
}

enum status scene_echoes_both(const struct scene *scene, struct echoes echoes[2])
{
    enum status status = scene_echoes(scene, &echoes[PRECISION_DOUBLE]);
    if (status != STATUS_OK)
        return status;
    echoes[PRECISION_DOUBLE].exponent = 0;
    status = echoes_convert(&echoes[PRECISION_DOUBLE], PRECISION_FLOAT, &echoes[PRECISION_FLOAT]);
    if (status != STATUS_OK)
        echoes_free(&echoes[PRECISION_DOUBLE]);
    return status;
}
