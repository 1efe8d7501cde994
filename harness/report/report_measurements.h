/* The measurements of a results folder on a page. */
#ifndef SASBENCH_REPORT_REPORT_MEASUREMENTS_H
#define SASBENCH_REPORT_REPORT_MEASUREMENTS_H

#include "results/results.h"
#include "report/page.h"

/* Each warning of a scene once, with the images that have it; nothing without any. */
void report_warnings_show(struct page *page, const struct results *results);
/* Heading, and a table for each scene, folded; below a row how its image was made. */
void report_measurements_show(struct page *page, const struct results *results, int scene_count,
                              const char *const *scenes);

#endif
