/* Cheapest settings at one glance (report_cheapest.h). */
#include "report/report_cheapest.h"

#include <stdio.h>
#include <string.h>

#include "show/plot.h"
#include "show/table.h"

enum { DECADES_MOST = 16 };

/* Empty where there is no such column. */
static const char *cell_of(const struct csv *csv, int row, const char *column)
{
    const int index = csv_column(csv, column);
    return index < 0 ? "" : csv_cell(csv, row, index);
}

/* By run time, of all algorithms; an older version of the file knows no families. */
static bool is_of_all(const struct csv *csv, int row)
{
    const char *family = cell_of(csv, row, "family");
    return strcmp(cell_of(csv, row, "cost"), "run_s") == 0 && (!*family || strcmp(family, "all") == 0);
}

static int decades_find(const struct csv *csv, const char *decades[DECADES_MOST])
{
    int count = 0;
    for (int row = 0; row < csv->row_count && count < DECADES_MOST; row++) {
        bool known = !is_of_all(csv, row);
        for (int k = 0; k < count; k++)
            known |= strcmp(decades[k], cell_of(csv, row, "error_below")) == 0;
        if (!known)
            decades[count++] = cell_of(csv, row, "error_below");
    }
    return count;
}

/* The rows of a scene stand together. */
static void scene_show(struct page *page, const struct csv *csv, int first, int decade_count,
                       const char *const decades[DECADES_MOST])
{
    const char *scene = cell_of(csv, first, "scene");
    char texts[DECADES_MOST][160] = {""};
    struct page_cell cells[DECADES_MOST + 1] = {{scene, NULL}};
    for (int row = first; row < csv->row_count && strcmp(cell_of(csv, row, "scene"), scene) == 0; row++)
        for (int k = 0; k < decade_count; k++) {
            char label[120];
            double run_s;
            if (!is_of_all(csv, row) || strcmp(cell_of(csv, row, "error_below"), decades[k]) != 0)
                continue;
            const bool timed = csv_number(cell_of(csv, row, "run_s"), &run_s);
            picture_label(cell_of(csv, row, "algorithm"), cell_of(csv, row, "options"), cell_of(csv, row, "precision"),
                          label, sizeof label);
            snprintf(texts[k], sizeof texts[k], "%s%s%s%s", label, timed ? ", " : "",
                     timed ? cell_time(run_s).text : "", *cell_of(csv, row, "noise") ? "~" : "");
        }
    for (int k = 0; k < decade_count; k++)
        cells[k + 1] = (struct page_cell){texts[k], NULL};
    page_row(page, cells);
}

void cheapest_summary_show(struct page *page, const struct csv *csv)
{
    const char *decades[DECADES_MOST];
    char titles[DECADES_MOST][40];
    struct page_column columns[DECADES_MOST + 1] = {{"fastest with an error up to", false}};
    const int count = decades_find(csv, decades);
    if (count == 0)
        return;
    for (int k = 0; k < count; k++) {
        snprintf(titles[k], sizeof titles[k], "%s", decades[k]);
        columns[k + 1] = (struct page_column){titles[k], false};
    }
    page_table_begin(page, count + 1, columns, false);
    for (int row = 0; row < csv->row_count; row++)
        if (row == 0 || strcmp(cell_of(csv, row, "scene"), cell_of(csv, row - 1, "scene")) != 0)
            scene_show(page, csv, row, count, decades);
    page_table_end(page);
}
