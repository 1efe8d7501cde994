/* The folders of a results site, by kind of machine. */
#ifndef SASBENCH_REPORT_SITE_PARTS_H
#define SASBENCH_REPORT_SITE_PARTS_H

#include <stdbool.h>

#include "report/page.h"
#include "results/results.h"

#define SITE_TITLE "sasbench: results of several machines"
enum { HEAD_MOST = 120 }; /* characters of a value in a file's head */

/* A results folder. Texts belong to its file. */
struct submission {
    const char *directory, *date, *commit;
    struct results results;
    int kind;
};

/* A kind of machine, whose times are compared. */
struct kind {
    char name[400];
    struct results newest; /* of each cell the row of the newest folder; texts are borrowed */
    struct origin {
        const struct submission *submission;
        int row;
    } * from; /* of each row */
};

struct site {
    struct submission *submissions; /* [submission_count], the newest first */
    struct kind *kinds;             /* [kind_count] */
    const char **scenes;            /* [scene_count] by name */
    int submission_count, kind_count, scene_count;
};

/* Errors: as site_write; site_free accepts a zeroed struct, and what a failure leaves. */
enum status site_read(int count, const char *const *folders, struct site *site);
void site_free(struct site *site);

/* Do rows differ in what was measured alone? */
bool site_is_cell(const struct measurement *a, const struct measurement *b);

/* index.html; the page of a scene. Errors: as page_chart. */
enum status site_index_show(struct page *page, const struct site *site);
enum status site_scene_show(struct page *page, const struct site *site, const char *scene);

#endif
