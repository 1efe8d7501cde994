/* The tree of subapertures (tree.h): parents and parts; steps and grids from the largest down; their available extent
   from the smallest up. */
#include "backprojection/factorised/tree.h"

#include <math.h>
#include <stdlib.h>

#include "backprojection/budget.h"
#include "backprojection/factorised/grids.h"
#include "backprojection/farrow.h"
#include "common/pulse_band.h"

/* Steps of range, over a record's samples c/(2 fs), at most: runs of pixels are fastest below one sample a pixel
   (general/run.h), of a level's image as of its parts' images. */
static const double STEP_MOST = 0.93, STEP_NEXT = 0.975;
static const double RATE_LEAST = 10;   /* lines a unit of s: a single ping would need almost none */
static const double ANGLE_LEAST = 1.1; /* oversampling */
static const double RANGE_MOST = 3;    /* oversampling by small steps of a record that is sampled far finer */

double tree_phase_limit(const struct tree_settings *settings, const struct acquisition *a)
{
    return budget_limit(fmin(1e-3, fmax(1e-6, 0.03 * settings->error)), a->fc, a->fs);
}

static void add(struct vector *sum, struct vector v, double weight)
{
    sum->x += weight * v.x;
    sum->y += weight * v.y;
    sum->z += weight * v.z;
}

/* Seconds from emission to the echoes of the patches' middle. */
static double delay_of_middle(const struct problem *problem, struct vector tx)
{
    double sum = 0;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        const struct vector middle = grid_point(g, 0.5 * (g->r_count - 1), 0.5 * (g->x_count - 1));
        sum += 2 * vector_norm(vector_difference(middle, tx)) / problem->acquisition->sound_speed;
    }
    return sum / problem->patch_count;
}

/* Midpoint of transmitter and receiver when the echo of the patches' middle arrives, in the plane of the image. */
static struct vector middle_of(const struct problem *problem, int ping, int receiver)
{
    const struct acquisition *a = problem->acquisition;
    const struct vector tx = a->tx[ping], v = a->velocity[ping];
    const struct vector rx = a->rx[(size_t)ping * (size_t)a->receivers + (size_t)receiver];
    const double tau = delay_of_middle(problem, tx);
    return (struct vector){0.5 * (tx.x + rx.x + v.x * tau), 0.5 * (tx.y + rx.y + v.y * tau), 0};
}

static void subaperture_place(const struct problem *problem, struct subaperture *part)
{
    const struct acquisition *a = problem->acquisition;
    const double weight = 1.0 / part->pings, one = weight / a->receivers;
    struct vector centre = {0, 0, 0}, tx = {0, 0, 0}, normal = {0, 0, 0};
    for (int p = part->ping; p < part->ping + part->pings; p++) {
        add(&tx, a->tx[p], weight);
        add(&normal, acquisition_normal(a, p), weight);
        for (int m = 0; m < a->receivers; m++)
            add(&centre, middle_of(problem, p, m), one);
    }
    const double size = vector_norm(normal);
    part->x = centre.x;
    part->y = centre.y;
    part->tx = tx;
    part->normal = size > 0 ? (struct vector){normal.x / size, normal.y / size, normal.z / size} : normal;
    part->normal_radius = size > 0 ? 0 : M_PI;
    for (int p = part->ping; p < part->ping + part->pings; p++) {
        const struct vector n = acquisition_normal(a, p);
        const double off = vector_norm(vector_difference(n, part->normal));
        part->tx_radius = fmax(part->tx_radius, vector_norm(vector_difference(a->tx[p], tx)));
        part->normal_radius = fmax(part->normal_radius, 2 * asin(fmin(1, 0.5 * off)));
        part->radius = fmax(part->radius, hypot(a->tx[p].x - part->x, a->tx[p].y - part->y));
        for (int m = 0; m < a->receivers; m++) {
            const struct vector rx = a->rx[(size_t)p * (size_t)a->receivers + (size_t)m];
            part->radius = fmax(part->radius, hypot(rx.x - part->x, rx.y - part->y));
        }
    }
}

/* Subapertures of level l have base factor^l pings each, the last one the rest. */
static long long pings_of(const struct tree_settings *settings, int level)
{
    double pings = settings->base;
    for (int n = 0; n < level; n++)
        pings *= settings->factor;
    return pings < 1e9 ? (long long)pings : 1000000000;
}

static int count_of(const struct tree *tree, int level)
{
    const long long pings = pings_of(&tree->settings, level);
    return (int)((tree->problem.acquisition->pings + pings - 1) / pings);
}

static void subapertures_make(struct tree *tree)
{
    const int stages = tree->settings.stages, factor = tree->settings.factor;
    for (int level = 0; level < stages; level++)
        for (int n = 0; n < count_of(tree, level); n++) {
            const long long pings = pings_of(&tree->settings, level),
                            left = tree->problem.acquisition->pings - n * pings;
            struct subaperture *part = &tree->subapertures[tree->first[level] + n];
            *part =
                (struct subaperture){.ping = (int)(n * pings),
                                     .pings = (int)(left < pings ? left : pings),
                                     .level = level,
                                     .parent = level + 1 < stages ? tree->first[level + 1] + n / factor : -1,
                                     .polars = tree->polars + (size_t)(tree->first[level] + n) * (size_t)tree->views};
            if (level > 0) {
                const int all = tree->first[level] - tree->first[level - 1], before = n * factor;
                part->child = tree->first[level - 1] + before;
                part->children = all - before < factor ? all - before : factor;
            }
            subaperture_place(&tree->problem, part);
        }
}

/* The extent that all views of a subaperture need. */
static struct sector wanted(const struct tree *tree, const struct subaperture *part, int view)
{
    const struct sector pixels = sector_of_pixels(tree, part, view);
    if (part->parent < 0)
        return pixels;
    return sector_join(pixels, sector_of_grid(tree, part, &tree->subapertures[part->parent], view));
}

/* m: the largest step of range of a level. */
static double step_most(const struct tree *tree, int level)
{
    const struct acquisition *a = tree->problem.acquisition;
    const double sample = STEP_MOST * a->sound_speed / (2 * a->fs);
    return pow(STEP_NEXT, level) * fmax(sample, a->sound_speed / (2 * tree->band * RANGE_MOST));
}

/* Lines a unit of s, no fewer than in the margins that the taps need, where frequencies may be higher. */
static double rate_with_margins(const struct tree *tree, int level, int view, const struct sector *sectors,
                                const struct polar_step *step)
{
    const double margin = (0.5 * tree->angle.taps + 1) / fmax(step->sine, RATE_LEAST);
    struct polar_step wide = {.sine = fmax(step->sine, RATE_LEAST)};
    for (int n = tree->first[level]; n < tree->first[level + 1]; n++) {
        struct sector sector = sectors[n];
        sector.low = fmax(sector.low - margin, -SINE_WIDEST);
        sector.high = fmin(sector.high + margin, SINE_WIDEST);
        if (sector.rho_low <= sector.rho_high)
            sector_rates(tree, &tree->subapertures[n], view, sector, &wide);
    }
    return wide.sine;
}

/* Steps and grids of a level, those of the level above being made. */
static void level_cover(struct tree *tree, int level, struct sector *sectors)
{
    for (int v = 0; v < tree->views; v++) {
        struct polar_step *step = polar_step(tree, level, v);
        *step = (struct polar_step){.rho = 1 / step_most(tree, level)};
        for (int n = tree->first[level]; n < tree->first[level + 1]; n++) {
            sectors[n] = wanted(tree, &tree->subapertures[n], v);
            if (sectors[n].rho_low <= sectors[n].rho_high)
                sector_rates(tree, &tree->subapertures[n], v, sectors[n], step);
        }
        step->sine = rate_with_margins(tree, level, v, sectors, step);
        step->rho = 1 / step->rho;
        step->sine = 1 / step->sine;
        for (int n = tree->first[level]; n < tree->first[level + 1]; n++)
            grid_cover(tree, step, sectors[n], &tree->subapertures[n].polars[v]);
    }
}

/* The available extent of the grids, their memory, and the places of each level. */
static void level_clip(struct tree *tree, int level)
{
    const int first = tree->first[level], end = tree->first[level + 1];
#pragma omp parallel for schedule(dynamic)
    for (int n = first; n < end; n++) {
        struct subaperture *part = &tree->subapertures[n];
        for (int v = 0; v < tree->views; v++)
            if (level == 0)
                grid_clip_records(tree, part, v, &part->polars[v]);
            else
                grid_clip_parts(tree, part, v, &part->polars[v]);
    }
    for (int n = first; n < end; n++) {
        struct subaperture *part = &tree->subapertures[n];
        for (int v = 0; v < tree->views; v++) {
            struct polar *polar = &part->polars[v];
            polar->offset = part->values;
            part->values += (size_t)polar->lines * 2 * polar_pitch(polar);
            struct polar_step *step = polar_step(tree, level, v);
            const int behind = polar->place_first + polar->places;
            if (polar->lines > 0 && (step->count == 0 || polar->place_first < step->place_first)) {
                step->count += step->count == 0 ? 0 : step->place_first - polar->place_first;
                step->place_first = polar->place_first;
            }
            if (polar->lines > 0 && behind - step->place_first > step->count)
                step->count = behind - step->place_first;
        }
    }
}

/* Lines run along range as seen from the middle of the track: along x or along r. */
static bool lines_along_x(const struct problem *problem, const struct grid *grid)
{
    const struct acquisition *a = problem->acquisition;
    const struct vector middle = grid_point(grid, 0.5 * (grid->r_count - 1), 0.5 * (grid->x_count - 1));
    const struct vector tx = a->tx[a->pings / 2];
    return fabs(middle.x - tx.x) > fabs(middle.y - tx.y);
}

static enum status taps_make(struct tree *tree)
{
    const struct acquisition *a = tree->problem.acquisition;
    const double each = tree_error_each(&tree->settings);
    struct law_spectrum spectrum;
    if (!law_spectrum(a, image_cells(&tree->problem), &spectrum))
        return STATUS_FAILED;
    tree->band = law_band(&spectrum, a, each * each);
    tree->degree = farrow_degree(each, &spectrum, 1);
    const double least = 0.8 * a->sound_speed / (2 * tree->band * step_most(tree, 0)); /* the least that this leaves */
    const enum status status = polar_taps_choose(each, ANGLE_LEAST, &tree->angle);
    tree->range = tree->angle;
    return status == STATUS_OK && !(tree->range.oversampling >= least) ? polar_taps_choose(each, least, &tree->range)
                                                                       : status;
}

enum status tree_make(const struct problem *problem, const struct tree_settings *settings, struct tree *tree)
{
    *tree = (struct tree){.problem = *problem, .settings = *settings, .views = 2 * problem->patch_count};
    for (int level = 0; level < settings->stages; level++)
        tree->first[level + 1] = tree->first[level] + count_of(tree, level);
    const size_t count = (size_t)tree->first[settings->stages], views = (size_t)tree->views;
    enum status status = taps_make(tree);
    if (status != STATUS_OK)
        return status;
    tree->along_x = malloc((size_t)problem->patch_count * sizeof *tree->along_x);
    tree->subapertures = calloc(count, sizeof *tree->subapertures);
    tree->polars = calloc(count * views, sizeof *tree->polars);
    tree->steps = calloc((size_t)settings->stages * views, sizeof *tree->steps);
    struct sector *sectors = malloc(count * sizeof *sectors);
    if (!tree->along_x || !tree->subapertures || !tree->polars || !tree->steps || !sectors) {
        free(sectors);
        return status_set(STATUS_FAILED, "no memory for a tree of %zu subapertures", count);
    }
    for (int k = 0; k < problem->patch_count; k++)
        tree->along_x[k] = lines_along_x(problem, &problem->patches[k]);
    subapertures_make(tree);
    for (int level = settings->stages - 1; level >= 0; level--)
        level_cover(tree, level, sectors);
    free(sectors);
    for (int level = 0; level < settings->stages; level++)
        level_clip(tree, level);
    tree->bytes = (double)problem->patch_count * sizeof *tree->along_x + (double)count * sizeof *tree->subapertures
                  + (double)(count * views) * sizeof *tree->polars
                  + (double)(settings->stages * views) * sizeof *tree->steps;
    return STATUS_OK;
}

void tree_free(struct tree *tree)
{
    free(tree->along_x);
    free(tree->subapertures);
    free(tree->polars);
    free(tree->steps);
    *tree = (struct tree){.views = 0};
}

/* A place at rho lies within rho -+ radius of a subaperture's elements, but for their height and for receivers' way
   while the echo is under way. */
struct sample_span tree_samples(const struct tree *tree)
{
    const struct acquisition *a = tree->problem.acquisition;
    struct sample_span read = pairs_samples(&tree->problem, NULL, 0);
    for (int n = 0; n < tree->first[1]; n++) {
        const struct subaperture *part = &tree->subapertures[n];
        double near = INFINITY, far = 0;
        for (int view = 0; view < tree->views; view++) {
            const struct polar *polar = &part->polars[view];
            const double rho = polar_step(tree, 0, view)->rho;
            if (polar->lines == 0)
                continue;
            near = fmin(near, polar->place_first * rho);
            far = fmax(far, (polar->place_first + polar->places - 1) * rho);
        }
        for (int p = part->ping; p < part->ping + part->pings && near <= far; p++) {
            const double speed = vector_norm(a->velocity[p]), c = a->sound_speed;
            double height = fabs(a->tx[p].z);
            for (int m = 0; m < a->receivers; m++)
                height = fmax(height, fabs(a->rx[(size_t)p * (size_t)a->receivers + (size_t)m].z));
            const double away = hypot(far + part->radius, height);
            const double least = 2 * fmax(0, near - part->radius) / (c + speed), most = 2 * away / (c - speed);
            read.first = fmin(read.first, floor((least - a->t0[p]) * a->fs) - 1);
            read.last = fmax(read.last, ceil((most - a->t0[p]) * a->fs) + 1);
        }
    }
    return (struct sample_span){fmax(read.first, 0), fmin(read.last, a->samples - 1)};
}
