/* The first table of a report: all scenes and algorithms at one glance. */
#ifndef SASBENCH_REPORT_REPORT_SUMMARY_H
#define SASBENCH_REPORT_REPORT_SUMMARY_H

#include "results/results.h"
#include "report/page.h"

/* A row for each scene, a column for each algorithm (in tables of some columns, no wider than a page): error and
   speed-up of its fastest setting with an error up to 0.1, or of its most exact one, and which was the fastest of all:
   the one that cheapest.csv has. Heading and links have the id "summary". */
bool summary_applies(const struct results *results); /* has any row an error */
void summary_show(struct page *page, const struct results *results, int scene_count, const char *const *scenes);

#endif
