/* Cells by counted work (cells.h). */
#define _GNU_SOURCE /* asprintf */
#include "ranks/cells.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/pairs/pairs.h"
#include "echoes/echo_data.h"
#include "measure/session.h"
#include "text/number.h"

/* FLOPs in whose time an engine sums a pair that no forecast counts; the exact image a pair, by sines and square roots;
   and the least of a cell: each image is repeated for half a second, some five times. */
static const double PAIR = 20, EXACT = 350, LEAST = 1.7e9, TIMES = 5;

enum status shard_parse(const char *command, const char *text, struct shard *shard)
{
    long long number, count;
    *shard = (struct shard){0, 0};
    if (!text)
        return STATUS_OK;
    const char *end = whole_read(text, 1, INT_MAX, &number);
    end = end && *end == '/' ? whole_read(end + 1, 1, INT_MAX, &count) : NULL;
    if (!end || *end || number > count)
        return status_set(STATUS_INVALID, "%s: --shard is '%s', must be a shard and their number, from 1/8 to 8/8",
                          command, text);
    *shard = (struct shard){(int)number, (int)count};
    return STATUS_OK;
}

static double flops_of(const struct scene *scene, const struct spec *spec)
{
    const struct algorithm *algorithm = spec->algorithm;
    const struct problem problem = session_problem(scene, algorithm, spec->precision);
    const struct forecast plain = {.sums_pairs = true, .pair_flops = algorithm->traits & TRAIT_EXACT ? EXACT : PAIR};
    struct forecast f = plain;
    const enum status status = algorithm->cost ? algorithm_cost(algorithm, &problem, spec->options, &f) : STATUS_OK;
    if (status == STATUS_UNSUPPORTED)
        return 0;
    if (status != STATUS_OK)
        f = plain;
    if (!f.sums_pairs)
        return f.migration_flops;
    return f.pair_flops * (f.image_cost > 0 ? f.image_pairs : pairs_estimate(&problem)) + f.image_flops + f.record_flops
           + f.kernel_flops;
}

static enum status scene_add(struct cells *cells, const struct scene *scene, int *index)
{
    const struct acquisition *a = &scene->acquisition;
    const struct problem exact = session_problem(scene, algorithm_find("reference"), PRECISION_DOUBLE);
    for (int k = 0; k < cells->scene_count; k++)
        if (strcmp(cells->scenes[k].name, scene->name) == 0) {
            *index = k;
            return STATUS_OK;
        }
    struct cell_scene *scenes = realloc(cells->scenes, ((size_t)cells->scene_count + 1) * sizeof *scenes);
    char *name = scenes ? strdup(scene->name) : NULL;
    cells->scenes = scenes ? scenes : cells->scenes;
    if (!name)
        return status_set(STATUS_FAILED, "%s: no memory for its cells", scene->name);
    const double points = scene->point_count > 1 ? scene->point_count : 1;
    const double simulation = PAIR * points * a->pings * a->receivers * a->samples;
    *index = cells->scene_count++;
    scenes[*index] =
        (struct cell_scene){name, 0, (EXACT * pairs_estimate(&exact) + (scene->recorded ? 0 : simulation)) / TIMES};
    return STATUS_OK;
}

/* A cell's name has no '\n' but this one: names are a file's line. */
static char *cell_name(const char *scene, const struct spec *spec)
{
    char *name;
    return asprintf(&name, "%s\n%s:%s,%s", scene, spec->algorithm->name, spec->text, precision_name(spec->precision))
                   < 0
               ? NULL
               : name;
}

enum status cells_add(struct cells *cells, const struct scene *scene, int spec_count, const struct spec *specs)
{
    int index = 0;
    enum status status = scene_add(cells, scene, &index);
    struct cells_one *list = realloc(cells->list, ((size_t)cells->count + (size_t)spec_count + 1) * sizeof *list);
    if (list)
        cells->list = list;
    else
        status = status_set(STATUS_FAILED, "%s: no memory for its cells", scene->name);
    for (int k = 0; k < spec_count && status == STATUS_OK; k++) {
        const double flops = flops_of(scene, &specs[k]), work = flops > LEAST ? flops : flops > 0 ? LEAST : 0;
        list[cells->count] = (struct cells_one){cell_name(scene->name, &specs[k]), index, work, true};
        if (!list[cells->count++].name)
            return status_set(STATUS_FAILED, "%s: no memory for its cells", scene->name);
        cells->scenes[index].work += work;
    }
    return status;
}

void cells_free(struct cells *cells)
{
    for (int k = 0; k < cells->count; k++)
        free(cells->list[k].name);
    for (int k = 0; k < cells->scene_count; k++)
        free(cells->scenes[k].name);
    free(cells->list);
    free(cells->scenes);
    *cells = (struct cells){.list = NULL};
}

static int descending(double a, double b)
{
    return (a < b) - (a > b);
}

static int cell_order(const void *a, const void *b, void *of)
{
    const struct cells_one *one = a, *other = b;
    const struct cell_scene *scenes = of;
    const int by_scene = descending(scenes[one->scene].work, scenes[other->scene].work);
    const int by_name = strcmp(scenes[one->scene].name, scenes[other->scene].name);
    const int by_work = descending(one->work, other->work);
    return by_scene ? by_scene : by_name ? by_name : by_work ? by_work : strcmp(one->name, other->name);
}

/* Each goes to the shard with the least work so far, of which a scene's echoes and exact image are a part. */
static enum status shards_deal(struct cells *cells, const struct shard *shard)
{
    const size_t count = (size_t)shard->count;
    double *work = calloc(count, sizeof *work);
    int *opened = calloc(count, sizeof *opened); /* the scene, from 1 */
    for (int n = 0; n < cells->count && work && opened; n++) {
        struct cells_one *cell = &cells->list[n];
        const double opening = cells->scenes[cell->scene].opening;
        double least = INFINITY;
        int best = 0;
        for (int s = 0; s < shard->count; s++) {
            const double after = work[s] + (opened[s] == cell->scene + 1 ? 0 : opening);
            if (after < least) {
                least = after;
                best = s;
            }
        }
        work[best] = least + cell->work;
        opened[best] = cell->scene + 1;
        cell->mine = best + 1 == shard->number;
    }
    const bool dealt = work && opened;
    free(work);
    free(opened);
    return dealt ? STATUS_OK : status_set(STATUS_FAILED, "no memory for %d shards", shard->count);
}

enum status cells_deal(struct cells *cells, const struct shard *shard)
{
    cells->next = -1;
    if (cells->count > 0)
        qsort_r(cells->list, (size_t)cells->count, sizeof *cells->list, cell_order, cells->scenes);
    return shard->count > 0 ? shards_deal(cells, shard) : STATUS_OK;
}

int cells_scene(const struct cells *cells, int k)
{
    int last = -1;
    for (int n = 0; n < cells->count; n++)
        if (cells->list[n].scene != last) {
            last = cells->list[n].scene;
            if (k-- == 0)
                break;
        }
    return last;
}

bool cells_is(const struct cells *cells, int n, const char *scene, const struct spec *spec)
{
    char *name = n < cells->count ? cell_name(scene, spec) : NULL;
    const bool same = name && strcmp(cells->list[n].name, name) == 0;
    free(name);
    return same;
}

int cells_find(const struct cells *cells, const char *scene, const struct spec *spec)
{
    char *name = cell_name(scene, spec);
    int found = -1;
    for (int n = 0; n < cells->count && name && found < 0; n++)
        if (strcmp(cells->list[n].name, name) == 0)
            found = n;
    free(name);
    return found;
}
