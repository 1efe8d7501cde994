/* An image in decibels, and beside it its difference from the exact one (plot.h). A patch of one or two rows or
   columns is drawn as curves. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "show/plot.h"
#include "show/plot_script.h"

enum {
    PIXELS_MAX = 900, /* of a panel, along each axis: about a screen's resolution */
    THIN = 2,         /* rows or columns that are drawn as curves */
    NAMES_MAX = 30    /* labelled targets of a panel; more would overlap */
};
static const char image_script[] = "image.gp";
static const double floor_db = -200; /* stands for zero power, far below the shown range */

/* One axis of a patch as drawn: blocks of pixels. */
struct drawn_axis {
    int count, pixels, block; /* drawn values; pixels of the image; pixels of a drawn value */
    double first, step;       /* m */
};

static struct drawn_axis axis_reduce(double first, double step, int pixels)
{
    int block = (pixels - 1) / PIXELS_MAX + 1;
    struct drawn_axis axis = {
        .count = (pixels - 1) / block + 1,
        .pixels = pixels,
        .block = block,
        .first = first + 0.5 * (block - 1) * step,
        .step = block * step,
    };
    if (axis.count == 1) {
        /* gnuplot needs two values: the one pixel as two halves. */
        axis.count = 2;
        axis.first -= 0.25 * axis.step;
        axis.step *= 0.5;
    }
    return axis;
}

/* First pixel of a drawn value. */
static int axis_pixel(const struct drawn_axis *axis, int k)
{
    return axis->pixels == 1 ? 0 : k * axis->block;
}

/* The drawn data: an image, or its difference from another on the same pixels. */
struct layer {
    const struct image *image, *minus; /* minus NULL: nothing */
    double zero_db;                    /* power */
};

static double pixel_power(const struct layer *layer, int patch, int i, int j)
{
    double complex z = image_pixel(layer->image, patch, i, j);
    if (layer->minus)
        z -= image_pixel(layer->minus, patch, i, j);
    return creal(z) * creal(z) + cimag(z) * cimag(z);
}

/* Largest power of all, and the number of pixels that are not finite. */
static double layer_peak(const struct layer *layer, long *not_finite)
{
    const struct image *image = layer->image;
    double peak = 0;
    *not_finite = 0;
    for (int p = 0; p < image->patch_count; p++)
        for (int i = 0; i < image->patches[p].r_count; i++)
            for (int j = 0; j < image->patches[p].x_count; j++) {
                double value = pixel_power(layer, p, i, j);
                if (isfinite(value))
                    peak = fmax(peak, value);
                else
                    ++*not_finite;
            }
    return peak;
}

static double decibels(const struct layer *layer, double power)
{
    return power > 0 ? fmax(10 * log10(power / layer->zero_db), floor_db) : isnan(power) ? NAN : floor_db;
}

/* The brightest finite pixel of a block in dB; NAN if there is none. */
static float block_db(const struct layer *layer, int patch, const struct drawn_axis *r, int i,
                      const struct drawn_axis *x, int j)
{
    double largest = NAN;
    int i_first = axis_pixel(r, i), j_first = axis_pixel(x, j);
    for (int m = i_first; m < i_first + r->block && m < r->pixels; m++)
        for (int n = j_first; n < j_first + x->block && n < x->pixels; n++) {
            double value = pixel_power(layer, patch, m, n);
            if (isfinite(value))
                largest = fmax(largest, value);
        }
    return (float)decibels(layer, largest);
}

/* Offset subtracted from the places of an axis, which gnuplot's matrices store as floats: 0 unless floats lose
   pixels. */
static double axis_origin(const struct drawn_axis *axis)
{
    const double farthest = fmax(fabs(axis->first), fabs(axis->first + axis->count * axis->step));
    return farthest > 0x1p18 * axis->step ? axis->first : 0;
}

/* In the format of gnuplot's `binary matrix`. */
static void matrix_write(FILE *file, const struct layer *layer, int patch)
{
    const struct grid *grid = &layer->image->patches[patch];
    struct drawn_axis x = axis_reduce(grid->x_first, grid->x_step, grid->x_count);
    struct drawn_axis r = axis_reduce(grid->r_first, grid->r_step, grid->r_count);
    const double x_first = x.first - axis_origin(&x), r_first = r.first - axis_origin(&r);
    float row[PIXELS_MAX + 1] = {(float)x.count};
    for (int j = 0; j < x.count; j++)
        row[j + 1] = (float)(x_first + j * x.step);
    fwrite(row, sizeof *row, (size_t)x.count + 1, file);
    for (int i = 0; i < r.count; i++) {
        row[0] = (float)(r_first + i * r.step);
        for (int j = 0; j < x.count; j++)
            row[j + 1] = block_db(layer, patch, &r, i, &x, j);
        fwrite(row, sizeof *row, (size_t)x.count + 1, file);
    }
}

/* How a patch is drawn: as an image, or a curve for each of its rows or columns. */
enum shape { SHAPE_IMAGE, SHAPE_ROWS, SHAPE_COLUMNS };
static const char *const shape_names[] = {"image", "rows", "columns"};

static enum shape shape_of(const struct grid *grid)
{
    if (grid->r_count <= THIN && grid->x_count > THIN)
        return SHAPE_ROWS;
    return grid->x_count <= THIN && grid->r_count > THIN ? SHAPE_COLUMNS : SHAPE_IMAGE;
}

/* A block of "place dB" for each curve. */
static void curves_write(FILE *file, const struct layer *layer, int patch)
{
    const struct grid *grid = &layer->image->patches[patch];
    const bool rows = shape_of(grid) == SHAPE_ROWS;
    const int curves = rows ? grid->r_count : grid->x_count, places = rows ? grid->x_count : grid->r_count;
    for (int c = 0; c < curves; c++) {
        for (int k = 0; k < places; k++) {
            const double place = rows ? grid->x_first + k * grid->x_step : grid->r_first + k * grid->r_step;
            fprintf(file, "%.15g %.6g\n", place,
                    decibels(layer, pixel_power(layer, patch, rows ? c : k, rows ? k : c)));
        }
        fprintf(file, "\n\n");
    }
}

/* One patch as a file; `array` of the script gets its path. */
static enum status panel_write(struct plot *plot, const char *array, const struct layer *layer, int patch)
{
    FILE *file;
    enum status status = plot_file_open(plot, array, patch, &file);
    if (status != STATUS_OK)
        return status;
    if (shape_of(&layer->image->patches[patch]) == SHAPE_IMAGE)
        matrix_write(file, layer, patch);
    else
        curves_write(file, layer, patch);
    return plot_file_flush(plot, file);
}

static double share(double place, double first, double step, int count)
{
    return (place - (first - 0.5 * step)) / (count * step);
}

/* Targets within a patch as "x r name"; returns their number. */
static int targets_write(FILE *file, const struct image_picture *picture, int patch)
{
    const struct grid *grid = &picture->image->patches[patch];
    int written = 0;
    fprintf(file, "targets[%d] = '$targets%d'\n$targets%d << END\n", patch + 1, patch, patch);
    for (int t = 0; t < picture->target_count && written < NAMES_MAX; t++) {
        const struct vector at = grid_coordinates(grid, picture->targets[t].x, picture->targets[t].r);
        const double x = share(at.x, grid->x_first, grid->x_step, grid->x_count);
        const double r = share(at.y, grid->r_first, grid->r_step, grid->r_count);
        if (x >= 0 && x <= 1 && r >= 0 && r <= 1) {
            fprintf(file, "%.15g %.15g T%d\n", at.x, at.y, t + 1);
            written++;
        }
    }
    fprintf(file, "END\n");
    return written;
}

/* The numbers of a patch: its edges in m, the offset of its places, how many curves, how many targets. */
static void numbers_write(FILE *preamble, const struct grid *grid, int patch, int target_count)
{
    const enum shape shape = shape_of(grid);
    const struct drawn_axis x = axis_reduce(grid->x_first, grid->x_step, grid->x_count);
    const struct drawn_axis r = axis_reduce(grid->r_first, grid->r_step, grid->r_count);
    const struct {
        const char *array;
        double value;
    } numbers[] = {
        {"x_low", grid->x_first - 0.5 * grid->x_step},
        {"x_high", grid->x_first + (grid->x_count - 0.5) * grid->x_step},
        {"r_low", grid->r_first - 0.5 * grid->r_step},
        {"r_high", grid->r_first + (grid->r_count - 0.5) * grid->r_step},
        {"x_origin", axis_origin(&x)},
        {"r_origin", axis_origin(&r)},
        {"curves", shape == SHAPE_ROWS      ? grid->r_count
                   : shape == SHAPE_COLUMNS ? grid->x_count
                                            : 0},
        {"target_count", target_count},
        {"turned", grid->angle_rad != 0},
    };
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        fprintf(preamble, "%s[%d] = %.17g\n", numbers[k].array, patch + 1, numbers[k].value);
    plot_array_write(preamble, "shapes", patch, shape_names[shape]);
}

static void title_write(const struct plot *plot, const struct image_picture *picture, double peak, long not_finite,
                        int shown)
{
    char notes[200] = "", full_title[600];
    size_t length = 0;
    if (!(peak > 0))
        length += (size_t)snprintf(notes + length, sizeof notes - length, " (all zero)");
    if (not_finite > 0)
        length += (size_t)snprintf(notes + length, sizeof notes - length, " (%ld %s not finite)", not_finite,
                                   not_finite == 1 ? "pixel" : "pixels");
    if (shown < picture->image->patch_count)
        snprintf(notes + length, sizeof notes - length, " (first %d of %d patches)", shown,
                 picture->image->patch_count);
    snprintf(full_title, sizeof full_title, "%.390s%s", picture->title, notes);
    plot_variable(plot->preamble, "title", full_title);
    plot_variable(plot->preamble, "footer", picture->footer ? picture->footer : "");
}

static enum status image_write(struct plot *plot, const struct image_picture *picture)
{
    static const char *const arrays[] = {"panels", "differences",  "targets", "shapes",   "x_low",
                                         "x_high", "r_low",        "r_high",  "x_origin", "r_origin",
                                         "curves", "target_count", "turned"};
    struct layer image = {.image = picture->image}, difference = {picture->image, picture->reference, 0};
    long not_finite, ignored;
    const int shown = image.image->patch_count < PANELS_MAX ? image.image->patch_count : PANELS_MAX;
    const double largest = picture->reference ? layer_peak(&difference, &ignored) : 0;
    image.zero_db = layer_peak(&image, &not_finite);
    if (picture->reference)
        difference.zero_db = layer_peak(&(struct layer){.image = picture->reference}, &ignored);
    const bool differs = largest > 0 && difference.zero_db > 0;
    title_write(plot, picture, image.zero_db, not_finite, shown);
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        plot_array(plot->preamble, arrays[k], shown);
    fprintf(plot->preamble, "range_db = %.10g\nhas_differences = %d\ndifference_top = %.10g\n",
            picture->range_db > 0 ? picture->range_db : IMAGE_RANGE_DB, differs,
            differs ? 10 * ceil(log10(largest / difference.zero_db)) : 0);
    enum status status = STATUS_OK;
    for (int p = 0; p < shown && status == STATUS_OK; p++) {
        status = panel_write(plot, "panels", &image, p);
        if (status == STATUS_OK && differs)
            status = panel_write(plot, "differences", &difference, p);
        numbers_write(plot->preamble, &picture->image->patches[p], p, targets_write(plot->preamble, picture, p));
    }
    return status;
}

enum status plot_image(struct plot_queue *queue, const char *path, const char *plots_directory,
                       const struct image_picture *picture)
{
    struct plot plot;
    enum status status = plot_begin(&plot, path, picture->named);
    if (status == STATUS_OK)
        status = image_write(&plot, picture);
    return plot_finish(&plot, status, queue, plots_directory, image_script);
}
