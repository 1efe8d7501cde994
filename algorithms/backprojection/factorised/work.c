/* Counted work of factorised back projection, and its cost, which decides the number of levels. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "backprojection/factorised/factorised.h"

/* Counts of lines of places or pixels: pairs of a pixel and a record, of a pixel and an image, samples of traces; lines
   read from images; lines of images times the pings that they sum; and lines of any kind times such records. */
struct amounts {
    double records, images, traces, lines, pings, blocks;
};

/* `count` stretches of lines that are read from images of a level. */
static void add_spans(const struct tree *tree, const struct polar_step *step, double metres, double pixels,
                      double count, struct amounts *sum)
{
    sum->images += count * pixels;
    sum->traces += count * (metres / step->rho + tree->range.taps + 2);
    sum->lines += count;
}

/* Images of a subaperture. */
static void count_images(const struct tree *tree, const struct subaperture *part, struct amounts *sum)
{
    for (int v = 0; v < tree->views; v++) {
        const struct polar *polar = &part->polars[v];
        const double places = (double)polar->lines * polar->places;
        if (part->level == 0) {
            sum->records += places * part->pings * tree->problem.acquisition->receivers;
            sum->pings += (double)polar->lines * part->pings;
            sum->blocks += (double)polar->lines * part->pings * tree->problem.acquisition->receivers;
            continue;
        }
        const double rho = polar_step(tree, part->level, v)->rho;
        add_spans(tree, polar_step(tree, part->level - 1, v), polar->places * rho, polar->places,
                  (double)part->children * polar->lines, sum);
    }
}

/* A line of a patch seen from one subaperture: reads of its images, and sums of its records. */
static void count_line(const struct tree *tree, int subaperture, int patch, int n, struct amounts *sum)
{
    const struct subaperture *part = &tree->subapertures[subaperture];
    const struct grid *grid = &tree->problem.patches[patch];
    const bool along_x = tree->along_x[patch];
    const double metres = along_x ? grid->x_step : grid->r_step;
    const double records = (double)part->pings * tree->problem.acquisition->receivers;
    const struct pixel_line line = grid_line(grid, along_x, n);
    struct spans spans;
    for (int view = 2 * patch; view < 2 * patch + 2; view++) {
        tree_pixels(tree, subaperture, view, &line, &spans);
        for (int k = 0; k < spans.count; k++) {
            const double pixels = spans.span[k].end - spans.span[k].begin;
            add_spans(tree, polar_step(tree, part->level, view), pixels * metres, pixels, 1, sum);
        }
    }
    if (part->level > 0)
        return;
    tree_direct(tree, subaperture, patch, &line, &spans);
    for (int k = 0; k < spans.count; k++)
        sum->records += (spans.span[k].end - spans.span[k].begin) * records;
    sum->blocks += spans.count * records;
}

/* All lines of a patch, or an estimate from some, the first and the last among them. */
static struct amounts count_pixels(const struct tree *tree, int subaperture, int patch, bool estimate)
{
    enum { SOME = 33 };
    const int lines = grid_line_count(&tree->problem.patches[patch], tree->along_x[patch]);
    const int visited = estimate && lines > 2 * SOME ? SOME : lines;
    const double each = (double)lines / visited;
    struct amounts sum = {0};
    for (int k = 0; k < visited; k++) {
        const int n = visited == lines ? k : (int)((long long)k * (lines - 1) / (visited - 1));
        count_line(tree, subaperture, patch, n, &sum);
    }
    return (struct amounts){sum.records * each, sum.images * each, sum.traces * each,
                            sum.lines * each,   sum.pings * each,  sum.blocks * each};
}

static void amounts_add(const struct amounts *some, struct amounts *sum)
{
    sum->records += some->records;
    sum->blocks += some->blocks;
    sum->images += some->images;
    sum->traces += some->traces;
    sum->lines += some->lines;
}

/* Costs in pairs of the general engine, measured: an image for each pixel; a trace for each sample, and for its taps
   and branches; a line through an image; a ping that a line sums, and each of its records. */
static const double IMAGE = 1.4, TRACE = 6, TAP = 0.6, BRANCH = 0.12, LINE = 1600, PING = 600, BLOCK = 130;

/* All but the records. */
static double images_of(const struct tree *tree, const struct amounts *sum)
{
    const double trace = TRACE + TAP * tree->angle.taps + BRANCH * tree->range.taps * tree->range.branches;
    return IMAGE * sum->images + trace * sum->traces + LINE * sum->lines + PING * sum->pings;
}

double factorised_pairs(const struct factorised_cost *cost)
{
    return cost->records + BLOCK * cost->blocks + cost->images;
}

/* Cost of images, and of lines through them. */
static double flops_of(const struct tree *tree, const struct amounts *sum)
{
    const struct polar_taps *range = &tree->range;
    return sum->images * (4.0 * (range->branches - 1) + 8)
           + sum->traces * 4 * (tree->angle.taps + (double)range->taps * range->branches);
}

static struct factorised_cost tree_cost(const struct tree *tree)
{
    struct amounts all = {0};
    for (int n = 0; n < tree->first[tree->settings.stages]; n++) {
        count_images(tree, &tree->subapertures[n], &all);
        for (int k = 0; k < tree->problem.patch_count; k++) {
            const struct amounts some = count_pixels(tree, n, k, true);
            amounts_add(&some, &all);
        }
    }
    return (struct factorised_cost){all.records, all.blocks, images_of(tree, &all), flops_of(tree, &all), tree->degree};
}

enum status factorised_cost(const struct problem *problem, const struct tree_settings *settings,
                            struct factorised_cost *cost)
{
    struct problem seen = *problem;
    struct turned_problem turned;
    struct tree tree = {.views = 0};
    enum status status = problem_turn_back(&seen, &turned, NULL);
    if (status == STATUS_OK)
        status = tree_make(&seen, settings, &tree);
    if (status == STATUS_OK)
        *cost = tree_cost(&tree);
    tree_free(&tree);
    turned_free(&turned);
    return status;
}

/* Pairs inside the aperture limit, of some lines and pings. */
static double pairs_about(const struct problem *problem)
{
    enum { LINES = 32, PINGS = 64 };
    const struct acquisition *a = problem->acquisition;
    double pairs = 0;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *grid = &problem->patches[k];
        const int stride = grid->x_count > LINES ? grid->x_count / LINES : 1;
        const int every = a->pings > PINGS ? a->pings / PINGS : 1;
        for (int n = 0; n < grid->x_count; n += stride)
            for (int p = 0; p < a->pings; p += every) {
                struct pair_span spans[2];
                const struct pixel_line along = grid_line(grid, false, n);
                const int count = pair_spans(a, p, acquisition_normal(a, p), &along, spans);
                for (int i = 0; i < count; i++)
                    pairs += (double)stride * every * (spans[i].end - spans[i].begin);
            }
    }
    return pairs * a->receivers;
}

double factorised_least(const struct problem *problem, double pairs)
{
    static const double LINES = 8; /* of an image */
    const struct acquisition *a = problem->acquisition;
    const double pixels = problem_pixels(problem), step = a->sound_speed / (2 * a->fs);
    double places = 0;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        places += fmin(g->r_count * g->r_step, g->x_count * g->x_step) / step + BLOCK + PING / a->receivers;
    }
    return IMAGE * pixels + pairs / pixels * LINES * places;
}

enum status factorised_cost_direct(const struct problem *problem, const struct forecast *forecast, double *pairs)
{
    /* Costs in pairs of the general engine, measured. With tables: a pair, more where a small number of columns from
       ping to ping share no loads; an entry. Without tables: the extra cost of a pair that shares no loads, and for
       each value. */
    static const double PAIR = 0.19, ALONE = 0.8, COLUMNS = 8, ENTRY = 6.6, APART = 5, APART_VALUE = 1.7;
    struct problem seen = *problem;
    struct turned_problem turned;
    enum status status = problem_turn_back(&seen, &turned, NULL);
    if (status == STATUS_OK)
        *pairs = forecast->tables
                     ? (PAIR + ALONE / fmin(forecast->residues, COLUMNS)) * pairs_about(&seen) + ENTRY * forecast->units
                     : (1 + forecast->apart * (APART + APART_VALUE * forecast->values)) * pairs_about(&seen)
                           + BLOCK * forecast->units;
    turned_free(&turned);
    return status;
}

enum status factorised_forecast(const struct problem *problem, const struct tree_settings *settings,
                                const struct factorised_cost *cost, struct forecast *forecast)
{
    const struct acquisition *a = problem->acquisition;
    const struct interpolator records = {.upsample = 1, .taps = 1, .degree = cost->degree};
    const struct bp_options options = {.engine = BP_ENGINE_GENERAL, .phase_limit = tree_phase_limit(settings, a)};
    const enum status status = bp_forecast(problem, &records, &options, forecast);
    if (status != STATUS_OK)
        return status;
    const double share = settings->error / sqrt(2 * settings->stages + 1);
    double *error = &forecast->error[CAUSE_INTERPOLATION]; /* of the records alone, a share of the error */
    *error = hypot(settings->error, sqrt(fmax(*error * *error - share * share, 0)));
    forecast->units = cost->blocks;
    forecast->apart = 0; /* images are sampled more finely than records */
    forecast->image_pairs = cost->records;
    forecast->image_cost = cost->images;
    forecast->image_flops = cost->flops;
    return STATUS_OK;
}

/* What is known of a subaperture and a patch, kept apart for sums that do not depend on the number of threads. */
static struct amounts *pixels_counted(const struct factorised *plan)
{
    const struct tree *tree = &plan->tree;
    const int patches = tree->problem.patch_count, count = tree->first[tree->settings.stages] * patches;
    struct amounts *amounts = calloc((size_t)count, sizeof *amounts);
    if (!amounts)
        return NULL;
#pragma omp parallel for schedule(dynamic)
    for (int i = 0; i < count; i++)
        amounts[i] = count_pixels(tree, i / patches, i % patches, tree->problem.estimate);
    return amounts;
}

void factorised_count(struct factorised *plan)
{
    const struct tree *tree = &plan->tree;
    const int patches = tree->problem.patch_count, count = tree->first[tree->settings.stages];
    struct amounts all = {0}, *pixels = pixels_counted(plan);
    plan->needed = store_room(&plan->bp.engines, (size_t)(count * patches), sizeof *plan->needed, 1);
    plan->used = store_room(&plan->bp.engines, (size_t)count, sizeof *plan->used, 1);
    plan->bp.engines.failed |= !pixels;
    for (int n = 0; !plan->bp.engines.failed && n < count; n++) {
        plan->used[n] = false;
        count_images(tree, &tree->subapertures[n], &all);
        plan->flops += 6 * (double)tree->subapertures[n].values / 2;
        for (int k = 0; k < patches; k++) {
            const struct amounts *some = &pixels[n * patches + k];
            plan->needed[n * patches + k] = some->lines > 0 || some->records > 0;
            plan->used[n] |= plan->needed[n * patches + k];
            plan->direct += some->records;
            all.images += some->images;
            all.traces += some->traces;
        }
    }
    free(pixels);
    for (int n = count - 1; !plan->bp.engines.failed && n >= 0; n--) /* parents first */
        if (tree->subapertures[n].parent >= 0)
            plan->used[n] |= plan->used[tree->subapertures[n].parent];
    plan->flops += all.records * (4.0 * (plan->bp.table.branches - 1) + 8) + flops_of(tree, &all);
}

void factorised_reads(const struct factorised *plan, bool *read)
{
    for (int n = 0; n < plan->tree.first[1]; n++) {
        const struct subaperture *part = &plan->tree.subapertures[n];
        for (int p = part->ping; p < part->ping + part->pings; p++)
            read[p] = plan->used[n];
    }
}

struct work factorised_work(const struct factorised *plan)
{
    const struct tree *tree = &plan->tree;
    struct work work = plan->bp.work;
    const double all = (double)plan->bp.problem.acquisition->pings * plan->bp.problem.acquisition->receivers
                       * problem_pixels(&plan->bp.problem);
    work.flops = plan->flops + plan->direct * (4.0 * (plan->bp.table.branches - 1) + 8);
    snprintf(work.engine, sizeof work.engine, "%d stages of %d", tree->settings.stages, tree->settings.factor);
    if (plan->direct > 0)
        snprintf(work.skipped, sizeof work.skipped, "%.3g %% of the pairs are summed from records, not from images",
                 100 * plan->direct / all);
    return work;
}
