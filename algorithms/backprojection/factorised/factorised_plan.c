/* Plan and work of factorised back projection (factorised.h). */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/budget.h"
#include "backprojection/factorised/factorised.h"
#include "common/memory.h"

static polar_trace_function *const trace_functions[][2] = {
    [ISA_BASELINE] = {polar_trace_float_baseline, polar_trace_double_baseline},
#ifdef SASBENCH_X86_64
    [ISA_V3] = {polar_trace_float_v3, polar_trace_double_v3},
    [ISA_V4] = {polar_trace_float_v4, polar_trace_double_v4},
#endif
};

static void *allocate(struct factorised *plan, size_t bytes)
{
    plan->bp.work.bytes += (double)bytes;
    return memory_aligned(64, bytes);
}

static bool images_make(struct factorised *plan)
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
        plan->images[level] = allocate(plan, (size_t)slots * plan->slot[level] * size);
        if (!plan->images[level])
            return false;
    }
    return true;
}

static bool phasors_make(struct factorised *plan)
{
    const struct tree *tree = &plan->tree;
    const struct acquisition *a = plan->bp.problem.acquisition;
    const int count = tree->settings.stages * tree->views;
    const bool is_double = plan->bp.problem.precision == PRECISION_DOUBLE;
    plan->phasors = calloc((size_t)count, sizeof *plan->phasors);
    if (!plan->phasors)
        return false;
    plan->bp.work.bytes += (double)count * sizeof *plan->phasors;
    for (int k = 0; k < count; k++) {
        const struct polar_step *step = &tree->steps[k];
        const size_t size = (size_t)step->count;
        plan->phasors[k] = allocate(plan, 2 * (size + 1) * real_size(plan->bp.problem.precision));
        if (!plan->phasors[k])
            return false;
        for (size_t n = 0; n < size; n++) {
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
    return true;
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

static bool scratch_make(struct factorised *plan)
{
    const struct acquisition *a = plan->bp.problem.acquisition;
    const size_t size = real_size(plan->bp.problem.precision), base = (size_t)plan->tree.settings.base;
    const size_t receivers = (size_t)a->receivers, row = plan->polar_layout.record + 1;
    plan->threads = omp_get_max_threads();
    plan->scratch = calloc((size_t)plan->threads, sizeof *plan->scratch);
    if (!plan->scratch)
        return false;
    double bytes = 0;
    for (int n = 0; n < plan->threads; n++) {
        struct factorised_scratch *s = &plan->scratch[n];
        const double before = plan->bp.work.bytes;
        s->interleaved = allocate(plan, 2 * bp_record_values(&plan->bp) * size);
        s->tx = allocate(plan, base * sizeof *s->tx);
        s->velocity = allocate(plan, base * sizeof *s->velocity);
        s->rx = allocate(plan, base * receivers * sizeof *s->rx);
        s->boxes = allocate(plan, base * sizeof *s->boxes);
        s->trace = allocate(plan, 2 * plan->trace_pitch * size);
        s->row = allocate(plan, row * size);
        if (!s->interleaved || !s->tx || !s->velocity || !s->rx || !s->boxes || !s->trace || !s->row)
            return false;
        /* What lies behind a trace is computed with, unused: what memory holds may be subnormal, which is slow. */
        memset(s->trace, 0, 2 * plan->trace_pitch * size);
        memset(s->row, 0, row * size);
        bytes = plan->bp.work.bytes - before;
        plan->bp.work.bytes = before;
    }
    plan->bp.work.bytes += bytes + sizeof *plan->scratch; /* of one thread */
    return true;
}

static bool sums_make(struct factorised *plan)
{
    const struct problem *problem = &plan->bp.problem;
    plan->sums = calloc((size_t)problem->patch_count, sizeof *plan->sums);
    if (!plan->sums)
        return false;
    plan->bp.work.bytes += (double)problem->patch_count * sizeof *plan->sums;
    for (int k = 0; k < problem->patch_count; k++) {
        const size_t pixels = (size_t)problem->patches[k].x_count * (size_t)problem->patches[k].r_count;
        plan->sums[k] = allocate(plan, 2 * pixels * real_size(problem->precision));
        if (!plan->sums[k])
            return false;
    }
    return true;
}

static bool pings_make(struct factorised *plan)
{
    const struct problem *problem = &plan->bp.problem;
    const struct acquisition *a = problem->acquisition;
    const double quintics = budget_quintics(plan->bp.medium.phase_limit, problem->precision);
    plan->normal = allocate(plan, (size_t)a->pings * sizeof *plan->normal);
    plan->boxes = allocate(plan, (size_t)a->pings * sizeof *plan->boxes);
    const size_t row = plan->layout.record * real_size(problem->precision);
    plan->rows = allocate(plan, (size_t)plan->tree.settings.base * (size_t)a->receivers * row + row);
    if (!plan->normal || !plan->boxes || !plan->rows)
        return false;
    for (int p = 0; p < a->pings; p++) {
        plan->normal[p] = acquisition_normal(a, p);
        plan->boxes[p] = ping_box_make(a, p, problem->patch_count, problem->patches, quintics);
    }
    return true;
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
    enum status status = bp_plan_traces(bp);
    if (status != STATUS_OK)
        return status;
    const enum precision precision = bp->problem.precision;
    const size_t places = (size_t)places_most(&plan->tree);
    plan->sum = bp_sum_choose(precision);
    plan->trace = trace_functions[isa_choose()][precision];
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
    plan->bp.work.bytes = sizeof *plan;
    enum status status = problem_turn_back(&plan->bp.problem, &plan->bp.turned, &plan->bp.work.bytes);
    if (status == STATUS_OK)
        status = tree_make(&plan->bp.problem, settings, &plan->tree);
    if (status == STATUS_OK)
        status = memory_check(bytes_needed(&plan->tree, problem->precision), "images of subapertures");
    plan->bp.work.bytes += plan->tree.bytes;
    if (status == STATUS_OK)
        status = reading_make(plan);
    if (status == STATUS_OK
        && !(pings_make(plan) && images_make(plan) && phasors_make(plan) && scratch_make(plan) && sums_make(plan)
             && factorised_count(plan)))
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
    for (int k = 0; plan->sums && k < plan->bp.problem.patch_count; k++)
        free(plan->sums[k]);
    for (int k = 0; plan->phasors && k < plan->tree.settings.stages * plan->tree.views; k++)
        free(plan->phasors[k]);
    for (int n = 0; plan->scratch && n < plan->threads; n++) {
        struct factorised_scratch *s = &plan->scratch[n];
        free(s->interleaved);
        free(s->tx);
        free(s->velocity);
        free(s->rx);
        free(s->boxes);
        free(s->trace);
        free(s->row);
    }
    for (int level = 0; level < STAGES_MOST; level++)
        free(plan->images[level]);
    free(plan->scratch);
    free(plan->sums);
    free(plan->phasors);
    free(plan->needed);
    free(plan->normal);
    free(plan->boxes);
    free(plan->rows);
    (plan->bp.problem.precision == PRECISION_DOUBLE ? traces_destroy_double : traces_destroy_float)(plan->bp.traces);
    tree_free(&plan->tree);
    turned_free(&plan->bp.turned);
    free(plan);
}
