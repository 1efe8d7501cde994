/* How the error falls along a series of settings: slopes.csv of a sweep (sweep_tables.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "text/shown_text.h"
#include "sweep/sweep_tables.h"

static const double floor_tolerance = 0.05;

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

/* The straight line through a part of a series. rates, errors: [count] of that part. */
static void slope_write(const struct point *points, const double *rates, const double *errors, int count,
                        const char *part, bool told, FILE *file)
{
    const struct measurement *row = points->row;
    struct line_fit fit = line_fit(count, rates, errors);
    char name[512], range[80];
    if (isnan(fit.slope))
        return;
    csv_write_fields(file,
                     (const char *const[]){row->scene, row->algorithm, points->setting.rest, row->precision,
                                           points->setting.name, part, NULL},
                     (double[]){points[0].setting.value, points[count - 1].setting.value, rates[0], rates[count - 1],
                                fit.points, fit.slope, fit.first, fit.last, fit.residual_log10},
                     9, true);
    if (!told)
        return;
    snprintf(name, sizeof name, "%s%s%s%s", row->algorithm, *points->setting.rest ? ":" : "", points->setting.rest,
             strcmp(row->precision, "double") == 0 ? " double" : "");
    shown_make(name);
    snprintf(range, sizeof range, "%s %g to %g", points->setting.name, points[0].setting.value,
             points[count - 1].setting.value);
    shown_make(range);
    printf("  %-36s %-8s %-18s %6d  %6.3f  %7.1e  %7.1e  %8.4f\n", name, part, range, fit.points, fit.slope, fit.first,
           fit.last, fit.residual_log10);
}

/* The parts of each series: the falling error and the floor; without a floor the finest half, for the method's
   asymptotic order. Settings without upsampling count by themselves. */
enum status slopes_write(const struct points *points, bool told, FILE *file)
{
    double *rates = calloc(2 * (size_t)points->count + 1, sizeof *rates);
    if (!rates)
        return status_set(STATUS_FAILED, "%s: no memory for %d rows", points->scene, points->count);
    double *errors = rates + points->count;
    if (told)
        printf("\n%s: slopes of log error against log rate (beta + 1, or the setting itself)\n"
               "  %-36s %-8s %-18s %6s  %6s  %7s  %7s  %8s\n",
               points->scene, "series", "part", "setting", "points", "slope", "first", "last", "residual");
    for (int s = 0; s < points->series_count; s++) {
        const struct point *list = &points->list[points->series[s].first];
        const int count = points->series[s].count;
        if (!*list->setting.name)
            continue;
        for (int k = 0; k < count; k++) {
            rates[k] = isnan(list[k].rate) ? list[k].setting.value : list[k].rate;
            errors[k] = list[k].row->error;
        }
        const int floor = floor_find(count, errors), finest = count / 2;
        slope_write(list, rates, errors, floor, "falling", told, file);
        if (floor == count && count - finest >= 3)
            slope_write(list + finest, rates + finest, errors + finest, count - finest, "finest", told, file);
        if (floor < count)
            slope_write(list + floor, rates + floor, errors + floor, count - floor, "floor", told, file);
    }
    free(rates);
    return STATUS_OK;
}
