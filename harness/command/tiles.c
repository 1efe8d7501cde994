/* `image --tile` and --memory: an image in tiles, in a file that keeps what is done (echoes/mat_tiles.h). */
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command/task.h"
#include "measure/tile_size.h"
#include "measure/tiled.h"
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

/* A shard has a stretch of tiles: neighbours read much the same pings. */
static bool is_of_shard(const struct tiles *tiles, const struct shard *shard, int n)
{
    return shard->count == 0 || (long long)n * shard->count / tiles_count(tiles) == shard->number - 1;
}

/* The first, or the next, tile for this process after tile `n`; -1: none is left. */
static int tile_next(const struct tiles *tiles, const struct shard *shard, int n)
{
    if (ranks_count() > 1)
        return ranks_next();
    do
        n++;
    while (n < tiles_count(tiles) && (tiles->done[n] || !is_of_shard(tiles, shard, n)));
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
        ranks_offer(count, todo, true);
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

static enum status tiles_form(const struct spec *spec, const struct shard *shard, const struct scene *scene,
                              struct tile_echoes *held, struct tiles *tiles)
{
    const int count = tiles_count(tiles), before = tiles_done(tiles);
    enum status status = STATUS_OK;
    if (before > 0 && ranks_number() == 0)
        printf("%s: %d of %d tiles were done\n", tiles->path, before, count);
    for (int n = -1; status == STATUS_OK && (n = tile_next(tiles, shard, n)) >= 0;) {
        progress_line(false, "%s: tile %d of %d by %s", scene->name, n + 1, count, spec->algorithm->name);
        struct tile tile;
        status = tile_form(spec, scene, held, tiles, n, &tile);
        if (status == STATUS_OK) {
            status = tiles_write(tiles, n, tile.image.pixels[0]);
            tile_free(&tile);
        }
    }
    progress_line_clear();
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
    enum status status = memory_of_tiles("image", task, &bytes);
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
    char settings[1400];
    struct shard shard;
    struct tile_echoes held;
    bool sealed = false;
    enum status status = tiled_check("image", spec, scene);
    if (status == STATUS_OK)
        status = shard_parse("image", task->shard, &shard);
    if (status == STATUS_OK)
        status = task->tile ? tile_parse(task->tile, &tiles) : memory_take(task, scene, &tiles);
    if (status == STATUS_OK)
        status = tile_try(spec, scene, &tiles);
    if (status != STATUS_OK)
        return status;
    const double begin = seconds_now();
    settings_format(task, scene, origin, settings, sizeof settings);
    status = tile_echoes_open(scene, spec->precision, &held); /* what is refused here leaves no file */
    if (status == STATUS_OK)
        status = file_open(&tiles, &shard, settings, origin);
    if (status != STATUS_OK) {
        tile_echoes_close(&held);
        return status;
    }
    status = tiles_form(spec, &shard, scene, &held, &tiles);
    if (status == STATUS_OK)
        status = file_finish(&tiles, &sealed);
    if (status == STATUS_OK && sealed)
        printf("%s: %s of %s, %d tiles, %s\n", task->output, origin->algorithm, scene->name, tiles_count(&tiles),
               cell_time(seconds_now() - begin).text);
    tiles_close(&tiles);
    tile_echoes_close(&held);
    return status;
}
