/* Back projection on a uniform straight track whose ping spacing is a whole number of azimuth steps: the geometry repeats
   itself from ping to ping, so that tables of one row serve all its columns (invariant/row.c). Records are laid out with pings
   contiguous, some receivers at a time; each image row is summed by one thread in a fixed order. Cost: 8 FLOPs a pair
   (nearest), tables of ratio x shifts entries for each row and receiver. */
#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/engine.h"
#include "backprojection/invariant/row.h"
#include "backprojection/pairs.h"

enum {
    SLAB_BYTES = 64 << 20, /* receivers are taken together up to this: the image is read and written for each slab */
    READ_BYTES = 4 << 20,  /* and as long as what one row of the image reads of them stays in the shared cache */
    SLAB_MOST = 128 << 20, /* one receiver's upsampled records: beyond it their phases are taken in passes */
    TILE = 16,             /* pings compressed together: one cache line of each fine sample */
    BLOCK = 16,            /* rows of the slab that are filled together */
    ROWS = 4,              /* image rows of one task */
    GROUP = 1024           /* entries of the tables that are made at once */
};

struct invariant {
    bp_row_function *row;
    struct bp_raster *rasters;      /* [patch_count] */
    double *offsets;                /* [receivers] m ahead of the transmitter */
    bool reversed;                  /* the sonar sails towards -x: pings are taken from the last to the first */
    struct bp_slab slab;            /* phase: of the current pass */
    size_t slab_rows;               /* of one receiver, at the most */
    int receivers;                  /* of one pass */
    int passes;                     /* over the phases of the upsampled records, which bound the slab's size */
    void *slab_re, *slab_im;        /* real [receivers][slab_rows][ping_stride] */
    void *tiles;                    /* complex [threads][TILE][shape.length] */
    struct bp_row_scratch *scratch; /* [threads], all in `tables` */
    void *tables;
    int patch_count;
    int *strides; /* [patch_count] */
    void **sums;  /* [patch_count]: re then im, real [r_count][ratio][stride] */
};

static bp_row_function *const row_functions[][2] = {
    [ISA_BASELINE] = {bp_row_float_baseline, bp_row_double_baseline},
#ifdef SASBENCH_X86_64
    [ISA_V3] = {bp_row_float_v3, bp_row_double_v3},
    [ISA_V4] = {bp_row_float_v4, bp_row_double_v4},
#endif
};

static int round_up(int value, int multiple)
{
    return (value + multiple - 1) / multiple * multiple;
}

/* s: by how much ideal delays may differ from real ones: 1e-7 of a turn, which bounds the phase by 1e-6 rad, and of a sample. */
static double tolerance(const struct acquisition *a)
{
    return 1e-7 / fmax(a->fc, a->fs);
}

/* The patch on the track's raster. The grid's and the pings' places must agree over the whole track. */
static enum status raster_make(const struct bp *bp, const struct straight_track *track, const struct grid *grid,
                               struct bp_raster *raster)
{
    const struct acquisition *a = bp->problem.acquisition;
    double spacing = fabs(track->spacing), steps = spacing / grid->x_step;
    double ratio = floor(steps + 0.5);
    if (a->pings == 1) /* every column is a phase of its own */
        ratio = grid->x_count;
    else if (!(ratio >= 1 && ratio <= INT_MAX)
             || !(fabs(spacing - ratio * grid->x_step) * (a->pings + grid->x_count / ratio)
                  < a->sound_speed * tolerance(a)))
        return status_set(STATUS_UNSUPPORTED, "the ping spacing %g m is %.9g azimuth steps, must be a whole number",
                          spacing, steps);
    if (!(grid->x_count + ratio + a->pings < INT_MAX / 2))
        return status_set(STATUS_UNSUPPORTED, "%d columns, of which %.0f are a ping spacing, are too many to index",
                          grid->x_count, ratio);
    *raster = (struct bp_raster){.x_first = track->spacing < 0 ? a->tx[a->pings - 1].x : a->tx[0].x,
                                 .spacing = a->pings == 1 ? grid->x_step * grid->x_count : spacing,
                                 .pings = a->pings,
                                 .speed = track->speed,
                                 .t0 = a->t0[0],
                                 .ratio = (int)ratio,
                                 .grid_first = grid->x_first,
                                 .grid_step = grid->x_step,
                                 .columns = grid->x_count,
                                 .blocks = (grid->x_count + (int)ratio - 1) / (int)ratio,
                                 .limit = a->aperture_limit};
    return STATUS_OK;
}

/* By how many metres a ping lies beside the ideal one that the tables hold, or its echoes beside theirs. */
static double ping_beside(const struct acquisition *a, const struct straight_track *track, int p)
{
    const double c = a->sound_speed, longest = fmax(fabs(a->t0[p]), fabs(a->t0[p] + (a->samples - 1) / a->fs));
    const struct vector v = a->velocity[p];
    double off = fmax(fmax(fabs(a->tx[p].y), fabs(a->tx[p].z)), fabs(a->tx[p].x - a->tx[0].x - p * track->spacing));
    off = fmax(off, c * fabs(a->t0[p] - a->t0[0]));
    off = fmax(off, longest * fmax(fabs(v.x - track->speed), fmax(fabs(v.y), fabs(v.z))));
    for (int m = 0; m < a->receivers; m++) {
        struct vector rx = a->rx[(size_t)p * (size_t)a->receivers + (size_t)m];
        off = fmax(off, fmax(fabs(rx.y), fabs(rx.z)));
        off = fmax(off, fabs(rx.x - a->tx[p].x - (a->rx[m].x - a->tx[0].x)));
    }
    return off;
}

static enum status invariant_applicable(const struct bp *bp)
{
    const struct acquisition *a = bp->problem.acquisition;
    struct straight_track track;
    struct bp_raster raster;
    if (bp->table.taps > 1 && bp->table.upsample > 1)
        return status_set(STATUS_UNSUPPORTED, "a kernel over upsampled records has no tables");
    if (!acquisition_is_straight(a, &track))
        return status_set(STATUS_UNSUPPORTED, "the track is not uniform and straight");
    for (int p = 0; p < a->pings; p++) {
        double off = ping_beside(a, &track, p);
        if (!(off < a->sound_speed * tolerance(a)))
            return status_set(STATUS_UNSUPPORTED,
                              "ping %d, its start of record or its velocity is %.3g m off a uniform "
                              "straight track, must be below %.3g m",
                              p + 1, off, a->sound_speed * tolerance(a));
    }
    for (int k = 0; k < bp->problem.patch_count; k++) {
        enum status status = raster_make(bp, &track, &bp->problem.patches[k], &raster);
        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

static void invariant_destroy(void *state)
{
    struct invariant *in = state;
    if (!in)
        return;
    for (int k = 0; in->sums && k < in->patch_count; k++)
        free(in->sums[k]);
    free(in->sums);
    free(in->strides);
    free(in->tables);
    free(in->scratch);
    free(in->tiles);
    free(in->slab_im);
    free(in->slab_re);
    free(in->offsets);
    free(in->rasters);
    free(in);
}

static void *allocate(size_t bytes, double *total)
{
    *total += (double)bytes;
    return aligned_alloc(64, (bytes + 63) / 64 * 64);
}

/* The largest distance along the track between a ping and a pixel at r that are a pair. */
static double reach(const struct bp_raster *raster, const struct grid *grid, double r)
{
    const double last_ping = raster->x_first + (raster->pings - 1) * raster->spacing, limit = raster->limit;
    const double last_column = grid->x_first + (grid->x_count - 1) * grid->x_step;
    const double most = fabs(fmax(last_ping - grid->x_first, last_column - raster->x_first));
    return limit < 1 ? fmin(most, r * limit / sqrt((1 - limit) * (1 + limit))) : most;
}

/* The least and the largest distance between a row of the grid and the track, whose side is no matter. */
static void row_ranges(const struct grid *grid, double r[2])
{
    const double first = grid->r_first, last = first + (grid->r_count - 1) * grid->r_step;
    r[0] = first < 0 && last > 0 ? 0 : fmin(fabs(first), fabs(last));
    r[1] = fmax(fabs(first), fabs(last));
}

/* The most samples of a record that one row of a patch reads: those between its nearest and its furthest pixel. */
static double samples_read(const struct bp *bp, const struct bp_raster *raster, const struct grid *grid)
{
    double samples = 0, r[2];
    row_ranges(grid, r);
    for (int end = 0; end < 2; end++) {
        double x = reach(raster, grid, r[end]);
        samples = fmax(samples, 2 * (sqrt(r[end] * r[end] + x * x) - r[end]) / bp->medium.sound_speed * bp->medium.fs);
    }
    return samples + bp->table.taps;
}

/* The most samples by which the delay changes over one azimuth step, of any pair inside the aperture or one ping spacing
   outside it: those of the row nearest to the track. */
static double steepness(const struct bp *bp, const struct bp_raster *raster, const struct grid *grid)
{
    const struct invariant *in = bp->state;
    const double c = bp->medium.sound_speed, v = fabs(raster->speed), e = (c - v) * (c + v);
    double offset = 0, ranges[2];
    for (int m = 0; m < bp->problem.acquisition->receivers; m++)
        offset = fmax(offset, fabs(in->offsets[m]));
    row_ranges(grid, ranges);
    const double r = ranges[0], x = reach(raster, grid, r) + raster->spacing, leg = sqrt(x * x + r * r);
    const double b = x + offset + v * leg / c, sine = x / leg, back = b / sqrt(b * b + e / (c * c) * r * r);
    return (sine / c + (v + c * back) / e * (1 + v / c * sine)) * grid->x_step * bp->medium.fs;
}

/* Neighbouring phases that are summed together. Of up to two taps, two where they mostly read the same samples; of more
   taps, as many as keep their samples within BP_SPREAD, rounding included. */
static int phases_together(const struct bp *bp, double steepness)
{
    if (bp->table.upsample > 1)
        return 1;
    if (bp->table.taps < 3)
        return steepness <= 0.5 ? 2 : 1;
    return (int)fmin(BP_TOGETHER, 1 + floor((BP_SPREAD - 1) / steepness));
}

/* Rows and receivers of the slab, and the passes that keep it small however much the records are upsampled. */
static void shape_slab(struct bp *bp, struct invariant *in, double read, int lead, int ping_stride)
{
    int upsample = bp->table.upsample, samples = bp->shape.samples;
    size_t row_bytes = (size_t)ping_stride * 2 * real_size(bp->problem.precision);
    size_t rows = upsample == 1 ? (size_t)bp->shape.length : (size_t)samples; /* of one phase */
    int width = (int)fmin(upsample, fmax(1, floor((double)SLAB_MOST / (double)(rows * row_bytes))));
    in->passes = (upsample + width - 1) / width;
    in->slab_rows = rows * (size_t)width;
    in->slab = (struct bp_slab){.receiver_stride = in->slab_rows * (size_t)ping_stride,
                                .ping_stride = ping_stride,
                                .lead = lead,
                                .width = width};
    double fitting = fmin((double)SLAB_BYTES / (double)(in->slab_rows * row_bytes),
                          (double)READ_BYTES / (read * width * (double)row_bytes));
    in->receivers = (int)fmin(bp->problem.acquisition->receivers, fmax(1, floor(fitting)));
}

struct arena {
    char *base; /* NULL while the size is being found */
    size_t used;
};

static void *take(struct arena *arena, size_t count, size_t size)
{
    void *part = arena->base ? arena->base + arena->used : NULL;
    arena->used += (count * size + 63) / 64 * 64;
    return part;
}

/* One thread's scratch, from the arena. */
static struct bp_row_scratch scratch_take(struct arena *arena, size_t phases, size_t shifts, size_t entries,
                                          size_t taps, size_t real_bytes)
{
    const size_t few = taps < 3 ? taps : 1, many = taps < 3 ? 0 : taps + BP_SPREAD;
    return (struct bp_row_scratch){.groups = take(arena, phases + 1, sizeof(struct bp_row_group)),
                                   .leg = take(arena, shifts, sizeof(double)),
                                   .ahead = take(arena, shifts, sizeof(double)),
                                   .shift = take(arena, shifts, sizeof(int)),
                                   .gate = take(arena, shifts, real_bytes),
                                   .capacity = (int)entries,
                                   .q = take(arena, entries, sizeof(double)),
                                   .kept = take(arena, entries, sizeof(int)),
                                   .row = take(arena, entries, sizeof(int)),
                                   .offset = take(arena, entries, sizeof(int)),
                                   .step = take(arena, entries, sizeof(int)),
                                   .rows = take(arena, entries, sizeof(int)),
                                   .wr = take(arena, entries * few, real_bytes),
                                   .wi = take(arena, entries * few, real_bytes),
                                   .weights = take(arena, entries * many, real_bytes)};
}

static enum status invariant_plan(struct bp *bp)
{
    const struct problem *problem = &bp->problem;
    const struct acquisition *a = problem->acquisition;
    struct invariant *in = bp->state = calloc(1, sizeof *in);
    struct straight_track track;
    if (!in)
        return status_set(STATUS_FAILED, "no memory for the plan");
    enum status status = bp_plan_records(bp);
    if (status != STATUS_OK)
        return status;
    acquisition_is_straight(a, &track);
    int threads = omp_get_max_threads(), blocks = 0;
    size_t most_phases = 0, most_shifts = 0;
    double samples = 0;
    size_t size = real_size(problem->precision);
    double *bytes = &bp->work.bytes, ignored = 0;
    in->row = row_functions[isa_choose()][problem->precision];
    in->reversed = track.spacing < 0;
    in->patch_count = problem->patch_count;
    in->rasters = allocate((size_t)problem->patch_count * sizeof *in->rasters, bytes);
    in->strides = allocate((size_t)problem->patch_count * sizeof *in->strides, bytes);
    in->sums = calloc((size_t)problem->patch_count, sizeof *in->sums);
    in->offsets = allocate((size_t)a->receivers * sizeof *in->offsets, bytes);
    if (!in->rasters || !in->strides || !in->sums || !in->offsets)
        return status_set(STATUS_FAILED, "no memory for the plan");
    for (int m = 0; m < a->receivers; m++)
        in->offsets[m] = a->rx[m].x - a->tx[0].x;
    for (int k = 0; k < problem->patch_count; k++) {
        struct bp_raster *raster = &in->rasters[k];
        raster_make(bp, &track, &problem->patches[k], raster);
        raster->together = phases_together(bp, steepness(bp, raster, &problem->patches[k]));
        in->strides[k] = round_up(raster->blocks + BP_LANES_MOST, 8);
        size_t phases = (size_t)(raster->ratio < raster->columns ? raster->ratio : raster->columns);
        in->sums[k] = allocate(2 * (size_t)problem->patches[k].r_count * phases * (size_t)in->strides[k] * size, bytes);
        if (!in->sums[k])
            return status_set(STATUS_FAILED, "no memory for the sums of %d x %d pixels", raster->columns,
                              problem->patches[k].r_count);
        blocks = raster->blocks > blocks ? raster->blocks : blocks;
        samples = fmax(samples, samples_read(bp, raster, &problem->patches[k]));
        size_t shifts = phases * (size_t)BP_ENTRIES(a->pings + raster->blocks);
        most_phases = phases > most_phases ? phases : most_phases;
        most_shifts = shifts > most_shifts ? shifts : most_shifts;
    }
    /* Vectors of columns are read that have a ping, and so up to their width less one before the first ping and behind the
       last. Room is made for the widest vectors, so that a plan needs the same memory on every machine. */
    int lead = BP_LANES_MOST * (int)sizeof(float) / (int)size;
    shape_slab(bp, in, samples, lead, round_up(a->pings + 2 * lead, 8));
    size_t values = (size_t)in->receivers * in->slab.receiver_stride,
           tile = (size_t)TILE * (size_t)bp->shape.length * 2 * size;
    size_t entries = BP_TOGETHER * (size_t)BP_ENTRIES(a->pings + blocks), taps = (size_t)bp->table.taps;
    entries = entries > GROUP ? entries : GROUP;
    struct arena arena = {NULL, 0};
    scratch_take(&arena, most_phases, most_shifts, entries, taps, size);
    const size_t per_thread = arena.used;
    if (!((double)entries * (double)(taps + BP_SPREAD) < INT_MAX))
        return status_set(STATUS_UNSUPPORTED, "tables of %zu entries are too long to index", entries);
    if (!(in->slab.receiver_stride < INT_MAX))
        return status_set(STATUS_UNSUPPORTED, "records of %zu values a receiver are too long to index",
                          in->slab.receiver_stride);
    in->slab_re = allocate(values * size, bytes);
    in->slab_im = allocate(values * size, bytes);
    in->tiles = allocate((size_t)threads * tile, &ignored);
    in->tables = allocate((size_t)threads * per_thread, &ignored);
    in->scratch = allocate((size_t)threads * sizeof *in->scratch, &ignored);
    if (!in->slab_re || !in->slab_im || !in->tiles || !in->tables || !in->scratch)
        return status_set(STATUS_FAILED, "no memory for records of %d receivers", in->receivers);
    *bytes += (double)(tile + per_thread + sizeof *in->scratch);
    arena = (struct arena){in->tables, 0};
    for (int t = 0; t < threads; t++)
        in->scratch[t] = scratch_take(&arena, most_phases, most_shifts, entries, taps, size);
    return STATUS_OK;
}

/* Scatter a tile of compressed pings, complex [count][length], into the slab: pings contiguous. In blocks of rows, so that
   each cache line of the slab is filled while it is near. */
#define SPREAD(real)                                                                                                   \
    do {                                                                                                               \
        const real *from = (const real *)tile;                                                                         \
        real *re = (real *)in->slab_re + base, *im = (real *)in->slab_im + base;                                       \
        for (size_t i = 0; i < in->slab_rows; i += BLOCK) {                                                            \
            size_t at[BLOCK], rows = in->slab_rows - i < BLOCK ? in->slab_rows - i : BLOCK;                            \
            for (size_t k = 0; k < rows; k++) {                                                                        \
                at[k] = source;                                                                                        \
                if (++within == width) { /* on to the next sample of the slab's phases */                              \
                    within = 0;                                                                                        \
                    source += upsample - width;                                                                        \
                }                                                                                                      \
                source++;                                                                                              \
            }                                                                                                          \
            for (size_t p = 0; p < (size_t)count; p++)                                                                 \
                for (size_t k = 0; k < rows; k++) {                                                                    \
                    size_t value = 2 * (p * length + (at[k] < length ? at[k] : length - 1));                           \
                    re[(i + k) * stride + p] = from[value];                                                            \
                    im[(i + k) * stride + p] = from[value + 1];                                                        \
                }                                                                                                      \
        }                                                                                                              \
    } while (0)

static void spread(const struct bp *bp, const void *tile, int receiver, int ping, int count)
{
    const struct invariant *in = bp->state;
    size_t upsample = (size_t)bp->table.upsample, guard = (size_t)bp->table.guard, length = (size_t)bp->shape.length;
    size_t stride = (size_t)in->slab.ping_stride, width = (size_t)in->slab.width, phase = (size_t)in->slab.phase;
    size_t base = (size_t)receiver * in->slab.receiver_stride + (size_t)in->slab.lead + (size_t)ping;
    /* Upsampled records leave the guards out; phases past the last sample repeat the end and are never asked for. */
    size_t source = upsample == 1 ? 0 : guard + phase, within = 0;
    if (bp->problem.precision == PRECISION_DOUBLE)
        SPREAD(double);
    else
        SPREAD(float);
}

/* Compress receivers [first, first + count) into the slab. */
static void fill_slab(const struct bp *bp, const struct echoes *echoes, int first, int count)
{
    const struct invariant *in = bp->state;
    int pings = bp->problem.acquisition->pings, receivers = bp->problem.acquisition->receivers;
    int tiles = (pings + TILE - 1) / TILE;
    size_t row_bytes = (size_t)bp->shape.length * 2 * real_size(bp->problem.precision);
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
        spread(bp, tile, g, begin, end - begin);
    }
}

static size_t row_values(const struct invariant *in, int k)
{
    const struct bp_raster *raster = &in->rasters[k];
    return (size_t)(raster->ratio < raster->columns ? raster->ratio : raster->columns) * (size_t)in->strides[k];
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
#pragma omp parallel for schedule(dynamic, ROWS)
    for (int i = 0; i < grid->r_count; i++) {
        char *re = (char *)in->sums[k] + (size_t)i * values * size;
        in->row(&bp->medium, &bp->table, &in->rasters[k], &slab, grid->r_first + i * grid->r_step, in->offsets + first,
                count, &in->scratch[omp_get_thread_num()], re, re + half * size, in->strides[k]);
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
            in->slab.phase = pass * in->slab.width;
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
