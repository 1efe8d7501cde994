/* Back projection for any track. Records are compressed in batches that stay in the cache. One thread sums each line of
   pixels, along azimuth or range, pairs in order, so that the bits do not depend on the number of threads. Delays are
   exact at six points of a block of pixels and quintics between them (general/blocks.c); with exact=true, and near the
   array, every delay is evaluated. */
#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/bp_engine.h"
#include "backprojection/budget.h"
#include "backprojection/general/lines.h"
#include "common/memory.h"
#include "common/progress.h"

enum {
    BATCH_BYTES = 1 << 20, /* rows of one batch: they stay in the second-level cache while all lines read them */
    BATCH_LEAST = 8,       /* rows of one batch at least, and one for each thread, as they share the compression */
    PART_LEAST = 256       /* pixels of a part of a line at least: some blocks */
};

struct general {
    bp_sum_function *sum;
    struct vector *normal;  /* [pings] acquisition_normal */
    struct ping_box *boxes; /* [pings] */
    int batch;              /* records */
    struct bp_layout layout;
    void *rows;        /* real [batch][layout.record]; one value more may be read */
    void *interleaved; /* [threads][each]: complex [branches][shape.length] */
    size_t each;       /* bytes */
    bool *along_x;     /* [patch_count] the lines' direction */
    void **sums;       /* [patch_count]: re then im, real [lines][pixels of a line] each */
};

static enum status general_applicable(const struct bp *bp)
{
    (void)bp;
    return STATUS_OK;
}

/* Measured, in pixels of a block: a block's quintic takes as long as 30, an exact delay as long as three. */
enum { BLOCK_COST = 30, EXACT_COST = 3, VECTOR = 16 };
/* Whole numbers, in which the order of sums does not matter. */
struct line_counts {
    double blocks, pixels, exact; /* pixels of whole vectors; and of exact delays */
    double met, apart;            /* pixels; those that load their own samples */
};

static void span_count(const struct ping_box *box, const struct pixel_line *line, struct pair_span left,
                       struct line_counts *counts)
{
    struct bp_block blocks[BP_BLOCKS];
    for (int count; (count = blocks_make(box, line, &left, blocks)) > 0;)
        for (int b = 0; b < count; b++) {
            const int pixels = (blocks[b].end - blocks[b].begin + VECTOR - 1) / VECTOR * VECTOR;
            counts->blocks += !blocks[b].exact;
            *(blocks[b].exact ? &counts->exact : &counts->pixels) += pixels;
        }
}

/* Cost of a patch's lines for one ping; only each `step`-th line is counted. */
static double lines_cost(const struct ping_box *box, const struct grid *grid, bool along_x, int step)
{
    struct line_counts counts = {0};
    for (int n = 0; n < grid_line_count(grid, along_x); n += step) {
        const struct pixel_line line = grid_line(grid, along_x, n);
        span_count(box, &line, (struct pair_span){0, line.count}, &counts);
    }
    return BLOCK_COST * counts.blocks + counts.pixels + EXACT_COST * counts.exact;
}

/* The steps between some of `count` things, evenly spaced. */
static int step_of(int count)
{
    enum { LOOKED_AT = 8 };
    return (count + LOOKED_AT - 1) / LOOKED_AT;
}

/* Pixels of neighbours further apart than this load their own samples (run.h): branches, and one value or two. */
static double steep_most(const struct bp *bp)
{
    return bp->kernel.branches > 0 || bp->table.branches > 1 ? 0.99 : 0.49;
}

/* Count the blocks and pixels of ping p's pairs with a patch, on each `step`-th line: [along range, along x]. */
static void ping_count(const struct bp *bp, int p, const struct ping_box *box, const struct grid *grid,
                       struct line_counts *sum)
{
    const struct acquisition *a = bp->problem.acquisition;
    const struct vector normal = acquisition_normal(a, p);
    const int steps[] = {step_of(grid_line_count(grid, false)), step_of(grid_line_count(grid, true))};
    const bool along_x =
        steps[1] * lines_cost(box, grid, true, steps[1]) < steps[0] * lines_cost(box, grid, false, steps[0]);
    const int lines = grid_line_count(grid, along_x), step = steps[along_x];
    const double looked = ceil((double)lines / step), finest = a->fs * bp->table.upsample;
    struct line_counts counts = {0};
    for (int n = 0; n < lines; n += step) {
        const struct pixel_line line = grid_line(grid, along_x, n);
        struct pair_span spans[2];
        const int count = pair_spans(a, p, normal, &line, spans);
        for (int s = 0; s < count; s++) {
            const double pixels = spans[s].end - spans[s].begin;
            span_count(box, &line, spans[s], &counts);
            counts.met += pixels;
            counts.apart += blocks_slope(a, p, &line, spans[s]) * finest > steep_most(bp) ? pixels : 0;
        }
    }
    sum->blocks += counts.blocks * lines / looked;
    sum->exact += counts.exact * lines / looked;
    sum->met += counts.met * lines / looked;
    sum->apart += counts.apart * lines / looked;
}

/* Blocks, extrapolated from some pings that are met and some lines. Exact delays count as blocks of the same time. */
static void general_units(const struct bp *bp, struct forecast *forecast)
{
    const struct problem *problem = &bp->problem;
    const struct acquisition *a = problem->acquisition;
    const double quintics = budget_quintics(bp->medium.phase_limit, problem->precision);
    const int met = bp_met_count(bp), pings = step_of(met);
    int passed = 0, looked_at = 0;
    struct line_counts sum = {0};
    for (int p = 0; p < a->pings; p++) {
        if (!bp_met(bp, p) || passed++ % pings != pings / 2)
            continue;
        looked_at++;
        const struct ping_box box = ping_box_make(a, p, problem->patch_count, problem->patches, quintics);
        for (int k = 0; k < problem->patch_count; k++)
            ping_count(bp, p, &box, &problem->patches[k], &sum);
    }
    const double units = sum.blocks + sum.exact * EXACT_COST / BLOCK_COST;
    const double records = looked_at > 0 ? (double)a->receivers * met / looked_at : 0;
    forecast->units = units * records;
    forecast->pairs = sum.met * records;
    forecast->apart = sum.met > 0 ? sum.apart / sum.met : 0;
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
                                  .origin = BP_BRANCHES_GUARD - bp->shape.first * bp->table.upsample,
                                  .branches = kernel->branches};
    bp->shape.flops += 4.0 * kernel->branches * kernel->taps * ((bp->shape.samples - 1.0) * bp->table.upsample + 1);
}

static enum status general_plan(struct bp *bp)
{
    const struct problem *problem = &bp->problem;
    const struct acquisition *a = problem->acquisition;
    struct store *store = &bp->engines;
    struct general *general = bp->state = store_keep(store, calloc(1, sizeof *general), free);
    if (!general)
        return status_set(STATUS_FAILED, "no memory for the plan");
    const enum status status = bp_plan_traces(bp, bp_samples_read(bp));
    if (status != STATUS_OK)
        return status;
    if (bp->kernel.branches > 0 && bp->medium.phase_limit > 0)
        read_branches(bp);
    int fine = bp->table.upsample * (bp->table.reading == BP_CUBICS ? BP_INTERVALS : 1);
    if (!((double)a->samples * fine < INT_MAX))
        return status_set(STATUS_UNSUPPORTED, "records of %d samples with %d points each are too long to index",
                          a->samples, fine);
    const struct bp_table *table = &bp->table;
    general->layout =
        bp_layout_make(problem->precision, bp_branch_length(bp), table->branches, table->reading == BP_BRANCHES);
    size_t size = real_size(problem->precision), row_bytes = general->layout.record * size;
    double pairs = (double)a->pings * a->receivers;
    general->sum = ISA_CHOOSE(bp_sum, problem->precision);
    const size_t threads = (size_t)omp_get_max_threads();
    general->batch = (int)fmin(pairs, fmax(fmax(BATCH_LEAST, (double)threads), (double)(BATCH_BYTES / row_bytes)));
    general->rows = store_room(store, (size_t)general->batch * row_bytes + size, 1, 0);
    general->each = 2 * bp_record_values(bp) * size;
    general->interleaved = store_room(store, threads, general->each, 1.0 / (double)threads);
    general->normal = store_room(store, (size_t)a->pings, sizeof *general->normal, 1);
    general->boxes = store_room(store, (size_t)a->pings, sizeof *general->boxes, 1);
    general->along_x = store_keep(store, malloc((size_t)problem->patch_count * sizeof *general->along_x), free);
    general->sums = store_keep(store, malloc((size_t)problem->patch_count * sizeof *general->sums), free);
    if (store->failed)
        return status_set(STATUS_FAILED, "no memory for %d records of %d values", general->batch, bp->shape.length);
    const double quintics = budget_quintics(bp->medium.phase_limit, problem->precision);
    for (int p = 0; p < a->pings; p++) {
        general->normal[p] = acquisition_normal(a, p);
        general->boxes[p] = ping_box_make(a, p, problem->patch_count, problem->patches, quintics);
    }
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *grid = &problem->patches[k];
        const struct ping_box *box = &general->boxes[a->pings / 2];
        size_t pixels = grid_pixels(grid);
        general->along_x[k] = lines_cost(box, grid, true, 1) < lines_cost(box, grid, false, 1);
        const struct pixel_window w = problem_window(problem, k);
        const size_t rows = (size_t)w.rows, columns = (size_t)w.columns;
        general->sums[k] = bp_part_allocate(bp, 2 * pixels * size, 2 * (general->along_x[k] ? rows : columns),
                                            (general->along_x[k] ? columns : rows) * size);
        if (!general->sums[k])
            return status_set(STATUS_FAILED, "no memory for the sums of %zu pixels", pixels);
    }
    store->bytes += sizeof *general + general->batch * (double)row_bytes;
    return STATUS_OK;
}

/* The end of the batch that begins with record `first`. It does not separate records that are summed together, so that
   bits do not depend on it. */
static size_t batch_end(const struct general *general, const struct acquisition *a, size_t first)
{
    const size_t pairs = (size_t)a->pings * (size_t)a->receivers, end = first + (size_t)general->batch;
    const size_t joined = (size_t)bp_pings_joined(a), receivers = (size_t)a->receivers;
    if (end >= pairs)
        return pairs;
    return joined > 1 ? end - end % (joined * receivers) : end - end % receivers % BP_RECORDS;
}

/* Leave out records at a batch's ends whose pings are not met. */
static void batch_trim(const struct bp *bp, size_t *first, size_t *end)
{
    const size_t receivers = (size_t)bp->problem.acquisition->receivers;
    while (*first < *end && !bp_met(bp, (int)(*first / receivers)))
        ++*first;
    while (*first < *end && !bp_met(bp, (int)((*end - 1) / receivers)))
        --*end;
}

/* Lines along range pass through whole records. If a batch of long ones does not stay in the cache, all lines are
   summed part by part: the records' part for each stays. */
static int line_parts(const struct general *general, const struct grid *grid, bool along_x, size_t row_bytes)
{
    const double whole = general->batch * (double)row_bytes / BATCH_BYTES;
    return along_x ? 1 : (int)fmax(1, fmin(ceil(whole), grid->r_count / PART_LEAST));
}

/* Lines of a window, or pixels of each of them. */
static struct pair_span window_span(const struct pixel_window *window, bool rows)
{
    const int first = rows ? window->row : window->column;
    return (struct pair_span){first, first + (rows ? window->rows : window->columns)};
}

/* The lines of a patch that are shown, each in `parts`. */
struct patch_parts {
    int begin, numbers, parts;
};

static struct patch_parts patch_parts(const struct bp *bp, int k)
{
    const struct general *general = bp->state;
    const struct pixel_window window = problem_window(&bp->problem, k);
    const struct pair_span shown = window_span(&window, general->along_x[k]);
    const size_t row_bytes = general->layout.record * real_size(bp->problem.precision);
    return (struct patch_parts){shown.begin, shown.end - shown.begin,
                                line_parts(general, &bp->problem.patches[k], general->along_x[k], row_bytes)};
}

/* A part of `parts`, of one line of patch k. */
struct line_part {
    int number, part, parts;
};

/* Add the batch's pairs, records [first, first + count). */
static void sum_part(const struct bp_lines *lines, int k, struct line_part of, size_t first, int count)
{
    const struct general *general = lines->bp->state;
    const struct grid *grid = &lines->bp->problem.patches[k];
    const size_t pixels = grid_pixels(grid), size = real_size(lines->bp->problem.precision);
    struct pixel_line line = grid_line(grid, general->along_x[k], of.number);
    const long long all = line.count;
    const int begin = (int)(all * of.part / of.parts), end = (int)(all * (of.part + 1) / of.parts);
    const struct pixel_window window = problem_window(&lines->bp->problem, k);
    const struct pair_span shown = window_span(&window, !general->along_x[k]);
    if (shown.end <= begin || shown.begin >= end)
        return;
    struct bp_lines part = *lines;
    part.shown = (struct pair_span){shown.begin - begin, shown.end - begin};
    const struct vector from = line_pixel(&line, begin);
    char *re = (char *)general->sums[k] + ((size_t)of.number * (size_t)line.count + (size_t)begin) * size;
    line.x_first = from.x;
    line.r_first = from.y;
    line.count = end - begin;
    bp_lines_add(&part, &line, first, count, re, re + pixels * size);
}

/* The sums that are stored. */
static void sums_clear(const struct bp *bp, int k)
{
    const struct general *general = bp->state;
    const struct grid *grid = &bp->problem.patches[k];
    const struct pixel_window window = problem_window(&bp->problem, k);
    const bool along_x = general->along_x[k];
    const struct pair_span lines = window_span(&window, along_x), shown = window_span(&window, !along_x);
    const size_t size = real_size(bp->problem.precision), count = (size_t)(along_x ? grid->x_count : grid->r_count);
    const size_t pixels = grid_pixels(grid), bytes = (size_t)(shown.end - shown.begin) * size;
    for (int n = lines.begin; n < lines.end; n++) {
        char *re = (char *)general->sums[k] + ((size_t)n * count + (size_t)shown.begin) * size;
        memset(re, 0, bytes);
        memset(re + pixels * size, 0, bytes);
    }
}

/* Parts of lines, of all patches. */
static int parts_count(const struct bp *bp)
{
    int count = 0;
    for (int k = 0; k < bp->problem.patch_count; k++) {
        const struct patch_parts all = patch_parts(bp, k);
        count += all.numbers * all.parts;
    }
    return count;
}

/* The batch's pairs of patch k, shared by the team of threads. Threads do not wait for each other: patches have sums
   of their own, and many are small. */
static void sum_patch(const struct bp_lines *lines, int k, size_t first, int count)
{
    const struct patch_parts all = patch_parts(lines->bp, k);
#pragma omp for schedule(dynamic) nowait
    for (int n = 0; n < all.numbers * all.parts; n++)
        if (progress_step())
            sum_part(lines, k, (struct line_part){all.begin + n % all.numbers, n / all.numbers, all.parts}, first,
                     count);
}

static void general_execute(struct bp *bp, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    struct general *general = bp->state;
    const struct problem *problem = &bp->problem;
    size_t pairs = (size_t)problem->acquisition->pings * (size_t)problem->acquisition->receivers;
    const size_t size = real_size(problem->precision);
    struct bp_lines lines = {
        bp,    general->sum, problem->acquisition, general->normal, general->boxes, general->rows, general->layout,
        {0, 0}};
    for (int k = 0; k < problem->patch_count; k++)
        sums_clear(bp, k);
    const int parts = parts_count(bp);
    for (size_t begin = 0, next; begin < pairs; begin = next) {
        next = batch_end(general, problem->acquisition, begin);
        size_t first = begin, end = next;
        batch_trim(bp, &first, &end);
        const int count = (int)(end - first);
        if (count == 0)
            continue;
#pragma omp parallel for schedule(static)
        for (int n = 0; n < count; n++)
            if (bp_met(bp, (int)((first + (size_t)n) / (size_t)problem->acquisition->receivers)))
                bp_record_fill(bp, &general->layout, echoes, first + (size_t)n,
                               (char *)general->interleaved + (size_t)omp_get_thread_num() * general->each,
                               (char *)general->rows + (size_t)n * general->layout.record * size);
        stages_end(stages, "compress");
        progress_part((double)begin / (double)pairs, (double)next / (double)pairs, parts);
#pragma omp parallel
        for (int k = 0; k < problem->patch_count; k++)
            sum_patch(&lines, k, first, count);
        stages_end(stages, "focus");
    }
    for (int k = 0; k < problem->patch_count; k++) {
        const struct pixel_window window = problem_window(problem, k);
        bp_lines_store(problem->precision, &problem->patches[k], general->along_x[k], general->sums[k], &window,
                       image->pixels[k]);
    }
    stages_end(stages, "store");
}

/* Neighbouring pings with a small number of receivers share blocks of pixels; some are outside the aperture of one
   ping. */
static double general_beside(const struct bp *bp)
{
    const struct acquisition *a = bp->problem.acquisition;
    const int joined = bp_pings_joined(a);
    double apart = 0;
    for (int p = 1; p < a->pings && joined > 1; p++)
        apart = fmax(apart, vector_norm(vector_difference(a->tx[p], a->tx[p - 1])));
    return (joined - 1) * apart;
}

const struct bp_engine bp_general = {
    .name = "general",
    .applicable = general_applicable,
    .units = general_units,
    .beside = general_beside,
    .plan = general_plan,
    .execute = general_execute,
};
