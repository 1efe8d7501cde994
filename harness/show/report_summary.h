/* The first table of a report: all scenes and algorithms at one glance. */
#ifndef SASBENCH_SHOW_REPORT_SUMMARY_H
#define SASBENCH_SHOW_REPORT_SUMMARY_H

#include "measure/results.h"
#include "show/page.h"

/* A row for each scene, a column for each algorithm: the error and the speed-up of its most exact setting, and which
   was the fastest below an error of 0.1. Heading and links have the id "summary". */
bool summary_applies(const struct results *results); /* has any row an error */
void summary_show(struct page *page, const struct results *results, int scene_count, const char *const *scenes);

#endif
