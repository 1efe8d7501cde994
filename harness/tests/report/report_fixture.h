/* What tests of reports share: made-up rows, and a parser that reads a page as a browser would have to. */
#ifndef SASBENCH_TEST_REPORT_FIXTURE_H
#define SASBENCH_TEST_REPORT_FIXTURE_H

#include "results/measurement.h"

/* A finished row; texts are borrowed. */
struct measurement row_of(const char *scene, const char *algorithm, const char *options, double run_s, double error);
/* Into the test's folder. */
void record_rows(const struct measurement *rows, int count);

enum { DEPTH_MAX = 64, IDS_MAX = 4000 };

struct parser {
    const char *at;
    char open[DEPTH_MAX][32]; /* names of the elements that are open */
    int depth;
    int tables, rows, drawings, images, scripts;
    char ids[IDS_MAX][48]; /* of elements */
    int id_count;
};

/* The whole page; fails the test where it is not well-formed, or something is loaded from outside. The caller frees
   it. */
struct parser *page_parse(const char *html);

#endif
