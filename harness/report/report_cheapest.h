/* The cheapest settings of a sweep over all its scenes, in one table of a report. */
#ifndef SASBENCH_REPORT_REPORT_CHEAPEST_H
#define SASBENCH_REPORT_REPORT_CHEAPEST_H

#include "files/csv.h"
#include "report/page.h"

/* Of cheapest.csv: a row for each scene, a column for each decade of error: the fastest setting of all algorithms,
   and its run time. Nothing where there is no such row. */
void cheapest_summary_show(struct page *page, const struct csv *csv);

#endif
