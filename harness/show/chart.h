/* Error against run time as a chart: its axes, where its points lie and the names beside them; gnuplot draws it
   (plot_results.c), and a page (page_chart.c). */
#ifndef SASBENCH_SHOW_CHART_H
#define SASBENCH_SHOW_CHART_H

#include "show/plot_points.h"

/* Logarithmic axes; pixels count from the upper left. */
struct chart {
    double cost_low, cost_high, error_low, error_high;
    double width, height; /* px */
    bool relative;        /* the cost is relative to the scalar reference loop's, else seconds */
};
/* Axes that hold the points of all scenes, with their bars and the scalar reference loop where they are in seconds;
   without points cost_low is INFINITY. */
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
    bool apart; /* so far from its point that a line must lead there */
};
/* Names of so wide signs, in *labels [points->count], where none covers another or a point: of settings that stand
   alone the algorithm's, of a series in float its numbers, as many as there is room for, those of the front first.
   Returns how many. */
int chart_label(const struct chart *chart, const struct points *points, double sign_px, struct chart_label *labels);

#endif
