/* Back projection for any track: records are compressed in batches that stay in the cache; each image column is summed
   by one thread, pairs in order, so that the bits do not depend on the number of threads. */
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "bp_internal.h"
#include "pairs.h"

enum {
    BATCH_BYTES = 8 << 20,          /* rows of one batch: they stay in the shared cache while all columns read them */
    BATCH_LEAST = 8,                /* rows of one batch at least, so that threads share the compression */
    COLUMNS = 8                     /* columns of one task, which reuse a row while it is near */
};

struct general {
    bp_sum_function *sum;
    struct vector *heading;         /* [pings] */
    int batch;                      /* rows */
    void *rows;                     /* complex [batch][shape.length] */
    int patch_count;
    void **sums;                    /* [patch_count]: re then im, real [x_count][r_count] each */
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
    free(general->heading);
    free(general->rows);
    free(general);
}

static enum status general_plan(struct bp *bp)
{
    const struct problem *problem = &bp->problem;
    const struct acquisition *a = problem->acquisition;
    struct general *general = bp->state = calloc(1, sizeof *general);
    if (!general)
        return status_set(STATUS_FAILED, "no memory for the plan");
    enum status status = bp_plan_records(bp);
    if (status != STATUS_OK)
        return status;
    size_t size = real_size(problem->precision), row_bytes = (size_t)bp->shape.length * 2 * size;
    double pairs = (double)a->pings * a->receivers;
    general->sum = sum_functions[isa_choose()][problem->precision];
    general->batch = (int)fmin(pairs, fmax(BATCH_LEAST, (double)(BATCH_BYTES / row_bytes)));
    general->rows = aligned_alloc(64, ((size_t)general->batch * row_bytes + 63) / 64 * 64);
    general->heading = calloc((size_t)a->pings, sizeof *general->heading);
    general->patch_count = problem->patch_count;
    general->sums = calloc((size_t)problem->patch_count, sizeof *general->sums);
    if (!general->rows || !general->heading || !general->sums)
        return status_set(STATUS_FAILED, "no memory for %d records of %d values", general->batch, bp->shape.length);
    for (int p = 0; p < a->pings; p++)
        general->heading[p] = acquisition_heading(a, p);
    for (int k = 0; k < problem->patch_count; k++) {
        size_t pixels = (size_t)problem->patches[k].x_count * (size_t)problem->patches[k].r_count;
        general->sums[k] = malloc(2 * pixels * size);
        if (!general->sums[k])
            return status_set(STATUS_FAILED, "no memory for the sums of %zu pixels", pixels);
    }
    bp->work.bytes += sizeof *general + (double)general->batch * (double)row_bytes
                      + (double)a->pings * sizeof *general->heading + problem_pixels(problem) * 2 * (double)size;
    return STATUS_OK;
}

/* Add the batch's pairs to columns [begin, end) of patch k. */
static void sum_columns(const struct bp *bp, int k, int begin, int end, size_t first, int count)
{
    const struct general *general = bp->state;
    const struct acquisition *a = bp->problem.acquisition;
    const struct grid *grid = &bp->problem.patches[k];
    size_t pixels = (size_t)grid->x_count * (size_t)grid->r_count, size = real_size(bp->problem.precision);
    for (int n = 0; n < count; n++) {
        size_t index = first + (size_t)n;
        int p = (int)(index / (size_t)a->receivers);
        struct bp_pair pair = {a->tx[p], a->rx[index], a->velocity[p], a->t0[p],
                               (const char *)general->rows + (size_t)n * (size_t)bp->shape.length * 2 * size};
        for (int j = begin; j < end; j++) {
            struct pair_span spans[2];
            double x = grid->x_first + j * grid->x_step;
            int span_count = pair_spans(a, p, general->heading[p], grid, x, spans);
            char *re = (char *)general->sums[k] + (size_t)j * (size_t)grid->r_count * size, *im = re + pixels * size;
            for (int s = 0; s < span_count; s++)
                general->sum(&bp->medium, &bp->table, &pair, x, grid->r_first, grid->r_step, spans[s].begin,
                             spans[s].end, re, im);
        }
    }
}

/* The planar [x][r] sums into the image's [r][x] pixels. */
static void store(const struct bp *bp, int k, void *pixels)
{
    const struct grid *grid = &bp->problem.patches[k];
    const void *sums = ((const struct general *)bp->state)->sums[k];
    size_t nx = (size_t)grid->x_count, nr = (size_t)grid->r_count, count = nx * nr;
    bool is_double = bp->problem.precision == PRECISION_DOUBLE;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < nr; i++)
        for (size_t j = 0; j < nx; j++)
            if (is_double) {
                ((double *)pixels)[2 * (i * nx + j)] = ((const double *)sums)[j * nr + i];
                ((double *)pixels)[2 * (i * nx + j) + 1] = ((const double *)sums)[count + j * nr + i];
            } else {
                ((float *)pixels)[2 * (i * nx + j)] = ((const float *)sums)[j * nr + i];
                ((float *)pixels)[2 * (i * nx + j) + 1] = ((const float *)sums)[count + j * nr + i];
            }
}

static void general_execute(struct bp *bp, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    struct general *general = bp->state;
    const struct problem *problem = &bp->problem;
    size_t pairs = (size_t)problem->acquisition->pings * (size_t)problem->acquisition->receivers;
    size_t size = real_size(problem->precision);
    for (int k = 0; k < problem->patch_count; k++)
        memset(general->sums[k], 0, 2 * (size_t)problem->patches[k].x_count * (size_t)problem->patches[k].r_count * size);
    for (size_t first = 0; first < pairs; first += (size_t)general->batch) {
        int count = pairs - first < (size_t)general->batch ? (int)(pairs - first) : general->batch;
#pragma omp parallel for schedule(static)
        for (int n = 0; n < count; n++)
            bp_fill_row(bp, omp_get_thread_num(), echoes, first + (size_t)n,
                        (char *)general->rows + (size_t)n * (size_t)bp->shape.length * 2 * size);
        stages_end(stages, "compress");
        for (int k = 0; k < problem->patch_count; k++) {
            int columns = problem->patches[k].x_count;
#pragma omp parallel for schedule(dynamic)
            for (int begin = 0; begin < columns; begin += COLUMNS)
                sum_columns(bp, k, begin, begin + COLUMNS < columns ? begin + COLUMNS : columns, first, count);
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
