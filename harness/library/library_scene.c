/* The library's scenes: from files and from arrays, their echoes and delays (libsasbench.h). */
#include <ctype.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contract/delay.h"
#include "echoes/echo_data.h"
#include "echoes/noise.h"
#include "files/hash.h"
#include "guests/shown.h"
#include "library/library.h"
#include "scene/simulate.h"

static enum status show(struct sasbench_scene *out)
{
    const struct scene *scene = &out->scene;
    out->grids = calloc((size_t)scene->patch_count, sizeof *out->grids);
    if (!out->grids)
        return status_set(STATUS_FAILED, "%s: no memory for %d patches", scene->name, scene->patch_count);
    for (int k = 0; k < scene->patch_count; k++)
        out->grids[k] = grid_show(&scene->patches[k]);
    out->acquisition = acquisition_show(&scene->acquisition);
    out->shown = (struct sasbench_arrays){.size = sizeof out->shown,
                                          .name = scene->name,
                                          .acquisition = &out->acquisition,
                                          .patch_count = scene->patch_count,
                                          .point_count = scene->point_count,
                                          .patches = out->grids,
                                          .points = (const double *)scene->targets};
    return STATUS_OK;
}

static struct grid grid_taken(const struct sas_grid *g)
{
    return (struct grid){g->x_first_m, g->x_step_m, g->x_count, g->r_first_m, g->r_step_m, g->r_count, g->angle_rad};
}

static enum status load(const struct sasbench *context, const void *name, struct scene *scene)
{
    return scene_load(name, context->scenes, scene);
}

struct file {
    const char *path;
    const struct sas_grid *grid;
};

static enum status read_file(const struct sasbench *context, const void *with, struct scene *scene)
{
    const struct file *file = with;
    struct grid grid;
    (void)context;
    if (!file->grid)
        return scene_from_echoes(file->path, NULL, file->path, true, scene);
    grid = grid_taken(file->grid);
    const enum status status = grid_check(&grid, "grid");
    return status == STATUS_OK ? scene_from_echoes(file->path, &grid, "grid", true, scene) : status;
}

/* Compression divides by the replica's energy, whose squares must fit. */
static enum status pulse_check(const char *name, const struct acquisition *a)
{
    const double largest = largest_part(a->pulse, PRECISION_DOUBLE, (size_t)a->pulse_length);
    return a->compressed || (largest >= 0x1p-20 && largest <= 0x1p20)
               ? STATUS_OK
               : status_set(STATUS_INVALID, "%s: the pulse's largest part is %g, must be 2^-20 to 2^20", name, largest);
}

static enum status image_take(const struct sasbench_arrays *arrays, struct scene *scene)
{
    if (arrays->patch_count < 1 || arrays->point_count < 0)
        return status_set(STATUS_INVALID, "%s: %d patches and %d points, must be at least 1 and 0", scene->name,
                          arrays->patch_count, arrays->point_count);
    const size_t points = (size_t)arrays->point_count;
    scene->patches = calloc((size_t)arrays->patch_count, sizeof *scene->patches);
    scene->targets = calloc(points + 1, sizeof *scene->targets);
    if (!scene->patches || !scene->targets)
        return status_set(STATUS_FAILED, "%s: no memory for patches and points", scene->name);
    for (; scene->patch_count < arrays->patch_count; scene->patch_count++) {
        struct grid *grid = &scene->patches[scene->patch_count];
        *grid = grid_taken(&arrays->patches[scene->patch_count]);
        const enum status status = grid_check(grid, scene->name);
        if (status != STATUS_OK)
            return status;
    }
    for (size_t k = 0; k < 4 * points; k++) {
        const double most = k % 4 < 2 ? COORDINATE_MAX_M : DBL_MAX;
        if (!(fabs(arrays->points[k]) <= most))
            return status_set(STATUS_INVALID, "%s: point %zu has %g, must be a number of at most %g", scene->name,
                              k / 4, arrays->points[k], most);
    }
    if (points > 0)
        memcpy(scene->targets, arrays->points, points * sizeof *scene->targets);
    scene->point_count = scene->target_count = arrays->point_count;
    return grid_meets_records(&scene->acquisition, scene->patch_count, scene->patches, scene->name);
}

static enum status echoes_take(const double *samples, struct scene *scene)
{
    struct acquisition *a = &scene->acquisition;
    if (!samples) {
        a->noise = noise_of_targets(a, scene->target_count, scene->targets, 0);
        return STATUS_OK;
    }
    const struct echoes given = {a, PRECISION_DOUBLE, samples, 0};
    struct echoes kept;
    enum status status = samples_check(a, PRECISION_DOUBLE, samples);
    if (status == STATUS_OK)
        status = echoes_allocate(a, PRECISION_DOUBLE, &kept);
    if (status != STATUS_OK)
        return status;
    memcpy((void *)kept.samples, samples, samples_bytes(a, PRECISION_DOUBLE));
    scene->recorded = (double complex *)kept.samples;
    return noise_measure(&given, &a->noise);
}

/* Names stand in rows of CSV files and in messages. */
static enum status name_take(const char *name, struct scene *scene)
{
    bool plain = *name && strlen(name) <= 200;
    for (const char *at = name; *at && plain; at++)
        plain = isprint((unsigned char)*at);
    if (!plain)
        return status_set(STATUS_INVALID, "a scene's name has %zu characters, must be 1 to 200 printable ones",
                          strlen(name));
    scene->name = strdup(name);
    scene->path = strdup("");
    scene->description = strdup("made of arrays");
    return scene->name && scene->path && scene->description ? STATUS_OK : status_set(STATUS_FAILED, "no memory");
}

/* Is all there that must be? */
static bool arrays_whole(const struct sasbench_arrays *arrays)
{
    const struct sas_acquisition *a = arrays->acquisition;
    return arrays->size == sizeof *arrays && arrays->name && arrays->patches
           && (arrays->points || arrays->point_count <= 0) && a && a->size == sizeof *a;
}

static enum status make(const struct sasbench *context, const void *with, struct scene *scene)
{
    const struct sasbench_arrays *arrays = with;
    (void)context;
    if (!arrays_whole(arrays))
        return status_set(STATUS_INVALID, "a scene of arrays lacks one that its counts need, its name or its size");
    const bool recorded = arrays->samples;
    *scene = (struct scene){.hash = HASH_BEGIN,
                            .beam = {.kind = BEAM_RECT, .truncation = TRUNCATION_NONE},
                            .acquisition = {.echo_sine = recorded ? 0 : INFINITY, .noisy = recorded}};
    enum status status = name_take(arrays->name, scene);
    if (status == STATUS_OK)
        status = acquisition_take(scene->name, arrays->acquisition, &scene->acquisition);
    if (status == STATUS_OK)
        status = pulse_check(scene->name, &scene->acquisition);
    if (status == STATUS_OK)
        status = image_take(arrays, scene);
    if (status == STATUS_OK)
        status = echoes_take(arrays->samples, scene);
    scene->pulse_kind = scene->acquisition.compressed ? PULSE_FLAT : PULSE_LFM;
    if (status != STATUS_OK)
        scene_free(scene);
    return status;
}

static int scene_take(struct sasbench *context,
                      enum status (*taker)(const struct sasbench *context, const void *with, struct scene *scene),
                      const void *with, struct sasbench_scene **scene)
{
    const int threads = turn_begin(context, TURN_ALONE);
    struct sasbench_scene *made = calloc(1, sizeof *made);
    enum status status = made ? STATUS_OK : status_set(STATUS_FAILED, "no memory for a scene");
    if (status == STATUS_OK) {
        made->context = context;
        status = taker(context, with, &made->scene);
        if (status == STATUS_OK)
            status = show(made);
        else
            made->scene = (struct scene){0};
    }
    *scene = NULL;
    if (status == STATUS_OK)
        *scene = made;
    else
        sasbench_scene_free(made);
    return turn_end(threads, status);
}

int sasbench_scene_load(struct sasbench *context, const char *name, struct sasbench_scene **scene)
{
    return scene_take(context, load, name, scene);
}

int sasbench_scene_read(struct sasbench *context, const char *path, const struct sas_grid *grid,
                        struct sasbench_scene **scene)
{
    return scene_take(context, read_file, &(struct file){path, grid}, scene);
}

int sasbench_scene_make(struct sasbench *context, const struct sasbench_arrays *arrays, struct sasbench_scene **scene)
{
    const int status = scene_take(context, make, arrays, scene);
    if (status == SAS_OK)
        (*scene)->silent = !arrays->samples && arrays->point_count == 0;
    return status;
}

const struct sasbench_arrays *sasbench_scene_arrays(const struct sasbench_scene *scene)
{
    return &scene->shown;
}

void sasbench_scene_free(struct sasbench_scene *scene)
{
    if (!scene)
        return;
    const int threads = turn_begin(scene->context, TURN_ALONE);
    if (scene->ready)
        session_close(&scene->session);
    scene_free(&scene->scene);
    free(scene->grids);
    free(scene);
    turn_end(threads, STATUS_OK);
}

enum status scene_check(const struct sasbench_scene *scene)
{
    return scene->silent ? status_set(STATUS_INVALID, "%s: has neither echoes nor points; one of them is needed",
                                      scene->scene.name)
                         : STATUS_OK;
}

/* Echoes of extreme numbers are divided by a power of two. */
static enum status echoes_put(const struct scene *scene, const struct echoes *both, int precision, void *samples)
{
    const size_t count = acquisition_samples(both->acquisition);
    const double *parts = both->samples,
                 largest = ldexp(largest_part(both->samples, PRECISION_DOUBLE, count), both->exponent);
    if (!(largest < INFINITY) || (precision == SAS_FLOAT && !single_holds(largest)))
        return status_set(STATUS_INVALID, "%s: the echoes' largest part is %g, beyond %s", scene->name, largest,
                          precision == SAS_FLOAT ? "single precision; double is needed" : "double precision");
    for (size_t k = 0; k < 2 * count; k++) {
        const double part = both->exponent ? ldexp(parts[k], both->exponent) : parts[k];
        if (precision == SAS_FLOAT)
            ((float *)samples)[k] = (float)part;
        else
            ((double *)samples)[k] = part;
    }
    return STATUS_OK;
}

int sasbench_echoes(struct sasbench_scene *scene, int precision, void *samples)
{
    const int threads = turn_begin(scene->context, TURN_ALONE);
    struct echoes echoes = {0};
    enum status status = precision_check(precision);
    if (status == STATUS_OK)
        status = scene_check(scene);
    if (status == STATUS_OK)
        status = scene_echoes(&scene->scene, &echoes);
    if (status == STATUS_OK)
        status = echoes_put(&scene->scene, &echoes, precision, samples);
    echoes_free(&echoes);
    return turn_end(threads, status);
}

/* The scene with its pixels as points, without noise; `pixels` NULL: of amplitude 0. Free the targets. */
static enum status pixels_take(const struct scene *from, const void *const *pixels, struct scene *scene)
{
    size_t count = 0;
    *scene = *from;
    scene->targets = NULL;
    scene->recorded = NULL;
    scene->noise_std = 0;
    if (from->recorded)
        scene->pulse_kind = from->acquisition.compressed ? PULSE_FLAT : PULSE_LFM;
    for (int k = 0; k < scene->patch_count; k++)
        count += grid_pixels(&scene->patches[k]);
    if (count > INT_MAX)
        return status_set(STATUS_INVALID, "%s: %zu pixels, must be at most %d", scene->name, count, INT_MAX);
    struct target *target = scene->targets = malloc(count * sizeof *target);
    if (!target)
        return status_set(STATUS_FAILED, "%s: no memory for %zu pixels", scene->name, count);
    scene->point_count = scene->target_count = (int)count;
    for (int k = 0; k < scene->patch_count; k++) {
        const struct grid *grid = &scene->patches[k];
        const double complex *amplitudes = pixels ? pixels[k] : NULL;
        for (int i = 0; i < grid->r_count; i++)
            for (int j = 0; j < grid->x_count; j++) {
                const struct vector place = grid_point(grid, i, j);
                *target++ = (struct target){place.x, place.y, amplitudes ? *amplitudes++ : 0};
            }
    }
    for (size_t n = 0; n < count; n++)
        if (!isfinite(creal(scene->targets[n].amplitude)) || !isfinite(cimag(scene->targets[n].amplitude)))
            return status_set(STATUS_INVALID, "%s: pixel %zu of the reflectivity is not finite", scene->name, n);
    return STATUS_OK;
}

int sasbench_forward(struct sasbench_scene *scene, const void *const *pixels, void *samples)
{
    const int threads = turn_begin(scene->context, TURN_ALONE);
    struct scene own;
    struct echoes echoes = {0};
    enum status status = pixels_take(&scene->scene, pixels, &own);
    if (status == STATUS_OK)
        status = scene_simulate(&own, &echoes);
    if (status == STATUS_OK)
        status = echoes_put(&own, &echoes, SAS_DOUBLE, samples);
    echoes_free(&echoes);
    free(own.targets);
    return turn_end(threads, status);
}

int sasbench_adjoint(struct sasbench_scene *scene, const void *samples, void *const *pixels)
{
    const int threads = turn_begin(scene->context, TURN_ALONE);
    struct scene own = {.target_count = 0};
    struct simulation *simulation = NULL;
    double complex *sums = NULL;
    enum status status = samples_check(&scene->scene.acquisition, PRECISION_DOUBLE, samples);
    if (status == STATUS_OK)
        status = pixels_take(&scene->scene, NULL, &own);
    if (status == STATUS_OK)
        status = simulation_open(&own, own.acquisition.pings, &simulation);
    if (status == STATUS_OK && !(sums = malloc((size_t)own.target_count * sizeof *sums)))
        status = status_set(STATUS_FAILED, "%s: no memory for %d pixels", own.name, own.target_count);
    if (status == STATUS_OK)
        status = simulation_adjoint(simulation, samples, sums);
    const double complex *from = sums;
    for (int k = 0; k < own.patch_count && status == STATUS_OK; k++) {
        const size_t count = grid_pixels(&own.patches[k]);
        memcpy(pixels[k], from, count * sizeof *from);
        from += count;
    }
    simulation_close(simulation);
    free(sums);
    free(own.targets);
    return turn_end(threads, status);
}

int sasbench_delays(const struct sasbench_scene *scene, size_t count, const double *points, double *delays)
{
    const struct acquisition *a = &scene->scene.acquisition;
    const long long records = (long long)a->pings * a->receivers;
    const int threads = turn_begin(scene->context, TURN_NONE);
    enum status status = STATUS_OK;
    for (size_t k = 0; k < 3 * count && status == STATUS_OK; k++)
        if (!isfinite(points[k]))
            status =
                status_set(STATUS_INVALID, "delays: point %zu has %g; finite numbers are needed", k / 3, points[k]);
    if (status == STATUS_OK) {
#pragma omp parallel for
        for (long long n = 0; n < records; n++) {
            const long long p = n / a->receivers;
            for (size_t k = 0; k < count; k++)
                delays[(size_t)n * count + k] =
                    delay_exact(a->tx[p], a->rx[n], a->velocity[p],
                                (struct vector){points[3 * k], points[3 * k + 1], points[3 * k + 2]}, a->sound_speed);
        }
    }
    return turn_end(threads, status);
}
