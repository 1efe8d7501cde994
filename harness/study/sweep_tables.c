/* What the rows of a sweep say (sweep_tables.h). */
#include "study/sweep_tables.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "data/csv.h"
#include "scene/scene.h"
#include "data/shown_text.h"
#include "show/plot_points.h"
#include "show/table.h"
#include "data/paths.h"
#include "data/text_file.h"

static const double floor_tolerance = 0.05;

/* --- Series --------------------------------------------------------------------------------------------------- */

struct line_fit line_fit(int count, const double *rate, const double *error)
{
    struct line_fit fit = {.points = count, .slope = NAN, .first = NAN, .last = NAN, .residual_log10 = NAN};
    double x_mean = 0, y_mean = 0, xx = 0, xy = 0, square = 0;
    for (int k = 0; k < count; k++) {
        x_mean += log10(rate[k]) / count;
        y_mean += log10(error[k]) / count;
    }
    for (int k = 0; k < count; k++) {
        double x = log10(rate[k]) - x_mean;
        xx += x * x;
        xy += x * (log10(error[k]) - y_mean);
    }
    if (count < 2 || !(xx > 0))
        return fit;
    fit.slope = xy / xx;
    for (int k = 0; k < count; k++) {
        double distance = log10(error[k]) - y_mean - fit.slope * (log10(rate[k]) - x_mean);
        square += distance * distance / count;
    }
    fit.first = pow(10, y_mean + fit.slope * (log10(rate[0]) - x_mean));
    fit.last = pow(10, y_mean + fit.slope * (log10(rate[count - 1]) - x_mean));
    fit.residual_log10 = sqrt(square);
    return fit;
}

int floor_find(int count, const double *error)
{
    int first = count - 1;
    while (first > 0 && fabs(error[first - 1] / error[count - 1] - 1) <= floor_tolerance)
        first--;
    return count < 2 || first == count - 1 ? count : first;
}

/* --- Rows ------------------------------------------------------------------------------------------------------ */

/* A measured setting as a point of its series. */
struct sweep_point {
    const struct measurement *row;
    struct setting setting; /* what varies along the series, and what does not */
    bool taken;             /* belongs to a series that is done */
};

static struct sweep_point point_read(const struct measurement *row)
{
    return (struct sweep_point){.row = row, .setting = setting_read(row->options)};
}

static bool same_series(const struct sweep_point *a, const struct sweep_point *b)
{
    return strcmp(a->row->scene, b->row->scene) == 0 && strcmp(a->row->algorithm, b->row->algorithm) == 0
           && strcmp(a->row->precision, b->row->precision) == 0 && strcmp(a->setting.name, b->setting.name) == 0
           && strcmp(a->setting.rest, b->setting.rest) == 0;
}

/* Settings that upsample nothing count by themselves. */
static double point_rate(const struct sweep_point *point)
{
    double rate = setting_rate(point->row->algorithm, &point->setting);
    return isnan(rate) ? point->setting.value : rate;
}

static int point_order(const void *a, const void *b)
{
    double x = ((const struct sweep_point *)a)->setting.value, y = ((const struct sweep_point *)b)->setting.value;
    return (x > y) - (x < y);
}

/* The rows of one scene that have both time and error, but for exact ones that image only a part of it. */
struct group {
    const char *scene;
    const struct measurement **rows; /* [count] borrowed */
    struct sweep_point *points;      /* [count] */
    double *error, *cost;            /* [count] room for a front's or a series' values */
    int *front;                      /* [count] room for a front */
    struct sweep_point *series;      /* [count] room for a series */
    int count;
};

static void group_free(struct group *group)
{
    free(group->rows);
    free(group->error);
    free(group->cost);
    free(group->front);
    free(group->points);
    free(group->series);
}

static enum status group_fill(const struct results *results, const char *scene, struct group *group)
{
    size_t most = (size_t)results->csv.row_count + 1;
    *group = (struct group){.scene = scene,
                            .rows = calloc(most, sizeof *group->rows),
                            .error = calloc(most, sizeof *group->error),
                            .cost = calloc(most, sizeof *group->cost),
                            .front = calloc(most, sizeof *group->front),
                            .points = calloc(most, sizeof *group->points),
                            .series = calloc(most, sizeof *group->series)};
    if (!group->rows || !group->error || !group->cost || !group->front || !group->points || !group->series)
        return status_set(STATUS_FAILED, "%s: no memory for %zu rows", scene, most);
    double most_pairs = scene_most_pairs(results, scene);
    for (int k = 0; k < results->csv.row_count; k++) {
        const struct measurement *row = &results->measurements[k];
        if (strcmp(row->scene, scene) == 0 && row_is_point(row, most_pairs)) {
            group->rows[group->count] = row;
            group->points[group->count++] = point_read(row);
        }
    }
    return STATUS_OK;
}

/* --- The files ------------------------------------------------------------------------------------------------- */

static const struct cost {
    const char *name, *title;
    size_t offset; /* of the double in struct measurement */
} costs[] = {
    {"run_s", "run time", offsetof(struct measurement, run_s)},
    {"flops", "counted FLOPs", offsetof(struct measurement, flops)},
};

static void group_values(struct group *group, const struct cost *cost)
{
    for (int k = 0; k < group->count; k++) {
        group->cost[k] = *(const double *)((const char *)group->rows[k] + cost->offset);
        group->error[k] = group->rows[k]->error;
    }
}

/* Fields of a row, texts first, then numbers; NULL ends the texts. */
static void fields_write(FILE *file, const char *const *texts, const double *numbers, int number_count)
{
    for (int k = 0; texts[k]; k++) {
        csv_write_text(file, texts[k]);
        fputc(texts[k + 1] || number_count ? ',' : '\n', file);
    }
    for (int k = 0; k < number_count; k++) {
        csv_write_number(file, numbers[k]);
        fputc(k < number_count - 1 ? ',' : '\n', file);
    }
}

static void fronts_write(struct group *group, FILE *file)
{
    for (size_t c = 0; c < sizeof costs / sizeof *costs; c++) {
        group_values(group, &costs[c]);
        int size = pareto_front_find(group->count, group->cost, group->error, group->front);
        for (int k = 0; k < size; k++) {
            const struct measurement *row = group->rows[group->front[k]];
            fields_write(
                file,
                (const char *const[]){row->scene, costs[c].name, row->algorithm, row->options, row->precision, NULL},
                (double[]){group->cost[group->front[k]], row->error}, 2);
        }
    }
}

/* The cheapest row with an error up to `below`, of equal ones the fastest; NULL if no row comes that far. */
static const struct measurement *cheapest_find(const struct group *group, double below)
{
    int best = -1;
    for (int k = 0; k < group->count; k++)
        if (group->error[k] <= below
            && (best < 0 || group->cost[k] < group->cost[best]
                || (group->cost[k] == group->cost[best] && group->rows[k]->run_s < group->rows[best]->run_s)))
            best = k;
    return best < 0 ? NULL : group->rows[best];
}

/* For each decade from 1 down to the last that any setting reaches. */
static void cheapest_write(struct group *group, FILE *file)
{
    printf("\n%s: the cheapest setting for each decade of error\n", group->scene);
    for (size_t c = 0; c < sizeof costs / sizeof *costs; c++) {
        const struct measurement *row;
        group_values(group, &costs[c]);
        printf("  by %s\n      below      time speed-up     MFLOP    error  setting\n", costs[c].title);
        for (int decade = 0; (row = cheapest_find(group, pow(10, decade))); decade--) {
            char threshold[16], spec[512];
            snprintf(threshold, sizeof threshold, "1e%d", decade);
            measurement_spec(row, spec, sizeof spec);
            shown_make(spec);
            printf("    %7s  %8s %8s %9s  %7.1e  %s\n", threshold, cell_time(row->run_s).text,
                   cell_significant(row->control_s / row->run_s, "x").text,
                   cell_significant(1e-6 * row->flops, "").text, row->error, spec);
            fields_write(file,
                         (const char *const[]){row->scene, costs[c].name, threshold, row->algorithm, row->options,
                                               row->precision, NULL},
                         (double[]){row->run_s, row->control_s / row->run_s, row->flops, row->error, row->error_gain,
                                    row->pslr_db, row->islr_db},
                         7);
        }
    }
}

/* The straight line through a part of a series. rates, errors: [count] of that part. */
static void slope_write(const struct sweep_point *points, const double *rates, const double *errors, int count,
                        const char *part, FILE *file)
{
    const struct measurement *row = points->row;
    struct line_fit fit = line_fit(count, rates, errors);
    char name[512], range[80];
    if (isnan(fit.slope))
        return;
    fields_write(file,
                 (const char *const[]){row->scene, row->algorithm, points->setting.rest, row->precision,
                                       points->setting.name, part, NULL},
                 (double[]){points[0].setting.value, points[count - 1].setting.value, rates[0], rates[count - 1],
                            fit.points, fit.slope, fit.first, fit.last, fit.residual_log10},
                 9);
    snprintf(name, sizeof name, "%s%s%s%s", row->algorithm, *points->setting.rest ? ":" : "", points->setting.rest,
             strcmp(row->precision, "double") == 0 ? " double" : "");
    shown_make(name);
    snprintf(range, sizeof range, "%s %g to %g", points->setting.name, points[0].setting.value,
             points[count - 1].setting.value);
    shown_make(range);
    printf("  %-36s %-8s %-18s %6d  %6.3f  %7.1e  %7.1e  %8.4f\n", name, part, range, fit.points, fit.slope, fit.first,
           fit.last, fit.residual_log10);
}

/* The series' parts: where the error falls and the floor; without a floor the finest half, for the order that the
   method tends to. */
static void series_write(const struct sweep_point *points, int count, const double *rates, const double *errors,
                         FILE *file)
{
    int floor = floor_find(count, errors), finest = count / 2;
    slope_write(points, rates, errors, floor, "falling", file);
    if (floor == count && count - finest >= 3)
        slope_write(points + finest, rates + finest, errors + finest, count - finest, "finest", file);
    if (floor < count)
        slope_write(points + floor, rates + floor, errors + floor, count - floor, "floor", file);
}

static void slopes_write(struct group *group, FILE *file)
{
    printf("\n%s: slopes of log error against log rate (beta + 1, or the setting itself)\n"
           "  %-36s %-8s %-18s %6s  %6s  %7s  %7s  %8s\n",
           group->scene, "series", "part", "setting", "points", "slope", "first", "last", "residual");
    for (int k = 0; k < group->count; k++) {
        const struct sweep_point *start = &group->points[k];
        int size = 0;
        if (start->taken || !*start->setting.name)
            continue;
        for (int j = k; j < group->count; j++)
            if (same_series(start, &group->points[j])) {
                group->series[size++] = group->points[j];
                group->points[j].taken = true;
            }
        qsort(group->series, (size_t)size, sizeof *group->series, point_order);
        for (int j = 0; j < size; j++) {
            group->cost[j] = point_rate(&group->series[j]);
            group->error[j] = group->series[j].row->error;
        }
        series_write(group->series, size, group->cost, group->error, file);
    }
}

/* The rules for the upsampling rate at this scene's numbers (BP22 Eq. (20), ZP15's lambda/8), and two error laws: the
   envelope's phase at the band's edge at rate 1, which falls as 1/rate, and the floor of linear interpolation. That
   is its loss 1 - sinc^2(f/fs), about (pi f/fs)^2/3, rms over a flat band |f| <= B/2: pi^2 (B/fs)^2/(12 sqrt 5). A
   scene that is no longer there as it was measured has none. */
static void rules_write(struct group *group, const struct scene *given, const struct csv *csv, FILE *file)
{
    struct scene scene = {0};
    char key[300], hash[17];
    if (!given && scene_load(group->scene, SCENE_DIRECTORY, &scene) != STATUS_OK)
        return;
    given = given ? given : &scene;
    snprintf(key, sizeof key, "scene %s", group->scene);
    snprintf(hash, sizeof hash, "%016" PRIx64, given->hash);
    const char *measured = csv_comment(csv, key);
    if (measured && strcmp(measured, hash) == 0) {
        const struct acquisition *a = &given->acquisition;
        double lambda = a->sound_speed / a->fc, bin = a->sound_speed / (2 * a->fs);
        double resolution = a->tx_length > 0 ? a->tx_length / 2 : NAN, fraction = a->bandwidth / a->fs;
        double bp22 = 2 * bin * 10 * lambda / (resolution * resolution), zp15 = 2 * a->fc / a->fs;
        fields_write(file, (const char *const[]){group->scene, NULL},
                     (double[]){a->fc, a->fs, a->bandwidth, bp22, zp15, M_PI * fraction / 2,
                                M_PI * M_PI / (12 * sqrt(5)) * fraction * fraction},
                     7);
        printf("\n%s: upsampling rates asked for by BP22 Eq. (20) > %.3g, by ZP15's lambda/8 > %.3g\n", group->scene,
               bp22, zp15);
    }
    scene_free(&scene);
}

enum { FRONTS, CHEAPEST, SLOPES, RULES, TABLES };

static const struct {
    const char *file, *format, *header;
} tables[TABLES] = {
    [FRONTS] = {"fronts.csv", "sasbench fronts 1", "scene,cost,algorithm,options,precision,value,error"},
    [CHEAPEST] = {"cheapest.csv", "sasbench cheapest 1",
                  "scene,cost,error_below,algorithm,options,precision,run_s,speed_up,flops,error,error_gain,pslr_db,"
                  "islr_db"},
    [SLOPES] = {"slopes.csv", "sasbench slopes 1",
                "scene,algorithm,options,precision,setting,part,first,last,rate_first,rate_last,points,slope,"
                "error_first,error_last,residual_log10"},
    [RULES] = {"rules.csv", "sasbench rules 1",
               "scene,fc_hz,fs_hz,bandwidth_hz,bp22_eq20_rate,zp15_rate,edge_phase_rad,linear_floor"},
};

/* `given` is the scene itself, or NULL. */
static enum status scene_tables(const struct results *results, const char *scene, const struct scene *given,
                                struct text_file *files)
{
    struct group group;
    enum status status = group_fill(results, scene, &group);
    if (status == STATUS_OK && group.count > 0) {
        fronts_write(&group, files[FRONTS].stream);
        cheapest_write(&group, files[CHEAPEST].stream);
        rules_write(&group, given, &results->csv, files[RULES].stream);
        slopes_write(&group, files[SLOPES].stream);
    }
    group_free(&group);
    return status;
}

static bool scene_seen(const struct results *results, int row)
{
    for (int k = 0; k < row; k++)
        if (strcmp(results->measurements[k].scene, results->measurements[row].scene) == 0)
            return true;
    return false;
}

static enum status table_open(const char *directory, int table, const struct csv *csv, struct text_file *file)
{
    static const char *const keys[] = {"machine", "commit", "date", "threads"};
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", directory, tables[table].file);
    enum status status = text_file_open(path, file);
    if (status != STATUS_OK)
        return status;
    fprintf(file->stream, "# %s\n", tables[table].format);
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        const char *value = csv_comment(csv, keys[k]);
        fprintf(file->stream, "# %s: %s\n", keys[k], value ? value : "unknown");
    }
    fprintf(file->stream, "%s\n", tables[table].header);
    return STATUS_OK;
}

static const struct scene *scene_find(const struct scene *scenes, int count, const char *name)
{
    for (int k = 0; k < count; k++)
        if (strcmp(scenes[k].name, name) == 0)
            return &scenes[k];
    return NULL;
}

enum status sweep_tables(const char *directory, const struct scene *scenes, int scene_count)
{
    struct results results;
    struct text_file files[TABLES];
    int opened = 0;
    char path[4096];
    snprintf(path, sizeof path, "%s/measurements.csv", directory);
    enum status status = results_read(path, &results);
    while (opened < TABLES && status == STATUS_OK) {
        status = table_open(directory, opened, &results.csv, &files[opened]);
        opened += status == STATUS_OK;
    }
    for (int row = 0; row < results.csv.row_count && status == STATUS_OK; row++)
        if (!scene_seen(&results, row)) {
            const char *scene = results.measurements[row].scene;
            status = scene_tables(&results, scene, scene_find(scenes, scene_count, scene), files);
        }
    for (int k = 0; k < opened; k++)
        status = text_file_close(&files[k], status);
    results_free(&results);
    return status;
}
