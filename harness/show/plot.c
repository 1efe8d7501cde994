/* Pictures through gnuplot: data files and a short preamble of variables go to a temporary folder beside the picture,
   then one of the scripts in plots/ draws them. The picture is drawn there, too, and renamed when whole. */
#include "show/plot.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "data/echo_data.h"
#include "data/temporary.h"
#include "show/gnuplot.h"

enum {
    PANELS_MAX = 8,  /* more do not fit a picture */
    PIXELS_MAX = 900 /* of a panel, along each axis: about what the screen shows */
};
static const double floor_db = -200; /* stands for zero power, far below what is shown */

/* One picture in the making. */
struct plot {
    char directory[PATH_MAX];   /* temporary, with everything in it */
    char output[PATH_MAX + 32]; /* the picture until it is whole */
    const char *path;           /* the picture */
    FILE *preamble;             /* sets the script's variables */
};

static void file_path(const struct plot *plot, const char *name, char path[PATH_MAX + 32])
{
    snprintf(path, PATH_MAX + 32, "%s/%.30s", plot->directory, name);
    temporary_inside(path);
}

static enum status file_failed(const char *path)
{
    return status_set(STATUS_FAILED, "plot: cannot write '%s': %s", path, strerror(errno));
}

/* A gnuplot string: nothing but the single quote is special between single quotes. */
static void text_write(FILE *file, const char *text)
{
    fputc('\'', file);
    for (; *text; text++) {
        if (*text == '\'')
            fputc('\'', file);
        fputc((unsigned char)*text < ' ' ? ' ' : *text, file);
    }
    fputc('\'', file);
}

static void variable_write(FILE *file, const char *name, const char *text)
{
    fprintf(file, "%s = ", name);
    text_write(file, text);
    fputc('\n', file);
}

static void array_begin(FILE *file, const char *name, int count)
{
    fprintf(file, "array %s[%d]\n", name, count);
}

static void array_write(FILE *file, const char *name, int index, const char *text)
{
    fprintf(file, "%s[%d] = ", name, index + 1);
    text_write(file, text);
    fputc('\n', file);
}

static bool is_svg(const char *path)
{
    size_t length = strlen(path);
    return length > 4 && strcmp(path + length - 4, ".svg") == 0;
}

static enum status plot_begin(struct plot *plot, const char *path)
{
    *plot = (struct plot){.path = path};
    if (gnuplot_hung())
        return status_set(STATUS_FAILED, "plot: '%.300s' is not drawn: gnuplot did not end on a picture before", path);

    /* gnuplot takes an output that begins with '|' for a command. */
    char beside[PATH_MAX], name[PATH_MAX + 32];
    if (snprintf(beside, sizeof beside, "%s%s", *path == '/' ? "" : "./", path) >= (int)sizeof beside)
        return status_set(STATUS_FAILED, "plot: the path '%.200s' is too long", path);
    if (!temporary_folder(beside, plot->directory)) {
        *plot->directory = '\0';
        return file_failed(path);
    }
    file_path(plot, is_svg(path) ? "picture.svg" : "picture.png", plot->output);
    file_path(plot, "run.gp", name);
    plot->preamble = fopen(name, "w");
    return plot->preamble ? STATUS_OK : file_failed(name);
}

/* Removes what is left; accepts a plot whose beginning failed. */
static void plot_end(struct plot *plot)
{
    if (plot->preamble)
        fclose(plot->preamble);
    if (*plot->directory)
        temporary_remove(plot->directory);
}

/* Draw with plots_directory/script. */
static enum status plot_run(struct plot *plot, const char *plots_directory, const char *script)
{
    char preamble[PATH_MAX + 32], log[PATH_MAX + 32];
    file_path(plot, "run.gp", preamble);
    file_path(plot, "log", log);
    variable_write(plot->preamble, "format", is_svg(plot->path) ? "svg" : "png");
    variable_write(plot->preamble, "output", plot->output);
    variable_write(plot->preamble, "plots", plots_directory);
    fprintf(plot->preamble, "load plots.'/%s'\n", script);
    bool written = !ferror(plot->preamble);
    written &= fclose(plot->preamble) == 0;
    plot->preamble = NULL;
    if (!written)
        return file_failed(preamble);

    int exit_status;
    enum status status = gnuplot_run(preamble, log, &exit_status);
    if (status != STATUS_OK)
        return status;
    if (exit_status != 0) {
        char complaint[400];
        gnuplot_complaint(log, complaint, sizeof complaint);
        return status_set(STATUS_FAILED, "plot: gnuplot failed on '%s' with %s/%s: %s", plot->path, plots_directory,
                          script, complaint);
    }
    return STATUS_OK;
}

/* Whether a picture reaches its end: gnuplot does not notice a full disk. */
static bool picture_is_whole(const char *path)
{
    static const char png[] = "\0\0\0\0IEND\xae\x42\x60\x82", svg[] = "</svg>";
    const char *wanted = is_svg(path) ? svg : png;
    const size_t size = is_svg(path) ? sizeof svg - 1 : sizeof png - 1;
    char end[32];
    FILE *file = fopen(path, "rb");
    if (!file)
        return false;
    size_t count = fseek(file, -(long)sizeof end, SEEK_END) == 0 ? fread(end, 1, sizeof end, file) : 0;
    fclose(file);
    while (is_svg(path) && count > 0 && end[count - 1] == '\n')
        count--;
    return count >= size && memcmp(end + count - size, wanted, size) == 0;
}

/* Put the picture in its place. */
static enum status plot_place(const struct plot *plot)
{
    if (!picture_is_whole(plot->output))
        return status_set(STATUS_FAILED, "plot: gnuplot left '%s' without its end (is the disk full?)", plot->path);
    return rename(plot->output, plot->path) == 0 ? STATUS_OK : file_failed(plot->path);
}

static enum status plot_draw(struct plot *plot, const char *plots_directory, const char *script)
{
    enum status status = plot_run(plot, plots_directory, script);
    return status == STATUS_OK ? plot_place(plot) : status;
}

/* One axis of a patch as it is drawn: blocks of pixels. */
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
        /* gnuplot demands two values: the one pixel as two halves. */
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

static double power(double complex z)
{
    return creal(z) * creal(z) + cimag(z) * cimag(z);
}

/* Largest power of the whole image, and how many pixels are not finite. */
static double image_peak(const struct image *image, long *not_finite)
{
    double peak = 0;
    *not_finite = 0;
    for (int p = 0; p < image->patch_count; p++)
        for (int i = 0; i < image->patches[p].r_count; i++)
            for (int j = 0; j < image->patches[p].x_count; j++) {
                double value = power(image_pixel(image, p, i, j));
                if (isfinite(value))
                    peak = fmax(peak, value);
                else
                    ++*not_finite;
            }
    return peak;
}

/* The brightest finite pixel of a block in dB; NAN if there is none. */
static float block_db(const struct image *image, int patch, const struct drawn_axis *r, int i,
                      const struct drawn_axis *x, int j, double peak)
{
    double largest = NAN;
    int i_first = axis_pixel(r, i), j_first = axis_pixel(x, j);
    for (int m = i_first; m < i_first + r->block && m < r->pixels; m++)
        for (int n = j_first; n < j_first + x->block && n < x->pixels; n++) {
            double value = power(image_pixel(image, patch, m, n));
            if (isfinite(value))
                largest = fmax(largest, value);
        }
    if (isnan(largest))
        return NAN;
    return largest > 0 ? (float)fmax(10 * log10(largest / peak), floor_db) : (float)floor_db;
}

/* One patch as gnuplot's `binary matrix`. */
static enum status panel_write(const char *path, const struct image *image, int patch, double peak)
{
    const struct grid *grid = &image->patches[patch];
    struct drawn_axis x = axis_reduce(grid->x_first, grid->x_step, grid->x_count);
    struct drawn_axis r = axis_reduce(grid->r_first, grid->r_step, grid->r_count);
    FILE *file = fopen(path, "wb");
    if (!file)
        return file_failed(path);
    float row[PIXELS_MAX + 1] = {(float)x.count};
    for (int j = 0; j < x.count; j++)
        row[j + 1] = (float)(x.first + j * x.step);
    fwrite(row, sizeof *row, (size_t)x.count + 1, file);
    for (int i = 0; i < r.count; i++) {
        row[0] = (float)(r.first + i * r.step);
        for (int j = 0; j < x.count; j++)
            row[j + 1] = block_db(image, patch, &r, i, &x, j, peak);
        fwrite(row, sizeof *row, (size_t)x.count + 1, file);
    }
    bool written = !ferror(file);
    written &= fclose(file) == 0;
    return written ? STATUS_OK : file_failed(path);
}

static enum status image_write(const struct plot *plot, const struct image *image, const char *title)
{
    long not_finite;
    double peak = image_peak(image, &not_finite);
    int shown = image->patch_count < PANELS_MAX ? image->patch_count : PANELS_MAX;
    char notes[200] = "", full_title[600];
    size_t length = 0;
    if (!(peak > 0))
        length += (size_t)snprintf(notes + length, sizeof notes - length, " (all zero)");
    if (not_finite > 0)
        length += (size_t)snprintf(notes + length, sizeof notes - length, " (%ld %s not finite)", not_finite,
                                   not_finite == 1 ? "pixel" : "pixels");
    if (shown < image->patch_count)
        snprintf(notes + length, sizeof notes - length, " (first %d of %d patches)", shown, image->patch_count);
    snprintf(full_title, sizeof full_title, "%.390s%s", title, notes);
    variable_write(plot->preamble, "title", full_title);

    array_begin(plot->preamble, "panels", shown);
    for (int p = 0; p < shown; p++) {
        char name[32], path[PATH_MAX + 32];
        snprintf(name, sizeof name, "panel%d", p);
        file_path(plot, name, path);
        enum status status = panel_write(path, image, p, peak);
        if (status != STATUS_OK)
            return status;
        array_write(plot->preamble, "panels", p, path);
    }
    return STATUS_OK;
}

enum status plot_image(const char *path, const char *plots_directory, const struct image *image, const char *title)
{
    struct plot plot;
    enum status status = plot_begin(&plot, path);
    if (status == STATUS_OK)
        status = image_write(&plot, image, title);
    if (status == STATUS_OK)
        status = plot_draw(&plot, plots_directory, "image.gp");
    plot_end(&plot);
    return status;
}

static enum status lines_write(const struct plot *plot, const char *title, int panel_count,
                               const char *const *panel_titles, int line_count, const struct slice_line *lines)
{
    int shown = panel_count < PANELS_MAX ? panel_count : PANELS_MAX;
    char full_title[600], path[PATH_MAX + 32];
    int length = snprintf(full_title, sizeof full_title, "%.500s", title);
    if (shown < panel_count)
        snprintf(full_title + length, sizeof full_title - (size_t)length, " (first %d of %d panels)", shown,
                 panel_count);
    file_path(plot, "slices", path);
    variable_write(plot->preamble, "title", full_title);
    variable_write(plot->preamble, "data", path);
    array_begin(plot->preamble, "panels", shown);
    for (int p = 0; p < shown; p++)
        array_write(plot->preamble, "panels", p, panel_titles[p]);
    array_begin(plot->preamble, "lines", line_count);
    for (int l = 0; l < line_count; l++)
        array_write(plot->preamble, "lines", l, lines[l].label);

    FILE *file = fopen(path, "w");
    if (!file)
        return file_failed(path);
    for (int b = 0; b < shown * line_count; b++) {
        /* A block without a row would not count, and shift the ones behind it. */
        fprintf(file, "0 NaN\n");
        for (int k = 0; k < lines[b].count; k++)
            fprintf(file, "%.9g %.6g\n", lines[b].position_m[k], fmax(lines[b].power_db[k], floor_db));
        fprintf(file, "\n\n");
    }
    bool written = !ferror(file);
    written &= fclose(file) == 0;
    return written ? STATUS_OK : file_failed(path);
}

static enum status lines_draw(const char *path, const char *plots_directory, const char *script, const char *title,
                              int panel_count, const char *const *panel_titles, int line_count,
                              const struct slice_line *lines)
{
    struct plot plot;
    enum status status = plot_begin(&plot, path);
    if (status == STATUS_OK)
        status = lines_write(&plot, title, panel_count, panel_titles, line_count, lines);
    if (status == STATUS_OK)
        status = plot_draw(&plot, plots_directory, script);
    plot_end(&plot);
    return status;
}

enum status plot_slices(const char *path, const char *plots_directory, const char *title, int panel_count,
                        const char *const *panel_titles, int line_count, const struct slice_line *lines)
{
    return lines_draw(path, plots_directory, "slices.gp", title, panel_count, panel_titles, line_count, lines);
}

enum status plot_phase(const char *path, const char *plots_directory, const char *title, int panel_count,
                       const char *const *panel_titles, int line_count, const struct slice_line *lines)
{
    return lines_draw(path, plots_directory, "phase.gp", title, panel_count, panel_titles, line_count, lines);
}

const char *const folder_plots[] = {"error_time", "error_flops", "lobes_time", "upsampling", NULL};

enum status plot_folder(const char *path, const char *plots_directory, const char *name, const char *folder,
                        const char *scene, bool *drawn)
{
    struct plot plot;
    char script[64];
    snprintf(script, sizeof script, "%s.gp", name);
    *drawn = false;
    enum status status = plot_begin(&plot, path);
    if (status == STATUS_OK) {
        variable_write(plot.preamble, "folder", folder);
        variable_write(plot.preamble, "scene", scene);
        status = plot_run(&plot, plots_directory, script);
    }
    if (status == STATUS_OK && access(plot.output, F_OK) == 0) {
        *drawn = true;
        status = plot_place(&plot);
    }
    plot_end(&plot);
    return status;
}

enum status plot_csv(const char *path, const char *plots_directory, const char *script, const char *csv)
{
    struct plot plot;
    enum status status = plot_begin(&plot, path);
    if (status == STATUS_OK) {
        variable_write(plot.preamble, "csv", csv);
        status = plot_draw(&plot, plots_directory, script);
    }
    plot_end(&plot);
    return status;
}

void picture_label(const char *algorithm, const char *options, const char *precision, char *label, size_t size)
{
    snprintf(label, size, "%s%s%s%s", algorithm, *options ? ":" : "", options,
             strcmp(precision, "double") == 0 ? " double" : "");
}

void picture_path(const char *directory, const char *scene, const char *rest, char *path, size_t size)
{
    int used = snprintf(path, size, "%s/", directory);
    if (used >= (int)size)
        return;
    snprintf(path + used, size - (size_t)used, "%s-%s", scene, rest);
    for (char *p = path + used; *p; p++)
        if (strchr("/:,= \\", *p))
            *p = '_';
}
