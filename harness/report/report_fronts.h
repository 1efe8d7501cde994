/* What a report begins with: three sentences, the overview, the fronts by scene, and the fastest setting for each power
   of ten of error. */
#ifndef SASBENCH_REPORT_REPORT_FRONTS_H
#define SASBENCH_REPORT_REPORT_FRONTS_H

#include "report/page.h"
#include "show/plot_points.h"

/* How much was measured, which are the fastest, what was refused, failed, is noisy or warned of. */
void report_sentences_show(struct page *page, const struct results *results, int scene_count,
                           const char *const *scenes);
/* All scenes at one glance. */
void report_overview_show(struct page *page, const struct points *points, int scene_count);
/* Of each scene a chart, its front as a table, and the commands that measure these again. Errors: as page_chart. */
enum status report_fronts_show(struct page *page, const struct points *points, int scene_count);
/* A row for each scene, a column for each power of ten of error that any reaches. */
void report_cheapest_show(struct page *page, const struct results *results, const struct points *points,
                          int scene_count);

#endif
