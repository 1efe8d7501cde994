/* The notes of echo files: the scene's image and its point targets. */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/matfile.h"
#include "echoes/matvar.h"

/* Numbers of a patch and of a target. */
enum { NOTES_GRID = 7, NOTES_TARGET = 4 };

void echo_notes_write(struct writer *writer, const struct echo_notes *notes)
{
    if (!notes)
        return;
    const size_t patches = (size_t)notes->patch_count, targets = (size_t)notes->target_count;
    double *numbers = malloc((patches * NOTES_GRID + targets * NOTES_TARGET + 1) * sizeof *numbers), *next = numbers;
    if (!numbers) {
        writer->status = status_set(STATUS_FAILED, "%s: out of memory for its notes", writer->path);
        return;
    }
    for (size_t k = 0; k < patches; k++) {
        const struct grid *g = &notes->patches[k];
        const double grid[NOTES_GRID] = {g->x_first, g->x_step,          g->x_count,  g->r_first,
                                         g->r_step,  (double)g->r_count, g->angle_rad};
        memcpy(next, grid, sizeof grid);
        next += NOTES_GRID;
    }
    for (size_t k = 0; k < targets; k++) {
        const struct target *t = &notes->targets[k];
        const double target[NOTES_TARGET] = {t->x, t->r, creal(t->amplitude), cimag(t->amplitude)};
        memcpy(next, target, sizeof target);
        next += NOTES_TARGET;
    }
    if (patches > 0)
        write_reals(writer, "image_grid", NOTES_GRID, patches, 1, numbers);
    if (targets > 0)
        write_reals(writer, "point_targets", NOTES_TARGET, targets, 1, numbers + patches * NOTES_GRID);
    if (notes->description)
        write_text(writer, "description", notes->description);
    free(numbers);
}

enum { IMAGE_GRID, POINT_TARGETS, NOTES };

static const struct wanted notes_variables[NOTES] = {
    [IMAGE_GRID] = {"image_grid", KIND_REAL, true,
                    "a real array [7 x K] (x first, step and count, r first, step and count, angle)"},
    [POINT_TARGETS] = {"point_targets", KIND_REAL, true,
                       "a real array [4 x n] of finite numbers (x, r, and the amplitude's real and imaginary part)"},
};

static enum status notes_refuse(const char *path, int k, const struct variable *v)
{
    return status_set(STATUS_INVALID, "%s: variable `%s` is [%zu x %zu x %zu], or has other numbers; %s is needed",
                      path, notes_variables[k].name, v->dims[0], v->dims[1], v->dims[2], notes_variables[k].accepted);
}

static bool whole_below(double value, double end)
{
    return value >= 0 && value < end && value == floor(value);
}

static enum status patches_fill(const char *path, const struct variable *v, struct echo_notes *notes)
{
    for (int k = 0; k < notes->patch_count; k++) {
        const double complex *n = v->values + k * NOTES_GRID;
        struct grid *grid = &notes->patches[k];
        if (!whole_below(creal(n[2]), INT_MAX) || !whole_below(creal(n[5]), INT_MAX) || !(fabs(creal(n[6])) < M_PI / 2))
            return notes_refuse(path, IMAGE_GRID, v);
        *grid = (struct grid){.x_first = creal(n[0]), .x_step = creal(n[1]), .x_count = (int)creal(n[2])};
        grid->r_first = creal(n[3]);
        grid->r_step = creal(n[4]);
        grid->r_count = (int)creal(n[5]);
        grid->angle_rad = creal(n[6]);
    }
    return STATUS_OK;
}

static enum status targets_fill(const char *path, const struct variable *v, struct echo_notes *notes)
{
    for (int k = 0; k < notes->target_count; k++) {
        const double complex *n = v->values + k * NOTES_TARGET;
        for (int i = 0; i < NOTES_TARGET; i++)
            if (!isfinite(creal(n[i])))
                return notes_refuse(path, POINT_TARGETS, v);
        notes->targets[k] = (struct target){creal(n[0]), creal(n[1]), __builtin_complex(creal(n[2]), creal(n[3]))};
    }
    return STATUS_OK;
}

void echo_notes_free(struct echo_notes *notes)
{
    free(notes->patches);
    free(notes->targets);
    *notes = (struct echo_notes){.description = NULL};
}

enum status echo_notes_read(const char *path, struct echo_notes *notes)
{
    struct variable v[NOTES];
    *notes = (struct echo_notes){.description = NULL};
    enum status status = variables_read(path, notes_variables, NOTES, v);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < NOTES && status == STATUS_OK; k++)
        if (v[k].values && !variable_has_shape(&v[k], k == IMAGE_GRID ? NOTES_GRID : NOTES_TARGET, v[k].dims[1], 1))
            status = notes_refuse(path, k, &v[k]);
    if (status == STATUS_OK) {
        notes->patch_count = v[IMAGE_GRID].values ? (int)v[IMAGE_GRID].dims[1] : 0;
        notes->target_count = v[POINT_TARGETS].values ? (int)v[POINT_TARGETS].dims[1] : 0;
        notes->patches = calloc((size_t)notes->patch_count + 1, sizeof *notes->patches);
        notes->targets = calloc((size_t)notes->target_count + 1, sizeof *notes->targets);
        if (!notes->patches || !notes->targets)
            status = status_set(STATUS_FAILED, "%s: out of memory for its notes", path);
    }
    if (status == STATUS_OK)
        status = patches_fill(path, &v[IMAGE_GRID], notes);
    if (status == STATUS_OK)
        status = targets_fill(path, &v[POINT_TARGETS], notes);
    variables_free(v, NOTES);
    if (status != STATUS_OK)
        echo_notes_free(notes);
    return status;
}
