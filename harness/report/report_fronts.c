/* The beginning of a report (report_parts.h). */
#include "report/report_parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "files/paths.h"
#include "text/text_append.h"
#include "report/page_chart.h"
#include "show/table.h"

/* --- Three sentences -------------------------------------------------------------------------------------------- */

static bool algorithm_seen(const struct results *results, int row)
{
    for (int k = 0; k < row; k++)
        if (strcmp(results->measurements[k].algorithm, results->measurements[row].algorithm) == 0)
            return true;
    return false;
}

static const char *plural(int count, const char *one, const char *more)
{
    return count == 1 ? one : more;
}

/* "Within an error of 1e-3 the fastest is rma_delay on 9 scenes, bp_farrow on 7; none comes so far on 2." */
static void fastest_tell(int scene_count, const char *const *scenes, const struct results *results, char *text,
                         size_t size)
{
    enum { NAMES_MOST = 40 };
    struct {
        const char *name;
        int scenes;
    } names[NAMES_MOST] = {{NULL, 0}};
    int count = 0, none = 0;
    for (int s = 0; s < scene_count; s++) {
        const struct measurement *row = scene_fastest(results, scenes[s], 1e-3);
        int k = 0;
        while (row && k < count && strcmp(names[k].name, row->algorithm) != 0)
            k++;
        none += !row;
        if (!row || k == NAMES_MOST)
            continue;
        names[k].name = row->algorithm;
        names[k].scenes++;
        count += k == count;
    }
    snprintf(text, size, "Within a relative error of 1e-3 the fastest is ");
    for (int shown = 0; shown < count; shown++) {
        int most = 0;
        for (int k = 1; k < count; k++)
            most = names[k].scenes > names[most].scenes ? k : most;
        text_append(text, size, "%s%.60s on %d", shown ? ", " : "", names[most].name, names[most].scenes);
        if (shown == 0)
            text_append(text, size, " %s", plural(names[most].scenes, "scene", "scenes"));
        names[most].scenes = 0;
    }
    if (count == 0)
        snprintf(text, size, "Nothing measured comes within a relative error of 1e-3");
    else if (none)
        text_append(text, size, "; on %d no algorithm comes within it", none);
    text_append(text, size, ".");
}

void report_sentences_show(struct page *page, const struct results *results, int scene_count, const char *const *scenes)
{
    int images = 0, algorithm_count = 0, refused = 0, failed = 0, noisy = 0, warned = 0;
    char text[1600];
    for (int k = 0; k < results->csv.row_count; k++) {
        const struct measurement *row = &results->measurements[k];
        const char *at = row->reason;
        images += strcmp(row->status, "ok") == 0;
        refused += strcmp(row->status, "unsupported") == 0;
        failed += strcmp(row->status, "failed") == 0;
        algorithm_count += !algorithm_seen(results, k);
        noisy += is_noisy(row);
        warned += strcmp(row->status, "ok") == 0 && warning_next(&at, text, sizeof text);
    }
    const char *machine = csv_comment(&results->csv, "machine"), *threads = csv_comment(&results->csv, "threads");
    snprintf(text, sizeof text, "%d %s by %d %s on %d %s, with %.20s %s on %.200s.", images,
             plural(images, "image", "images"), algorithm_count, plural(algorithm_count, "algorithm", "algorithms"),
             scene_count, plural(scene_count, "scene", "scenes"), threads ? threads : "an unknown number of",
             threads && strcmp(threads, "1") == 0 ? "thread" : "threads", machine ? machine : "an unknown machine");
    page_paragraph(page, text);
    fastest_tell(scene_count, scenes, results, text, sizeof text);
    page_paragraph(page, text);
    snprintf(text, sizeof text,
             "%d %s refused, %d failed; %d of the images have a warning, and the times of %d are noisy (~).", refused,
             plural(refused, "image was", "images were"), failed, warned, noisy);
    page_paragraph(page, text);
}

/* --- Pictures --------------------------------------------------------------------------------------------------- */

void report_overview_show(struct page *page, const struct points *points, int scene_count)
{
    struct families families;
    families_read(data_path(DATA_PLOTS), &families);
    page_heading(page, 2, "overview", "All scenes");
    page_paragraph(page,
                   "Error against speed-up over the scalar reference loop, the same axes everywhere: faster is to "
                   "the left, more exact below; grey: the Pareto front, what no other setting beats in both.");
    page_overview(page, &families, points, scene_count);
}

/* The front, the fastest first. */
static void front_table(struct page *page, const struct points *points)
{
    static const struct page_column columns[] = {
        {"setting", false}, {"error", true}, {"run time", true}, {"speed-up", true}};
    page_table_begin(page, 4, columns);
    for (int k = 0; k < points->front_count; k++) {
        const struct measurement *row = points->list[points->front[k]].row;
        char spec[512], error[32];
        const struct cell time = cell_run_time(row), speed_up = cell_significant(row->control_s / row->run_s, "x");
        measurement_spec(row, spec, sizeof spec);
        snprintf(error, sizeof error, "%.1e", row->error);
        page_row(page, (struct page_cell[]){{spec, NULL}, {error, NULL}, {time.text, NULL}, {speed_up.text, NULL}});
    }
    page_table_end(page);
}

static void commands_show(struct page *page, const struct points *points)
{
    page_part_begin(page, "Measure these again");
    fputs("<pre>", page->stream);
    for (int k = 0; k < points->front_count; k++) {
        char command[1500];
        measured_again(points->list[points->front[k]].row, command, sizeof command);
        page_text(page, command);
        fputc('\n', page->stream);
    }
    fputs("</pre>\n", page->stream);
    page_part_end(page);
}

enum status report_front_show(struct page *page, const struct families *families, const struct points *points)
{
    fputs("<div class=\"pair\"><div>\n", page->stream);
    const enum status status = page_chart(page, families, points);
    fputs("</div><div>\n", page->stream);
    front_table(page, points);
    commands_show(page, points);
    fputs("</div></div>\n", page->stream);
    return status;
}

enum status report_fronts_show(struct page *page, const struct points *points, int scene_count)
{
    struct families families;
    enum status status = STATUS_OK;
    families_read(data_path(DATA_PLOTS), &families);
    page_heading(page, 2, "fronts", "Pareto fronts");
    for (int s = 0; s < scene_count && status == STATUS_OK; s++) {
        char id[32];
        if (points[s].count == 0)
            continue;
        snprintf(id, sizeof id, "scene-%d", s + 1);
        page_heading(page, 3, id, points[s].scene);
        status = report_front_show(page, &families, &points[s]);
    }
    return status;
}

/* --- The fastest for each power of ten -------------------------------------------------------------------------- */

/* The setting, if the algorithm has several; time and speed-up. */
static void fastest_text(const struct points *points, const struct measurement *row, char *text, size_t size)
{
    int k = 0;
    while (k < points->count && points->list[k].row != row)
        k++;
    if (k < points->count && points->series[points->list[k].series].alone)
        snprintf(text, size, "%s", row->algorithm);
    else
        measurement_spec(row, text, size);
    text_append(text, size, ", %s", cell_run_time(row).text);
    if (row->control_s > 0)
        text_append(text, size, ", %s", cell_significant(row->control_s / row->run_s, "x").text);
}

void report_cheapest_show(struct page *page, const char *id, const struct results *results, const struct points *points,
                          int scene_count)
{
    enum { DECADES_MOST = 7 };
    char titles[DECADES_MOST][16];
    struct page_column columns[DECADES_MOST + 1] = {{"error up to", false}};
    int count = 0;
    for (bool reached = true; reached && count < DECADES_MOST;) {
        reached = false;
        for (int s = 0; s < scene_count; s++)
            reached |= scene_fastest(results, points[s].scene, pow(10, -count - 1)) != NULL;
        if (reached) {
            snprintf(titles[count], sizeof titles[count], "1e-%d", count + 1);
            columns[count + 1] = (struct page_column){titles[count], false};
            count++;
        }
    }
    if (count == 0)
        return;
    if (id)
        page_heading(page, 2, id, "The fastest for each power of ten of error");
    page_table_begin(page, count + 1, columns);
    for (int s = 0; s < scene_count; s++) {
        char texts[DECADES_MOST][700];
        struct page_cell cells[DECADES_MOST + 1] = {{points[s].scene, NULL}};
        for (int k = 0; k < count; k++) {
            const struct measurement *row = scene_fastest(results, points[s].scene, pow(10, -k - 1));
            if (row)
                fastest_text(&points[s], row, texts[k], sizeof texts[k]);
            cells[k + 1] = (struct page_cell){row ? texts[k] : "none", NULL};
        }
        page_row(page, cells);
    }
    page_table_end(page);
}
