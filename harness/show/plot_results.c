/* Error against time of a results folder: data blocks for plots/error_time.gp, overview.gp, upsampling.gp (plot.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "files/folder.h"
#include "files/paths.h"
#include "text/text_append.h"
#include "show/chart.h"
#include "show/plot.h"
#include "show/plot_script.h"

/* Pictures in the making. */
struct drawer {
    const char *directory;
    char footer[600];
    struct plot_queue queue;
};

/* --- What the scripts share ------------------------------------------------------------------------------------- */

/* A line of numbers of a data block. */
static void line_write(FILE *file, int count, const double *numbers)
{
    for (int k = 0; k < count; k++) {
        const char *end = k < count - 1 ? " " : "\n";
        if (isfinite(numbers[k]))
            fprintf(file, "%.9g%s", numbers[k], end);
        else
            fprintf(file, "NaN%s", end); /* gnuplot knows no other spelling, in which printf differs */
    }
}

/* $rows: a block for each series of run_s error low high rate islr; and a description of each series. */
static void points_write(FILE *file, const struct points *points)
{
    fputs("$rows << END\n", file);
    for (int s = 0; s < points->series_count; s++) {
        for (int k = 0; k < points->series[s].count; k++) {
            const struct point *point = &points->list[points->series[s].first + k];
            double low, high;
            measurement_interval(point->row, &low, &high);
            line_write(file, 6,
                       (double[]){point->row->run_s, point->row->error, low, high, point->rate, point->row->islr_db});
        }
        fputs("\n\n", file);
    }
    fputs("END\n", file);
    plot_array(file, "series", points->series_count);
    plot_array(file, "algorithms", points->series_count);
    fprintf(file, "array member[%d]\narray precise[%d]\narray counts[%d]\n", points->series_count, points->series_count,
            points->series_count);
    for (int s = 0; s < points->series_count; s++) {
        const struct series *series = &points->series[s];
        const struct measurement *row = points->list[series->first].row;
        plot_array_write(file, "series", s, series->title);
        plot_array_write(file, "algorithms", s, row->algorithm);
        fprintf(file, "member[%d] = %d; precise[%d] = %d; counts[%d] = %d\n", s + 1, series->member, s + 1,
                strcmp(row->precision, "double") == 0, s + 1, series->count);
    }
}

/* Both formats of a picture, DIR/NAME.png and .svg; `write` writes its data, from `of`. */
static void draw(struct drawer *drawer, const char *scene, const char *name, const char *script,
                 enum status (*write)(FILE *file, const void *of), const void *of)
{
    char file[64], path[4096];
    for (int svg = 0; svg < 2; svg++) {
        struct plot plot;
        snprintf(file, sizeof file, "%s.%s", name, svg ? "svg" : "png");
        if (scene)
            picture_path(drawer->directory, scene, file, path, sizeof path);
        else
            snprintf(path, sizeof path, "%s/%s", drawer->directory, file);
        place_clear(path);
        if (!of)
            continue;
        enum status status = plot_begin(&plot, path, false);
        if (status == STATUS_OK) {
            plot_variable(plot.preamble, "footer", drawer->footer);
            status = write(plot.preamble, of);
        }
        (void)plot_finish(&plot, status, &drawer->queue, data_path(DATA_PLOTS), script);
    }
}

/* --- One scene -------------------------------------------------------------------------------------------------- */

enum { PANEL_WIDTH = 865, PANEL_HEIGHT = 520, SIGN = 8 }; /* px */

/* $labels: left end and middle of each name, its series, and the end of its line (NaN: none); the line begins at the
   point. */
static enum status labels_write(FILE *file, const struct points *points, const struct chart *chart)
{
    struct chart_label *labels = calloc((size_t)points->count + 1, sizeof *labels);
    if (!labels)
        return status_set(STATUS_FAILED, "%s: no memory for %d names", points->scene, points->count);
    const int count = chart_label(chart, points, SIGN, labels);
    fputs("$labels << END\nNaN NaN 0 NaN NaN NaN NaN\n", file); /* gnuplot needs one */
    for (int k = 0; k < count; k++) {
        const struct chart_label *label = &labels[k];
        const struct point *point = &points->list[label->point];
        const double x = chart_x(chart, point->row->run_s) / chart->width,
                     y = chart_y(chart, point->row->error) / chart->height,
                     near = fmin(fmax(x, label->x / chart->width), (label->x + label->width) / chart->width);
        line_write(file, 7,
                   (double[]){label->x / chart->width, 1 - label->y / chart->height, point->series + 1,
                              label->apart ? x : NAN, 1 - y, near - x,
                              y - (label->y + (label->y < y * chart->height ? 6 : -6)) / chart->height});
    }
    fputs("END\n", file);
    plot_array(file, "names", count + 1);
    plot_array_write(file, "names", 0, "");
    for (int k = 0; k < count; k++)
        plot_array_write(file, "names", k + 1, labels[k].text);
    free(labels);
    return STATUS_OK;
}

static enum status error_time_write(FILE *file, const void *of)
{
    const struct points *points = of;
    const struct chart chart = chart_fit(points, 1, false, PANEL_WIDTH, PANEL_HEIGHT);
    plot_variable(file, "title", points->scene);
    fprintf(file,
            "panel_width = %d; panel_height = %d\nx_low = %.9g; x_high = %.9g\ny_low = %.9g; y_high = %.9g\n"
            "control_s = ",
            PANEL_WIDTH, PANEL_HEIGHT, chart.cost_low, chart.cost_high, chart.error_low, chart.error_high);
    line_write(file, 1, &points->control_s);
    points_write(file, points);
    fputs("$front << END\n", file);
    for (int k = 0; k < points->front_count; k++) {
        const struct measurement *row = points->list[points->front[k]].row;
        line_write(file, 2, (double[]){row->run_s, row->error});
    }
    fputs("END\n", file);
    return labels_write(file, points, &chart);
}

/* --- The upsampling rate ---------------------------------------------------------------------------------------- */

struct upsampling {
    const char *directory;
    const struct points *points;
};

/* Does a series of three points change the rate? */
static bool rates_vary(const struct points *points)
{
    bool vary = false;
    for (int s = 0; s < points->series_count; s++) {
        const struct point *first = &points->list[points->series[s].first];
        vary |= points->series[s].count >= 3 && first[points->series[s].count - 1].rate > first->rate;
    }
    return vary;
}

static double number_of(const struct csv *csv, int row, const char *column)
{
    double value = NAN;
    const int index = csv_column(csv, column);
    return index >= 0 && csv_number(csv_cell(csv, row, index), &value) ? value : NAN;
}

static bool text_is(const struct csv *csv, int row, const char *column, const char *text)
{
    const int index = csv_column(csv, column);
    return index >= 0 && strcmp(csv_cell(csv, row, index), text) == 0;
}

/* $slopes: rate error, two for each line that `sweep` fitted; $slope_labels: its middle, slope and whether a floor. */
static void slopes_write(FILE *file, const struct csv *csv, const char *scene)
{
    int count = 0;
    for (int labels = 0; labels < 2; labels++) {
        fprintf(file, "$slope%s << END\n", labels ? "_labels" : "s");
        for (int row = 0; row < csv->row_count; row++) {
            const double rates[] = {number_of(csv, row, "rate_first"), number_of(csv, row, "rate_last")},
                         errors[] = {number_of(csv, row, "error_first"), number_of(csv, row, "error_last")};
            if (!text_is(csv, row, "scene", scene) || text_is(csv, row, "part", "falling")
                || !(text_is(csv, row, "setting", "beta") || text_is(csv, row, "setting", "factor"))
                || !text_is(csv, row, "precision", "float") || !(rates[0] * rates[1] > 0 && errors[0] * errors[1] > 0)
                || !isfinite(number_of(csv, row, "slope")))
                continue;
            count++;
            if (labels) {
                line_write(file, 4,
                           (double[]){sqrt(rates[0] * rates[1]), sqrt(errors[0] * errors[1]),
                                      number_of(csv, row, "slope"), text_is(csv, row, "part", "floor")});
            } else {
                line_write(file, 2, (double[]){rates[0], errors[0]});
                line_write(file, 2, (double[]){rates[1], errors[1]});
                fputs("\n\n", file);
            }
        }
        fputs("END\n", file);
    }
    fprintf(file, "has_slopes = %d\n", count > 0);
}

/* The rates of the papers' rules, and the constants of the error laws; 0 where there are none. */
static void rules_write(FILE *file, const struct csv *csv, const char *scene)
{
    static const char *const names[][2] = {{"bp22_eq20_rate", "bp22_rate"},
                                           {"zp15_rate", "zp15_rate"},
                                           {"edge_phase_rad", "edge_phase"},
                                           {"linear_floor", "linear_floor"}};
    int row = 0;
    while (row < csv->row_count && !text_is(csv, row, "scene", scene))
        row++;
    fprintf(file, "has_rules = %d\n", row < csv->row_count);
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        const double value = row < csv->row_count ? number_of(csv, row, names[k][0]) : NAN;
        fprintf(file, "%s = %.9g\n", names[k][1], isfinite(value) ? value : 0);
    }
}

static enum status table_read(const char *directory, const char *name, struct csv *csv)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    *csv = (struct csv){0};
    return place_is_file(path) ? csv_read(path, CSV_TAIL_KEEP, csv) : STATUS_OK;
}

static enum status upsampling_write(FILE *file, const void *of)
{
    const struct upsampling *upsampling = of;
    const struct points *points = upsampling->points;
    struct csv slopes = {0}, rules = {0};
    double islr = NAN;
    enum status status = table_read(upsampling->directory, "slopes.csv", &slopes);
    if (status == STATUS_OK)
        status = table_read(upsampling->directory, "rules.csv", &rules);
    for (int k = 0; k < points->count; k++)
        if (strcmp(points->list[k].row->algorithm, "reference") == 0)
            islr = points->list[k].row->islr_db;
    plot_variable(file, "title", points->scene);
    fprintf(file, "reference_islr = %.9g\nhas_lobes = %d\n", isfinite(islr) ? islr : 0, isfinite(islr));
    points_write(file, points);
    fprintf(file, "array rated[%d]\n", points->series_count);
    for (int s = 0; s < points->series_count; s++)
        fprintf(file, "rated[%d] = %d\n", s + 1, isfinite(points->list[points->series[s].first].rate));
    slopes_write(file, &slopes, points->scene);
    rules_write(file, &rules, points->scene);
    csv_free(&slopes);
    csv_free(&rules);
    return status;
}

/* --- All scenes ------------------------------------------------------------------------------------------------- */

struct overview {
    struct points *scenes; /* [count] */
    int count;
    const char **names; /* [name_count] of algorithms, in the order of their first points */
    int name_count;
};

static int name_find(struct overview *overview, const char *name)
{
    int number = 0;
    while (number < overview->name_count && strcmp(overview->names[number], name) != 0)
        number++;
    if (number == overview->name_count)
        overview->names[overview->name_count++] = name;
    return number;
}

/* $rows and $fronts: a block for each scene of speed-up, error and the algorithm's number. */
static enum status overview_write(FILE *file, const void *of)
{
    struct overview overview = *(const struct overview *)of;
    for (int fronts = 0; fronts < 2; fronts++) {
        fprintf(file, "$%s << END\n", fronts ? "fronts" : "rows");
        for (int s = 0; s < overview.count; s++) {
            const struct points *points = &overview.scenes[s];
            for (int k = 0; k < (fronts ? points->front_count : points->count); k++) {
                const struct measurement *row = points->list[fronts ? points->front[k] : k].row;
                line_write(
                    file, 3,
                    (double[]){row->control_s / row->run_s, row->error, name_find(&overview, row->algorithm) + 1});
            }
            fputs("\n\n", file);
        }
        fputs("END\n", file);
    }
    plot_array(file, "algorithms", overview.name_count);
    for (int k = 0; k < overview.name_count; k++)
        plot_array_write(file, "algorithms", k, overview.names[k]);
    plot_array(file, "scenes", overview.count);
    for (int s = 0; s < overview.count; s++)
        plot_array_write(file, "scenes", s, overview.scenes[s].scene);
    return STATUS_OK;
}

/* The overview of scenes with points, whose times are in that of the scalar reference loop. */
static enum status overview_draw(struct drawer *drawer, const struct results *results, struct points *scenes, int count)
{
    struct overview overview = {.scenes = scenes, .names = calloc((size_t)results->csv.row_count + 1, sizeof(char *))};
    for (int s = 0; s < count; s++)
        if (scenes[s].count > 0 && scenes[s].control_s > 0) {
            const struct points points = scenes[s]; /* the others go last */
            scenes[s] = scenes[overview.count];
            scenes[overview.count++] = points;
        }
    enum status status =
        overview.names ? STATUS_OK : status_set(STATUS_FAILED, "%s: no memory for names", drawer->directory);
    if (status == STATUS_OK)
        draw(drawer, NULL, "overview", "overview.gp", overview_write, overview.count > 1 ? &overview : NULL);
    free(overview.names);
    return status;
}

enum status plot_results(const char *directory, const char *scene, int *undrawn)
{
    static const char *const keys[] = {"machine", "threads", "commit"};
    struct drawer drawer = {.directory = directory};
    struct results results;
    struct points *points = NULL;
    const char **scenes = NULL;
    int count = 0;
    char path[4096];
    snprintf(path, sizeof path, "%s/measurements.csv", directory);
    enum status status = results_read(path, &results);
    if (status == STATUS_OK)
        status = scenes_find(&results, &scenes, &count);
    if (status == STATUS_OK && !(points = calloc((size_t)count + 1, sizeof *points)))
        status = status_set(STATUS_FAILED, "%s: no memory for %d scenes", directory, count);
    for (size_t k = 0; k < sizeof keys / sizeof *keys && status == STATUS_OK; k++) {
        const char *value = csv_comment(&results.csv, keys[k]);
        text_append(drawer.footer, sizeof drawer.footer, "%s%s %.150s", k ? ", " : "", keys[k],
                    value ? value : "unknown");
    }
    for (int s = 0; s < count && status == STATUS_OK; s++)
        if (!scene || strcmp(scenes[s], scene) == 0)
            status = points_find(&results, scenes[s], &points[s]);
    for (int s = 0; s < count && status == STATUS_OK; s++) {
        if (scene && strcmp(scenes[s], scene) != 0)
            continue;
        draw(&drawer, scenes[s], "error_time", "error_time.gp", error_time_write,
             points[s].count > 1 ? &points[s] : NULL);
        if (scene)
            draw(&drawer, scene, "upsampling", "upsampling.gp", upsampling_write,
                 rates_vary(&points[s]) ? &(struct upsampling){directory, &points[s]} : NULL);
    }
    if (status == STATUS_OK && !scene)
        status = overview_draw(&drawer, &results, points, count);
    plot_queue_draw(&drawer.queue);
    *undrawn += drawer.queue.undrawn;
    for (int s = 0; s < count && points; s++)
        points_free(&points[s]);
    free(points);
    free(scenes);
    results_free(&results);
    return status;
}
