/* Back projection for any track: records are compressed in batches that stay in the cache; each line of pixels, along
   azimuth or range, is summed by one thread, pairs in order, so that the bits do not depend on the number of threads.
   Delays are exact at six points of a block of pixels and quintics between them (general/blocks.c); with exact=true,
   and near the array, every delay is evaluated. */
#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/engine.h"
#include "backprojection/budget.h"
#include "backprojection/general/sum.h"
#include "backprojection/pairs.h"

enum {
    BATCH_BYTES = 8 << 20, /* rows of one batch: they stay in the shared cache while all lines read them */
    BATCH_LEAST = 8        /* rows of one batch at least, so that threads share the compression */
};

struct general {
    bp_sum_function *sum;
    struct vector *normal;  /* [pings] acquisition_normal */
    struct ping_box *boxes; /* [pings] */
    int batch;              /* records */
    struct bp_layout layout;
    void *rows;        /* real [batch][layout.record]; one value more may be read */
    void *interleaved; /* complex [threads][branches][shape.length] */
    int patch_count;
    bool *along_x; /* [patch_count] the lines' direction */
    void **sums;   /* [patch_count]: re then im, real [lines][pixels of a line] each */
};

static bp_sum_function *const sum_functions[][2] = {
    [ISA_BASELINE] = {bp_sum_float_baseline, bp_sum_double_baseline},
#ifdef SASBENCH_X86_64
    [ISA_V3] = {bp_sum_float_v3, bp_sum_double_v3},
    [ISA_V4] = {bp_sum_float_v4, bp_sum_double_v4},
#endif
};

static enum status general_applicable(const struct bp *bp)
{
    (void)bp;
    return STATUS_OK;
}

static void general_destroy(void *state)
{
    struct general *general = state;
    if (!general)
        return;
    for (int k = 0; general->sums && k < general->patch_count; k++)
        free(general->sums[k]);
    free(general->sums);
    free(general->along_x);
    free(general->boxes);
    free(general->normal);
    free(general->interleaved);
    free(general->rows);
    free(general);
}

/* What a patch's lines cost for one ping, in pixels of a block: measured, a block's quintic takes as long as 30 pixels,
   an exact delay as long as three. */
static double lines_cost(const struct ping_box *box, const struct grid *grid, bool along_x)
{
    enum { BLOCK_COST = 30, EXACT_COST = 3, VECTOR = 16 };
    double cost = 0;
    for (int n = 0; n < grid_line_count(grid, along_x); n++) {
        struct pixel_line line = grid_line(grid, along_x, n);
        struct pair_span left = {0, line.count};
        struct bp_block blocks[BP_BLOCKS];
        for (int count; (count = blocks_make(box, &line, &left, blocks)) > 0;)
            for (int b = 0; b < count; b++) {
                int pixels = (blocks[b].end - blocks[b].begin + VECTOR - 1) / VECTOR * VECTOR;
                cost += blocks[b].exact ? EXACT_COST * pixels : BLOCK_COST + pixels;
            }
    }
    return cost;
}

/* A kernel's branches in place of its taps. */
static void read_branches(struct bp *bp)
{
    const struct bp_kernel *kernel = &bp->kernel;
    bp->table = (struct bp_table){.reading = BP_BRANCHES,
                                  .upsample = bp->table.upsample,
                                  .steps = 1,
                                  .taps = kernel->branches,
                                  .guard = BP_BRANCHES_GUARD,
                                  .branches = kernel->branches};
    bp->shape.flops += 4.0 * kernel->branches * kernel->taps * ((bp->shape.samples - 1.0) * bp->table.upsample + 1);
}

/* Values of a branch: as a record's, but for the guards of a kernel. */
static size_t branch_length(const struct bp *bp)
{
    return (size_t)(bp->shape.length + 2 * (bp->table.guard - bp->shape.guard));
}

/* Complex values of a record before they are spread: its trace, and after it the branches of a kernel. */
static size_t values_of(const struct bp *bp)
{
    const size_t trace = (size_t)bp->shape.branches * (size_t)bp->shape.length;
    return trace + (bp->table.branches > bp->shape.branches ? (size_t)bp->table.branches * branch_length(bp) : 0);
}

/* One block more than a record has: windows are two. Rounded up, so that a plan needs the same memory everywhere. */
static struct bp_layout layout_make(const struct bp *bp)
{
    const size_t length = branch_length(bp), parts = 2 * (size_t)bp->table.branches;
    const size_t vector = 64 / real_size(bp->problem.precision), blocks = (length + vector - 1) / vector + 1;
    const bool branches = bp->table.reading == BP_BRANCHES;
    struct bp_layout layout = {.apart = branches ? blocks * vector : length, .blocks = 1};
#ifdef SASBENCH_X86_64
    if (branches && isa_choose() == ISA_V4)
        layout = (struct bp_layout){.apart = vector, .blocks = (int)blocks};
#endif
    layout.record = (size_t)layout.blocks * parts * layout.apart;
    return layout;
}

static enum status general_plan(struct bp *bp)
{
    const struct problem *problem = &bp->problem;
    const struct acquisition *a = problem->acquisition;
    struct general *general = bp->state = calloc(1, sizeof *general);
    if (!general)
        return status_set(STATUS_FAILED, "no memory for the plan");
    enum status status = bp_plan_traces(bp);
    if (status != STATUS_OK)
        return status;
    if (bp->kernel.branches > 0 && bp->medium.phase_limit > 0)
        read_branches(bp);
    int fine = bp->table.upsample * (bp->table.reading == BP_CUBICS ? BP_INTERVALS : 1);
    if (!((double)a->samples * fine < INT_MAX))
        return status_set(STATUS_UNSUPPORTED, "records of %d samples with %d points each are too long to index",
                          a->samples, fine);
    general->layout = layout_make(bp);
    size_t size = real_size(problem->precision), row_bytes = general->layout.record * size;
    double pairs = (double)a->pings * a->receivers;
    general->sum = sum_functions[isa_choose()][problem->precision];
    general->batch = (int)fmin(pairs, fmax(BATCH_LEAST, (double)(BATCH_BYTES / row_bytes)));
    general->rows = aligned_alloc(64, ((size_t)general->batch * row_bytes + size + 63) / 64 * 64);
    const size_t interleaved = 2 * values_of(bp) * size;
    general->interleaved = malloc((size_t)omp_get_max_threads() * interleaved);
    general->normal = calloc((size_t)a->pings, sizeof *general->normal);
    general->boxes = calloc((size_t)a->pings, sizeof *general->boxes);
    general->patch_count = problem->patch_count;
    general->along_x = calloc((size_t)problem->patch_count, sizeof *general->along_x);
    general->sums = calloc((size_t)problem->patch_count, sizeof *general->sums);
    if (!general->rows || !general->interleaved || !general->normal || !general->boxes || !general->along_x
        || !general->sums)
        return status_set(STATUS_FAILED, "no memory for %d records of %d values", general->batch, bp->shape.length);
    const double quintics = budget_quintics(bp->medium.phase_limit, problem->precision);
    for (int p = 0; p < a->pings; p++) {
        general->normal[p] = acquisition_normal(a, p);
        general->boxes[p] = ping_box_make(a, p, problem->patch_count, problem->patches, quintics);
    }
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *grid = &problem->patches[k];
        const struct ping_box *box = &general->boxes[a->pings / 2];
        size_t pixels = (size_t)grid->x_count * (size_t)grid->r_count;
        general->along_x[k] = lines_cost(box, grid, true) < lines_cost(box, grid, false);
        general->sums[k] = malloc(2 * pixels * size);
        if (!general->sums[k])
            return status_set(STATUS_FAILED, "no memory for the sums of %zu pixels", pixels);
    }
    bp->work.bytes += sizeof *general + general->batch * (double)row_bytes + (double)interleaved
                      + (double)a->pings * (double)(sizeof *general->normal + sizeof *general->boxes)
                      + problem_pixels(problem) * 2 * (double)size;
    return STATUS_OK;
}

/* Add some receivers to pixels `within` of a line. */
static void sum_span(const struct bp *bp, const struct ping_box *box, const struct bp_ping *ping,
                     const struct pixel_line *line, struct pair_span within, void *re, void *im)
{
    const struct general *general = bp->state;
    struct bp_block blocks[BP_BLOCKS];
    struct pair_span left = within;
    for (int count; (count = blocks_make(box, line, &left, blocks)) > 0;)
        general->sum(&bp->medium, &bp->table, ping, line, count, blocks, re, im);
}

/* Is the delay of every pixel of `within` inside every receiver's record, by the least and the longest way there is? */
static bool inside_record(const struct bp *bp, int p, const struct pixel_line *line, struct pair_span within)
{
    const struct acquisition *a = bp->problem.acquisition;
    const struct general *general = bp->state;
    double c = a->sound_speed, first = a->t0[p], last = first + (a->samples - 1) / a->fs, slack = 1e-9 / a->fs;
    double least = 2 * ping_box_clearance(&general->boxes[p], line, within.begin, within.end) / c;
    double most = 2 * ping_box_extent(&general->boxes[p], line, within.begin, within.end) / c;
    return least >= first + slack && most <= last - slack;
}

/* Add the batch's pairs, records [first, first + count), to one line of patch k. */
static void sum_line(const struct bp *bp, int k, int number, size_t first, int count)
{
    const struct general *general = bp->state;
    const struct acquisition *a = bp->problem.acquisition;
    const struct grid *grid = &bp->problem.patches[k];
    const struct pixel_line line = grid_line(grid, general->along_x[k], number);
    size_t pixels = (size_t)grid->x_count * (size_t)grid->r_count, size = real_size(bp->problem.precision);
    size_t row_bytes = general->layout.record * size, end = first + (size_t)count;
    char *re = (char *)general->sums[k] + (size_t)number * (size_t)line.count * size, *im = re + pixels * size;
    for (size_t index = first; index < end;) {
        int p = (int)(index / (size_t)a->receivers), m = (int)(index % (size_t)a->receivers);
        struct bp_ping ping = {a->tx[p],       a->velocity[p],
                               a->t0[p],       a->receivers - m,
                               a->rx + index,  (const char *)general->rows + (index - first) * row_bytes,
                               general->layout};
        if (end - index < (size_t)ping.receivers)
            ping.receivers = (int)(end - index);
        struct pair_span aperture[2], record[2];
        int spans = pair_spans(a, p, general->normal[p], &line, aperture);
        for (int s = 0; s < spans; s++) {
            if (inside_record(bp, p, &line, aperture[s])) {
                sum_span(bp, &general->boxes[p], &ping, &line, aperture[s], re, im);
                continue;
            }
            struct bp_ping one = ping;
            one.receivers = 1;
            for (int n = 0; n < ping.receivers; n++) {
                int parts = record_spans(a, p, m + n, &line, aperture[s], record);
                one.rx = ping.rx + n;
                one.rows = (const char *)ping.rows + (size_t)n * row_bytes;
                for (int i = 0; i < parts; i++)
                    sum_span(bp, &general->boxes[p], &one, &line, record[i], re, im);
            }
        }
        index += (size_t)ping.receivers;
    }
}

/* The planar sums into the image's [r][x] pixels. */
static void store(const struct bp *bp, int k, void *pixels)
{
    const struct general *general = bp->state;
    const struct grid *grid = &bp->problem.patches[k];
    const void *sums = general->sums[k];
    size_t nx = (size_t)grid->x_count, nr = (size_t)grid->r_count, count = nx * nr;
    size_t row = general->along_x[k] ? nx : 1, column = general->along_x[k] ? 1 : nr;
    bool is_double = bp->problem.precision == PRECISION_DOUBLE;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < nr; i++)
        for (size_t j = 0; j < nx; j++) {
            size_t from = i * row + j * column, to = 2 * (i * nx + j);
            if (is_double) {
                ((double *)pixels)[to] = ((const double *)sums)[from];
                ((double *)pixels)[to + 1] = ((const double *)sums)[count + from];
            } else {
                ((float *)pixels)[to] = ((const float *)sums)[from];
                ((float *)pixels)[to + 1] = ((const float *)sums)[count + from];
            }
        }
}

/* One branch, complex [length], into its blocks. */
#define SPREAD(real)                                                                                                   \
    do {                                                                                                               \
        const real *values = (const real *)from + 2 * branch * length;                                                 \
        real *to = (real *)row + 2 * branch * block;                                                                   \
        for (size_t left = length, k = 0; k < (size_t)layout->blocks; k++, to += step) {                               \
            const size_t count = left < block ? left : block;                                                          \
            for (size_t i = 0; i < count; i++) {                                                                       \
                to[i] = values[2 * i];                                                                                 \
                to[block + i] = values[2 * i + 1];                                                                     \
            }                                                                                                          \
            for (size_t i = count; i < block; i++)                                                                     \
                to[i] = to[block + i] = 0;                                                                             \
            values += 2 * count;                                                                                       \
            left -= count;                                                                                             \
        }                                                                                                              \
    } while (0)

/* A kernel's branches of a trace, complex [branches][length], which follow it; 0 beyond the record's ends. */
#define FILTER(real)                                                                                                   \
    do {                                                                                                               \
        const size_t count = 2 * (length - 2 * guard);                                                                 \
        for (size_t m = 0; m < branches; m++) {                                                                        \
            real *to = (real *)trace + 2 * ((size_t)bp->shape.length + m * length);                                    \
            memset(to, 0, 2 * length * sizeof *to);                                                                    \
            to += 2 * guard;                                                                                           \
            for (int t = 0; t < kernel->taps; t++) {                                                                   \
                const real weight = (real)kernel->coefficients[m * (size_t)kernel->taps + (size_t)t];                  \
                const real *values = (const real *)trace + 2 * (bp->shape.guard + kernel->first + t);                  \
                for (size_t i = 0; i < count; i++)                                                                     \
                    to[i] += weight * values[i];                                                                       \
            }                                                                                                          \
        }                                                                                                              \
    } while (0)

static void filter(const struct bp *bp, void *trace)
{
    const struct bp_kernel *kernel = &bp->kernel;
    const size_t branches = (size_t)bp->table.branches, length = branch_length(bp), guard = (size_t)bp->table.guard;
    if (bp->problem.precision == PRECISION_DOUBLE)
        FILTER(double);
    else
        FILTER(float);
}

/* Compress one record into row n of the batch. */
static void fill(const struct bp *bp, const struct echoes *echoes, size_t index, int n)
{
    const struct general *general = bp->state;
    const struct bp_layout *layout = &general->layout;
    const size_t branches = (size_t)bp->table.branches, length = branch_length(bp);
    const size_t block = layout->apart, step = 2 * branches * block, size = real_size(bp->problem.precision);
    int thread = omp_get_thread_num();
    void *row = (char *)general->rows + (size_t)n * layout->record * size;
    char *from = (char *)general->interleaved + (size_t)thread * 2 * values_of(bp) * size;
    bp_fill_row(bp, thread, echoes, index, from);
    if (bp->table.branches > bp->shape.branches) {
        filter(bp, from);
        from += 2 * (size_t)bp->shape.length * size;
    }
    for (size_t branch = 0; branch < branches; branch++)
        if (bp->problem.precision == PRECISION_DOUBLE)
            SPREAD(double);
        else
            SPREAD(float);
}

static void general_execute(struct bp *bp, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    struct general *general = bp->state;
    const struct problem *problem = &bp->problem;
    size_t pairs = (size_t)problem->acquisition->pings * (size_t)problem->acquisition->receivers;
    size_t size = real_size(problem->precision);
    for (int k = 0; k < problem->patch_count; k++)
        memset(general->sums[k], 0,
               2 * (size_t)problem->patches[k].x_count * (size_t)problem->patches[k].r_count * size);
    for (size_t first = 0; first < pairs; first += (size_t)general->batch) {
        int count = pairs - first < (size_t)general->batch ? (int)(pairs - first) : general->batch;
#pragma omp parallel for schedule(static)
        for (int n = 0; n < count; n++)
            fill(bp, echoes, first + (size_t)n, n);
        stages_end(stages, "compress");
        for (int k = 0; k < problem->patch_count; k++) {
#pragma omp parallel for schedule(dynamic)
            for (int n = 0; n < grid_line_count(&problem->patches[k], general->along_x[k]); n++)
                sum_line(bp, k, n, first, count);
        }
        stages_end(stages, "focus");
    }
    for (int k = 0; k < problem->patch_count; k++)
        store(bp, k, image->pixels[k]);
    stages_end(stages, "store");
}

const struct bp_engine bp_general = {
    .name = "general",
    .applicable = general_applicable,
    .plan = general_plan,
    .execute = general_execute,
    .destroy = general_destroy,
};
