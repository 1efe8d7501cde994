/* Back projection on a uniform straight track whose ping spacing is a whole number of azimuth steps: the geometry
   repeats from ping to ping, so that tables of one row serve all its columns (invariant/row.h). Traces are stored with
   pings contiguous, some receivers at a time; one thread sums each image row in a fixed order. Cost: 8 FLOPs a pair
   (nearest), tables of ratio x shifts entries for each row and receiver. */
#include <math.h>
#include <omp.h>
#include <string.h>

#include "backprojection/invariant/invariant_plan.h"
#include "common/memory.h"
#include "common/progress.h"

enum { ROWS_SUMMED = 4 /* image rows of one task */ };

/* The place of a tile of pings in the slab. */
struct tile_place {
    int receiver, ping, count;
};

/* The record of the raster's ping p to receiver m: pings are taken from the last to the first where they sail back. */
static size_t record_of(const struct bp *bp, int p, int m)
{
    const struct acquisition *a = bp->problem.acquisition;
    const struct invariant *in = bp->state;
    return (size_t)(in->reversed ? a->pings - 1 - p : p) * (size_t)a->receivers + (size_t)m;
}

/* A tile of `count` pings from `ping` on into every `every`-th row of a receiver's part of the slab, from row
   `first` on: the samples of one branch or fine step. */
static void scatter(const struct bp *bp, const void *tile, size_t pitch, size_t samples, size_t first, size_t every,
                    const struct tile_place *place)
{
    const struct invariant *in = bp->state;
    const size_t stride = (size_t)in->slab.ping_stride, size = real_size(bp->problem.precision);
    const size_t at = ((size_t)place->receiver * in->slab.receiver_stride + first * stride + (size_t)in->slab.lead
                       + (size_t)place->ping)
                      * size;
    in->scatter(
        &(struct bp_scattering){samples, pitch, every * stride, (char *)in->slab_re + at, (char *)in->slab_im + at},
        tile, place->count);
}

/* Is any of `count` pings of the raster from `ping` on in a pair? The slab stays zero for others. */
static bool tile_met(const struct bp *bp, int ping, int count)
{
    const int receivers = bp->problem.acquisition->receivers;
    bool met = false;
    for (int p = ping; p < ping + count && !met; p++)
        met = bp_met(bp, (int)(record_of(bp, p, 0) / (size_t)receivers));
    return met;
}

/* Compress a tile's pings of record m, whole rows with their guards: row i branches + n is sample i of branch n. */
static void fill_rows(const struct bp *bp, const struct echoes *echoes, int m, const struct tile_place *place)
{
    const struct invariant *in = bp->state;
    const size_t length = (size_t)bp->shape.length, branches = (size_t)bp->shape.branches, pitch = branches * length;
    const size_t bytes = 2 * real_size(bp->problem.precision);
    const int thread = omp_get_thread_num();
    char *tile = (char *)in->tiles + (size_t)thread * in->tile_bytes;
    for (int p = 0; p < place->count; p++) {
        char *row = tile + (size_t)p * pitch * bytes;
        if (tile_met(bp, place->ping + p, 1))
            traces_of(bp->problem.precision)
                ->fill(bp->traces, thread, bp_record(bp, echoes, record_of(bp, place->ping + p, m)), row);
        else
            memset(row, 0, pitch * bytes);
    }
    for (size_t n = 0; n < branches; n++)
        scatter(bp, tile + n * length * bytes, pitch, length, n, branches, place);
}

/* The same of the fine steps that the slab holds, each from a transform of its own into rows of its own. */
static void fill_steps(const struct bp *bp, const struct echoes *echoes, int m, const struct tile_place *place)
{
    const struct invariant *in = bp->state;
    const size_t bytes = bp->shape.pitch * 2 * real_size(bp->problem.precision);
    const size_t samples = (size_t)bp->shape.samples;
    const struct traces_build *traces = traces_of(bp->problem.precision);
    const size_t begin = (size_t)(bp->shape.first - bp->shape.from) * 2 * real_size(bp->problem.precision);
    const int thread = omp_get_thread_num();
    char *spectra = (char *)in->tiles + (size_t)thread * in->tile_bytes, *tile = spectra + TILE * bytes;
    for (int p = 0; p < place->count; p++)
        if (tile_met(bp, place->ping + p, 1))
            traces->spectrum(bp->traces, thread, bp_record(bp, echoes, record_of(bp, place->ping + p, m)),
                             spectra + (size_t)p * bytes);
    for (int k = 0; k < in->slab.step_count && in->slab.step_first + k < bp->table.upsample; k++) {
        for (int p = 0; p < place->count; p++)
            if (tile_met(bp, place->ping + p, 1))
                traces->plane(bp->traces, thread, spectra + (size_t)p * bytes, in->slab.step_first + k,
                              tile + (size_t)p * bytes);
            else
                memset(tile + (size_t)p * bytes, 0, bytes);
        scatter(bp, tile + begin, bp->shape.pitch, samples, (size_t)k * samples, 1, place);
    }
}

/* Compress receivers [first, first + count) into the slab. */
static void fill_slab(const struct bp *bp, const struct echoes *echoes, int first, int count)
{
    int pings = bp->problem.acquisition->pings;
    int tiles = (pings + TILE - 1) / TILE;
#pragma omp parallel for schedule(dynamic)
    for (int n = 0; n < count * tiles; n++) {
        const int g = n / tiles, ping = n % tiles * TILE, left = pings - ping;
        const struct tile_place place = {g, ping, left < TILE ? left : TILE};
        if (tile_met(bp, ping, place.count))
            (bp_whole(&bp->table) ? fill_rows : fill_steps)(bp, echoes, first + g, &place);
    }
}

static size_t row_values(const struct invariant *in, int k)
{
    const struct bp_raster *raster = &in->rasters[k];
    return (size_t)raster_residues(raster) * (size_t)in->strides[k];
}

/* Add the slab's receivers to all rows of patch k. */
static void sum_rows(const struct bp *bp, int k, int first, int count)
{
    const struct invariant *in = bp->state;
    const struct grid *grid = &bp->problem.patches[k];
    const struct pixel_window window = problem_window(&bp->problem, k);
    const size_t size = real_size(bp->problem.precision), values = row_values(in, k);
    const size_t half = values * (size_t)window.rows;
    struct bp_slab slab = in->slab;
    slab.re = in->slab_re;
    slab.im = in->slab_im;
    const int end = window.row + window.rows, threads = omp_get_max_threads();
    const int share = (window.rows + threads - 1) / threads; /* of a thread: few rows are work for all */
    const int together = in->rasters[k].rows < share ? in->rasters[k].rows : share;
#pragma omp parallel for schedule(dynamic, (ROWS_SUMMED + together - 1) / together)
    for (int row = window.row; row < end; row += together) {
        struct bp_row rows[BP_ROWS_MOST];
        int taken = 0;
        for (int i = row; i < end && i < row + together; i++) {
            char *re = (char *)in->sums[k] + (size_t)(i - window.row) * values * size;
            rows[taken] = (struct bp_row){.medium = &bp->medium,
                                          .table = &bp->table,
                                          .raster = &in->rasters[k],
                                          .slab = &slab,
                                          .r = grid->r_first + i * grid->r_step,
                                          .receivers = count,
                                          .offsets = in->offsets + first,
                                          .scratch = &in->scratch[omp_get_thread_num() * in->rows + taken],
                                          .re = re,
                                          .im = re + half * size,
                                          .stride = in->strides[k]};
            taken += progress_step();
        }
        if (taken > 0)
            in->row(rows, taken);
    }
}

/* The sums [r][rho][j] into the pixels [r][rho + ratio j]. */
static void store(const struct bp *bp, int k, void *pixels)
{
    const struct invariant *in = bp->state;
    const struct pixel_window window = problem_window(&bp->problem, k);
    size_t values = row_values(in, k), half = values * (size_t)window.rows, columns = (size_t)window.columns;
    size_t ratio = (size_t)in->rasters[k].ratio, stride = (size_t)in->strides[k];
    const size_t stored = (size_t)in->rasters[k].stored;
    bool is_double = bp->problem.precision == PRECISION_DOUBLE;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < (size_t)window.rows; i++)
        for (size_t j = 0; j < columns; j++) {
            size_t n = (size_t)window.column + j, to = 2 * (i * columns + j);
            size_t from = i * values + n % ratio * stride + n / ratio - stored;
            if (is_double) {
                ((double *)pixels)[to] = ((const double *)in->sums[k])[from];
                ((double *)pixels)[to + 1] = ((const double *)in->sums[k])[half + from];
            } else {
                ((float *)pixels)[to] = ((const float *)in->sums[k])[from];
                ((float *)pixels)[to + 1] = ((const float *)in->sums[k])[half + from];
            }
        }
}

static void invariant_execute(struct bp *bp, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    struct invariant *in = bp->state;
    const int receivers = bp->problem.acquisition->receivers;
    const size_t size = real_size(bp->problem.precision);
    for (int k = 0; k < in->patch_count; k++)
        memory_clear(in->sums[k], 2 * row_values(in, k) * (size_t)problem_window(&bp->problem, k).rows * size);
    stages_end(stages, "clear");
    for (int first = 0; first < receivers; first += in->receivers) {
        int count = receivers - first < in->receivers ? receivers - first : in->receivers;
        for (int pass = 0; pass < in->passes; pass++) {
            in->slab.step_first = pass * in->slab.step_count;
            fill_slab(bp, echoes, first, count);
            stages_end(stages, "compress");
            const double passes = ceil((double)receivers / in->receivers) * in->passes,
                         done = first / in->receivers * in->passes + pass;
            for (int k = 0; k < in->patch_count; k++) {
                const double sums = passes * in->patch_count, sum = done * in->patch_count + k;
                progress_part(sum / sums, (sum + 1) / sums, problem_window(&bp->problem, k).rows);
                sum_rows(bp, k, first, count);
            }
            stages_end(stages, "focus");
        }
    }
    for (int k = 0; k < in->patch_count; k++)
        store(bp, k, image->pixels[k]);
    stages_end(stages, "store");
}

/* A group of residues has entries up to one ping spacing outside the aperture of some; a row is proved to lie inside
   the samples by the farthest receiver and another spacing. */
static double invariant_beside(const struct bp *bp)
{
    const struct problem *problem = &bp->problem;
    const struct acquisition *a = problem->acquisition;
    double spacing = a->pings > 1 ? fabs(a->tx[1].x - a->tx[0].x) : 0, offset = 0;
    for (int m = 0; m < a->receivers; m++)
        offset = fmax(offset, fabs(a->rx[m].x - a->tx[0].x));
    for (int k = 0; k < problem->patch_count && a->pings == 1; k++)
        spacing = fmax(spacing, problem->patches[k].x_count * problem->patches[k].x_step);
    return 2 * (spacing + offset);
}

const struct bp_engine bp_invariant = {
    .name = "invariant",
    .applicable = invariant_applicable,
    .units = invariant_units,
    .beside = invariant_beside,
    .plan = invariant_plan,
    .execute = invariant_execute,
};
