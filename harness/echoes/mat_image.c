/* Image files: which variables they have, in which shapes. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/matfile.h"
#include "echoes/matvar.h"

enum image_variable { IMAGE, IMAGE_X, IMAGE_R, IMAGE_ANGLE, IMAGE_VARIABLES };

static const struct wanted image_variables[IMAGE_VARIABLES] = {
    [IMAGE] = {"image", KIND_COMPLEX, false, "a complex array [R x X] (range x azimuth)"},
    [IMAGE_X] = {"x", KIND_REAL, false, "an evenly spaced, rising row [1 x X] in m"},
    [IMAGE_R] = {"r", KIND_REAL, false, "an evenly spaced, rising row [1 x R] in m"},
    [IMAGE_ANGLE] = {"angle", KIND_SCALAR, true, "a scalar between -pi/2 and pi/2 in rad"},
};

static void write_axis(struct writer *writer, const char *name, double first, double step, int count)
{
    double *values = malloc((size_t)count * sizeof *values);
    if (!values) {
        writer->status = status_set(STATUS_FAILED, "%s: out of memory to write %d numbers", writer->path, count);
        return;
    }
    for (int i = 0; i < count; i++) {
        values[i] = first + i * step;
    }
    write_reals(writer, name, 1, (size_t)count, 1, values);
    free(values);
}

/* "image" for the first patch, "image_2" for the second. */
static const char *patch_name(const char *name, int patch, char *text, size_t size)
{
    if (patch == 0)
        return name;
    snprintf(text, size, "%s_%d", name, patch + 1);
    return text;
}

void image_axes_write(struct writer *writer, const struct grid *grid, int patch)
{
    char text[32];
    write_axis(writer, patch_name("x", patch, text, sizeof text), grid->x_first, grid->x_step, grid->x_count);
    write_axis(writer, patch_name("r", patch, text, sizeof text), grid->r_first, grid->r_step, grid->r_count);
    if (grid->angle_rad != 0) {
        write_reals(writer, patch_name("angle", patch, text, sizeof text), 1, 1, 1, &grid->angle_rad);
    }
}

/* An image's origin, each a text or a number of struct image_origin. */
static const struct {
    struct wanted wanted;
    size_t offset; /* of the field */
} sayings[] = {
    {{"algorithm", KIND_TEXT, true, "a text"}, offsetof(struct image_origin, algorithm)},
    {{"options", KIND_TEXT, true, "a text"}, offsetof(struct image_origin, options)},
    {{"scene", KIND_TEXT, true, "a text"}, offsetof(struct image_origin, scene)},
    {{"engine", KIND_TEXT, true, "a text"}, offsetof(struct image_origin, engine)},
    {{"scene_hash", KIND_TEXT, true, "a text"}, offsetof(struct image_origin, scene_hash)},
    {{"commit", KIND_TEXT, true, "a text"}, offsetof(struct image_origin, commit)},
    {{"date", KIND_TEXT, true, "a text"}, offsetof(struct image_origin, date)},
    {{"status", KIND_TEXT, true, "a text"}, offsetof(struct image_origin, status)},
    {{"fc", KIND_SCALAR, true, "a scalar in Hz"}, offsetof(struct image_origin, fc)},
    {{"sound_speed", KIND_SCALAR, true, "a scalar in m/s"}, offsetof(struct image_origin, sound_speed)},
};
enum { SAYINGS = sizeof sayings / sizeof *sayings };

void image_sayings_write(struct writer *writer, const struct image_origin *origin)
{
    for (int k = 0; k < SAYINGS; k++) {
        const char *field = (const char *)origin + sayings[k].offset;
        const double *number = (const void *)field;
        const bool is_text = sayings[k].wanted.kind == KIND_TEXT;
        if (is_text && *field) {
            write_text(writer, sayings[k].wanted.name, field);
        } else if (!is_text && !isnan(*number)) {
            write_reals(writer, sayings[k].wanted.name, 1, 1, 1, number);
        }
    }
}

enum status image_file_write(const char *path, const struct image *image, const struct image_origin *origin)
{
    size_t largest = 0;
    for (int k = 0; k < image->patch_count; k++) {
        size_t bytes = grid_pixels(&image->patches[k]) * precision_size(image->precision);
        largest = bytes > largest ? bytes : largest;
    }
    struct writer writer;
    if (writer_open(&writer, path, largest) != STATUS_OK) {
        return writer.status;
    }
    for (int k = 0; k < image->patch_count; k++) {
        const struct grid *grid = &image->patches[k];
        size_t rows = (size_t)grid->r_count, columns = (size_t)grid->x_count;
        char text[32];
        write_complex(&writer, patch_name("image", k, text, sizeof text), (size_t[]){rows, columns, 1},
                      image->precision, image->pixels[k], rows, columns);
        image_axes_write(&writer, grid, k);
    }
    image_sayings_write(&writer, origin);
    return writer_close(&writer);
}

/* First value, step (1 for a single value) and count of an evenly spaced axis of `expected` values. */
static enum status axis_read(const char *path, const struct wanted *wanted, const struct variable *variable,
                             size_t expected, double *first, double *step, int *count)
{
    if (!variable_is_vector(variable) || variable_count(variable) != expected || expected > INT_MAX) {
        return status_set(STATUS_INVALID, "%s: variable `%s` is [%zu x %zu x %zu] for %zu pixels; %s is needed", path,
                          wanted->name, variable->dims[0], variable->dims[1], variable->dims[2], expected,
                          wanted->accepted);
    }
    size_t last = expected - 1;
    *first = creal(variable->values[0]);
    *step = last > 0 ? (creal(variable->values[last]) - *first) / (double)last : 1;
    *count = (int)expected;
    for (size_t i = 0; i < expected; i++) {
        const double value = creal(variable->values[i]), even = *first + (double)i * *step;
        if (!(*step > 0) || !(fabs(value - even) <= 1e-6 * *step)) {
            return status_set(STATUS_INVALID,
                              "%s: variable `%s` has %.9g at place %zu, %.9g would be even; %s%s is needed", path,
                              wanted->name, value, i + 1, even, wanted->accepted,
                              variable->is_single ? " of class double (this one is single)" : "");
        }
    }
    return STATUS_OK;
}

/* Pixels of a patch, malloc'ed complex double row by row, and its grid. `wanted` names its variables. */
static enum status patch_fill(const char *path, const struct wanted *wanted, const struct variable *v,
                              struct grid *grid, double complex **pixels)
{
    size_t rows = v[IMAGE].dims[0], columns = v[IMAGE].dims[1];
    if (v[IMAGE].dims[2] != 1) {
        return status_set(STATUS_INVALID, "%s: variable `%s` is [%zu x %zu x %zu]; %s is needed", path,
                          wanted[IMAGE].name, rows, columns, v[IMAGE].dims[2], wanted[IMAGE].accepted);
    }
    enum status status =
        axis_read(path, &wanted[IMAGE_X], &v[IMAGE_X], columns, &grid->x_first, &grid->x_step, &grid->x_count);
    if (status == STATUS_OK) {
        status = axis_read(path, &wanted[IMAGE_R], &v[IMAGE_R], rows, &grid->r_first, &grid->r_step, &grid->r_count);
    }
    grid->angle_rad = v[IMAGE_ANGLE].values ? creal(v[IMAGE_ANGLE].values[0]) : 0;
    if (status == STATUS_OK && !(fabs(grid->angle_rad) < M_PI / 2)) {
        status = status_set(STATUS_INVALID, "%s: variable `%s` is %g; %s is needed", path, wanted[IMAGE_ANGLE].name,
                            grid->angle_rad, wanted[IMAGE_ANGLE].accepted);
    }
    if (status != STATUS_OK) {
        return status;
    }
    *pixels = malloc(rows * columns * sizeof **pixels);
    if (!*pixels) {
        return status_set(STATUS_FAILED, "%s: out of memory for an image of %zu x %zu pixels", path, rows, columns);
    }
    for (size_t i = 0; i < rows; i++) {
        for (size_t j = 0; j < columns; j++) {
            (*pixels)[i * columns + j] = v[IMAGE].values[j * rows + i];
        }
    }
    return STATUS_OK;
}

/* Read the patch of the next number; *more is false where the file has none. */
static enum status patch_add(const char *path, struct image_file *file, bool *more)
{
    struct wanted wanted[IMAGE_VARIABLES];
    struct variable variables[IMAGE_VARIABLES];
    char names[IMAGE_VARIABLES][32];
    const int patch = file->image.patch_count;
    for (int k = 0; k < IMAGE_VARIABLES; k++) {
        wanted[k] = image_variables[k];
        wanted[k].name = patch_name(image_variables[k].name, patch, names[k], sizeof names[k]);
        wanted[k].is_optional = patch > 0 || k == IMAGE_ANGLE;
    }
    enum status status = variables_read(path, wanted, IMAGE_VARIABLES, variables);
    if (status != STATUS_OK) {
        return status;
    }
    /* The image decides whether there is a further patch: its axes are then needed. */
    *more = variables[IMAGE].values != NULL;
    for (int k = 0; k < IMAGE_VARIABLES; k++) {
        wanted[k].is_optional = k == IMAGE_ANGLE;
    }
    if (*more) {
        status = variables_check(path, wanted, IMAGE_VARIABLES, variables);
    }
    if (status != STATUS_OK || !*more) {
        variables_free(variables, IMAGE_VARIABLES);
        return status;
    }
    struct grid *patches = realloc(file->patches, ((size_t)patch + 1) * sizeof *patches);
    void **pixels = realloc(file->image.pixels, ((size_t)patch + 1) * sizeof *pixels);
    file->patches = patches ? patches : file->patches;
    file->image.patches = file->patches;
    file->image.pixels = pixels ? pixels : file->image.pixels;
    if (!patches || !pixels) {
        status = status_set(STATUS_FAILED, "%s: out of memory for %d patches", path, patch + 1);
    }
    double complex *values = NULL;
    if (status == STATUS_OK) {
        status = patch_fill(path, wanted, variables, &patches[patch], &values);
    }
    if (status == STATUS_OK) {
        pixels[patch] = values;
        file->image.patch_count++;
    }
    variables_free(variables, IMAGE_VARIABLES);
    return status;
}

/* As far as a file has them; other than plain characters become '?'. */
static enum status sayings_read(const char *path, struct image_origin *origin)
{
    struct wanted wanted[SAYINGS];
    struct variable variables[SAYINGS];
    for (int k = 0; k < SAYINGS; k++) {
        wanted[k] = sayings[k].wanted;
    }
    *origin = (struct image_origin){.fc = NAN, .sound_speed = NAN};
    enum status status = variables_read(path, wanted, SAYINGS, variables);
    if (status != STATUS_OK) {
        return status;
    }
    for (int k = 0; k < SAYINGS; k++) {
        char *field = (char *)origin + sayings[k].offset;
        const size_t count = variables[k].values ? variable_count(&variables[k]) : 0;
        if (wanted[k].kind == KIND_SCALAR && count > 0) {
            *(double *)(void *)field = creal(variables[k].values[0]);
        }
        for (size_t i = 0; wanted[k].kind == KIND_TEXT && i < count && i < sizeof origin->scene - 1; i++) {
            const double code = creal(variables[k].values[i]);
            field[i] = code >= ' ' && code <= '~' ? (char)code : '?';
        }
    }
    variables_free(variables, SAYINGS);
    return STATUS_OK;
}

enum status image_file_is(const char *path, bool *is)
{
    struct wanted axis = image_variables[IMAGE_X];
    struct variable variable;
    axis.is_optional = true;
    enum status status = variables_read(path, &axis, 1, &variable);
    *is = status == STATUS_OK && variable.values;
    if (status == STATUS_OK) {
        variables_free(&variable, 1);
    }
    return status;
}

enum status image_file_open(const char *path, struct image_file *file)
{
    *file = (struct image_file){.image.precision = PRECISION_DOUBLE};
    bool more = true;
    enum status status = STATUS_OK;
    while (status == STATUS_OK && more) {
        status = patch_add(path, file, &more);
    }
    if (status == STATUS_OK) {
        status = sayings_read(path, &file->origin);
    }
    if (status != STATUS_OK) {
        image_file_close(file);
    }
    return status;
}

enum status image_file_open_whole(const char *path, struct image_file *file)
{
    const enum status status = image_file_open(path, file);
    if (status != STATUS_OK || strncmp(file->origin.status, "unfinished", strlen("unfinished")) != 0)
        return status;
    image_file_close(file);
    return status_set(STATUS_INVALID,
                      "%s: the image is unfinished, its pixels of missing tiles are zero; the command that began it "
                      "finishes it (`info` counts its tiles)",
                      path);
}

void image_file_close(struct image_file *file)
{
    image_free(&file->image);
    free(file->patches);
    *file = (struct image_file){0};
}
