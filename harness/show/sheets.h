/* The tables of a results folder other than its measurements: what `sweep` and `reproduce` write beside them. */
#ifndef SASBENCH_SHOW_SHEETS_H
#define SASBENCH_SHOW_SHEETS_H

#include "data/csv.h"
#include "show/page.h"

enum { SHEET_COLUMNS = 12 };

/* A CSV file on the page. */
struct sheet {
    const char *file, *id, *title, *text;
    const char *group;                  /* column whose values become headings, or NULL */
    bool stack;                         /* long texts: rows fall apart on a narrow screen */
    bool late;                          /* long and for reference: after the pictures */
    struct {
        const char *name, *title;
        enum { SHOW_TEXT, SHOW_NUMBER, SHOW_VERDICT, SHOW_ONCE } show;  /* once: not again in the rows below */
    } columns[SHEET_COLUMNS];           /* title NULL ends */
};
enum { SHEETS = 5 };
extern const struct sheet sheets[SHEETS];

/* The file in DIR, into a zeroed *csv, which stays so where there is none. Errors: as csv_read; STATUS_INVALID naming
   a column that is missing. */
enum status sheet_read(const char *directory, const struct sheet *sheet, struct csv *csv);
/* Heading, text and rows; nothing for a file without rows. */
void sheet_show(struct page *page, const struct sheet *sheet, const struct csv *csv);

#endif
