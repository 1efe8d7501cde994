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

/* What a tile of compressed pings becomes in the slab: sample i of branch m, complex value i + m `length` of a ping's
   `pitch`, is row first + (i branches + m) step. */
struct scattering {
    size_t pitch, length, branches, rows; /* rows: of all branches */
    size_t first, step;
};

/* Pings contiguous; in blocks of rows, so that each cache line of the slab is filled while it is near. */
#define SCATTER(real)                                                                                                  \
    do {                                                                                                               \
        const real *from = (const real *)tile;                                                                         \
        real *re = (real *)in->slab_re + base, *im = (real *)in->slab_im + base;                                       \
        for (size_t i = 0, branch = 0, sample = 0; i < s->rows; i += ROWS_FILLED) {                                    \
            size_t at[ROWS_FILLED], rows = s->rows - i < ROWS_FILLED ? s->rows - i : ROWS_FILLED;                      \
            for (size_t k = 0; k < rows; k++) {                                                                        \
                at[k] = branch * s->length + sample;                                                                   \
                branch = branch + 1 < s->branches ? branch + 1 : 0;                                                    \
                sample += branch == 0;                                                                                 \
            }                                                                                                          \
            for (size_t p = 0; p < (size_t)count; p++)                                                                 \
                for (size_t k = 0; k < rows; k++) {                                                                    \
                    const size_t value = 2 * (p * s->pitch + at[k]), to = (i + k) * s->step * stride + p;              \
                    re[to] = from[value];                                                                              \
                    im[to] = from[value + 1];                                                                          \
                }                                                                                                      \
        }                                                                                                              \
    } while (0)

static void scatter(const struct bp *bp, const void *tile, const struct scattering *s, int receiver, int ping,
                    int count)
{
    const struct invariant *in = bp->state;
    const size_t stride = (size_t)in->slab.ping_stride;
    const size_t base =
        (size_t)receiver * in->slab.receiver_stride + s->first * stride + (size_t)in->slab.lead + (size_t)ping;
    if (bp->problem.precision == PRECISION_DOUBLE)
        SCATTER(double);
    else
        SCATTER(float);
}

/* Compress pings [begin, end) of slab's receiver g, record m, whole rows with their guards. */
static void fill_rows(const struct bp *bp, const struct echoes *echoes, int m, int g, int begin, int end)
{
    const struct invariant *in = bp->state;
    const size_t length = (size_t)bp->shape.length, branches = (size_t)bp->shape.branches;
    const struct scattering whole = {branches * length, length, branches, in->slab_rows, 0, 1};
    const int pings = bp->problem.acquisition->pings, receivers = bp->problem.acquisition->receivers;
    const int thread = omp_get_thread_num();
    char *tile = (char *)in->tiles + (size_t)thread * in->tile_bytes;
    for (int p = begin; p < end; p++) {
        int ping = in->reversed ? pings - 1 - p : p;
        bp_fill_row(bp, thread, echoes, (size_t)ping * (size_t)receivers + (size_t)m,
                    tile + (size_t)(p - begin) * whole.pitch * 2 * real_size(bp->problem.precision));
    }
    scatter(bp, tile, &whole, g, begin, end - begin);
}

/* The same of the fine steps that the slab holds, each from a transform of its own. */
static void fill_steps(const struct bp *bp, const struct echoes *echoes, int m, int g, int begin, int end)
{
    const struct invariant *in = bp->state;
    const int pings = bp->problem.acquisition->pings, receivers = bp->problem.acquisition->receivers;
    const size_t pitch = bp->shape.pitch, bytes = pitch * 2 * real_size(bp->problem.precision);
    const size_t samples = (size_t)bp->shape.samples;
    char *spectra = (char *)in->tiles + (size_t)omp_get_thread_num() * in->tile_bytes, *tile = spectra + TILE * bytes;
    for (int p = begin; p < end; p++) {
        int ping = in->reversed ? pings - 1 - p : p;
        bp_fill_spectrum(bp, echoes, (size_t)ping * (size_t)receivers + (size_t)m,
                         spectra + (size_t)(p - begin) * bytes);
    }
    for (int k = 0; k < in->slab.step_count && in->slab.step_first + k < bp->table.upsample; k++) {
        const struct scattering step = {pitch, 0, 1, samples, (size_t)k, (size_t)in->slab.step_count};
        for (int p = 0; p < end - begin; p++)
            bp_fill_plane(bp, spectra + (size_t)p * bytes, in->slab.step_first + k, tile + (size_t)p * bytes);
        scatter(bp, tile, &step, g, begin, end - begin);
    }
}

/* Compress receivers [first, first + count) into the slab. */
static void fill_slab(const struct bp *bp, const struct echoes *echoes, int first, int count)
{
    int pings = bp->problem.acquisition->pings;
    int tiles = (pings + TILE - 1) / TILE;
#pragma omp parallel for schedule(dynamic)
    for (int n = 0; n < count * tiles; n++) {
        int g = n / tiles, begin = n % tiles * TILE, end = begin + TILE < pings ? begin + TILE : pings;
        (bp_whole(&bp->table) ? fill_rows : fill_steps)(bp, echoes, first + g, g, begin, end);
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
