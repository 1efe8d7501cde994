/* The summary of a report (report_summary.h). */
#include "show/report_summary.h"
#include "data/text_append.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ALGORITHMS_MOST = 24 };
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

/* The row of least error; NULL where the algorithm has no image of the scene. */
static const struct measurement *best_find(const struct results *results, const char *scene, const char *algorithm,
                                           bool *tried)
{
    const struct measurement *best = NULL;
    *tried = false;
    for (int k = 0; k < results->csv.row_count; k++) {
        const struct measurement *row = &results->measurements[k];
        if (strcmp(row->scene, scene) != 0 || strcmp(row->algorithm, algorithm) != 0)
            continue;
        *tried = true;
        if (strcmp(row->status, "ok") == 0 && isfinite(row->error) && (!best || row->error < best->error))
            best = row;
    }
    return best;
}

static void scene_show(struct page *page, const struct results *results, const char *scene, int count,
                       const char *const *names)
{
    const struct measurement *best[ALGORITHMS_MOST];
    char texts[ALGORITHMS_MOST][48];
    struct page_cell cells[ALGORITHMS_MOST + 1] = {{scene, NULL}};
    int fastest = -1;
    for (int k = 0; k < count; k++) {
        bool tried;
        best[k] = best_find(results, scene, names[k], &tried);
        snprintf(texts[k], sizeof texts[k], "%s", tried ? "no image" : "");
        if (best[k] && best[k]->control_s > 0 && best[k]->run_s > 0)
            snprintf(texts[k], sizeof texts[k], "%.1e, %.3gx", best[k]->error, best[k]->control_s / best[k]->run_s);
        else if (best[k])
            snprintf(texts[k], sizeof texts[k], "%.1e", best[k]->error);
        if (best[k] && best[k]->error <= error_usable && best[k]->run_s > 0
            && (fastest < 0 || best[k]->run_s < best[fastest]->run_s))
            fastest = k;
    }
    for (int k = 0; k < count; k++)
        cells[k + 1] = (struct page_cell){texts[k], k == fastest ? "good" : NULL};
    if (fastest >= 0 && page->format == PAGE_MARKDOWN)
        text_append(texts[fastest], sizeof texts[fastest], ", fastest");
    page_row(page, cells);
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
    struct page_column columns[ALGORITHMS_MOST + 1] = {{"scene", false}};
    const int count = algorithms_find(results, names);
    if (!summary_applies(results))
        return;
    for (int k = 0; k < count; k++)
        columns[k + 1] = (struct page_column){names[k], true};
    page_heading(page, 2, "summary", "Summary");
    page_paragraph(
        page, "Error against the exact image and speed-up against the scalar reference loop, of each algorithm's most "
              "exact setting; marked: the fastest of those with an error up to 0.1.");
    page_table_begin(page, count + 1, columns, false);
    for (int s = 0; s < scene_count; s++)
        scene_show(page, results, scenes[s], count, names);
    page_table_end(page);
}
