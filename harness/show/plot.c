/* Slices, phase errors, and pictures of a folder or a CSV file (plot.h). */
#include "show/plot.h"

#include <math.h>
#include <string.h>

#include "show/plot_script.h"

static const double floor_db = -200; /* stands for zero power, far below the shown range */

/* The extent of slices: all lines out to the last place where one is above -30 dB, with a dozen points a line. */
static double slices_extent(const struct slice_line *lines, int count)
{
    double reach = 0;
    for (int b = 0; b < count; b++)
        for (int k = 0; k < lines[b].count; k++)
            if (lines[b].power_db[k] > -30)
                reach = fmax(reach, fabs(lines[b].position_m[k]));
    return reach > 0 ? 1.15 * reach : 1;
}

static void extent_write(FILE *preamble, const struct slice_line *lines, int count, double extent)
{
    double top = floor_db;
    long places = 0;
    bool differences = false;
    for (int b = 0; b < count; b++) {
        differences |= lines[b].count > 0 && lines[b].difference_db;
        for (int k = 0; k < lines[b].count; k++)
            if (fabs(lines[b].position_m[k]) <= extent) {
                places++;
                top = lines[b].difference_db ? fmax(top, lines[b].difference_db[k]) : top;
            }
    }
    fprintf(preamble, "extent = %.9g\npoint_interval = %ld\nhas_differences = %d\ndifference_top = %g\n", extent,
            places / (12 * count), differences, differences ? 10 * ceil(top / 10) : 0);
}

/* A data block for each line, out to the first place beyond the extent. */
static void line_write(FILE *file, const struct slice_line *line, int index, double extent)
{
    fprintf(file, "data[%d] = '$line%d'\n$line%d << END\n", index + 1, index, index);
    fprintf(file, "0 NaN NaN\n"); /* gnuplot refuses a block without a row */
    for (int k = 0; k < line->count; k++) {
        const bool near = fabs(line->position_m[k]) <= extent;
        if (near || (k > 0 && fabs(line->position_m[k - 1]) <= extent)
            || (k + 1 < line->count && fabs(line->position_m[k + 1]) <= extent))
            fprintf(file, "%.9g %.6g %.6g\n", line->position_m[k], fmax(line->power_db[k], floor_db),
                    line->difference_db ? fmax(line->difference_db[k], floor_db) : NAN);
    }
    fprintf(file, "END\n");
}

/* Slices are cut to their extent. */
static void lines_write(const struct plot *plot, const struct slices_picture *picture)
{
    const int shown = picture->panel_count < PANELS_MAX ? picture->panel_count : PANELS_MAX;
    const int count = shown * picture->line_count;
    const struct slice_line *lines = picture->lines;
    const double extent = picture->phase ? INFINITY : slices_extent(lines, count);
    char title[600];
    int length = snprintf(title, sizeof title, "%.500s", picture->title);
    if (shown < picture->panel_count)
        snprintf(title + length, sizeof title - (size_t)length, " (first %d of %d panels)", shown,
                 picture->panel_count);
    plot_variable(plot->preamble, "title", title);
    plot_variable(plot->preamble, "footer", picture->footer ? picture->footer : "");
    plot_array(plot->preamble, "panels", shown);
    for (int p = 0; p < shown; p++)
        plot_array_write(plot->preamble, "panels", p, picture->panel_titles[p]);
    plot_array(plot->preamble, "lines", picture->line_count);
    plot_array(plot->preamble, "algorithms", picture->line_count);
    plot_array(plot->preamble, "printed", picture->line_count);
    for (int l = 0; l < picture->line_count; l++) {
        plot_array_write(plot->preamble, "lines", l, lines[l].label);
        plot_array_write(plot->preamble, "algorithms", l, lines[l].algorithm ? lines[l].algorithm : lines[l].label);
        fprintf(plot->preamble, "printed[%d] = %.9g\n", l + 1, lines[l].printed);
    }
    if (!picture->phase)
        extent_write(plot->preamble, lines, count, extent);
    plot_array(plot->preamble, "data", count);
    for (int b = 0; b < count; b++)
        line_write(plot->preamble, &lines[b], b, extent);
}

enum status plot_slices(struct plot_queue *queue, const char *path, const char *plots_directory,
                        const struct slices_picture *picture)
{
    struct plot plot;
    enum status status = plot_begin(&plot, path, false);
    if (status == STATUS_OK)
        lines_write(&plot, picture);
    return plot_finish(&plot, status, queue, plots_directory, picture->phase ? "phase.gp" : "slices.gp");
}

enum status plot_csv(const char *path, const char *plots_directory, const char *script, const char *csv,
                     const char *footer)
{
    struct plot plot;
    char beside[4200];
    snprintf(beside, sizeof beside, "%s", path);
    plot_path_svg(beside);
    enum status status = plot_begin(&plot, path, false);
    if (status == STATUS_OK) {
        plot_path_variable(plot.preamble, "csv", csv);
        plot_variable(plot.preamble, "footer", footer);
    }
    status = plot_finish(&plot, status, NULL, plots_directory, script);
    return status == STATUS_OK && strcmp(beside, path) != 0 ? plot_csv(beside, plots_directory, script, csv, footer)
                                                            : status;
}

void picture_label(const char *algorithm, const char *options, const char *precision, char *label, size_t size)
{
    snprintf(label, size, "%s%s%s%s", algorithm, *options ? ":" : "", options,
             strcmp(precision, "double") == 0 ? " double" : "");
}

void plot_path_svg(char *path)
{
    memcpy(path + strlen(path) - strlen("png"), "svg", strlen("svg"));
}

void picture_path(const char *directory, const char *scene, const char *rest, char *path, size_t size)
{
    int used = snprintf(path, size, "%s/", directory);
    if (used >= (int)size)
        return;
    snprintf(path + used, size - (size_t)used, "%s-%s", scene, rest);
    for (char *p = path + used; *p; p++)
        if (strchr("/:,= \\|&;<>()$`'\"*?[]{}", *p))
            *p = '_';
}
