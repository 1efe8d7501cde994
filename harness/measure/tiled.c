/* Images formed tile by tile (tiled.h). */
#include "measure/tiled.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "choice/choice.h"
#include "common/clock.h"
#include "common/memory.h"
#include "echoes/echo_data.h"
#include "measure/tile_size.h"
#include "scene/simulate.h"

enum status tiled_check(const char *command, const struct spec *spec, const struct scene *scene)
{
    struct budget budget;
    if (!choice_asked(spec, &budget) && spec->algorithm->traits & TRAIT_WINDOW && scene->patch_count == 1)
        return STATUS_OK;
    return status_set(
        STATUS_UNSUPPORTED,
        "%s: --tile and --memory take an image of one patch, by any algorithm but auto, wk_polar (whose "
        "filter needs the whole track: `filter` writes filtered echoes for the others), plug-ins, programs "
        "and chains of filters; %s of %d patches is asked for",
        command, spec->algorithm->name, scene->patch_count);
}

static enum status range_check(double largest, enum precision precision)
{
    const double reach = precision == PRECISION_DOUBLE ? 0x1p400 : 0x1p40;
    return !(largest > 0) || (largest >= 1 / reach && largest <= reach)
               ? STATUS_OK
               : status_set(STATUS_UNSUPPORTED, "tiles: the largest sample is %.3g, must be from %.3g to %.3g in %s%s",
                            largest, 1 / reach, reach, precision_name(precision),
                            precision == PRECISION_DOUBLE ? "" : "; precision=double holds more");
}

enum status tile_echoes_open(const struct scene *scene, enum precision precision, struct tile_echoes *held)
{
    const struct acquisition *a = &scene->acquisition;
    const size_t pings = (size_t)a->pings;
    struct echoes from;
    *held = (struct tile_echoes){.column = -1};
    if (!scene->recording.path) {
        enum status status = scene_echoes(scene, &from);
        if (status == STATUS_OK)
            status = echoes_convert(&from, precision, &held->echoes);
        if (status == STATUS_OK && precision == PRECISION_FLOAT && held->echoes.exponent != 0)
            status = status_set(STATUS_UNSUPPORTED,
                                "tiles: float does not hold the amplitudes of %s's echoes; "
                                "precision=double does",
                                scene->name);
        echoes_free(&from);
        return status;
    }
    const enum status status = range_check(scene->recording.largest, precision);
    if (status != STATUS_OK)
        return status;
    const size_t size = size_product(pings, (size_t)a->receivers, (size_t)a->samples, precision_size(precision));
    held->has = calloc(pings, sizeof *held->has);
    held->wanted = calloc(pings, sizeof *held->wanted);
    held->echoes = (struct echoes){a, precision, size > 0 ? memory_sparse(size, true) : NULL, 0};
    return held->has && held->wanted && held->echoes.samples
               ? STATUS_OK
               : status_set(STATUS_FAILED, "%s: out of memory for a tile's echoes", scene->recording.path);
}

void tile_echoes_close(struct tile_echoes *held)
{
    if (!held->has)
        echoes_free(&held->echoes);
    else
        memory_sparse_free((void *)held->echoes.samples);
    free(held->has);
    free(held->wanted);
}

/* Give up the pings that are not wanted: each stretch at once, which leaves no page that two of them share. */
static void pings_drop(int pings, struct tile_echoes *held, size_t bytes)
{
    int first = 0;
    bool some = false;
    for (int p = 0; p <= pings; p++) {
        if (p < pings && !held->wanted[p]) {
            some |= held->has[p];
            held->has[p] = false;
            continue;
        }
        if (some)
            memory_sparse_drop((void *)held->echoes.samples, (size_t)first * bytes, (size_t)p * bytes);
        some = false;
        first = p + 1;
    }
}

/* Read the pings that a plan needs and that are not held; of another stretch, only those that this plan needs are kept.
 */
static enum status pings_read(const struct scene *scene, const struct imaging *imaging, const struct problem *problem,
                              struct tile_echoes *held)
{
    const struct acquisition *a = &scene->acquisition;
    const size_t each = (size_t)a->receivers * (size_t)a->samples, bytes = each * precision_size(problem->precision);
    const struct pings pings = {
        a->pings,      held->wanted, problem->precision, scene->recording.exponent, each, (void *)held->echoes.samples,
        &held->largest};
    int count = 0;
    imaging_reads(imaging, problem, held->wanted);
    if (held->column != problem->window->column)
        pings_drop(a->pings, held, bytes);
    for (size_t p = 0; p < (size_t)a->pings; p++) {
        held->wanted[p] &= !held->has[p];
        count += held->wanted[p];
    }
    held->column = problem->window->column;
    if (count == 0) /* a file of version 5 would be read whole */
        return STATUS_OK;
    enum status status = echo_file_read_pings(scene->recording.path, a, &pings);
    for (size_t p = 0; p < (size_t)a->pings; p++)
        held->has[p] |= held->wanted[p];
    if (status == STATUS_OK && held->largest > scene->recording.largest)
        status = range_check(held->largest, problem->precision);
    return status;
}

enum status tile_form(const struct spec *spec, const struct scene *scene, struct tile_echoes *held,
                      const struct tiles *tiles, int number, struct tile *tile)
{
    *tile = (struct tile){.window = tiles_window(tiles, number)};
    tile->problem = problem_make(&scene->acquisition, 1, &tiles->grid, spec->precision);
    tile->problem.window = &tile->window;
    enum status status = imaging_open(spec, &tile->problem, &tile->imaging);
    if (status != STATUS_OK)
        return status;
    if (scene->recording.path)
        status = pings_read(scene, &tile->imaging, &tile->problem, held);
    if (status == STATUS_OK) {
        stages_begin(&tile->stages);
        const double begin = tile->stages.mark;
        status = imaging_execute(&tile->imaging, &held->echoes, &tile->stages);
        tile->run_s = seconds_now() - begin;
    }
    if (status == STATUS_OK)
        status = imaging_finish(&tile->imaging, &held->echoes, &tile->image);
    if (status != STATUS_OK)
        tile_free(tile);
    return status;
}

void tile_free(struct tile *tile)
{
    image_free(&tile->image);
    imaging_close(&tile->imaging);
}

/* The exact image of some of a tile's pixels. It may need pings that the tile did not. */
static enum status tile_probe(const struct spec *exact, const struct scene *scene, struct tile_echoes *held,
                              const struct tile *tile, struct probe *all)
{
    const struct problem part = problem_make(&scene->acquisition, 1, &tile->imaging.part, exact->precision);
    const struct region everywhere = {1, &tile->imaging.part};
    struct problem read = tile->problem;
    struct imaging imaging;
    struct probe probe;
    read.estimate = true;
    enum status status = imaging_open(exact, &read, &imaging);
    if (status == STATUS_OK) {
        status = pings_read(scene, &imaging, &read, held);
        imaging_close(&imaging);
    }
    if (status == STATUS_OK)
        status = probe_make(exact, &part, &held->echoes, &tile->image, &everywhere, &probe);
    if (status == STATUS_OK) {
        status = probe_join(all, &probe, &tile->window);
        probe_free(&probe);
    }
    return status;
}

static void pixels_take(const struct tile *tile, const struct image *image)
{
    const size_t size = precision_size(image->precision), row = (size_t)tile->window.columns * size;
    for (int i = 0; i < tile->window.rows; i++) {
        const size_t to =
            (size_t)(tile->window.row + i) * (size_t)image->patches->x_count + (size_t)tile->window.column;
        memcpy((char *)image->pixels[0] + to * size, (const char *)tile->image.pixels[0] + (size_t)i * row, row);
    }
}

static void times_add(const struct tile *tile, struct timing *timing)
{
    const struct work work = tile->imaging.algorithm->work(tile->imaging.plan);
    struct work *sum = &timing->work;
    const double flops = sum->flops + work.flops, pairs = sum->pairs + work.pairs, bytes = fmax(sum->bytes, work.bytes);
    *sum = work;
    sum->flops = flops;
    sum->pairs = pairs;
    sum->bytes = bytes;
    sum->published[0].source = NULL; /* this one tile's, as what is left out */
    *sum->skipped = '\0';
    timing->plan_s += tile->imaging.plan_s;
    timing->run_s += tile->run_s;
    for (int k = 0; k < tile->stages.count; k++)
        stages_add(&timing->stages, tile->stages.stage[k].name, tile->stages.stage[k].seconds);
}

static enum status tiles_measure(const struct spec *spec, const struct spec *exact, const struct scene *scene,
                                 struct tiled_image *tiled)
{
    struct tile_echoes held;
    struct probe probe = {.count = 0};
    enum status status = tile_echoes_open(scene, spec->precision, &held);
    for (int n = 0; n < tiles_count(&tiled->tiles) && status == STATUS_OK; n++) {
        struct tile tile;
        status = tile_form(spec, scene, &held, &tiled->tiles, n, &tile);
        if (status != STATUS_OK)
            break;
        pixels_take(&tile, &tiled->image);
        times_add(&tile, &tiled->timing);
        status = tile_probe(exact, scene, &held, &tile, &probe);
        tile_free(&tile);
    }
    if (status == STATUS_OK)
        tiled->error = probe_measure(&probe, &tiled->image);
    probe_free(&probe);
    tile_echoes_close(&held);
    return status;
}

enum status tiled_measure(const struct spec *spec, const struct scene *scene, double memory, struct tiled_image *tiled)
{
    const struct grid *grid = &scene->patches[0];
    const double whole = (double)grid_pixels(grid) * (double)precision_size(spec->precision);
    struct spec exact;
    struct tile_cost cost;
    *tiled =
        (struct tiled_image){.tiles = {.grid = *grid, .precision = spec->precision},
                             .timing = {.runs = 1, .run_q1_s = NAN, .run_q3_s = NAN, .waited = NAN, .control_s = NAN}};
    enum status status = tiled_check("run", spec, scene);
    if (status == STATUS_OK && !(memory > whole))
        status = status_set(STATUS_UNSUPPORTED,
                            "run: --memory: the whole image of %.4g MB is kept for its metrics; "
                            "%.4g MB are wanted (cure: `image --memory`, which measures nothing)",
                            1e-6 * whole, 1e-6 * memory);
    if (status == STATUS_OK)
        status = tile_choose(spec, scene, memory - whole, &tiled->tiles, &cost);
    if (status == STATUS_OK)
        status = image_allocate(1, grid, spec->precision, &tiled->image);
    if (status != STATUS_OK)
        return status;
    status = spec_parse(spec->precision == PRECISION_DOUBLE ? "reference:precision=double" : "reference", &exact);
    if (status == STATUS_OK) {
        status = tiles_measure(spec, &exact, scene, tiled);
        spec_free(&exact);
    }
    tiled->timing.run_min_s = tiled->timing.spent_s = tiled->timing.run_s;
    if (status != STATUS_OK)
        image_free(&tiled->image);
    return status;
}
