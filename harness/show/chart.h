/* Error against run time as a chart: its axes, the places of its points and the names beside them. gnuplot draws it
   (plot_results.c), and so does a page (page_chart.c). */
#ifndef SASBENCH_SHOW_CHART_H
#define SASBENCH_SHOW_CHART_H

#include "show/plot_points.h"

/* Logarithmic axes; pixels count from the upper left. */
struct chart {
    double cost_low, cost_high, error_low, error_high;
    double width, height; /* px */
    bool relative;        /* the cost is relative to the scalar reference loop's, else seconds */
};
/* Axes that contain the points of all scenes with their bars, and the scalar reference loop where costs are in
   seconds; without points cost_low is INFINITY. */
struct chart chart_fit(const struct points *scenes, int scene_count, bool relative, double width, double height);
double chart_cost(const struct chart *chart, const struct measurement *row);
double chart_x(const struct chart *chart, double cost);
double chart_y(const struct chart *chart, double error);

/* A name beside a point. */
struct chart_label {
    char text[64];
    int point;
    double x, y; /* px: left end and middle of the text */
    double width;
    bool apart; /* so far from its point that a line must connect them */
};
/* Names whose characters are sign_px wide, in *labels [points->count], none over another or over a point. A setting
   that stands alone has its algorithm's name; a series in float has its numbers, as many as there is room for, those
   of the front first. Returns their number. */
int chart_label(const struct chart *chart, const struct points *points, double sign_px, struct chart_label *labels);

#endif
