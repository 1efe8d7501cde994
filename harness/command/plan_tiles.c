#include "command/plan_tiles.h"

#include <math.h>
#include <stdio.h>

#include "choice/process.h"
#include "show/table.h"

bool plan_is_tiled(const struct scene *scene, double bytes)
{
    const struct problem problem = scene_problem(scene, PRECISION_FLOAT);
    return scene->patch_count == 1 && process_bytes(&problem, 0) > bytes;
}

/* ---- one tile for all ---- */

/* As if the tile were all of the image, and its pings all of the track. */
static enum status tile_plan(const struct scene *scene, const struct budget *budget, bool both,
                             const struct tiled *tiled, struct planned *planned)
{
    const struct pixel_window window = tile_dearest(&scene->acquisition, &tiled->tiles);
    const int first = tiled->cost.first, pings = tiled->cost.last - first + 1;
    struct grid grid = grid_part(scene->patches, &window);
    struct scene part = *scene;
    struct acquisition flown;
    struct budget own = *budget;
    own.bytes = INFINITY; /* tile_choose holds it */
    own.windows = true;
    part.patches = &grid;
    part.acquisition = acquisition_part(&scene->acquisition, first, pings);
    part.recording.first = first;
    if (scene->flown) {
        flown = acquisition_part(scene->flown, first, pings);
        part.flown = &flown;
    }
    const enum status status = planned_make(&part, &own, both, planned);
    planned->scene = scene;
    planned->budget = *budget;
    return status;
}

static const struct choice *chosen(const struct planned *planned)
{
    return &planned->choices[planned_precision(planned)];
}

static enum status chosen_spec(const struct planned *planned, struct spec *spec)
{
    return choice_spec(chosen(planned), &planned->budget, (enum precision)planned_precision(planned), spec);
}

/* From the tile that was planned to all tiles of the chosen setting. */
static void planned_scale(struct planned *planned, const struct tiled *tiled)
{
    const struct choice *choice = chosen(planned);
    const double times = tiled->cost.flops * tiles_count(&tiled->tiles) / choice->work.flops;
    choice->list[0].bytes = tiled->cost.bytes;
    for (int precision = 0; precision < 2; precision++)
        for (int k = 0; k < planned->choices[precision].count; k++) {
            struct candidate *c = &planned->choices[precision].list[k];
            c->seconds *= times;
            c->flops *= times;
            c->pairs *= times;
        }
}

/* Tiles of the chosen setting. Ahead of it, the planned tile is one of the setting that needs the least memory. */
static enum status tiles_make(const struct scene *scene, const struct budget *budget, bool both,
                              struct planned *planned, struct tiled *tiled)
{
    struct spec spec;
    tiled->tiles.grid = scene->patches[0];
    enum status status = spec_parse("bp_nearest", &spec);
    if (status != STATUS_OK)
        return status;
    status = tile_choose(&spec, scene, budget->bytes, &tiled->tiles, &tiled->cost);
    spec_free(&spec);
    if (status == STATUS_OK && tiled->cost.pings == 0)
        status = status_set(STATUS_UNSUPPORTED, "no ping of %s meets the middle of the image", scene->name);
    if (status == STATUS_OK)
        status = tile_plan(scene, budget, both, tiled, planned);
    if (status != STATUS_OK || planned_precision(planned) < 0)
        return status;
    status = chosen_spec(planned, &spec);
    if (status != STATUS_OK)
        return status;
    tiled->tiles.precision = spec.precision;
    status = tile_choose(&spec, scene, budget->bytes, &tiled->tiles, &tiled->cost);
    spec_free(&spec);
    if (status == STATUS_OK) {
        tiled->flop_s = chosen(planned)->list[0].seconds / chosen(planned)->work.flops;
        planned_scale(planned, tiled);
    }
    return status;
}

enum status plan_make(const struct scene *scene, const struct budget *budget, bool both, struct planned *planned,
                      struct tiled *tiled)
{
    *planned = (struct planned){.scene = scene, .budget = *budget};
    *tiled = (struct tiled){.flop_s = NAN};
    enum status status;
    if (plan_is_tiled(scene, budget->bytes)) {
        status = tiles_make(scene, budget, both, planned, tiled);
        return status == STATUS_UNSUPPORTED ? status_set(STATUS_FAILED, "plan: %s", status_message()) : status;
    }
    status = planned_make(scene, budget, both, planned);
    if (status == STATUS_OK && planned_precision(planned) >= 0)
        tiled->flop_s = chosen(planned)->list[0].seconds / chosen(planned)->work.flops;
    return status;
}

/* ---- in words ---- */

/* Of the echo file, or of the one that `simulate` would write. */
static double ping_bytes(const struct scene *scene)
{
    const struct acquisition *a = &scene->acquisition;
    return scene->recording.path ? scene->recording.bytes / scene->recording.pings
                                 : (double)a->receivers * a->samples * (double)precision_size(PRECISION_DOUBLE);
}

void tiles_print(const struct scene *scene, const struct tiled *tiled)
{
    const struct tiles *tiles = &tiled->tiles;
    const struct acquisition *a = &scene->acquisition;
    const double ping = ping_bytes(scene), pings = (double)tiled->cost.pings * tiles_count(tiles);
    char text[300];
    snprintf(
        text, sizeof text,
        "In %d tiles of %d x %d pixels (along x, r). Each reads up to %d of %d pings, all of them %s, %.2g times "
        "the echoes, and they write %s.",
        tiles_count(tiles), tiles->columns, tiles->rows, tiled->cost.pings, a->pings,
        cell_significant(1e-9 * ping * pings, " GB").text, pings / a->pings,
        cell_significant(1e-9 * (double)grid_pixels(&tiles->grid) * (double)precision_size(tiles->precision), " GB")
            .text);
    table_text(stdout, 0, text);
}

static enum status node_line(int nodes, const struct spec *spec, const struct scene *scene, const struct tiled *tiled,
                             double *alone)
{
    const struct acquisition *a = &scene->acquisition;
    const struct grid *g = &scene->patches[0];
    struct tiles tiles = tiled->tiles;
    struct tile_cost cost;
    const bool whole = tiles.columns == 0;
    const int share = (g->x_count + nodes - 1) / nodes;
    tiles.grid = *g;
    tiles.precision = spec->precision;
    tiles.rows = whole ? g->r_count : tiles.rows;
    tiles.columns = whole || share < tiles.columns ? share : tiles.columns;
    const enum status status = tile_cost(spec, scene, &tiles, &cost);
    if (status != STATUS_OK)
        return status;
    const int count = tiles_count(&tiles), each = (count + nodes - 1) / nodes;
    const double seconds = each * cost.flops * tiled->flop_s, pings = (double)count * cost.pings;
    const double size = (double)precision_size(spec->precision), pixels = (double)grid_pixels(g);
    const double bytes = pings * ping_bytes(scene) + pixels * size;
    char tile[32];
    *alone = nodes == 1 ? seconds : *alone;
    snprintf(tile, sizeof tile, "%dx%d", tiles.columns, tiles.rows);
    printf("  %5d  %-12s %7d %9s %8.3g %8.3g %9s %9s\n", nodes, tile, each, cell_time(seconds).text, *alone / seconds,
           pings / a->pings, cell_significant(1e-9 * bytes, " GB").text,
           cell_significant(1e-6 * bytes / seconds, " MB/s").text);
    return STATUS_OK;
}

enum status nodes_print(int nodes, const struct scene *scene, const struct planned *planned, const struct tiled *tiled)
{
    struct spec spec;
    double alone = NAN;
    if (scene->patch_count != 1)
        return status_set(STATUS_UNSUPPORTED, "plan: --nodes divides an image of one patch; %s has %d", scene->name,
                          scene->patch_count);
    enum status status = chosen_spec(planned, &spec);
    if (status != STATUS_OK)
        return status;
    puts("On machines such as this one (`faster`: than one; `read`: times the echoes; `files`: read and written, and\n"
         "the rate at which that takes as long as all computing):");
    printf("  %5s  %-12s %7s %9s %8s %8s %9s %9s\n", "nodes", "tile", "each", "time", "faster", "read", "files",
           "rate");
    for (int n = 1; n < nodes && status == STATUS_OK; n *= 2)
        status = node_line(n, &spec, scene, tiled, &alone);
    if (status == STATUS_OK)
        status = node_line(nodes, &spec, scene, tiled, &alone);
    spec_free(&spec);
    return status;
}
