/* Points of the plots (plot_points.h). */
#include "show/plot_points.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "files/csv.h"
#include "text/text_append.h"

static struct setting setting_read(const char *options)
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

/* Beta points are inserted between two samples, zero padding multiplies them, the nearest sample alone is rate 1. */
static double setting_rate(const char *algorithm, const struct setting *setting)
{
    if (strcmp(setting->name, "beta") == 0)
        return setting->value + 1;
    if (strcmp(setting->name, "factor") == 0)
        return setting->value;
    return strcmp(algorithm, "bp_nearest") == 0 ? 1 : NAN;
}

/* Measured, with time and error, and not an exact image of only a part of the scene; most_pairs: the most of any of
   its rows. */
static bool row_is_point(const struct measurement *row, double most_pairs)
{
    bool partial = row->pairs > 0 && row->pairs < 0.999 * most_pairs;
    return strcmp(row->status, "ok") == 0 && row->run_s > 0 && row->runs > 0 && row->error > 0 && !partial;
}

static double scene_most_pairs(const struct results *results, const char *scene)
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

const struct measurement *scene_fastest(const struct results *results, const char *scene, double error_most)
{
    const struct measurement *best = NULL;
    for (int chosen = 0; chosen < 2 && !best; chosen++)
        for (int k = 0; k < results->csv.row_count; k++) {
            const struct measurement *row = &results->measurements[k];
            if (strcmp(row->scene, scene) == 0 && strcmp(row->algorithm, "reference") != 0
                && (strcmp(row->algorithm, "auto") == 0) == chosen
                && measurement_is_cheaper(row, best, offsetof(struct measurement, run_s), error_most))
                best = row;
        }
    return best;
}

enum status scenes_find(const struct results *results, const char ***scenes, int *count)
{
    const int rows = results->csv.row_count;
    *count = 0;
    *scenes = calloc((size_t)rows + 1, sizeof **scenes);
    if (!*scenes)
        return status_set(STATUS_FAILED, "%s: no memory for %d rows", results->csv.path, rows);
    for (int row = 0; row < rows; row++) {
        bool seen = false;
        for (int k = *count - 1; k >= 0 && !seen; k--)
            seen = strcmp((*scenes)[k], results->measurements[row].scene) == 0;
        if (!seen)
            (*scenes)[(*count)++] = results->measurements[row].scene;
    }
    return STATUS_OK;
}

/* --- Points of a scene ----------------------------------------------------------------------------------------- */

void points_free(struct points *points)
{
    free(points->list);
    free(points->series);
    free(points->front);
    *points = (struct points){0};
}

static bool settings_vary(const struct point *a, const struct point *b)
{
    return strcmp(a->setting.rest, b->setting.rest) != 0 || strcmp(a->setting.name, b->setting.name) != 0;
}

/* The index of a point's series, which may be a new one. */
static int series_find(struct points *points, const struct point *point)
{
    for (int k = 0; k < points->count; k++) {
        const struct point *other = &points->list[k];
        if (strcmp(other->row->algorithm, point->row->algorithm) == 0
            && strcmp(other->row->precision, point->row->precision) == 0 && !settings_vary(other, point))
            return other->series;
    }
    struct series *series = &points->series[points->series_count];
    snprintf(series->title, sizeof series->title, "%.40s%s%s", point->row->algorithm, *point->setting.rest ? " " : "",
             point->setting.rest);
    return points->series_count++;
}

/* From sorted points: the range of each series, and its index among its algorithm's; both precisions of one setting
   are one. */
static void series_number(struct points *points)
{
    for (int k = points->count - 1; k >= 0; k--) {
        points->series[points->list[k].series].first = k;
        points->series[points->list[k].series].count++;
    }
    for (int s = 0; s < points->series_count; s++) {
        struct series *series = &points->series[s];
        const struct point *mine = &points->list[series->first];
        series->alone = series->count == 1;
        for (int t = 0, next = 0; t < points->series_count; t++) {
            const struct point *other = &points->list[points->series[t].first];
            if (t == s || strcmp(other->row->algorithm, mine->row->algorithm) != 0)
                continue;
            series->alone = false;
            if (t < s && !settings_vary(other, mine)) {
                series->member = points->series[t].member;
                break;
            }
            if (t < s && points->series[t].member >= next)
                series->member = next = points->series[t].member + 1;
        }
    }
}

static int point_order(const void *a, const void *b)
{
    const struct point *x = a, *y = b;
    const double more = x->setting.value - y->setting.value;
    return x->series != y->series ? x->series - y->series : (more > 0) - (more < 0);
}

static int number_order(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Front and median; costs and errors have room for each point. */
static void points_judge(struct points *points, double *costs, double *errors)
{
    int known = 0;
    for (int k = 0; k < points->count; k++)
        if (points->list[k].row->control_s > 0)
            costs[known++] = points->list[k].row->control_s;
    qsort(costs, (size_t)known, sizeof *costs, number_order);
    points->control_s = known ? costs[(known - 1) / 2] : NAN;
    for (int k = 0; k < points->count; k++) {
        costs[k] = points->list[k].row->run_s;
        errors[k] = points->list[k].row->error;
    }
    points->front_count = pareto_front_find(points->count, costs, errors, points->front);
    for (int k = 0; k < points->front_count; k++)
        points->list[points->front[k]].on_front = true;
}

enum status points_find(const struct results *results, const char *scene, struct points *points)
{
    const size_t most = (size_t)results->csv.row_count + 1;
    const double most_pairs = scene_most_pairs(results, scene);
    double *room = calloc(2 * most, sizeof *room);
    *points = (struct points){.scene = scene,
                              .list = calloc(most, sizeof *points->list),
                              .series = calloc(most, sizeof *points->series),
                              .front = calloc(most, sizeof *points->front)};
    if (!room || !points->list || !points->series || !points->front) {
        free(room);
        points_free(points);
        return status_set(STATUS_FAILED, "%s: no memory for %zu points", scene, most);
    }
    for (int k = 0; k < results->csv.row_count; k++) {
        const struct measurement *row = &results->measurements[k];
        if (strcmp(row->scene, scene) != 0 || !row_is_point(row, most_pairs))
            continue;
        struct point *point = &points->list[points->count];
        *point = (struct point){.row = row, .setting = setting_read(row->options)};
        point->rate = setting_rate(row->algorithm, &point->setting);
        point->series = series_find(points, point);
        points->count++;
    }
    qsort(points->list, (size_t)points->count, sizeof *points->list, point_order);
    series_number(points);
    points_judge(points, room, room + most);
    free(room);
    return STATUS_OK;
}
