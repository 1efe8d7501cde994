/* The summary of a report (report_summary.h). */
#include "report/report_summary.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "text/text_append.h"
#include "show/table.h"

enum { ALGORITHMS_MOST = 64, COLUMNS_MOST = 8 };
static const double error_usable = 0.1; /* of the fastest: what range migration refuses beyond */

/* The algorithms in the order of their first rows, `reference` left out: it is what errors are measured against. */
static int algorithms_find(const struct results *results, const char *names[ALGORITHMS_MOST])
{
    int count = 0;
    for (int row = 0; row < results->csv.row_count && count < ALGORITHMS_MOST; row++) {
        const char *name = results->measurements[row].algorithm;
        bool known = strcmp(name, "reference") == 0;
        for (int k = 0; k < count; k++)
            known |= strcmp(names[k], name) == 0;
        if (!known)
            names[count++] = name;
    }
    return count;
}

/* The algorithm's fastest row with a usable error, else the one of least error; NULL where it has no image. */
static const struct measurement *best_find(const struct results *results, const char *scene, const char *algorithm,
                                           bool *tried)
{
    const struct measurement *fastest = NULL, *best = NULL;
    *tried = false;
    for (int k = 0; k < results->csv.row_count; k++) {
        const struct measurement *row = &results->measurements[k];
        if (strcmp(row->scene, scene) != 0 || strcmp(row->algorithm, algorithm) != 0)
            continue;
        *tried = true;
        if (measurement_is_cheaper(row, fastest, offsetof(struct measurement, run_s), error_usable))
            fastest = row;
        if (strcmp(row->status, "ok") == 0 && isfinite(row->error) && (!best || row->error < best->error))
            best = row;
    }
    return fastest ? fastest : best;
}

/* A row of some of the algorithms; `fastest`: of all of them. */
static void scene_show(struct page *page, const struct results *results, const char *scene, int count,
                       const char *const *names, const struct measurement *fastest)
{
    char texts[COLUMNS_MOST][64];
    struct page_cell cells[COLUMNS_MOST + 1] = {{scene, NULL}};
    for (int k = 0; k < count; k++) {
        bool tried;
        const struct measurement *best = best_find(results, scene, names[k], &tried);
        snprintf(texts[k], sizeof texts[k], "%s", tried ? "no image" : "");
        if (best && best->control_s > 0 && best->run_s > 0)
            snprintf(texts[k], sizeof texts[k], "%.1e, %s%s", best->error,
                     cell_significant(best->control_s / best->run_s, "x").text, is_noisy(best) ? "~" : "");
        else if (best)
            snprintf(texts[k], sizeof texts[k], "%.1e", best->error);
        if (best && best == fastest && page->format == PAGE_MARKDOWN)
            text_append(texts[k], sizeof texts[k], ", fastest");
        cells[k + 1] = (struct page_cell){texts[k], best && best == fastest ? "good" : NULL};
    }
    page_row(page, cells);
}

static const struct measurement *fastest_find(const struct results *results, const char *scene, int count,
                                              const char *const *names)
{
    const struct measurement *fastest = NULL;
    for (int k = 0; k < count; k++) {
        bool tried;
        const struct measurement *best = best_find(results, scene, names[k], &tried);
        if (best && measurement_is_cheaper(best, fastest, offsetof(struct measurement, run_s), error_usable))
            fastest = best;
    }
    return fastest;
}

bool summary_applies(const struct results *results)
{
    for (int k = 0; k < results->csv.row_count; k++)
        if (strcmp(results->measurements[k].status, "ok") == 0 && isfinite(results->measurements[k].error)
            && strcmp(results->measurements[k].algorithm, "reference") != 0)
            return true;
    return false;
}

void summary_show(struct page *page, const struct results *results, int scene_count, const char *const *scenes)
{
    const char *names[ALGORITHMS_MOST];
    const int count = algorithms_find(results, names);
    if (!summary_applies(results))
        return;
    page_heading(page, 2, "summary", "Summary");
    page_paragraph(
        page, "Error against the exact image and speed-up against the scalar reference loop (~: the time is noisy), of "
              "each algorithm's fastest setting with an error up to 0.1, or of its most exact one where none has; "
              "marked: the fastest of all with an error up to 0.1.");
    /* No wider than a page: so many columns that all tables have about as many. */
    const int tables = (count + COLUMNS_MOST - 1) / COLUMNS_MOST, width = (count + tables - 1) / tables;
    for (int first = 0; first < count; first += width) {
        struct page_column columns[COLUMNS_MOST + 1] = {{"scene", false}};
        const int shown = count - first < width ? count - first : width;
        for (int k = 0; k < shown; k++)
            columns[k + 1] = (struct page_column){names[first + k], true};
        page_table_begin(page, shown + 1, columns, false);
        for (int s = 0; s < scene_count; s++)
            scene_show(page, results, scenes[s], shown, names + first, fastest_find(results, scenes[s], count, names));
        page_table_end(page);
    }
}
