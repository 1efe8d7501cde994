/* Measurements on a page (report_parts.h). */
#include "report/report_parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "text/text_append.h"
#include "measure/outcome.h"
#include "show/table.h"

enum { COLUMNS_MOST = 32, DERIVED = 4, WARNING_LENGTH = 600 };
/* Columns ahead of the metrics. */
static const struct page_column derived_columns[DERIVED] = {
    {"algorithm", false}, {"run time", true}, {"speed-up", true}, {"plan", true}};

/* --- Warnings -------------------------------------------------------------------------------------------------- */

static bool is_warned(const struct measurement *row, const char *warning)
{
    char text[WARNING_LENGTH];
    for (const char *at = row->reason; warning_next(&at, text, sizeof text);)
        if (strcmp(text, warning) == 0)
            return true;
    return false;
}

/* Which images of the row's scene have a warning; empty where an earlier row has it and has listed them. */
static void warned_find(const struct results *results, int row, const char *warning, char *who, size_t size)
{
    char spec[512];
    int images = 0, warned = 0;
    *who = '\0';
    for (int k = 0; k < results->csv.row_count; k++) {
        const struct measurement *other = &results->measurements[k];
        if (strcmp(other->scene, results->measurements[row].scene) != 0 || strcmp(other->status, "ok") != 0)
            continue;
        images++;
        if (!is_warned(other, warning))
            continue;
        if (k < row) {
            *who = '\0';
            return;
        }
        measurement_spec(other, spec, sizeof spec);
        text_append(who, size, "%s%s", warned++ ? ", " : "", spec);
    }
    if (warned == images && images > 1)
        snprintf(who, size, "all");
}

void report_warnings_show(struct page *page, const struct results *results)
{
    static const struct page_column columns[] = {{"scene", false}, {"warning", false}, {"images", false}};
    char text[WARNING_LENGTH], who[1200];
    bool any = false;
    for (int k = 0; k < results->csv.row_count; k++) {
        const struct measurement *row = &results->measurements[k];
        if (strcmp(row->status, "ok") != 0)
            continue;
        for (const char *at = row->reason; warning_next(&at, text, sizeof text);) {
            warned_find(results, k, text, who, sizeof who);
            if (!*who)
                continue;
            if (!any) {
                page_heading(page, 2, "warnings", "Warnings");
                page_table_begin(page, 3, columns);
            }
            any = true;
            page_row(page,
                     (struct page_cell[]){{row->scene, NULL}, {text + strlen(OUTCOME_WARNING), NULL}, {who, NULL}});
        }
    }
    if (any)
        page_table_end(page);
}

/* --- Rows ------------------------------------------------------------------------------------------------------ */

/* Has the scene no targets, according to any of its images? */
static bool scene_is_blind(const struct results *results, const char *scene)
{
    bool blind = false;
    for (int k = 0; k < results->csv.row_count; k++)
        blind |= strcmp(results->measurements[k].scene, scene) == 0 && measurement_is_blind(&results->measurements[k]);
    return blind;
}

static void note_add(char *note, size_t size, const char *text)
{
    if (*text)
        text_append(note, size, "%s%s", *note ? "; " : "", text);
}

/* Engine, left-out work, and the parts of the reason that are no warnings. */
static void note_make(const struct measurement *row, char *note, size_t size)
{
    char text[1200];
    const char *first = strstr(row->reason, OUTCOME_WARNING);
    size_t length = first ? (size_t)(first - row->reason) : strlen(row->reason);
    *note = '\0';
    note_add(note, size, row->engine);
    note_add(note, size, row->skipped);
    if (first && length >= 2)
        length -= 2; /* "; " */
    snprintf(text, sizeof text, "%.*s", (int)length, row->reason);
    note_add(note, size, text);
}

static void row_show(struct page *page, const struct measurement *row, bool blind)
{
    char spec[512], note[2400], time[64];
    struct cell texts[COLUMNS_MOST] = {
        [2] = cell_significant(row->control_s / row->run_s, "x"), [3] = cell_time(row->plan_s)};
    struct page_cell cells[COLUMNS_MOST];
    int count = DERIVED;
    measurement_spec(row, spec, sizeof spec);
    if (strcmp(row->status, "ok") != 0) {
        snprintf(note, sizeof note, "%s: %s", row->status, row->reason);
        page_row_note(page, spec, note);
        return;
    }
    snprintf(time, sizeof time, "%s", cell_run_time(row).text);
    if (isfinite(row->run_q1_s) && isfinite(row->run_q3_s))
        snprintf(time, sizeof time, "%.12s (-%.1f, +%.1f %%)", cell_run_time(row).text,
                 fmin(999, 100 * (1 - row->run_q1_s / row->run_s)), fmin(999, 100 * (row->run_q3_s / row->run_s - 1)));
    for (const struct column *column = measurement_columns; column->name; column++)
        if (column_is_shown(column, !blind))
            texts[count++] = cell_metric(column, row);
    for (int k = 2; k < count; k++)
        cells[k] = (struct page_cell){strcmp(texts[k].text, "-") == 0 ? "" : texts[k].text, NULL};
    cells[0] = (struct page_cell){spec, NULL};
    cells[1] = (struct page_cell){time, NULL};
    note_make(row, note, sizeof note);
    page_row(page, cells);
    if (*note)
        page_row_note(page, "", note);
}

/* The columns of a table; `titles` keeps metrics' titles with their units. */
static int columns_make(bool blind, struct page_column columns[COLUMNS_MOST], char titles[COLUMNS_MOST][48])
{
    int count = DERIVED;
    memcpy(columns, derived_columns, sizeof derived_columns);
    for (const struct column *column = measurement_columns; column->name; column++)
        if (column_is_shown(column, !blind)) {
            snprintf(titles[count], sizeof titles[count], *column->shown.unit ? "%s (%s)" : "%s", column->shown.title,
                     column->shown.unit);
            columns[count] = (struct page_column){titles[count], true};
            count++;
        }
    return count;
}

void report_measurements_show(struct page *page, const struct results *results, int scene_count,
                              const char *const *scenes)
{
    page_heading(page, 2, "measurements", "Measurements");
    page_paragraph(
        page,
        "Run time: median seconds from the echoes in memory to the complex image (~: noisy); speed-up: against the "
        "scalar reference loop timed beside. In parentheses the quartiles of the runs. Errors: relative L2 "
        "against the exact image. Width, PSLR and ISLR: medians over the targets, azimuth, main lobe "
        "from first minimum to first minimum; without targets the image's sharpness. Below a row: the engine that the "
        "plan chose, and what it left out.");
    for (int s = 0; s < scene_count; s++) {
        const bool blind = scene_is_blind(results, scenes[s]);
        struct page_column columns[COLUMNS_MOST];
        char titles[COLUMNS_MOST][48];
        page_part_begin(page, scenes[s]);
        page_table_begin(page, columns_make(blind, columns, titles), columns);
        for (int row = 0; row < results->csv.row_count; row++)
            if (strcmp(results->measurements[row].scene, scenes[s]) == 0)
                row_show(page, &results->measurements[row], blind);
        page_table_end(page);
        page_part_end(page);
    }
}
