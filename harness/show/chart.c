/* Axes and names of a chart (chart.h). */
#include "show/chart.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "show/plot.h"

static const double point_px = 5, line_px = 14; /* half of a point; a line of text */

struct chart chart_fit(const struct points *scenes, int scene_count, bool relative, double width, double height)
{
    struct chart chart = {INFINITY, 0, INFINITY, 0, width, height, relative};
    for (int s = 0; s < scene_count; s++) {
        if (!relative && scenes[s].count > 0 && isfinite(scenes[s].control_s)) {
            chart.cost_low = fmin(chart.cost_low, scenes[s].control_s);
            chart.cost_high = fmax(chart.cost_high, scenes[s].control_s);
        }
        for (int k = 0; k < scenes[s].count; k++) {
            const struct measurement *row = scenes[s].list[k].row;
            double low, high;
            measurement_interval(row, &low, &high);
            chart.cost_low = fmin(chart.cost_low, relative ? chart_cost(&chart, row) : low);
            chart.cost_high = fmax(chart.cost_high, relative ? chart_cost(&chart, row) : high);
            chart.error_low = fmin(chart.error_low, row->error);
            chart.error_high = fmax(chart.error_high, row->error);
        }
    }
    chart.cost_low /= 1.4;
    chart.cost_high *= 1.4;
    chart.error_low /= 1.6;
    chart.error_high *= 1.6;
    return chart;
}

double chart_cost(const struct chart *chart, const struct measurement *row)
{
    return chart->relative ? row->run_s / row->control_s : row->run_s;
}

double chart_x(const struct chart *chart, double cost)
{
    return chart->width * log(cost / chart->cost_low) / log(chart->cost_high / chart->cost_low);
}

double chart_y(const struct chart *chart, double error)
{
    return chart->height * log(chart->error_high / error) / log(chart->error_high / chart->error_low);
}

/* Is the label's place inside the chart and free of points and of earlier labels? */
static bool is_free(const struct chart *chart, const struct points *points, const struct chart_label *labels, int count,
                    const struct chart_label *label)
{
    bool free = label->x >= 2 && label->x + label->width <= chart->width - 2 && label->y >= line_px / 2
                && label->y <= chart->height - line_px / 2;
    for (int k = 0; k < points->count && free; k++) {
        const struct measurement *row = points->list[k].row;
        const double x = chart_x(chart, row->run_s), y = chart_y(chart, row->error);
        free = x + point_px <= label->x || x - point_px >= label->x + label->width
               || fabs(y - label->y) >= point_px + line_px / 2 - 2;
    }
    for (int k = 0; k < count && free; k++)
        free = labels[k].x + labels[k].width + 3 <= label->x || labels[k].x >= label->x + label->width + 3
               || fabs(labels[k].y - label->y) >= line_px;
    return free;
}

/* Beside its point, or on wider and wider rings around it; false without room. */
static bool label_place(const struct chart *chart, const struct points *points, const struct chart_label *labels,
                        int count, int rings, struct chart_label *label)
{
    static const double sides[][2] = {{1, -1.2}, {1, 0}, {1, 1.2}, {-1, 1.2}, {-1, 0}, {-1, -1.2}, {0, -1}, {0, 1}};
    const struct measurement *row = points->list[label->point].row;
    const double x = chart_x(chart, row->run_s), y = chart_y(chart, row->error);
    for (int ring = 0; ring < rings; ring++)
        for (size_t k = 0; k < sizeof sides / sizeof *sides; k++) {
            const double away = 2 * point_px + line_px * ring;
            label->x = x + sides[k][0] * (point_px + 2 + line_px * ring) + (sides[k][0] - 1) * label->width / 2;
            label->y = y + sides[k][1] * (sides[k][0] == 0 ? away + line_px / 4 : away);
            label->apart = ring > 0;
            if (is_free(chart, points, labels, count, label))
                return true;
        }
    return false;
}

static void label_text(const struct points *points, int point, char *text, size_t size)
{
    const struct measurement *row = points->list[point].row;
    const struct series *series = &points->series[points->list[point].series];
    if (series->alone)
        snprintf(text, size, "%s", row->algorithm);
    else if (series->count == 1)
        picture_label(row->algorithm, row->options, row->precision, text, size);
    else if (isfinite(points->list[point].setting.value) && strcmp(row->precision, "double") != 0)
        snprintf(text, size, "%.9g", points->list[point].setting.value);
}

/* The front first, then the ends of series, then the rest. */
static int rank_of(const struct points *points, int point)
{
    const struct series *series = &points->series[points->list[point].series];
    const bool end = point == series->first || point == series->first + series->count - 1;
    return points->list[point].on_front ? 0 : end ? 1 : 2;
}

int chart_label(const struct chart *chart, const struct points *points, double sign_px, struct chart_label *labels)
{
    int count = 0;
    for (int rank = 0; rank < 3; rank++)
        for (int k = 0; k < points->count; k++) {
            struct chart_label *label = &labels[count];
            *label = (struct chart_label){.point = k};
            if (rank_of(points, k) != rank)
                continue;
            label_text(points, k, label->text, sizeof label->text);
            label->width = sign_px * (double)strlen(label->text);
            const int rings = points->series[points->list[k].series].count == 1 ? 9 : 1;
            count += *label->text && label_place(chart, points, labels, count, rings, label);
        }
    return count;
}
