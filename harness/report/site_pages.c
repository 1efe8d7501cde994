/* The pages of a results site (site_parts.h). */
#include <stdlib.h>
#include <string.h>

#include "files/paths.h"
#include "report/page_chart.h"
#include "report/report_parts.h"
#include "report/site_parts.h"
#include "show/table.h"

/* A choice of one machine, where there are several. */
static const char machine_script[] =
    "<script>\n"
    "const sections = [...document.querySelectorAll('section')];\n"
    "if (sections.length > 1) {\n"
    "  const choice = document.createElement('select');\n"
    "  choice.setAttribute('aria-label', 'machine');\n"
    "  choice.add(new Option('all machines', ''));\n"
    "  for (const section of sections) choice.add(new Option(section.querySelector('h2').textContent));\n"
    "  choice.onchange = () => sections.forEach((section, k) => {\n"
    "    section.hidden = choice.selectedIndex > 0 && choice.selectedIndex - 1 !== k;\n"
    "  });\n"
    "  document.querySelector('nav').append(choice);\n"
    "}\n"
    "</script>\n";

static void section_begin(struct page *page, const struct kind *kind)
{
    fputs("<section>\n", page->stream);
    page_heading(page, 2, NULL, kind->name);
}

static void end(struct page *page)
{
    fputs(machine_script, page->stream);
    page_end(page);
}

/* ---- The index ---- */

static void folders_show(struct page *page, const struct site *site)
{
    static const struct page_column columns[] = {
        {"folder", false}, {"machine", false}, {"date", false}, {"commit", false}, {"rows", true}};
    page_heading(page, 2, NULL, "Results");
    page_table_begin(page, 5, columns);
    for (int k = 0; k < site->submission_count; k++) {
        const struct submission *s = &site->submissions[k];
        char rows[16];
        snprintf(rows, sizeof rows, "%d", s->results.csv.row_count);
        page_row(page, (struct page_cell[]){{s->directory, NULL},
                                            {site->kinds[s->kind].name, NULL},
                                            {s->date, NULL},
                                            {s->commit, NULL},
                                            {rows, NULL}});
    }
    page_table_end(page);
}

static void scenes_link(struct page *page, const struct site *site)
{
    fputs("<nav>\n", page->stream);
    for (int s = 0; s < site->scene_count; s++) {
        char name[32];
        snprintf(name, sizeof name, "scene-%d.html", s + 1);
        page_file(page, name, site->scenes[s]);
        fputc('\n', page->stream);
    }
    fputs("</nav>\n", page->stream);
}

/* The fastest of each scene, on one kind of machine. */
static enum status ranking_show(struct page *page, const struct kind *kind)
{
    const char **scenes = NULL;
    int count = 0;
    enum status status = scenes_find(&kind->newest, &scenes, &count);
    struct points *points = status == STATUS_OK ? calloc((size_t)count + 1, sizeof *points) : NULL;
    if (status == STATUS_OK && !points)
        status = status_set(STATUS_FAILED, "no memory for %d scenes", count);
    for (int s = 0; s < count && status == STATUS_OK; s++)
        status = points_find(&kind->newest, scenes[s], &points[s]);
    if (status == STATUS_OK)
        report_cheapest_show(page, NULL, &kind->newest, points, count);
    for (int s = 0; s < count && points; s++)
        points_free(&points[s]);
    free(points);
    free(scenes);
    return status;
}

enum status site_index_show(struct page *page, const struct site *site)
{
    enum status status = STATUS_OK;
    page_begin(page, SITE_TITLE);
    page_paragraph(page,
                   "The fastest setting on each scene, for each power of ten of relative error. Times are compared on "
                   "one kind of machine alone. A scene's page has its fronts, the commands that measure them again, "
                   "and all rows.");
    scenes_link(page, site);
    folders_show(page, site);
    for (int k = 0; k < site->kind_count && status == STATUS_OK; k++) {
        section_begin(page, &site->kinds[k]);
        status = ranking_show(page, &site->kinds[k]);
        fputs("</section>\n", page->stream);
    }
    end(page);
    return status;
}

/* ---- A scene ---- */

static void fields_write(struct page *page, const char *const *cells, int count)
{
    for (int k = 0; k < count; k++) {
        char *text = NULL;
        size_t size;
        FILE *stream = open_memstream(&text, &size);
        if (!stream)
            return;
        csv_write_text(stream, cells[k]);
        fclose(stream);
        page_text(page, text);
        fputc(k + 1 < count ? ',' : '\n', page->stream);
        free(text);
    }
}

/* As they stand in their files. */
static void rows_show(struct page *page, const struct kind *kind, const char *scene)
{
    const struct submission *last = NULL;
    page_part_begin(page, "All rows");
    fputs("<pre>", page->stream);
    for (int k = 0; k < kind->newest.csv.row_count; k++) {
        const struct origin *from = &kind->from[k];
        const struct csv *csv = &from->submission->results.csv;
        if (strcmp(kind->newest.measurements[k].scene, scene) != 0)
            continue;
        if (from->submission != last) {
            page_text(page, csv->path);
            fputs(":\n", page->stream);
            fields_write(page, (const char *const *)csv->columns, csv->column_count);
        }
        last = from->submission;
        fields_write(page, (const char *const *)csv->cells + (size_t)from->row * (size_t)csv->column_count,
                     csv->column_count);
    }
    fputs("</pre>\n", page->stream);
    page_part_end(page);
}

/* The cell's row in a folder; NULL without one that was measured. */
static const struct measurement *row_of(const struct submission *submission, const struct measurement *cell)
{
    for (int k = 0; k < submission->results.csv.row_count; k++) {
        const struct measurement *row = &submission->results.measurements[k];
        if (site_is_cell(row, cell) && strcmp(row->status, "ok") == 0)
            return row;
    }
    return NULL;
}

/* A cell that several folders of a kind have, the newest first; the setting stands in the first row. */
static void cell_history(struct page *page, const struct site *site, int kind, const struct measurement *cell)
{
    char spec[512];
    measurement_spec(cell, spec, sizeof spec);
    for (int k = 0; k < site->submission_count; k++) {
        const struct submission *s = &site->submissions[k];
        const struct measurement *row = s->kind == kind ? row_of(s, cell) : NULL;
        if (!row)
            continue;
        char error[32];
        const struct cell time = cell_run_time(row);
        snprintf(error, sizeof error, "%.1e", row->error);
        page_row(page, (struct page_cell[]){
                           {spec, NULL}, {s->date, NULL}, {s->commit, NULL}, {time.text, NULL}, {error, NULL}});
        *spec = '\0';
    }
}

static void history_show(struct page *page, const struct site *site, int kind, const char *scene)
{
    static const struct page_column columns[] = {
        {"setting", false}, {"date", false}, {"commit", false}, {"run time", true}, {"error", true}};
    const struct results *newest = &site->kinds[kind].newest;
    bool begun = false;
    for (int k = 0; k < newest->csv.row_count; k++) {
        const struct measurement *cell = &newest->measurements[k];
        int moments = 0;
        for (int n = 0; n < site->submission_count && strcmp(cell->scene, scene) == 0; n++)
            moments += site->submissions[n].kind == kind && row_of(&site->submissions[n], cell);
        if (moments < 2)
            continue;
        if (!begun) {
            page_heading(page, 3, NULL, "Over commits");
            page_table_begin(page, 5, columns);
        }
        begun = true;
        cell_history(page, site, kind, cell);
    }
    if (begun)
        page_table_end(page);
}

static bool kind_has(const struct kind *kind, const char *scene)
{
    for (int k = 0; k < kind->newest.csv.row_count; k++)
        if (strcmp(kind->newest.measurements[k].scene, scene) == 0)
            return true;
    return false;
}

enum status site_scene_show(struct page *page, const struct site *site, const char *scene)
{
    struct families families;
    enum status status = STATUS_OK;
    families_read(data_path(DATA_PLOTS), &families);
    page_begin(page, scene);
    fputs("<nav>", page->stream);
    page_file(page, "index.html", "All scenes");
    fputs("</nav>\n", page->stream);
    for (int k = 0; k < site->kind_count && status == STATUS_OK; k++) {
        const struct kind *kind = &site->kinds[k];
        struct points points = {.scene = NULL};
        if (!kind_has(kind, scene))
            continue;
        section_begin(page, kind);
        status = points_find(&kind->newest, scene, &points);
        if (status == STATUS_OK && points.count > 0)
            status = report_front_show(page, &families, &points);
        else if (status == STATUS_OK)
            page_paragraph(page, "No image was measured: the rows say why.");
        history_show(page, site, k, scene);
        rows_show(page, kind, scene);
        fputs("</section>\n", page->stream);
        points_free(&points);
    }
    end(page);
    return status;
}
