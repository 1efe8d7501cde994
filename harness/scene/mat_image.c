/* Image files: which variables they have, in which shapes. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/matfile.h"
#include "scene/matvar.h"

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

enum status image_file_write(const char *path, const struct image *image, const char *algorithm, const char *options,
                             const char *scene)
{
    size_t largest = 0;
    for (int k = 0; k < image->patch_count; k++) {
        size_t bytes =
            (size_t)image->patches[k].r_count * (size_t)image->patches[k].x_count * precision_size(image->precision);
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
        write_axis(&writer, patch_name("x", k, text, sizeof text), grid->x_first, grid->x_step, grid->x_count);
        write_axis(&writer, patch_name("r", k, text, sizeof text), grid->r_first, grid->r_step, grid->r_count);
        if (grid->angle_rad != 0) {
            write_reals(&writer, patch_name("angle", k, text, sizeof text), 1, 1, 1, &grid->angle_rad);
        }
    }
    write_text(&writer, "algorithm", algorithm);
    write_text(&writer, "options", options);
    write_text(&writer, "scene", scene);
    return writer_close(&writer);
}

/* First value, step (1 for a single value) and count of an evenly spaced axis of `expected` values. */
static enum status axis_read(const char *path, const struct wanted *wanted, const struct variable *variable,
                             size_t expected, double *first, double *step, int *count)
{
    if (!variable_has_shape(variable, 1, expected, 1) || expected > INT_MAX) {
        return status_set(STATUS_INVALID, "%s: variable `%s` is [%zu x %zu x %zu] for %zu pixels; %s is needed", path,
                          wanted->name, variable->dims[0], variable->dims[1], variable->dims[2], expected,
                          wanted->accepted);
    }
    size_t last = expected - 1;
    *first = creal(variable->values[0]);
    *step = last > 0 ? (creal(variable->values[last]) - *first) / (double)last : 1;
    *count = (int)expected;
    for (size_t i = 0; i < expected; i++) {
        double deviation = creal(variable->values[i]) - (*first + (double)i * *step);
        if (!(*step > 0) || !(fabs(deviation) <= 1e-6 * *step)) {
            return status_set(STATUS_INVALID, "%s: variable `%s` has %g at place %zu; %s is needed", path, wanted->name,
                              creal(variable->values[i]), i + 1, wanted->accepted);
        }
    }
    return STATUS_OK;
}

static enum status image_fill(const char *path, const struct variable *v, struct grid *grid, double complex **pixels)
{
    size_t rows = v[IMAGE].dims[0], columns = v[IMAGE].dims[1];
    if (v[IMAGE].dims[2] != 1) {
        return status_set(STATUS_INVALID, "%s: variable `image` is [%zu x %zu x %zu]; %s is needed", path, rows,
                          columns, v[IMAGE].dims[2], image_variables[IMAGE].accepted);
    }
    enum status status =
        axis_read(path, &image_variables[IMAGE_X], &v[IMAGE_X], columns, &grid->x_first, &grid->x_step, &grid->x_count);
    if (status == STATUS_OK) {
        status = axis_read(path, &image_variables[IMAGE_R], &v[IMAGE_R], rows, &grid->r_first, &grid->r_step,
                           &grid->r_count);
    }
    grid->angle_rad = v[IMAGE_ANGLE].values ? creal(v[IMAGE_ANGLE].values[0]) : 0;
    if (status == STATUS_OK && !(fabs(grid->angle_rad) < M_PI / 2)) {
        status = status_set(STATUS_INVALID, "%s: variable `angle` is %g; %s is needed", path, grid->angle_rad,
                            image_variables[IMAGE_ANGLE].accepted);
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

enum status image_file_read(const char *path, struct grid *grid, double complex **pixels)
{
    *pixels = NULL;
    struct variable variables[IMAGE_VARIABLES];
    enum status status = variables_read(path, image_variables, IMAGE_VARIABLES, variables);
    if (status == STATUS_OK) {
        status = image_fill(path, variables, grid, pixels);
        variables_free(variables, IMAGE_VARIABLES);
    }
    return status;
}
