/* Tables of `sweep`, `reproduce` and `stability` on a page (report_parts.h). */
#include "report/report_parts.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

#include "report/published.h"
#include "text/text_append.h"
#include "show/plot.h"

/* Empty without such a column. */
static const char *cell_of(const struct csv *csv, int row, const char *column)
{
    const int index = csv_column(csv, column);
    return index < 0 ? "" : csv_cell(csv, row, index);
}

/* The chosen settings, a line an image. */
static void plans_summary_show(struct page *page, const struct csv *csv)
{
    enum { COLUMNS = 6 };
    static const char *const names[COLUMNS] = {"scene", "options", "algorithm", "seconds", "error", "text"};
    static const struct page_column columns[COLUMNS] = {{"scene", false},  {"budget", false},
                                                        {"chosen", false}, {"time (s)", true},
                                                        {"error", true},   {"what is left out", false}};
    page_table_begin(page, COLUMNS, columns);
    for (int row = 0; row < csv->row_count; row++) {
        struct page_cell cells[COLUMNS];
        char label[160], numbers[COLUMNS][32];
        if (strcmp(cell_of(csv, row, "verdict"), "chosen") != 0)
            continue;
        for (int k = 0; k < COLUMNS; k++) {
            double value;
            cells[k] = (struct page_cell){cell_of(csv, row, names[k]), NULL};
            if (columns[k].number && csv_number(cells[k].text, &value) && isfinite(value)) {
                snprintf(numbers[k], sizeof numbers[k], "%.2g", value);
                cells[k].text = numbers[k];
            }
        }
        picture_label(cells[2].text, cell_of(csv, row, "settings"), cell_of(csv, row, "precision"), label,
                      sizeof label);
        cells[2].text = label;
        page_row(page, cells);
    }
    page_table_end(page);
}

const struct report_table report_tables[REPORT_TABLES] = {
    {.file = "cheapest.csv",
     .id = "cheapest",
     .title = "Cheapest settings",
     .text =
         "For each decade of error the setting that reaches it at the least cost; for each scene by run time and by "
         "counted operations, of all algorithms, and of each family. Ties: settings that are as fast within the "
         "noise.",
     .group = "scene",
     .columns = {{"error_below", "error below", SHOW_TEXT},
                 {"cost", "cost", SHOW_TEXT},
                 {"family", "of", SHOW_TEXT},
                 {"algorithm", "algorithm", SHOW_TEXT},
                 {"options", "options", SHOW_TEXT},
                 {"precision", "precision", SHOW_TEXT},
                 {"run_s", "run time (s)", SHOW_NUMBER},
                 {"speed_up", "speed-up", SHOW_NUMBER},
                 {"flops", "FLOP", SHOW_NUMBER},
                 {"error", "error", SHOW_NUMBER},
                 {"pslr_db", "PSLR (dB)", SHOW_NUMBER},
                 {"islr_db", "ISLR (dB)", SHOW_NUMBER},
                 {"ties", "ties", SHOW_TEXT}}},
    {.file = "slopes.csv",
     .id = "slopes",
     .title = "Slopes",
     .text =
         "Straight lines through log error against log rate (beta + 1, or the setting itself), by least squares: "
         "where "
         "the error falls, the finest half of that, and the floor. The residual is the points' rms distance from the "
         "line in log10.",
     .group = "scene",
     .columns = {{"algorithm", "algorithm", SHOW_TEXT},
                 {"options", "options", SHOW_TEXT},
                 {"precision", "precision", SHOW_TEXT},
                 {"part", "part", SHOW_TEXT},
                 {"setting", "setting", SHOW_TEXT},
                 {"first", "from", SHOW_NUMBER},
                 {"last", "to", SHOW_NUMBER},
                 {"points", "points", SHOW_NUMBER},
                 {"slope", "slope", SHOW_NUMBER},
                 {"error_first", "error from", SHOW_NUMBER},
                 {"error_last", "error to", SHOW_NUMBER},
                 {"residual_log10", "residual", SHOW_NUMBER}}},
    {.file = "plans.csv",
     .id = "plans",
     .title = "Plans",
     .text = "The settings that `auto` chose, and of each other algorithm the fastest setting within the error, or the "
             "nearest to it. Times and errors are predicted; the measured ones are below.",
     .group = "scene",
     .summary = plans_summary_show,
     .columns = {{"options", "budget", SHOW_ONCE},
                 {"precision", "precision", SHOW_ONCE},
                 {"algorithm", "algorithm", SHOW_TEXT},
                 {"settings", "settings", SHOW_TEXT},
                 {"verdict", "verdict", SHOW_TEXT},
                 {"seconds", "time (s)", SHOW_NUMBER},
                 {"error", "error", SHOW_NUMBER},
                 {"text", "why, or what is left out", SHOW_TEXT}}},
    {.file = "predictions.csv",
     .id = "predictions",
     .title = "Predicted errors",
     .text = "Predicted errors over those measured after one gain, of all images of an algorithm. Below 1 the "
             "prediction is too low.",
     .columns = {{"algorithm", "algorithm", SHOW_TEXT},
                 {"images", "images", SHOW_NUMBER},
                 {"least", "least", SHOW_NUMBER},
                 {"lower_quartile", "lower quartile", SHOW_NUMBER},
                 {"median", "median", SHOW_NUMBER},
                 {"upper_quartile", "upper quartile", SHOW_NUMBER},
                 {"largest", "largest", SHOW_NUMBER}}},
    {.file = "rules.csv",
     .id = "rules",
     .title = "Upsampling rules",
     .text = "Samples for each one recorded that BP22 Eq. (20) and ZP15's lambda/8 rule require, and the constants "
             "of the error laws.",
     .columns = {{"scene", "scene", SHOW_TEXT},
                 {"fc_hz", "fc (Hz)", SHOW_NUMBER},
                 {"fs_hz", "fs (Hz)", SHOW_NUMBER},
                 {"bandwidth_hz", "B (Hz)", SHOW_NUMBER},
                 {"bp22_eq20_rate", "BP22 Eq. (20): more than", SHOW_NUMBER},
                 {"zp15_rate", "ZP15: more than", SHOW_NUMBER},
                 {"edge_phase_rad", "phase at the band's edge at rate 1 (rad)", SHOW_NUMBER},
                 {"linear_floor", "linear's floor", SHOW_NUMBER}}},
    {.file = "claims.csv",
     .id = "claims",
     .title = "Claims",
     .text = "What the papers claim, each decided from the measurements of this folder: as printed, and, where LBF21's "
             "scheme matters, with the corrected scheme (theta at F, blocks that blend).",
     .group = "paper",
     .columns = {{"id", "id", SHOW_TEXT},
                 {"section", "section", SHOW_TEXT},
                 {"claim", "claim", SHOW_TEXT},
                 {"verdict", "as printed", SHOW_VERDICT},
                 {"corrected", "corrected", SHOW_VERDICT},
                 {"evidence", "evidence", SHOW_TEXT}}},
    {.file = "reproduced.csv",
     .id = "reproduced",
     .title = "Papers' tables",
     .text =
         "The papers' numbers beside ours; difference is ours less the paper's. An assumption stands once, and holds "
         "for the rows below it.",
     .group = "table",
     .columns = {{"item", "item", SHOW_TEXT},
                 {"quantity", "quantity", SHOW_TEXT},
                 {"definition", "definition", SHOW_TEXT},
                 {"unit", "unit", SHOW_TEXT},
                 {"paper", "paper", SHOW_NUMBER},
                 {"ours", "ours", SHOW_NUMBER},
                 {"difference", "difference", SHOW_NUMBER},
                 {"assumption", "assumption", SHOW_ONCE}}},
    [REPORT_STABILITY] =
        {.file = "stability.csv",
         .id = "stability",
         .title = "Stability",
         .text = "Extreme scenes in several rounding modes. Error: relative L2 against the right image, and its bound. "
                 "Digits lost: against the method's own sum in extended precision; 2 are accepted. Spread: the largest "
                 "difference between two rounding modes.",
         .group = "scene",
         .columns = {{"algorithm", "algorithm", SHOW_TEXT},
                     {"options", "options", SHOW_TEXT},
                     {"precision", "precision", SHOW_TEXT},
                     {"engine", "engine", SHOW_TEXT},
                     {"verdict", "verdict", SHOW_TEXT},
                     {"error", "error", SHOW_NUMBER},
                     {"error_bound", "bound", SHOW_NUMBER},
                     {"digits", "digits lost", SHOW_NUMBER},
                     {"spread", "spread", SHOW_NUMBER},
                     {"same_bits", "same bits", SHOW_TEXT},
                     {"finite", "finite", SHOW_TEXT},
                     {"reason", "reason", SHOW_TEXT}}},
};

enum status report_table_read(const char *directory, const struct report_table *table, struct csv *csv)
{
    char path[4096];
    struct stat info;
    snprintf(path, sizeof path, "%s/%s", directory, table->file);
    if (stat(path, &info) != 0)
        return STATUS_OK;
    enum status status = csv_read(path, CSV_TAIL_KEEP, csv);
    if (status == STATUS_OK && table->group && csv_column(csv, table->group) < 0)
        status = status_set(STATUS_INVALID, "%s: there is no column '%s', which is needed", path, table->group);
    for (int k = 0; k < REPORT_COLUMNS && table->columns[k].title && status == STATUS_OK; k++)
        if (csv_column(csv, table->columns[k].name) < 0)
            status = status_set(STATUS_INVALID, "%s: there is no column '%s', which is needed", path,
                                table->columns[k].name);
    return status;
}

/* The style of a verdict; NULL for other texts. */
static const char *verdict_class(const char *verdict)
{
    static const char *const classes[CLAIM_VERDICTS] = {[CLAIM_HOLDS] = "good",
                                                        [CLAIM_ASSUMED] = "soft",
                                                        [CLAIM_IDENTITY] = "soft",
                                                        [CLAIM_FAILS] = "bad",
                                                        [CLAIM_UNDECIDED] = "open"};
    for (int k = 0; k < CLAIM_VERDICTS; k++)
        if (strcmp(claim_verdict_names[k], verdict) == 0)
            return classes[k];
    return NULL;
}

/* Counts of each verdict, for each column of verdicts. */
static void verdicts_count_show(struct page *page, const struct report_table *table, const struct csv *csv)
{
    for (int k = 0; k < REPORT_COLUMNS && table->columns[k].title; k++) {
        char text[256] = "";
        if (table->columns[k].show != SHOW_VERDICT)
            continue;
        for (int verdict = 0; verdict < CLAIM_VERDICTS; verdict++) {
            int count = 0, column = csv_column(csv, table->columns[k].name);
            for (int row = 0; row < csv->row_count; row++)
                count += strcmp(csv_cell(csv, row, column), claim_verdict_names[verdict]) == 0;
            text_append(text, sizeof text, "%s%s%d %s", *text ? "" : table->columns[k].title, *text ? ", " : ": ",
                        count, claim_verdict_names[verdict]);
        }
        page_paragraph(page, text);
    }
}

static void rows_show(struct page *page, const struct report_table *table, const struct csv *csv, const char *group)
{
    struct page_column columns[REPORT_COLUMNS];
    const char *above[REPORT_COLUMNS] = {NULL};
    int count = 0;
    for (; count < REPORT_COLUMNS && table->columns[count].title; count++)
        columns[count] = (struct page_column){table->columns[count].title, table->columns[count].show == SHOW_NUMBER};
    page_table_begin(page, count, columns);
    for (int row = 0; row < csv->row_count; row++) {
        struct page_cell cells[REPORT_COLUMNS];
        char numbers[REPORT_COLUMNS][32];
        if (group && strcmp(csv_cell(csv, row, csv_column(csv, table->group)), group) != 0)
            continue;
        for (int k = 0; k < count; k++) {
            const char *text = cell_of(csv, row, table->columns[k].name);
            const int show = (int)table->columns[k].show;
            double value;
            cells[k] = (struct page_cell){text, NULL};
            if (show == SHOW_VERDICT)
                cells[k].class = verdict_class(text);
            if (show == SHOW_ONCE && above[k] && strcmp(above[k], text) == 0)
                cells[k].text = "";
            if (show == SHOW_NUMBER && csv_number(text, &value)) {
                snprintf(numbers[k], sizeof numbers[k], "%.4g", value);
                cells[k].text = isnan(value) ? "" : numbers[k];
            }
            above[k] = text;
        }
        page_row(page, cells);
    }
    page_table_end(page);
}

/* The title of a group: that of the paper's table. */
static void group_title(const struct report_table *table, const char *group, char *title, size_t size)
{
    snprintf(title, size, "%s", group);
    for (int k = 0; paper_tables[k].id; k++)
        if (table->group && strcmp(table->group, "table") == 0 && strcmp(paper_tables[k].id, group) == 0)
            snprintf(title, size, "%s", paper_tables[k].title);
}

static bool group_seen(const struct csv *csv, int column, int row)
{
    for (int k = 0; k < row; k++)
        if (strcmp(csv_cell(csv, k, column), csv_cell(csv, row, column)) == 0)
            return true;
    return false;
}

void report_table_show(struct page *page, const struct report_table *table, const struct csv *csv)
{
    if (csv->row_count == 0)
        return;
    page_heading(page, 2, table->id, table->title);
    page_paragraph(page, table->text);
    verdicts_count_show(page, table, csv);
    if (table->summary) {
        page_part_begin(page, "At a glance");
        table->summary(page, csv);
        page_part_end(page);
    }
    const int column = table->group ? csv_column(csv, table->group) : -1;
    for (int row = 0; row < (column < 0 ? 1 : csv->row_count); row++) {
        char title[400];
        if (column >= 0 && group_seen(csv, column, row))
            continue;
        group_title(table, column < 0 ? table->file : csv_cell(csv, row, column), title, sizeof title);
        page_part_begin(page, title);
        rows_show(page, table, csv, column < 0 ? NULL : csv_cell(csv, row, column));
        page_part_end(page);
    }
}
