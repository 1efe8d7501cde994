/* Scene files: what the keys say about each other, and the acquisition, targets and image made from them. The keys
   themselves are in keys.c and scenes/README.md. */
#include "scene/scene.h"

#include <fts.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "data/random.h"
#include "scene/keys.h"
#include "scene/simulate.h"
#include "scene/simulate.h"

#define EXTENSION   ".cfg"
#define FNV_OFFSET  14695981039346656037u
#define BYTES_MAX   0x1p40 /* of double samples */
#define RECORDS_MAX 0x1p26 /* pings times receivers */

static enum status check_beam(const struct reading *reading)
{
    const struct acquisition *a = &reading->scene.acquisition;
    const struct beam *beam = &reading->scene.beam;
    bool truncated = beam->truncation != TRUNCATION_NONE, tapered = beam->kind == BEAM_TXRX;
    if (truncated && !(beam->limit > 0)) {
        return refuse(reading, reading->beam, "beam", "limit", "a number > 0 with beam.truncation \"%s\"",
                      truncation_names[beam->truncation]);
    }
    if (!truncated && beam->limit > 0) {
        return refuse(reading, reading->beam, "beam", "limit", "left out with beam.truncation \"none\"");
    }
    if ((truncated || tapered) && !(a->tx_length > 0)) {
        return refuse(reading, reading->array, "array", "tx_length",
                      "a number > 0 m with beam.kind \"txrx\" or a beam.truncation");
    }
    if (tapered && !(a->rx_length > 0)) {
        return refuse(reading, reading->array, "array", "rx_length", "a number > 0 m with beam.kind \"txrx\"");
    }
    return STATUS_OK;
}

static enum status check_pulse(const struct reading *reading)
{
    const struct scene *scene = &reading->scene;
    const struct acquisition *a = &scene->acquisition;
    if (scene->pulse_kind == PULSE_FLAT) {
        return scene->pulse_duration > 0
                   ? refuse(reading, reading->pulse, "pulse", "duration", "left out with pulse.kind \"flat\"")
                   : STATUS_OK;
    }
    if (!(scene->pulse_duration * a->fs <= a->samples) || !(scene->pulse_duration > 0)) {
        return refuse(reading, reading->pulse, "pulse", "duration",
                      "> 0 s and no longer than the record of %.10g s (record.samples/sonar.fs)", a->samples / a->fs);
    }
    return STATUS_OK;
}

static enum status check_sizes(const struct reading *reading)
{
    const struct acquisition *a = &reading->scene.acquisition;
    double records = (double)a->pings * a->receivers, bytes = records * a->samples * sizeof(double complex);
    if (!(records <= RECORDS_MAX)) {
        return refuse(reading, reading->track, "track", "pings", "at most %.10g with %d receivers (2^26 records)",
                      floor(RECORDS_MAX / a->receivers), a->receivers);
    }
    if (!(bytes <= BYTES_MAX)) {
        return refuse(reading, reading->record, "record", "samples",
                      "at most %.10g with %.10g records (2^40 bytes of samples)",
                      floor(BYTES_MAX / sizeof(double complex) / records), records);
    }
    return STATUS_OK;
}

/* Pings and receivers must stay where coordinates may be. */
static enum status check_places(const struct reading *reading)
{
    const struct acquisition *a = &reading->scene.acquisition;
    double last_offset = reading->first_offset_m + (a->receivers - 1) * reading->pitch_m;
    double sailed = (a->pings - 1) * (reading->speed_m_s * reading->pri_s), last = reading->x_first_m + sailed;
    if (!(fabs(last) <= COORDINATE_MAX_M)) {
        return refuse(reading, reading->track, "track", "pri",
                      "such that the last of %d pings at %g m/s, at %g m, stays "
                      "within +-%g m",
                      a->pings, reading->speed_m_s, last, COORDINATE_MAX_M);
    }
    if (!(fabs(last_offset) <= COORDINATE_MAX_M)) {
        return refuse(reading, reading->array, "array", "pitch",
                      "such that the last of %d receivers, %g m ahead of the "
                      "transmitter, stays within +-%g m",
                      a->receivers, last_offset, COORDINATE_MAX_M);
    }
    return STATUS_OK;
}

static enum status check_image_kind(const struct reading *reading)
{
    const char *one = "one of `x` with `r`, `around_targets`, `patches`";
    bool whole = reading->x && reading->r;
    if ((reading->x || reading->r) + (reading->around_targets != NULL) + (reading->patches != NULL) != 1) {
        return refuse(reading, reading->image, "image", NULL, "a group with exactly %s", one);
    }
    if (!whole && (reading->x || reading->r)) {
        return refuse(reading, reading->image, "image", reading->x ? "r" : "x", "given together with `%s`",
                      reading->x ? "x" : "r");
    }
    if (!whole && reading->reference) {
        return refuse(reading, reading->image, "image", "reference", "left out without `x` and `r`");
    }
    if (reading->patches && config_setting_length(reading->patches) == 0) {
        return refuse(reading, reading->image, "image", "patches", "a list of at least one patch");
    }
    bool needs_points = reading->around_targets || reading->reference;
    if (needs_points && !(reading->points && config_setting_length(reading->points) > 0)) {
        return refuse(reading, reading->targets, "targets", "points",
                      "a list of at least one target, with image.around_targets or image.reference");
    }
    return STATUS_OK;
}

static enum status reading_check(const struct reading *reading)
{
    const struct acquisition *a = &reading->scene.acquisition;
    if (!(a->fs >= a->bandwidth)) {
        return refuse(reading, reading->sonar, "sonar", "fs", "at least sonar.bandwidth (%.10g Hz)", a->bandwidth);
    }
    if (!(fabs(reading->speed_m_s) < a->sound_speed)) {
        return refuse(reading, reading->track, "track", "speed", "below sonar.sound_speed (%.10g m/s) in magnitude",
                      a->sound_speed);
    }
    if (a->receivers > 1 && reading->pitch_m == 0) {
        return refuse(reading, reading->array, "array", "pitch", "a number other than 0 m with %d receivers",
                      a->receivers);
    }
    enum status (*const checks[])(const struct reading *) = {check_beam, check_pulse, check_sizes, check_places,
                                                             check_image_kind};
    enum status status = STATUS_OK;
    for (size_t i = 0; i < sizeof checks / sizeof *checks && status == STATUS_OK; i++) {
        status = checks[i](reading);
    }
    return status;
}

static enum status out_of_memory(const struct reading *reading)
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
        a->t0[p] = reading->first_sample / a->fs;
        a->tx[p].x = reading->x_first_m + p * reading->speed_m_s * reading->pri_s;
        a->velocity[p].x = reading->speed_m_s;
        for (int m = 0; m < a->receivers; m++) {
            a->rx[(size_t)p * (size_t)a->receivers + (size_t)m].x =
                a->tx[p].x + reading->first_offset_m + m * reading->pitch_m;
        }
    }
    a->echo_sine = beam_sine(scene);
    a->echo_tapers = scene->beam.kind == BEAM_TXRX;
    return acquisition_check(a, reading->path);
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
        return out_of_memory(reading);
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
        status = scene->targets ? STATUS_OK : out_of_memory(reading);
    }
    for (; scene->point_count < points && status == STATUS_OK; scene->point_count++) {
        status = group_read(reading, config_setting_get_elem(reading->points, (unsigned)scene->point_count),
                            "targets.points", &scene->targets[scene->point_count]);
    }
    scene->target_count = scene->point_count;
    for (int f = 0; f < field_count && status == STATUS_OK; f++) {
        field_draw(&fields[f], scene->targets + scene->target_count);
        scene->target_count += fields[f].count;
    }
    free(fields);
    return status;
}

/* One axis of a patch that has its target on the middle pixel. */
static enum status axis_around(const struct reading *reading, const char *half_key, double centre, double half,
                               double step, double *first, int *count)
{
    double reach = round(half / step);
    if (!(reach <= INT_MAX / 2)) {
        return refuse(reading, reading->around_targets, "image.around_targets", half_key, "at most %d steps of %g m",
                      INT_MAX / 2, step);
    }
    *first = centre - reach * step;
    *count = 2 * (int)reach + 1;
    return STATUS_OK;
}

static enum status patches_around_targets(struct reading *reading)
{
    struct scene *scene = &reading->scene;
    struct around_keys around;
    enum status status = group_read(reading, reading->around_targets, "image.around_targets", &around);
    for (; scene->patch_count < scene->point_count && status == STATUS_OK; scene->patch_count++) {
        const struct target *target = &scene->targets[scene->patch_count];
        struct grid *grid = &scene->patches[scene->patch_count];
        *grid = (struct grid){.x_step = around.x_step_m, .r_step = around.r_step_m};
        status =
            axis_around(reading, "half_x", target->x, around.half_x_m, grid->x_step, &grid->x_first, &grid->x_count);
        if (status == STATUS_OK) {
            status = axis_around(reading, "half_r", target->r, around.half_r_m, grid->r_step, &grid->r_first,
                                 &grid->r_count);
        }
    }
    return status;
}

/* The pixels of an axis within `half` of the pixel nearest to `centre`; false if there are none. */
static bool axis_cut(double centre, double half, double *first, double step, int *count)
{
    double middle = round((centre - *first) / step), reach = round(half / step);
    double begin = fmax(0, middle - reach), end = fmin(*count - 1, middle + reach);
    if (!(begin <= end)) {
        return false;
    }
    *first += begin * step;
    *count = (int)(end - begin) + 1;
    return true;
}

static enum status reference_fill(struct reading *reading)
{
    struct scene *scene = &reading->scene;
    struct around_keys around;
    enum status status = group_read(reading, reading->reference, "image.reference", &around);
    if (status != STATUS_OK) {
        return status;
    }
    scene->reference_patches = calloc((size_t)scene->point_count, sizeof *scene->reference_patches);
    if (!scene->reference_patches) {
        return out_of_memory(reading);
    }
    for (int i = 0; i < scene->point_count; i++) {
        struct grid cut = scene->patches[0];
        if (axis_cut(scene->targets[i].x, around.half_x_m, &cut.x_first, cut.x_step, &cut.x_count)
            && axis_cut(scene->targets[i].r, around.half_r_m, &cut.r_first, cut.r_step, &cut.r_count)) {
            scene->reference_patches[scene->reference_count++] = cut;
        }
    }
    return scene->reference_count > 0 ? STATUS_OK
                                      : refuse(reading, reading->reference, "image.reference", NULL,
                                               "such that it holds a pixel of the image");
}

static enum status grid_read(struct reading *reading, config_setting_t *x, config_setting_t *r, struct grid *grid)
{
    struct axis_keys along, across;
    enum status status = group_read(reading, x, "axis", &along);
    if (status == STATUS_OK) {
        status = group_read(reading, r, "axis", &across);
    }
    if (status == STATUS_OK) {
        *grid = (struct grid){.x_first = along.first_m,
                              .x_step = along.step_m,
                              .x_count = along.count,
                              .r_first = across.first_m,
                              .r_step = across.step_m,
                              .r_count = across.count};
    }
    return status;
}

static enum status image_fill(struct reading *reading)
{
    struct scene *scene = &reading->scene;
    int patches = reading->patches ? config_setting_length(reading->patches) : 0;
    int most = patches > scene->point_count ? patches : scene->point_count;
    scene->patches = calloc((size_t)most + 1, sizeof *scene->patches);
    if (!scene->patches) {
        return out_of_memory(reading);
    }
    enum status status = STATUS_OK;
    if (reading->around_targets) {
        status = patches_around_targets(reading);
    } else if (reading->patches) {
        for (; scene->patch_count < patches && status == STATUS_OK; scene->patch_count++) {
            struct patch_keys patch;
            status = group_read(reading, config_setting_get_elem(reading->patches, (unsigned)scene->patch_count),
                                "image.patches", &patch);
            if (status == STATUS_OK) {
                status = grid_read(reading, patch.x, patch.r, &scene->patches[scene->patch_count]);
            }
        }
    } else {
        scene->patch_count = 1;
        status = grid_read(reading, reading->x, reading->r, &scene->patches[0]);
    }
    for (int i = 0; i < scene->patch_count && status == STATUS_OK; i++) {
        status = grid_check(&scene->patches[i], reading->path);
    }
    if (status == STATUS_OK && reading->reference) {
        status = reference_fill(reading);
    }
    return status == STATUS_OK
               ? grid_meets_records(&scene->acquisition, scene->patch_count, scene->patches, reading->path)
               : status;
}

static enum status reading_fill(struct reading *reading, config_setting_t *root)
{
    enum status status = groups_read(reading, root);
    if (status == STATUS_OK) {
        status = reading_check(reading);
    }
    if (status == STATUS_OK) {
        status = acquisition_fill(reading);
    }
    if (status == STATUS_OK) {
        status = targets_fill(reading);
    }
    if (status == STATUS_OK) {
        status = image_fill(reading);
    }
    if (status == STATUS_OK) {
        reading->scene.description = strdup(reading->description);
        status = reading->scene.description ? STATUS_OK : out_of_memory(reading);
    }
    return status;
}

static enum status file_read(struct reading *reading, const char *scene_directory)
{
    enum status status = scene_text_read(reading->path, scene_directory, &reading->text);
    if (status != STATUS_OK) {
        return status;
    }
    config_t config;
    config_init(&config);
    config_set_auto_convert(&config, CONFIG_TRUE);
    if (config_read_string(&config, reading->text.text)) {
        status = reading_fill(reading, config_root_setting(&config));
    } else {
        char place[320];
        place_format(reading, (unsigned)config_error_line(&config), place, sizeof place);
        status = status_set(STATUS_INVALID,
                            "%s: %s; must be libconfig text, each key once in its group, arrays of "
                            "one type",
                            place, config_error_text(&config));
    }
    config_destroy(&config);
    scene_text_free(&reading->text);
    return status;
}

static bool has_extension(const char *path)
{
    size_t length = strlen(path), extension = strlen(EXTENSION);
    return length > extension && strcmp(path + length - extension, EXTENSION) == 0;
}

/* The part of DIR/bp22/table3.cfg below DIR without extension; NULL for a path elsewhere. */
static char *name_below(const char *path, const char *directory)
{
    size_t length = strlen(directory);
    return strncmp(path, directory, length) == 0 && path[length] == '/'
               ? strndup(path + length + 1, strlen(path) - length - 1 - strlen(EXTENSION))
               : NULL;
}

/* The last `parts` parts of a full path without extension. */
static char *name_of(const char *full_path, int parts)
{
    const char *end = full_path + strlen(full_path), *begin = end;
    for (; begin > full_path && (begin[-1] != '/' || --parts > 0);)
        begin--;
    return strndup(begin, (size_t)(end - begin) - (has_extension(begin) ? strlen(EXTENSION) : 0));
}

static bool has_controls(const char *text)
{
    for (; *text; text++) {
        if ((unsigned char)*text < ' ' || *text == 0x7f) {
            return true;
        }
    }
    return false;
}

/* A scene has one name, however its path is written: below `directory` its path there, elsewhere that of its file. */
static enum status names_fill(struct scene *scene, const char *path, const char *directory)
{
    char *full_directory = realpath(directory, NULL);
    scene->path = realpath(path, NULL);
    if (!scene->path) {
        scene->path = strdup(path); /* reading it tells what is wrong */
    }
    if (scene->path && full_directory && has_extension(scene->path)) {
        scene->name = name_below(scene->path, full_directory);
    }
    scene->shipped = scene->name != NULL;
    if (scene->path && !scene->name) {
        scene->name = name_of(scene->path, 1);
    }
    free(full_directory);
    if (scene->path && has_controls(scene->path)) { /* it would go into tables and pictures */
        return status_set(STATUS_INVALID, "%s: the path of the scene holds control characters, must be plain text",
                          path);
    }
    return scene->path && scene->name ? STATUS_OK : status_set(STATUS_FAILED, "%s: out of memory for the scene", path);
}

enum status scenes_tell_apart(struct scene *a, struct scene *b)
{
    int parts = 1;
    for (const char *c = a->name; *c; c++) {
        parts += *c == '/';
    }
    while (strcmp(a->name, b->name) == 0) {
        parts++;
        struct scene *const both[] = {a, b};
        for (int k = 0; k < 2; k++) {
            char *longer = both[k]->shipped ? strdup(both[k]->name) : name_of(both[k]->path, parts);
            if (!longer) {
                return status_set(STATUS_FAILED, "%s: out of memory for the scene", both[k]->name);
            }
            free(both[k]->name);
            both[k]->name = longer;
        }
    }
    return STATUS_OK;
}

enum status scene_load(const char *scene, const char *scene_directory, struct scene *out)
{
    *out = (struct scene){0};
    char *path = malloc(strlen(scene) + strlen(scene_directory) + sizeof "/" EXTENSION);
    if (!path) {
        return status_set(STATUS_FAILED, "%s: out of memory for the scene", scene);
    }
    if (has_extension(scene)) {
        strcpy(path, scene);
    } else {
        sprintf(path, "%s/%s%s", scene_directory, scene, EXTENSION);
    }
    struct reading reading = {.path = path, .scene = {.hash = FNV_OFFSET}};
    enum status status = names_fill(&reading.scene, path, scene_directory);
    if (status == STATUS_OK) {
        status = file_read(&reading, scene_directory);
    }
    if (status == STATUS_OK) {
        *out = reading.scene;
    } else {
        scene_free(&reading.scene);
    }
    free(path);
    return status;
}

void scene_free(struct scene *scene)
{
    acquisition_free(&scene->acquisition);
    free(scene->name);
    free(scene->path);
    free(scene->description);
    free(scene->targets);
    free(scene->patches);
    free(scene->reference_patches);
    *scene = (struct scene){0};
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

enum status scene_names(const char *scene_directory, char ***names, int *count)
{
    *names = NULL;
    *count = 0;
    char *roots[] = {(char *)scene_directory, NULL};
    struct stat about;
    FTS *tree = stat(scene_directory, &about) == 0 && S_ISDIR(about.st_mode)
                    ? fts_open(roots, FTS_LOGICAL | FTS_NOCHDIR | FTS_NOSTAT, NULL)
                    : NULL;
    if (!tree) {
        return status_set(STATUS_INVALID, "%s: not a readable folder; must be the folder of the scenes",
                          scene_directory);
    }
    bool memory = true;
    for (FTSENT *entry = fts_read(tree); entry && memory; entry = fts_read(tree)) {
        bool is_scene = (entry->fts_info == FTS_F || entry->fts_info == FTS_NSOK) && has_extension(entry->fts_name);
        if (!is_scene || strchr("_.", entry->fts_name[0])) {
            continue;
        }
        char **longer = realloc(*names, ((size_t)*count + 1) * sizeof **names);
        memory = longer != NULL;
        if (memory) {
            *names = longer;
            longer[*count] = name_below(entry->fts_path, scene_directory);
            memory = longer[*count] != NULL;
            *count += memory;
        }
    }
    fts_close(tree);
    if (!memory) {
        scene_names_free(*names, *count);
        *names = NULL;
        *count = 0;
        return status_set(STATUS_FAILED, "%s: out of memory for the names of scenes", scene_directory);
    }
    if (*count > 0) {
        qsort(*names, (size_t)*count, sizeof **names, compare_names);
    }
    return STATUS_OK;
}

void scene_names_free(char **names, int count)
{
    for (int i = 0; i < count; i++) {
        free(names[i]);
    }
    free(names);
}
