/* Plan and work of factorised back projection (factorised.h). */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/budget.h"
#include "backprojection/factorised/factorised.h"

static void *room(struct factorised *plan, size_t count, size_t size)
{
    return store_room(&plan->bp.engines, count, size, 1);
}

static void images_make(struct factorised *plan)
{
    const struct tree *tree = &plan->tree;
    const size_t size = real_size(plan->bp.problem.precision);
    for (int level = 0; level < tree->settings.stages; level++) {
        const bool top = level == tree->settings.stages - 1;
        const int count = tree->first[level + 1] - tree->first[level];
        const int slots = top ? 1 : count < tree->settings.factor ? count : tree->settings.factor;
        for (int n = tree->first[level]; n < tree->first[level + 1]; n++)
            if (tree->subapertures[n].values > plan->slot[level])
                plan->slot[level] = tree->subapertures[n].values;
        plan->slot[level] += 16;
        plan->images[level] = room(plan, (size_t)slots * plan->slot[level], size);
    }
}

static void phasors_make(struct factorised *plan)
{
    const struct tree *tree = &plan->tree;
    const struct acquisition *a = plan->bp.problem.acquisition;
    const int count = tree->settings.stages * tree->views;
    const bool is_double = plan->bp.problem.precision == PRECISION_DOUBLE;
    plan->phasors = room(plan, (size_t)count, sizeof *plan->phasors);
    for (int k = 0; k < count && !plan->bp.engines.failed; k++) {
        const struct polar_step *step = &tree->steps[k];
        const size_t size = (size_t)step->count;
        plan->phasors[k] = room(plan, 2 * (size + 1), real_size(plan->bp.problem.precision));
        for (size_t n = 0; plan->phasors[k] && n < size; n++) {
            double cycles = a->fc * 2 * ((double)step->place_first + (double)n) * step->rho / a->sound_speed;
            cycles -= floor(cycles);
            const double c = cos(2 * M_PI * cycles), s = sin(2 * M_PI * cycles);
            if (is_double) {
                ((double *)plan->phasors[k])[n] = c;
                ((double *)plan->phasors[k])[size + n] = s;
            } else {
                ((float *)plan->phasors[k])[n] = (float)c;
                ((float *)plan->phasors[k])[size + n] = (float)s;
            }
        }
    }
}

/* The longest trace, in places. */
static int places_most(const struct tree *tree)
{
    int most = 0;
    for (int n = 0; n < tree->first[tree->settings.stages]; n++)
        for (int v = 0; v < tree->views; v++)
            most = tree->subapertures[n].polars[v].places > most ? tree->subapertures[n].polars[v].places : most;
    return most;
}

/* Scratch of all threads in one block, so that its counted bytes are the same for any number of threads. */
static void scratch_make(struct factorised *plan)
{
    enum { PARTS = 7, LINE = 64 };
    const struct acquisition *a = plan->bp.problem.acquisition;
    const size_t size = real_size(plan->bp.problem.precision), base = (size_t)plan->tree.settings.base;
    const size_t row = plan->polar_layout.record + 1, vectors = base * sizeof(struct vector);
    const size_t bytes[PARTS] = {2 * bp_record_values(&plan->bp) * size,
                                 vectors,
                                 vectors,
                                 vectors * (size_t)a->receivers,
                                 base * sizeof(struct ping_box),
                                 2 * plan->trace_pitch * size,
                                 row * size};
    size_t from[PARTS + 1] = {0}; /* each at a cache line */
    for (int k = 0; k < PARTS; k++)
        from[k + 1] = from[k] + (bytes[k] + LINE - 1) / LINE * LINE;
    plan->threads = omp_get_max_threads();
    const double share = 1.0 / plan->threads;
    struct store *store = &plan->bp.engines;
    plan->scratch = store_room(store, (size_t)plan->threads, sizeof *plan->scratch, share);
    char *block = store_room(store, (size_t)plan->threads, from[PARTS], share);
    for (int n = 0; !store->failed && n < plan->threads; n++, block += from[PARTS]) {
        plan->scratch[n] = (struct factorised_scratch){.interleaved = block,
                                                       .tx = (void *)(block + from[1]),
                                                       .velocity = (void *)(block + from[2]),
                                                       .rx = (void *)(block + from[3]),
                                                       .boxes = (void *)(block + from[4]),
                                                       .trace = block + from[5],
                                                       .row = block + from[6]};
        /* Values behind a trace are computed with, unused: leftovers in memory may be subnormal, which is slow. */
        memset(block + from[5], 0, bytes[5]);
        memset(block + from[6], 0, bytes[6]);
    }
}

static void sums_make(struct factorised *plan)
{
    const struct problem *problem = &plan->bp.problem;
    plan->sums = room(plan, (size_t)problem->patch_count, sizeof *plan->sums);
    for (int k = 0; plan->sums && k < problem->patch_count; k++)
        plan->sums[k] = room(plan, 2 * grid_pixels(&problem->patches[k]), real_size(problem->precision));
}

static void pings_make(struct factorised *plan)
{
    const struct problem *problem = &plan->bp.problem;
    const struct acquisition *a = problem->acquisition;
    const double quintics = budget_quintics(plan->bp.medium.phase_limit, problem->precision);
    plan->normal = room(plan, (size_t)a->pings, sizeof *plan->normal);
    plan->boxes = room(plan, (size_t)a->pings, sizeof *plan->boxes);
    const size_t records = (size_t)plan->tree.settings.base * (size_t)a->receivers;
    plan->rows = room(plan, records + 1, plan->layout.record * real_size(problem->precision));
    for (int p = 0; !plan->bp.engines.failed && p < a->pings; p++) {
        plan->normal[p] = acquisition_normal(a, p);
        plan->boxes[p] = ping_box_make(a, p, problem->patch_count, problem->patches, quintics);
    }
}

/* Records, tables and layouts. */
static enum status reading_make(struct factorised *plan)
{
    struct bp *bp = &plan->bp;
    const struct acquisition *a = bp->problem.acquisition;
    const int degree = plan->tree.degree, branches = plan->tree.range.branches;
    bp->medium =
        (struct bp_medium){a->sound_speed, a->fc, a->fs, 0, a->samples - 1, tree_phase_limit(&plan->tree.settings, a)};
    bp->table = (struct bp_table){.reading = BP_BRANCHES,
                                  .upsample = 1,
                                  .steps = 1,
                                  .taps = degree + 1,
                                  .guard = BP_BRANCHES_GUARD,
                                  .branches = degree + 1,
                                  .shift = 0.5};
    enum status status = bp_plan_traces(bp, tree_samples(&plan->tree));
    if (status != STATUS_OK)
        return status;
    const enum precision precision = bp->problem.precision;
    const size_t places = (size_t)places_most(&plan->tree);
    plan->sum = ISA_CHOOSE(bp_sum, precision);
    plan->trace = ISA_CHOOSE(polar_trace, precision);
    plan->layout = bp_layout_make(precision, bp_branch_length(bp), degree + 1, true);
    plan->polar_layout = bp_layout_make(precision, places + 3 * BP_BRANCHES_GUARD, branches, true);
    plan->polar_table = bp->table;
    plan->polar_table.taps = plan->polar_table.branches = branches;
    plan->polar_table.origin = plan->polar_table.guard;
    plan->polar_table.shift = 0; /* read half way between two samples (backprojection/kernel.h) */
    plan->trace_pitch = (places + 2 * FITTED_TAPS_MOST + TRACE_PLACES + 15) / 16 * 16;
    const double quintics = budget_quintics(bp->medium.phase_limit, precision);
    plan->reach = pow(256 * quintics * a->sound_speed / (2 * M_PI * a->fc), 1.0 / 6);
    plan->longest = 0x1p18 * a->sound_speed / a->fc;
    return STATUS_OK;
}

static double bytes_needed(const struct tree *tree, enum precision precision)
{
    double values = 0;
    for (int level = 0; level < tree->settings.stages; level++) {
        double most = 0;
        for (int n = tree->first[level]; n < tree->first[level + 1]; n++)
            most = fmax(most, (double)tree->subapertures[n].values);
        values += most * (level == tree->settings.stages - 1 ? 1 : tree->settings.factor);
    }
    return (values + 2 * problem_pixels(&tree->problem)) * (double)real_size(precision);
}

enum status factorised_plan(const struct problem *problem, const struct tree_settings *settings,
                            struct factorised **out)
{
    *out = NULL;
    struct factorised *plan = calloc(1, sizeof *plan);
    if (!plan)
        return status_set(STATUS_FAILED, "no memory for the plan");
    plan->bp.problem = *problem;
    plan->bp.work.bytes = BP_BYTES(*plan);
    enum status status = problem_turn_back(&plan->bp.problem, &plan->bp.turned, &plan->bp.work.bytes);
    if (status == STATUS_OK)
        status = tree_make(&plan->bp.problem, settings, &plan->tree);
    if (status == STATUS_OK)
        status = memory_check(bytes_needed(&plan->tree, problem->precision), "images of subapertures");
    plan->bp.work.bytes += plan->tree.bytes;
    if (status == STATUS_OK)
        status = reading_make(plan);
    if (status == STATUS_OK) {
        pings_make(plan);
        images_make(plan);
        phasors_make(plan);
        scratch_make(plan);
        sums_make(plan);
        factorised_count(plan);
    }
    plan->bp.work.bytes += plan->bp.engines.bytes;
    if (status == STATUS_OK && plan->bp.engines.failed)
        status = status_set(STATUS_FAILED, "no memory for images of subapertures");
    if (status != STATUS_OK) {
        factorised_destroy(plan);
        return status;
    }
    plan->flops += plan->bp.shape.flops * problem->acquisition->pings * problem->acquisition->receivers;
    *out = plan;
    return STATUS_OK;
}

void factorised_destroy(struct factorised *plan)
{
    if (!plan)
        return;
    store_release(&plan->bp.engines);
    tree_free(&plan->tree);
    turned_free(&plan->bp.turned);
    free(plan);
}
