/* A page of headings, tables and pictures, written as one self-contained HTML file.

   The HTML is strict: every element is closed, every attribute quoted, nothing is loaded from outside, and the page
   can be read without its one script. These functions escape text; callers pass it plain. */
#ifndef SASBENCH_REPORT_PAGE_H
#define SASBENCH_REPORT_PAGE_H

#include <stdbool.h>
#include <stdio.h>

#include "contract/status.h"

struct page_column {
    const char *title;
    bool number; /* aligned right */
};

struct page {
    FILE *stream;
    /* For these functions alone. */
    const struct page_column *columns; /* [column_count] of the open table */
    int column_count;
    int drawings; /* SVG pictures so far: the prefix of their elements' names */
};

struct page_cell {
    const char *text;
    const char *class; /* of the HTML cell: good, soft, bad, open; NULL for none */
};

void page_begin(struct page *page, const char *title);
void page_end(struct page *page);

/* A text, escaped, for callers that write their own elements. */
void page_text(struct page *page, const char *text);
/* level 2 or 3; `id` for links within the page, may be NULL. */
void page_heading(struct page *page, int level, const char *id, const char *text);
void page_paragraph(struct page *page, const char *text);
/* A part with a title, folded at first. */
void page_part_begin(struct page *page, const char *title);
void page_part_end(struct page *page);
/* A link to a heading, by its id. */
void page_link(struct page *page, const char *id, const char *text);

/* On a narrow screen each row becomes a block. `columns` stays borrowed until page_table_end. A row has a cell for
   each column, the first being its name; page_row_note writes one text in place of the other cells; without a name
   it belongs to the row above. */
void page_table_begin(struct page *page, int count, const struct page_column *columns);
void page_row(struct page *page, const struct page_cell *cells);
void page_row_note(struct page *page, const char *name, const char *note);
void page_table_end(struct page *page);

/* An SVG of gnuplot stands inline, its names made unique; a PNG is encoded in the page. Errors: STATUS_FAILED when
   the file cannot be read. */
enum status page_drawing(struct page *page, const char *path, const char *title);
enum status page_image(struct page *page, const char *path, const char *caption);
/* The JPEG file of the descriptor `small` in place of a PNG, with a link to the file `name` beside the page. */
enum status page_thumbnail(struct page *page, int small, const char *name, const char *caption);
/* A link to a file beside the page. */
void page_file(struct page *page, const char *name, const char *text);

extern const char page_style[], page_script[];

#endif
