/* Factorised back projection: subapertures from the smallest up, with the parts of one at a time in memory. One thread
   makes each line of places or pixels, parts in order, so that the bits do not depend on the number of threads. */
#include <math.h>
#include <omp.h>
#include <string.h>

#include "backprojection/budget.h"
#include "backprojection/factorised/factorised.h"
#include "common/memory.h"
#include "common/progress.h"

/* re, im of some values times exp(-j angle) from tables of cosines and sines. */
#define TURN(real)                                                                                                     \
    do {                                                                                                               \
        real *x = re, *y = im;                                                                                         \
        const real *c = (const real *)phasors + first, *s = c + size;                                                  \
        for (size_t i = 0; i < count; i++) {                                                                           \
            const real turned = x[i] * c[i] + y[i] * s[i];                                                             \
            y[i] = y[i] * c[i] - x[i] * s[i];                                                                          \
            x[i] = turned;                                                                                             \
        }                                                                                                              \
    } while (0)

static void turn_back(enum precision precision, const void *phasors, size_t size, size_t first, size_t count, void *re,
                      void *im)
{
    if (precision == PRECISION_DOUBLE)
        TURN(double);
    else
        TURN(float);
}

/* One execution. */
struct forming {
    struct factorised *plan;
    const struct echoes *echoes;
    struct stages *stages;
};

static void *image_of(const struct factorised *plan, int subaperture)
{
    const struct subaperture *part = &plan->tree.subapertures[subaperture];
    const int slot = part->parent < 0 ? 0 : subaperture - plan->tree.subapertures[part->parent].child;
    const size_t size = real_size(plan->bp.problem.precision);
    return (char *)plan->images[part->level] + (size_t)slot * plan->slot[part->level] * size;
}

/* A line of a subaperture's image. */
struct polar_line {
    double sine, cosine;
    struct pixel_line line; /* its places, seen from the centre: along r */
    void *re, *im;
};

static struct polar_line polar_line(const struct factorised *plan, int subaperture, int view, int number)
{
    const struct subaperture *part = &plan->tree.subapertures[subaperture];
    const struct polar *polar = &part->polars[view];
    const struct polar_step *step = polar_step(&plan->tree, part->level, view);
    const size_t size = real_size(plan->bp.problem.precision), pitch = polar_pitch(polar);
    struct polar_line line = {.sine = (polar->line_first + number) * step->sine,
                              .line = {0, polar->place_first * step->rho, 0, step->rho, polar->places}};
    line.cosine = sqrt(1 - line.sine * line.sine);
    line.re = (char *)image_of(plan, subaperture) + (polar->offset + (size_t)number * 2 * pitch) * size;
    line.im = (char *)line.re + pitch * size;
    memset(line.re, 0, 2 * pitch * size);
    return line;
}

static void polar_line_end(const struct factorised *plan, int subaperture, int view, const struct polar_line *line)
{
    const struct subaperture *part = &plan->tree.subapertures[subaperture];
    const struct polar_step *step = polar_step(&plan->tree, part->level, view);
    const struct polar *polar = &part->polars[view];
    turn_back(plan->bp.problem.precision, plan->phasors[part->level * plan->tree.views + view], (size_t)step->count,
              (size_t)(polar->place_first - step->place_first), (size_t)polar->places, line->re, line->im);
}

/* Records onto a line of an image of level 0: the ray is the axis r of a scene of its own. */
static void line_from_records(const struct factorised *plan, int subaperture, int view, int number)
{
    const struct subaperture *part = &plan->tree.subapertures[subaperture];
    const struct acquisition *a = plan->bp.problem.acquisition;
    const struct factorised_scratch *scratch = &plan->scratch[omp_get_thread_num()];
    const struct polar_line to = polar_line(plan, subaperture, view, number);
    const size_t receivers = (size_t)a->receivers, first = (size_t)part->ping;
    struct acquisition seen = *a;
    double ex, ey;
    polar_turn_back(polar_axes(&plan->tree, view), to.cosine, to.sine, &ex, &ey);
    seen.pings = part->pings;
    seen.t0 = a->t0 + first;
    seen.tx = scratch->tx;
    seen.rx = scratch->rx;
    seen.velocity = scratch->velocity;
    seen.aperture_limit = INFINITY;
    for (int p = 0; p < part->pings; p++) {
        const struct vector tx = a->tx[first + (size_t)p], v = a->velocity[first + (size_t)p];
        double x = tx.x - part->x, y = tx.y - part->y;
        seen.tx[p] = (struct vector){x * ey - y * ex, x * ex + y * ey, tx.z};
        seen.velocity[p] = (struct vector){v.x * ey - v.y * ex, v.x * ex + v.y * ey, v.z};
        for (size_t m = (size_t)p * receivers; m < (size_t)(p + 1) * receivers; m++) {
            const struct vector rx = a->rx[first * receivers + m];
            x = rx.x - part->x;
            y = rx.y - part->y;
            seen.rx[m] = (struct vector){x * ey - y * ex, x * ex + y * ey, rx.z};
        }
    }
    const struct grid grid = {0, 1, 1, to.line.r_first, to.line.r_step, to.line.count, 0};
    const double quintics = budget_quintics(plan->bp.medium.phase_limit, plan->bp.problem.precision);
    for (int p = 0; p < part->pings; p++)
        scratch->boxes[p] = ping_box_make(&seen, p, 1, &grid, quintics);
    const struct bp_lines lines = {&plan->bp,      plan->sum,  &seen,        plan->normal,
                                   scratch->boxes, plan->rows, plan->layout, {0, 0}};
    bp_lines_add(&lines, &to.line, 0, part->pings * a->receivers, to.re, to.im);
    polar_line_end(plan, subaperture, view, &to);
}

/* Pixels or places on a line, and its course through a subaperture's image. */
struct crossed {
    const struct pixel_line *line;
    struct vector centre; /* of the subaperture, in the line's axes */
    struct polar_crossing crossing;
    void *re, *im; /* sums of the line's pixel 0 */
};

/* Add a subaperture's image to pixels of a line. */
static void line_add(const struct factorised *plan, int subaperture, int view, const struct crossed *to,
                     struct pair_span span)
{
    const struct subaperture *part = &plan->tree.subapertures[subaperture];
    const struct polar *polar = &part->polars[view];
    const struct polar_step *step = polar_step(&plan->tree, part->level, view);
    struct factorised_scratch *scratch = &plan->scratch[omp_get_thread_num()];
    const struct problem *problem = &plan->bp.problem;
    const double c = plan->bp.medium.sound_speed;
    const struct polar_image image = {(const char *)image_of(plan, subaperture)
                                          + polar->offset * real_size(problem->precision),
                                      polar_pitch(polar),
                                      polar->line_first,
                                      polar->lines,
                                      polar->place_first,
                                      polar->places,
                                      step->rho,
                                      step->sine,
                                      &plan->tree.range,
                                      &plan->tree.angle};
    const struct vector centre = to->centre, p = line_pixel(to->line, span.begin),
                        q = line_pixel(to->line, span.end - 1);
    const double a = hypot(p.x - centre.x, p.y - centre.y), b = hypot(q.x - centre.x, q.y - centre.y);
    const int first = (int)floor(fmin(a, b) / step->rho) - 1, count = (int)floor(fmax(a, b) / step->rho) + 3 - first;
    const int before = first - image.range->taps / 2 + 1, behind = first + count + image.range->taps / 2;
    if (before < image.place_first || behind > image.place_first + image.places) {
        scratch->outside += span.end - span.begin;
        return;
    }
    scratch->outside += plan->trace(&image, &to->crossing, first, count, scratch->trace, plan->trace_pitch,
                                    &plan->polar_layout, scratch->row);
    struct bp_medium medium = plan->bp.medium;
    medium.fs = c / (2 * step->rho);
    medium.first = 0;
    medium.last = count - 1;
    const struct bp_ping ping = {centre,  {0, 0, 0},    2 * first * step->rho / c, 1,
                                 &centre, scratch->row, plan->polar_layout,        span};
    const struct bp_pings alone = {1, &ping};
    const struct ping_box box = {centre, centre, plan->reach, plan->longest};
    struct bp_block blocks[BP_BLOCKS];
    for (int n; (n = blocks_make(&box, to->line, &span, blocks)) > 0;)
        plan->sum(&medium, &plan->polar_table, &alone, to->line, n, blocks, to->re, to->im);
}

/* The images of its parts onto a line of a subaperture's. */
static void line_from_parts(const struct factorised *plan, int subaperture, int view, int number)
{
    const struct subaperture *part = &plan->tree.subapertures[subaperture];
    const struct polar_line to = polar_line(plan, subaperture, view, number);
    for (int n = part->child; n < part->child + part->children; n++) {
        const struct subaperture *child = &plan->tree.subapertures[n];
        double dx, dy;
        polar_turn(polar_axes(&plan->tree, view), part->x - child->x, part->y - child->y, &dx, &dy);
        const double offset = dy * to.cosine - dx * to.sine, along = dx * to.cosine + dy * to.sine;
        const struct crossed crossed = {&to.line, {-offset, -along, 0}, {offset, to.sine, to.cosine}, to.re, to.im};
        line_add(plan, n, view, &crossed, (struct pair_span){0, to.line.count});
    }
    polar_line_end(plan, subaperture, view, &to);
}

/* Pixels of one line of a patch: from the subaperture's images, and the rest from its records. */
static void line_of_pixels(const struct factorised *plan, int subaperture, int patch, int number)
{
    const struct tree *tree = &plan->tree;
    const struct subaperture *part = &tree->subapertures[subaperture];
    const struct problem *problem = &plan->bp.problem;
    const struct grid *grid = &problem->patches[patch];
    const struct pixel_line line = grid_line(grid, tree->along_x[patch], number);
    const size_t pixels = grid_pixels(grid), size = real_size(problem->precision);
    const size_t receivers = (size_t)problem->acquisition->receivers;
    char *re = (char *)plan->sums[patch] + (size_t)number * (size_t)line.count * size, *im = re + pixels * size;
    struct spans spans;
    for (int side = 0; side < 2; side++) {
        const int view = 2 * patch + side;
        double along, across;
        polar_turn(polar_axes(tree, view), line.x_first - part->x, line.r_first - part->y, &along, &across);
        const struct crossed crossed = {&line, {part->x, part->y, 0}, {across, 0, 1}, re, im};
        tree_pixels(tree, subaperture, view, &line, &spans);
        for (int k = 0; k < spans.count; k++)
            line_add(plan, subaperture, view, &crossed, spans.span[k]);
    }
    if (part->level > 0)
        return;
    const struct bp_lines lines = {&plan->bp,   plan->sum,  problem->acquisition, plan->normal,
                                   plan->boxes, plan->rows, plan->layout,         {0, 0}};
    tree_direct(tree, subaperture, patch, &line, &spans);
    for (int k = 0; k < spans.count; k++) {
        const int begin = spans.span[k].begin;
        struct pixel_line some = line;
        some.x_first += begin * line.x_step;
        some.r_first += begin * line.r_step;
        some.count = spans.span[k].end - begin;
        bp_lines_add(&lines, &some, (size_t)part->ping * receivers, part->pings * (int)receivers,
                     re + (size_t)begin * size, im + (size_t)begin * size);
    }
}

static void compress(const struct forming *forming, const struct subaperture *part)
{
    const struct factorised *plan = forming->plan;
    const size_t receivers = (size_t)plan->bp.problem.acquisition->receivers;
    const size_t row_bytes = plan->layout.record * real_size(plan->bp.problem.precision);
#pragma omp parallel for schedule(static)
    for (int n = 0; n < part->pings * (int)receivers; n++)
        bp_record_fill(&plan->bp, &plan->layout, forming->echoes, (size_t)part->ping * receivers + (size_t)n,
                       plan->scratch[omp_get_thread_num()].interleaved, (char *)plan->rows + (size_t)n * row_bytes);
    stages_end(forming->stages, "compress");
}

/* Make a subaperture's images, and add them to the pixels. */
static void subaperture_form(const struct forming *forming, int subaperture)
{
    const struct factorised *plan = forming->plan;
    const struct tree *tree = &plan->tree;
    const struct subaperture *part = &tree->subapertures[subaperture];
    if (!progress_step())
        return;
    for (int n = part->child; n < part->child + part->children; n++)
        subaperture_form(forming, n);
    if (!plan->used[subaperture])
        return;
    if (part->level == 0)
        compress(forming, part);
    for (int v = 0; v < tree->views; v++) {
#pragma omp parallel for schedule(dynamic)
        for (int n = 0; n < part->polars[v].lines; n++)
            if (part->level == 0)
                line_from_records(plan, subaperture, v, n);
            else
                line_from_parts(plan, subaperture, v, n);
    }
    stages_end(forming->stages, part->level == 0 ? "records" : "merge");
    for (int k = 0; k < tree->problem.patch_count; k++)
        if (plan->needed[subaperture * tree->problem.patch_count + k]) {
#pragma omp parallel for schedule(dynamic)
            for (int n = 0; n < grid_line_count(&tree->problem.patches[k], tree->along_x[k]); n++)
                line_of_pixels(plan, subaperture, k, n);
        }
    stages_end(forming->stages, "pixels");
}

enum status factorised_execute(struct factorised *plan, const struct echoes *echoes, struct image *image,
                               struct stages *stages)
{
    const struct tree *tree = &plan->tree;
    const struct forming forming = {plan, echoes, stages};
    const size_t size = real_size(plan->bp.problem.precision);
    long long outside = 0;
    for (int n = 0; n < plan->threads; n++)
        plan->scratch[n].outside = 0;
    for (int k = 0; k < tree->problem.patch_count; k++) {
        const struct grid *grid = &tree->problem.patches[k];
        memory_clear(plan->sums[k], 2 * grid_pixels(grid) * size);
    }
    progress_part(0, 1, tree->first[tree->settings.stages]);
    for (int n = tree->first[tree->settings.stages - 1]; n < tree->first[tree->settings.stages]; n++)
        subaperture_form(&forming, n);
    for (int k = 0; k < tree->problem.patch_count; k++) {
        const struct pixel_window all = problem_window(&tree->problem, k);
        bp_lines_store(plan->bp.problem.precision, &tree->problem.patches[k], tree->along_x[k], plan->sums[k], &all,
                       image->pixels[k]);
    }
    stages_end(stages, "store");
    for (int n = 0; n < plan->threads; n++)
        outside += plan->scratch[n].outside;
    return outside == 0 ? STATUS_OK
                        : status_set(STATUS_FAILED,
                                     "bp_factorised: %lld values lie outside of subapertures' images and were read as "
                                     "zero: a fault of this program; stages=0 does without images",
                                     outside);
}
