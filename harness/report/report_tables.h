/* The tables of a results folder other than its measurements: what `sweep` and `reproduce` write beside them. */
#ifndef SASBENCH_REPORT_REPORT_TABLES_H
#define SASBENCH_REPORT_REPORT_TABLES_H

#include "files/csv.h"
#include "report/page.h"

enum { REPORT_COLUMNS = 13 };

/* A CSV file on the page. */
struct report_table {
    const char *file, *id, *title, *text;
    const char *group;                                         /* column whose values become headings, or NULL */
    void (*summary)(struct page *page, const struct csv *csv); /* of all groups, ahead of them; may be NULL */
    struct {
        const char *name, *title;
        enum { SHOW_TEXT, SHOW_NUMBER, SHOW_VERDICT, SHOW_ONCE } show; /* once: not again in the rows below */
    } columns[REPORT_COLUMNS];                                         /* title NULL ends */
};
enum { REPORT_TABLES = 8, REPORT_STABILITY = 7 };
extern const struct report_table report_tables[REPORT_TABLES];

/* The file in DIR, into a zeroed *csv, which stays so where there is none. Errors: as csv_read; STATUS_INVALID naming
   a column that is missing. */
enum status report_table_read(const char *directory, const struct report_table *table, struct csv *csv);
/* Heading, text and rows; nothing for a file without rows. */
void report_table_show(struct page *page, const struct report_table *table, const struct csv *csv);

#endif
