/* `image --tile` and --memory: an image in tiles, in a file that keeps what is done (echoes/mat_tiles.h). */
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "choice/choice.h"
#include "command/task.h"
#include "command/tile_size.h"
#include "common/memory.h"
#include "echoes/echo_data.h"
#include "echoes/mat_tiles.h"
#include "imaging/imaging.h"
#include "ranks/cells.h"
#include "ranks/ranks.h"
#include "run/progress_line.h"
#include "scene/simulate.h"
#include "show/table.h"
#include "text/number.h"

/* "512x4096": pixels along x and r. */
static enum status tile_parse(const char *text, struct tiles *tiles)
{
    long long columns, rows;
    const char *end = whole_read(text, 1, INT_MAX, &columns);
    end = end && *end == 'x' ? whole_read(end + 1, 1, INT_MAX, &rows) : NULL;
    if (!end || *end)
        return status_set(STATUS_INVALID,
                          "image: --tile is '%s', must be pixels along x and r, whole numbers above 0: 4096x512", text);
    tiles->columns = columns < tiles->grid.x_count ? (int)columns : tiles->grid.x_count;
    tiles->rows = rows < tiles->grid.r_count ? (int)rows : tiles->grid.r_count;
    return STATUS_OK;
}

/* Echoes of a scene: in memory, or of a recording those pings that were read. */
struct held {
    struct echoes echoes;
    bool *has, *wanted; /* [pings] */
    int column;         /* first one of the stretch that they were read for */
    double largest;     /* of what was read */
};

static enum status range_check(double largest, enum precision precision)
{
    const double reach = precision == PRECISION_DOUBLE ? 0x1p400 : 0x1p40;
    return !(largest > 0) || (largest >= 1 / reach && largest <= reach)
               ? STATUS_OK
               : status_set(STATUS_UNSUPPORTED, "image: --tile: the largest sample is %.3g, must be from %.3g to %.3g",
                            largest, 1 / reach, reach);
}

/* Errors: STATUS_UNSUPPORTED where samples do not fit the precision as they are: the whole image would be of samples
   divided by a power of two. */
static enum status held_make(const struct scene *scene, enum precision precision, struct held *held)
{
    const struct acquisition *a = &scene->acquisition;
    const size_t pings = (size_t)a->pings;
    struct echoes from;
    *held = (struct held){.column = -1};
    if (!scene->recording.path) {
        enum status status = scene_echoes(scene, &from);
        if (status == STATUS_OK)
            status = echoes_convert(&from, precision, &held->echoes);
        echoes_free(&from);
        return status;
    }
    const enum status status = range_check(scene->recording.largest, precision);
    if (status != STATUS_OK)
        return status;
    const size_t size = size_product(pings, (size_t)a->receivers, (size_t)a->samples, precision_size(precision));
    held->has = calloc(pings, sizeof *held->has);
    held->wanted = calloc(pings, sizeof *held->wanted);
    held->echoes = (struct echoes){a, precision, size > 0 ? memory_sparse(size) : NULL, 0};
    return held->has && held->wanted && held->echoes.samples
               ? STATUS_OK
               : status_set(STATUS_FAILED, "%s: out of memory for a tile's echoes", scene->recording.path);
}

static void held_free(struct held *held)
{
    if (!held->has)
        echoes_free(&held->echoes);
    else
        memory_sparse_free((void *)held->echoes.samples);
    free(held->has);
    free(held->wanted);
}

/* Read the pings that a plan needs and that are not held; of another stretch, only those that this plan needs are kept.
 */
static enum status held_read(const struct scene *scene, const struct imaging *imaging, const struct problem *problem,
                             struct held *held)
{
    const struct acquisition *a = &scene->acquisition;
    const size_t each = (size_t)a->receivers * (size_t)a->samples, bytes = each * precision_size(problem->precision);
    const struct pings pings = {
        a->pings,      held->wanted, problem->precision, scene->recording.exponent, each, (void *)held->echoes.samples,
        &held->largest};
    imaging_reads(imaging, problem, held->wanted);
    for (size_t p = 0; p < (size_t)a->pings; p++) {
        if (held->has[p] && !held->wanted[p] && held->column != problem->window->column) {
            memory_sparse_drop(pings.samples, p * bytes, (p + 1) * bytes);
            held->has[p] = false;
        }
        held->wanted[p] &= !held->has[p];
    }
    held->column = problem->window->column;
    enum status status = echo_file_read_pings(scene->recording.path, a, &pings);
    for (size_t p = 0; p < (size_t)a->pings; p++)
        held->has[p] |= held->wanted[p];
    if (status == STATUS_OK && held->largest > scene->recording.largest)
        status = range_check(held->largest, problem->precision);
    return status;
}

static enum status tile_form(const struct spec *spec, const struct scene *scene, struct held *held, struct tiles *tiles,
                             int number)
{
    const struct pixel_window window = tiles_window(tiles, number);
    struct problem problem = problem_make(&scene->acquisition, 1, &tiles->grid, spec->precision);
    struct imaging imaging;
    struct image image;
    struct stages stages;
    problem.window = &window;
    enum status status = imaging_open(spec, &problem, &imaging);
    if (status != STATUS_OK)
        return status;
    if (scene->recording.path)
        status = held_read(scene, &imaging, &problem, held);
    stages_begin(&stages);
    if (status == STATUS_OK)
        status = imaging_execute(&imaging, &held->echoes, &stages);
    if (status == STATUS_OK)
        status = imaging_finish(&imaging, &held->echoes, &image);
    if (status == STATUS_OK) {
        status = image.precision == tiles->precision
                     ? tiles_write(tiles, number, image.pixels[0])
                     : status_set(STATUS_UNSUPPORTED, "image: --tile: float does not hold these echoes' amplitudes; "
                                                      "precision=double does");
        image_free(&image);
    }
    imaging_close(&imaging);
    return status;
}

/* All settings that determine pixels. */
static void settings_format(const struct task *task, const struct scene *scene, const struct image_origin *origin,
                            char *text, size_t size)
{
    const struct spec *spec = &task->specs[0];
    const struct grid *g = &scene->patches[0];
    snprintf(text, size,
             "algorithm: %s:%s,precision=%s\ngrid: %.17g:%.17g:%d,%.17g:%.17g:%d,%.17g\nscene's content: %016" PRIx64
             "\nprogram: %s\n",
             spec->algorithm->name, spec->text, precision_name(spec->precision), g->x_first, g->x_step, g->x_count,
             g->r_first, g->r_step, g->r_count, g->angle_rad, scene->hash, origin->commit);
}

/* The first, or the next, tile for this process after tile `n`; -1: none is left. */
static int tile_next(const struct tiles *tiles, const struct shard *shard, int n)
{
    if (ranks_count() > 1)
        return ranks_next();
    do
        n++;
    while (n < tiles_count(tiles) && (tiles->done[n] || (shard->count > 0 && n % shard->count != shard->number - 1)));
    return n < tiles_count(tiles) ? n : -1;
}

/* Open the file; rank 0 makes it, and hands out what is to be done. */
static enum status file_open(struct tiles *tiles, const struct shard *shard, const char *settings,
                             const struct image_origin *origin)
{
    tiles->writer = ranks_count() > 1 ? ranks_number() + 1 : shard->number;
    tiles->anew = ranks_count() > 1;
    ranks_meet();
    enum status status = tiles_open(tiles, settings, origin);
    if (status != STATUS_OK || ranks_count() == 1 || ranks_number() > 0)
        return status;
    int count = 0, *todo = calloc((size_t)tiles_count(tiles), sizeof *todo);
    for (int n = 0; n < tiles_count(tiles) && todo; n++)
        if (!tiles->done[n])
            todo[count++] = n;
    if (todo)
        ranks_offer(count, todo);
    else
        status = status_set(STATUS_FAILED, "%s: out of memory for its tiles", tiles->path);
    free(todo);
    return status;
}

/* The last one finishes the file. */
static enum status file_finish(struct tiles *tiles, bool *sealed)
{
    *sealed = false;
    if (ranks_number() > 0)
        return STATUS_OK;
    ranks_join();
    const enum status status = tiles_seal(tiles, sealed);
    int done, count;
    if (status == STATUS_OK && !*sealed && tiles_claimed(tiles->path, &done, &count))
        printf("%s: this part is done, %d of all %d tiles\n", tiles->path, done, count);
    return status;
}

static enum status tiles_form(const struct task *task, const struct shard *shard, const struct scene *scene,
                              struct tiles *tiles)
{
    const struct spec *spec = &task->specs[0];
    const int count = tiles_count(tiles), before = tiles_done(tiles);
    struct held held = {.has = NULL};
    enum status status = before < count ? held_make(scene, spec->precision, &held) : STATUS_OK;
    if (before > 0 && ranks_number() == 0)
        printf("%s: %d of %d tiles were done\n", tiles->path, before, count);
    for (int n = -1; status == STATUS_OK && (n = tile_next(tiles, shard, n)) >= 0;) {
        progress_line(false, "%s: tile %d of %d by %s", scene->name, n + 1, count, spec->algorithm->name);
        status = tile_form(spec, scene, &held, tiles, n);
    }
    progress_line_clear();
    held_free(&held);
    return status;
}

/* Of azimuth transforms: tiles overlap along the track. `read`: pings of a tile in the middle. */
static void overlap_print(const struct scene *scene, const struct tiles *tiles, int read)
{
    enum { MOST = 2 }; /* times the work of the whole image: narrower tiles are mostly overlap */
    const struct acquisition *a = &scene->acquisition;
    const struct grid *g = &tiles->grid;
    const int wide = (g->x_count + tiles->columns - 1) / tiles->columns;
    struct condition overlap =
        condition_most(SEVERITY_WARN, "tile_overlap", (double)read * wide / a->pings, MOST,
                       "pings that all tiles along x image, over those of the track", "back projection");
    const double each = g->x_step * cos(g->angle_rad) * (a->pings - 1) / fabs(a->tx[a->pings - 1].x - a->tx[0].x);
    const double columns = ceil((read - tiles->columns * each) * g->x_count / (MOST * a->pings - g->x_count * each));
    if (columns > tiles->columns && columns <= g->x_count)
        condition_cure_add(&overlap, ", or tiles of %.0f columns", columns);
    warnings_print(&overlap, 1);
    printf("%s: a tile of %d columns images %d of %d pings; conditions are those of the whole image\n", tiles->path,
           tiles->columns, read, a->pings);
}

/* Before the file is made: what refuses the whole image refuses its tiles, and a tile in the middle is planned. */
static enum status tile_try(const struct spec *spec, const struct scene *scene, const struct tiles *tiles)
{
    const int deep = (tiles->grid.r_count + tiles->rows - 1) / tiles->rows;
    const struct pixel_window window = tiles_window(tiles, tiles_count(tiles) / deep / 2 * deep);
    struct problem problem = problem_make(&scene->acquisition, 1, &tiles->grid, spec->precision);
    struct imaging imaging;
    struct condition list[CONDITIONS_MAX];
    bool *read = calloc((size_t)scene->acquisition.pings, sizeof *read);
    const int conditions = algorithm_conditions(spec->algorithm, &problem, spec->options, list, CONDITIONS_MAX);
    enum status status = read ? conditions_check(spec->algorithm->name, list, conditions)
                              : status_set(STATUS_FAILED, "%s: out of memory for its pings", tiles->path);
    problem.window = &window;
    if (status == STATUS_OK)
        status = imaging_open(spec, &problem, &imaging);
    if (status == STATUS_OK && !(spec->algorithm->traits & TRAIT_ANY_TRACK) && ranks_number() == 0) {
        int count = 0;
        imaging_reads(&imaging, &problem, read);
        for (int p = 0; p < scene->acquisition.pings; p++)
            count += read[p];
        overlap_print(scene, tiles, count);
    }
    if (status == STATUS_OK)
        imaging_close(&imaging);
    free(read);
    return status;
}

/* --memory: all ranks and shards choose the same tile. */
static enum status memory_take(const struct task *task, const struct scene *scene, struct tiles *tiles)
{
    double bytes;
    struct tile_cost cost;
    enum status status = memory_parse("image", task->memory, &bytes);
    if (status != STATUS_OK)
        return status;
    progress_line(false, "%s: tiles for %s", scene->name, task->memory);
    status = tile_choose(&task->specs[0], scene, bytes, tiles, &cost);
    progress_line_clear();
    if (status == STATUS_OK && ranks_number() == 0)
        printf("%s: --tile %dx%d, %d in all; a process takes up to %s and reads up to %d of %d pings a tile\n",
               tiles->path, tiles->columns, tiles->rows, tiles_count(tiles),
               cell_significant(1e-6 * cost.bytes, " MB").text, cost.pings, scene->acquisition.pings);
    return status;
}

bool image_is_tiled(const struct task *task)
{
    return task->tile || task->memory;
}

enum status image_tiles(const struct task *task, const struct scene *scene, const struct image_origin *origin)
{
    const struct spec *spec = &task->specs[0];
    struct tiles tiles = {.path = task->output, .grid = scene->patches[0], .precision = spec->precision};
    struct budget budget;
    char settings[1400];
    if (choice_asked(spec, &budget) || !(spec->algorithm->traits & TRAIT_WINDOW) || scene->patch_count != 1)
        return status_set(
            STATUS_UNSUPPORTED,
            "image: --tile takes an image of one patch, by any algorithm but auto, wk_polar (whose filter "
            "needs the whole track: `filter` writes filtered echoes for the others), plug-ins, programs "
            "and chains of filters; %s of %d patches is asked for",
            spec->algorithm->name, scene->patch_count);
    struct shard shard;
    bool sealed = false;
    enum status status = shard_parse("image", task->shard, &shard);
    if (status == STATUS_OK)
        status = task->tile ? tile_parse(task->tile, &tiles) : memory_take(task, scene, &tiles);
    if (status == STATUS_OK)
        status = tile_try(spec, scene, &tiles);
    if (status != STATUS_OK)
        return status;
    settings_format(task, scene, origin, settings, sizeof settings);
    status = file_open(&tiles, &shard, settings, origin);
    if (status != STATUS_OK)
        return status;
    const double begin = seconds_now();
    status = tiles_form(task, &shard, scene, &tiles);
    if (status == STATUS_OK)
        status = file_finish(&tiles, &sealed);
    if (status == STATUS_OK && sealed)
        printf("%s: %s of %s, %d tiles, %s\n", task->output, origin->algorithm, scene->name, tiles_count(&tiles),
               cell_time(seconds_now() - begin).text);
    tiles_close(&tiles);
    return status;
}
