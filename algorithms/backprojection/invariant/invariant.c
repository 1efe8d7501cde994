/* Back projection on a uniform straight track whose ping spacing is a whole number of azimuth steps: the geometry
   repeats itself from ping to ping, so that tables of one row serve all its columns (invariant/row.h). Traces are laid
   out with pings contiguous, some receivers at a time; each image row is summed by one thread in a fixed order. Cost: 8
   FLOPs a pair (nearest), tables of ratio x shifts entries for each row and receiver. */
#include <omp.h>
#include <string.h>

#include "backprojection/invariant/plan.h"

enum {
    ROWS_FILLED = 16, /* rows of the slab that are filled together */
    ROWS_SUMMED = 4   /* image rows of one task */
};

/* Scatter a tile of compressed pings, complex [count][branches][length], into the slab: pings contiguous. In blocks
   of rows, so that each cache line of the slab is filled while it is near. */
#define SCATTER(real)                                                                                                  \
    do {                                                                                                               \
        const real *from = (const real *)tile;                                                                         \
        real *re = (real *)in->slab_re + base, *im = (real *)in->slab_im + base;                                       \
        for (size_t i = 0; i < in->slab_rows; i += ROWS_FILLED) {                                                      \
            size_t at[ROWS_FILLED], rows = in->slab_rows - i < ROWS_FILLED ? in->slab_rows - i : ROWS_FILLED;          \
            for (size_t k = 0; k < rows; k++) {                                                                        \
                at[k] = branch * length + source;                                                                      \
                if (++branch < branches)                                                                               \
                    continue;                                                                                          \
                branch = 0;                                                                                            \
                if (++within == width) { /* on to the next sample of the steps of the slab */                          \
                    within = 0;                                                                                        \
                    source += upsample - width;                                                                        \
                }                                                                                                      \
                source++;                                                                                              \
            }                                                                                                          \
            for (size_t p = 0; p < (size_t)count; p++)                                                                 \
                for (size_t k = 0; k < rows; k++) {                                                                    \
                    size_t value = 2 * (p * branches * length + (at[k] < last ? at[k] : last));                        \
                    re[(i + k) * stride + p] = from[value];                                                            \
                    im[(i + k) * stride + p] = from[value + 1];                                                        \
                }                                                                                                      \
        }                                                                                                              \
    } while (0)

static void scatter(const struct bp *bp, const void *tile, int receiver, int ping, int count)
{
    const struct invariant *in = bp->state;
    size_t upsample = (size_t)bp->table.upsample, guard = (size_t)bp->table.guard, length = (size_t)bp->shape.length;
    size_t branches = (size_t)bp->table.branches, branch = 0;
    size_t stride = (size_t)in->slab.ping_stride, width = (size_t)in->slab.step_count,
           step = (size_t)in->slab.step_first;
    size_t base = (size_t)receiver * in->slab.receiver_stride + (size_t)in->slab.lead + (size_t)ping;
    const size_t last = branches * length - 1;
    /* Upsampled traces leave the guards out; residues past the last sample repeat the end and are never asked for. */
    size_t source = upsample == 1 || branches > 1 ? 0 : guard + step, within = 0;
    if (bp->problem.precision == PRECISION_DOUBLE)
        SCATTER(double);
    else
        SCATTER(float);
}

/* Compress receivers [first, first + count) into the slab. */
static void fill_slab(const struct bp *bp, const struct echoes *echoes, int first, int count)
{
    const struct invariant *in = bp->state;
    int pings = bp->problem.acquisition->pings, receivers = bp->problem.acquisition->receivers;
    int tiles = (pings + TILE - 1) / TILE;
    size_t row_bytes = (size_t)bp->shape.branches * (size_t)bp->shape.length * 2 * real_size(bp->problem.precision);
#pragma omp parallel for schedule(dynamic)
    for (int n = 0; n < count * tiles; n++) {
        int g = n / tiles, begin = n % tiles * TILE, end = begin + TILE < pings ? begin + TILE : pings;
        int thread = omp_get_thread_num();
        char *tile = (char *)in->tiles + (size_t)thread * TILE * row_bytes;
        for (int p = begin; p < end; p++) {
            int ping = in->reversed ? pings - 1 - p : p;
            bp_fill_row(bp, thread, echoes, (size_t)ping * (size_t)receivers + (size_t)(first + g),
                        tile + (size_t)(p - begin) * row_bytes);
        }
        scatter(bp, tile, g, begin, end - begin);
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
    size_t size = real_size(bp->problem.precision), values = row_values(in, k), half = values * (size_t)grid->r_count;
    struct bp_slab slab = in->slab;
    slab.re = in->slab_re;
    slab.im = in->slab_im;
#pragma omp parallel for schedule(dynamic, ROWS_SUMMED)
    for (int i = 0; i < grid->r_count; i++) {
        char *re = (char *)in->sums[k] + (size_t)i * values * size;
        const struct bp_row row = {.medium = &bp->medium,
                                   .table = &bp->table,
                                   .raster = &in->rasters[k],
                                   .slab = &slab,
                                   .r = grid->r_first + i * grid->r_step,
                                   .receivers = count,
                                   .offsets = in->offsets + first,
                                   .scratch = &in->scratch[omp_get_thread_num()],
                                   .re = re,
                                   .im = re + half * size,
                                   .stride = in->strides[k]};
        in->row(&row);
    }
}

/* The sums [r][rho][j] into the pixels [r][rho + ratio j]. */
static void store(const struct bp *bp, int k, void *pixels)
{
    const struct invariant *in = bp->state;
    const struct grid *grid = &bp->problem.patches[k];
    size_t values = row_values(in, k), half = values * (size_t)grid->r_count, nx = (size_t)grid->x_count;
    size_t ratio = (size_t)in->rasters[k].ratio, stride = (size_t)in->strides[k];
    bool is_double = bp->problem.precision == PRECISION_DOUBLE;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < (size_t)grid->r_count; i++)
        for (size_t n = 0; n < nx; n++) {
            size_t from = i * values + n % ratio * stride + n / ratio, to = 2 * (i * nx + n);
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
    int receivers = bp->problem.acquisition->receivers;
    size_t size = real_size(bp->problem.precision), slab = (size_t)in->receivers * in->slab.receiver_stride * size;
    for (int k = 0; k < in->patch_count; k++)
        memset(in->sums[k], 0, 2 * row_values(in, k) * (size_t)bp->problem.patches[k].r_count * size);
    memset(in->slab_re, 0, slab); /* the lead and the end of each row stay zero */
    memset(in->slab_im, 0, slab);
    stages_end(stages, "clear");
    for (int first = 0; first < receivers; first += in->receivers) {
        int count = receivers - first < in->receivers ? receivers - first : in->receivers;
        for (int pass = 0; pass < in->passes; pass++) {
            in->slab.step_first = pass * in->slab.step_count;
            fill_slab(bp, echoes, first, count);
            stages_end(stages, "compress");
            for (int k = 0; k < in->patch_count; k++)
                sum_rows(bp, k, first, count);
            stages_end(stages, "focus");
        }
    }
    for (int k = 0; k < in->patch_count; k++)
        store(bp, k, image->pixels[k]);
    stages_end(stages, "store");
}

const struct bp_engine bp_invariant = {
    .name = "invariant",
    .applicable = invariant_applicable,
    .plan = invariant_plan,
    .execute = invariant_execute,
    .destroy = invariant_destroy,
};
