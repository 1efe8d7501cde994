/* The measurements of a results folder on a page. */
#ifndef SASBENCH_REPORT_REPORT_MEASUREMENTS_H
#define SASBENCH_REPORT_REPORT_MEASUREMENTS_H

#include "results/results.h"
#include "report/page.h"

/* Heading, and a table for each scene: its warnings once ahead of it; below a row what is to be said of that alone. */
void report_measurements_show(struct page *page, const struct results *results, int scene_count,
                              const char *const *scenes);

#endif
