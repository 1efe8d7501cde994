/* Points of the plots (plot_points.h). */
#include "show/plot_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "files/csv.h"
#include "text/text_append.h"
#include "files/text_file.h"

struct setting setting_read(const char *options)
{
    struct setting setting = {.value = NAN};
    char copy[256], *rest = copy;
    snprintf(copy, sizeof copy, "%s", options);
    for (char *option; (option = strsep(&rest, ","));) {
        const char *value = strchr(option, '=');
        double number;
        if (!*setting.name && value && csv_number(value + 1, &number) && isfinite(number)) {
            snprintf(setting.name, sizeof setting.name, "%.*s", (int)(value - option), option);
            setting.value = number;
        } else {
            text_append(setting.rest, sizeof setting.rest, "%s%s", *setting.rest ? "," : "", option);
        }
    }
    return setting;
}

double setting_rate(const char *algorithm, const struct setting *setting)
{
    if (strcmp(setting->name, "beta") == 0)
        return setting->value + 1;
    if (strcmp(setting->name, "factor") == 0)
        return setting->value;
    return strcmp(algorithm, "bp_nearest") == 0 ? 1 : NAN;
}

bool row_is_point(const struct measurement *row, double most_pairs)
{
    bool partial = row->pairs > 0 && row->pairs < 0.999 * most_pairs;
    return strcmp(row->status, "ok") == 0 && row->run_s > 0 && row->error > 0 && !partial;
}

double scene_most_pairs(const struct results *results, const char *scene)
{
    double most = 0;
    for (int k = 0; k < results->csv.row_count; k++)
        if (strcmp(results->measurements[k].scene, scene) == 0)
            most = fmax(most, results->measurements[k].pairs);
    return most;
}

int pareto_front_find(int count, const double *cost, const double *error, int *front)
{
    int size = 0;
    for (int i = 0; i < count; i++) {
        bool beaten = !(cost[i] > 0 && error[i] > 0);
        for (int j = 0; j < count && !beaten; j++)
            beaten = cost[j] > 0 && error[j] > 0 && cost[j] <= cost[i] && error[j] <= error[i]
                     && (cost[j] < cost[i] || error[j] < error[i] || j < i);
        if (beaten)
            continue;
        int at = size++;
        for (; at > 0 && cost[front[at - 1]] > cost[i]; at--)
            front[at] = front[at - 1];
        front[at] = i;
    }
    return size;
}

int pareto_ties_find(int count, const double *low, const double *high, const double *error, int size, int *front)
{
    int ties = 0;
    for (int i = 0; i < count; i++) {
        bool beaten = !(low[i] > 0 && error[i] > 0);
        for (int k = 0; k < size && !beaten; k++)
            beaten = front[k] == i || (error[front[k]] <= error[i] && high[front[k]] <= low[i]);
        if (!beaten)
            front[size + ties++] = i;
    }
    return ties;
}

/* All [row_count]; of one scene at a time. */
struct points {
    double *run_s, *flops, *error; /* NAN where a row is no point of the scene */
    int *front;
    bool *is_point, *cheap[2]; /* of the Pareto front by run time, by FLOPs */
};

static void points_free(struct points *points)
{
    free(points->run_s);
    free(points->flops);
    free(points->error);
    free(points->front);
    free(points->is_point);
    free(points->cheap[0]);
    free(points->cheap[1]);
}

static enum status points_make(int count, struct points *points)
{
    size_t room = (size_t)count + 1;
    *points = (struct points){calloc(room, sizeof *points->run_s),    calloc(room, sizeof *points->flops),
                              calloc(room, sizeof *points->error),    calloc(room, sizeof *points->front),
                              calloc(room, sizeof *points->is_point), {calloc(room, 1), calloc(room, 1)}};
    if (points->run_s && points->flops && points->error && points->front && points->is_point && points->cheap[0]
        && points->cheap[1])
        return STATUS_OK;
    points_free(points);
    return status_set(STATUS_FAILED, "no memory for %d points", count);
}

/* Marks the rows of a scene. */
static void scene_mark(const struct results *results, const char *scene, struct points *points)
{
    int count = results->csv.row_count;
    double most_pairs = scene_most_pairs(results, scene);
    for (int k = 0; k < count; k++) {
        const struct measurement *row = &results->measurements[k];
        bool ours = strcmp(row->scene, scene) == 0 && row_is_point(row, most_pairs);
        points->is_point[k] |= ours;
        points->run_s[k] = ours ? row->run_s : NAN;
        points->flops[k] = ours ? row->flops : NAN;
        points->error[k] = ours ? row->error : NAN;
    }
    for (int c = 0; c < 2; c++) {
        int size = pareto_front_find(count, c ? points->flops : points->run_s, points->error, points->front);
        for (int k = 0; k < size; k++)
            points->cheap[c][points->front[k]] = true;
    }
}

static void rows_write(FILE *file, const struct results *results, const struct points *points)
{
    for (int k = 0; k < results->csv.row_count; k++) {
        const struct measurement *row = &results->measurements[k];
        const struct setting setting = setting_read(row->options);
        const char *const texts[] = {row->scene, row->algorithm, row->precision, setting.rest};
        const double numbers[] = {setting.value, setting_rate(row->algorithm, &setting),
                                  row->run_s,    row->flops,
                                  row->error,    row->pslr_db,
                                  row->islr_db,  row->control_s};
        double interval[2];
        measurement_interval(row, &interval[0], &interval[1]);
        if (strcmp(row->status, "ok") != 0 || !(row->run_s > 0 && row->error > 0))
            continue;
        for (size_t n = 0; n < sizeof texts / sizeof *texts; n++) {
            csv_write_text(file, texts[n]);
            fputc(',', file);
        }
        for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++) {
            csv_write_number(file, numbers[n]);
            fputc(',', file);
        }
        fprintf(file, "%d,%d,%d", points->is_point[k], points->cheap[0][k], points->cheap[1][k]);
        for (int n = 0; n < 2; n++) {
            fputc(',', file);
            csv_write_number(file, interval[n]);
        }
        fputc('\n', file);
    }
}

static bool scene_is_new(const struct results *results, int row)
{
    for (int k = 0; k < row; k++)
        if (strcmp(results->measurements[k].scene, results->measurements[row].scene) == 0)
            return false;
    return true;
}

static enum status file_write(const char *directory, const struct results *results, const struct points *points)
{
    static const char *const keys[] = {"machine", "threads", "commit"};
    char path[4096];
    struct text_file file;
    snprintf(path, sizeof path, "%s/points.csv", directory);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    fputs("# sasbench points 2\n", file.stream);
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        const char *value = csv_comment(&results->csv, keys[k]);
        fprintf(file.stream, "# %s: %s\n", keys[k], value ? value : "unknown");
    }
    fputs("scene,algorithm,precision,rest,value,rate,run_s,flops,error,pslr_db,islr_db,control_s,is_point,front_run_s,"
          "front_flops,run_q1_s,run_q3_s\n",
          file.stream);
    rows_write(file.stream, results, points);
    return text_file_close(&file, STATUS_OK);
}

enum status plot_points_write(const char *directory)
{
    char path[4096];
    struct results results;
    struct points points;
    snprintf(path, sizeof path, "%s/measurements.csv", directory);
    enum status status = results_read(path, &results);
    if (status == STATUS_OK)
        status = points_make(results.csv.row_count, &points);
    if (status == STATUS_OK) {
        for (int row = 0; row < results.csv.row_count; row++)
            if (scene_is_new(&results, row))
                scene_mark(&results, results.measurements[row].scene, &points);
        status = file_write(directory, &results, &points);
        points_free(&points);
    }
    results_free(&results);
    return status;
}
