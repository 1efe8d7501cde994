/* Error against run time on a page: our own SVG, whose points have names and can be reached by keyboard. */
#ifndef SASBENCH_REPORT_PAGE_CHART_H
#define SASBENCH_REPORT_PAGE_CHART_H

#include "report/page.h"
#include "show/plot_points.h"

/* Colours and points of the algorithms, from the one table in plots/families.gp. */
enum { FAMILIES_MOST = 40 };

struct family {
    char name[32], colour[8]; /* "#0072b2" */
    int point;                /* as gnuplot numbers them, filled */
};
struct families {
    struct family list[FAMILIES_MOST]; /* [count] at least one: the last is for all other algorithms */
    int count;
};
/* Without a readable table all algorithms look alike. */
void families_read(const char *plots_directory, struct families *families);
const struct family *family_of(const struct families *families, const char *algorithm);

/* One scene's points. Those of the front can be focused and show the command that measures them again. Errors:
   STATUS_FAILED without memory. */
enum status page_chart(struct page *page, const struct families *families, const struct points *points);
/* All scenes as small panels with the same axes, each a link to #scene-1, #scene-2 ..., and a legend of the points.
   Scenes without points have no panel. */
void page_overview(struct page *page, const struct families *families, const struct points *scenes, int count);
/* The command that measures a row again. */
void measured_again(const struct measurement *row, char *text, size_t size);

#endif
