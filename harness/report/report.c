/* The command `report`: a results folder as one HTML page, and as Markdown (report.h). */
#include "report/report.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "show/plot.h"
#include "show/plot_points.h"
#include "results/results.h"
#include "report/report_measurements.h"
#include "report/report_pictures.h"
#include "report/report_summary.h"
#include "report/report_tables.h"
#include "files/paths.h"
#include "files/text_file.h"

/* --- The folder ------------------------------------------------------------------------------------------------ */

struct drawing {
    const char *scene; /* borrowed from the results */
    char title[300];   /* "sweep/point: error_time" */
    char path[4096];   /* empty: the scene has nothing to show there */
    char fault[400];   /* why it could not be drawn; empty: drawn */
};

struct folder {
    const char *directory;
    struct results results;
    const char **scenes; /* [scene_count] borrowed, in the order of their first rows */
    int scene_count;
    struct csv csvs[REPORT_TABLES]; /* column_count 0: not there */
    struct drawing *drawings;       /* [drawing_count] */
    int drawing_count;
    struct dirent **files; /* [file_count] PNG files of `phase`, `reproduce`, `sweep` and `stability`, by name */
    int file_count;
};

/* Has the folder measurements, or only what `stability` wrote? */
static bool is_measured(const struct folder *folder)
{
    return folder->results.csv.column_count > 0;
}

static void folder_free(struct folder *folder)
{
    results_free(&folder->results);
    for (int k = 0; k < REPORT_TABLES; k++)
        csv_free(&folder->csvs[k]);
    for (int k = 0; k < folder->file_count; k++)
        free(folder->files[k]);
    free(folder->files);
    free(folder->scenes);
    free(folder->drawings);
}

static int is_figure(const struct dirent *entry)
{
    size_t length = strlen(entry->d_name);
    return strcmp(entry->d_name, "stability.png") == 0 || strcmp(entry->d_name, "predicted.png") == 0
           || ((strncmp(entry->d_name, "phase-", 6) == 0 || strncmp(entry->d_name, "figure-", 7) == 0) && length > 4
               && strcmp(entry->d_name + length - 4, ".png") == 0);
}

static void drawings_make(struct folder *folder)
{
    for (int s = 0; s < folder->scene_count; s++)
        for (int k = 0; folder_plots[k]; k++) {
            struct drawing *drawing = &folder->drawings[folder->drawing_count++];
            char name[64];
            bool drawn;
            *drawing = (struct drawing){.scene = folder->scenes[s]};
            snprintf(drawing->title, sizeof drawing->title, "%.200s: %s", drawing->scene, folder_plots[k]);
            snprintf(name, sizeof name, "%s.svg", folder_plots[k]);
            picture_path(folder->directory, drawing->scene, name, drawing->path, sizeof drawing->path);
            if (plot_folder(drawing->path, PLOT_DIRECTORY, folder_plots[k], folder->directory, drawing->scene, &drawn)
                != STATUS_OK)
                snprintf(drawing->fault, sizeof drawing->fault, "%s could not be drawn: %s", folder_plots[k],
                         status_message());
            else if (!drawn)
                *drawing->path = '\0';
        }
}

/* What the page tells of drawings that are not there, for who does not read it. */
static enum status drawings_check(const struct folder *folder)
{
    const char *fault = NULL;
    int undrawn = 0;
    for (int k = 0; k < folder->drawing_count; k++)
        if (*folder->drawings[k].fault) {
            fault = fault ? fault : folder->drawings[k].fault;
            undrawn++;
        }
    return undrawn == 0 ? STATUS_OK
                        : status_set(STATUS_FAILED, "%s: %d of %d drawings could not be drawn; the first: %s",
                                     folder->directory, undrawn, folder->drawing_count, fault);
}

static enum status folder_read(const char *directory, struct folder *folder)
{
    char path[4096];
    int plots = 0;
    *folder = (struct folder){.directory = directory};
    snprintf(path, sizeof path, "%s/measurements.csv", directory);
    /* What `stability` wrote stands alone. */
    const bool there = access(path, F_OK) == 0;
    enum status status = STATUS_OK;
    if (!there)
        status = report_table_read(directory, &report_tables[REPORT_STABILITY], &folder->csvs[REPORT_STABILITY]);
    if (status == STATUS_OK && (there || folder->csvs[REPORT_STABILITY].column_count == 0))
        status = results_read(path, &folder->results);
    for (int k = 0; k < REPORT_TABLES && status == STATUS_OK; k++)
        if (folder->csvs[k].column_count == 0)
            status = report_table_read(directory, &report_tables[k], &folder->csvs[k]);
    if (status != STATUS_OK)
        return status;
    while (folder_plots[plots])
        plots++;
    size_t rows = (size_t)folder->results.csv.row_count;
    folder->scenes = calloc(rows + 1, sizeof *folder->scenes);
    for (size_t row = 0; row < rows && folder->scenes; row++) {
        bool known = false;
        for (int k = 0; k < folder->scene_count; k++)
            known |= strcmp(folder->scenes[k], folder->results.measurements[row].scene) == 0;
        if (!known)
            folder->scenes[folder->scene_count++] = folder->results.measurements[row].scene;
    }
    folder->drawings = calloc((size_t)(folder->scene_count * plots) + 1, sizeof *folder->drawings);
    if (!folder->scenes || !folder->drawings)
        return status_set(STATUS_FAILED, "%s: no memory for %zu rows", directory, rows);
    if (is_measured(folder))
        status = plot_points_write(directory);
    if (status != STATUS_OK)
        return status;
    drawings_make(folder);
    int count = scandir(directory, &folder->files, is_figure, alphasort);
    folder->file_count = count > 0 ? count : 0;
    return STATUS_OK;
}

/* --- Sections -------------------------------------------------------------------------------------------------- */

static void machine_show(struct page *page, const struct folder *folder)
{
    static const char *const keys[] = {"machine",   "isa",    "threads", "compiler", "flags",
                                       "libraries", "commit", "program", "date"};
    static const struct page_column columns[] = {{"of the measurements", false}, {"", false}};
    page_heading(page, 2, "machine", "Machine and program");
    page_table_begin(page, 2, columns, false);
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        const char *value =
            csv_comment(is_measured(folder) ? &folder->results.csv : &folder->csvs[REPORT_STABILITY], keys[k]);
        page_row(page, (struct page_cell[]){{keys[k], NULL}, {value ? value : "unknown", NULL}});
    }
    page_table_end(page);
}

static enum status plots_show(struct page *page, const struct folder *folder)
{
    enum status status = STATUS_OK;
    const char *shown = NULL;
    struct pictures_count count = {0};
    page_heading(page, 2, "plots", "Plots");
    for (int k = 0; k < folder->drawing_count && status == STATUS_OK; k++) {
        const struct drawing *drawing = &folder->drawings[k];
        if (!*drawing->path)
            continue;
        if (shown != drawing->scene)
            page_heading(page, 3, NULL, shown = drawing->scene);
        if (*drawing->fault)
            page_paragraph(page, drawing->fault);
        else if (report_room(page, drawing->path, 1, &count))
            status = page_drawing(page, drawing->path, drawing->title);
    }
    if (!shown)
        page_paragraph(page, "No scene here has an algorithm in three settings with both a time and an error.");
    report_left_out_show(page, &count);
    return status;
}

/* What `phase` and `reproduce` drew as the papers do, and what `stability` and `sweep` drew of the whole: as SVG where
   that is there. */
static enum status figures_show(struct page *page, const struct folder *folder)
{
    enum status status = STATUS_OK;
    char path[4096];
    struct pictures_count count = {0};
    if (folder->file_count == 0)
        return STATUS_OK;
    page_heading(page, 2, "figures", "Figures");
    for (int k = 0; k < folder->file_count && status == STATUS_OK; k++) {
        const char *name = folder->files[k]->d_name;
        char beside[4096];
        snprintf(path, sizeof path, "%s/%s", folder->directory, name);
        snprintf(beside, sizeof beside, "%s", path);
        plot_path_svg(beside);
        if (report_room(page, beside, 1, &(struct pictures_count){0}))
            status = page_drawing(page, beside, name);
        else
            status = report_picture_show(page, path, NULL, name, &count);
    }
    report_left_out_show(page, &count);
    return status;
}

static void tables_show(struct page *page, const struct folder *folder, bool first)
{
    for (int k = 0; k < REPORT_TABLES; k++)
        if (report_tables[k].first == first)
            report_table_show(page, &report_tables[k], &folder->csvs[k]);
}

/* Links to the sections, in their order. */
static void contents_show(struct page *page, const struct folder *folder)
{
    const char *ids[REPORT_TABLES + 6] = {"summary"}, *titles[REPORT_TABLES + 6] = {"Summary"};
    int count = is_measured(folder) && summary_applies(&folder->results);
    for (int first = 1; first >= 0; first--) {
        for (int k = 0; k < REPORT_TABLES; k++)
            if (folder->csvs[k].row_count > 0 && report_tables[k].first == (first == 1)) {
                ids[count] = report_tables[k].id;
                titles[count++] = report_tables[k].title;
            }
        if (first && folder->file_count) {
            ids[count] = "figures";
            titles[count++] = "Figures";
        }
        for (int k = 0; first && k < (is_measured(folder) ? 2 : 1); k++) {
            ids[count] = k ? "plots" : "machine";
            titles[count++] = k ? "Plots" : "Machine";
        }
    }
    if (is_measured(folder)) {
        ids[count] = "measurements";
        titles[count++] = "Measurements";
    }
    ids[count] = "images";
    titles[count++] = "Slices and images";
    page_contents(page, count, ids, titles);
}

enum { MARKDOWN_ROWS = 20 }; /* more measurements are not for a comment */

static enum status folder_show(struct page *page, const struct folder *folder)
{
    const bool html = page->format == PAGE_HTML;
    char title[4200];
    snprintf(title, sizeof title, "sasbench: %s", folder->directory);
    page_begin(page, title);
    contents_show(page, folder);
    if (is_measured(folder))
        summary_show(page, &folder->results, folder->scene_count, folder->scenes);
    tables_show(page, folder, true);
    enum status status = html ? figures_show(page, folder) : STATUS_OK;
    machine_show(page, folder);
    if (status == STATUS_OK && html && is_measured(folder))
        status = plots_show(page, folder);
    tables_show(page, folder, false);
    if (is_measured(folder) && (html || folder->results.csv.row_count <= MARKDOWN_ROWS))
        report_measurements_show(page, &folder->results, folder->scene_count, folder->scenes);
    else if (is_measured(folder))
        page_paragraph(page, "All measurements are in measurements.csv and report.html.");
    if (status == STATUS_OK && html)
        status = report_pictures_show(page, folder->directory, &folder->results, folder->scene_count, folder->scenes);
    page_end(page);
    return status;
}

enum status report_write(const char *directory)
{
    static const struct {
        const char *file;
        enum page_format format;
        long bytes;
    } pages[] = {{"report.html", PAGE_HTML, 0}, {"report.md", PAGE_MARKDOWN, REPORT_MARKDOWN_BYTES}};
    struct folder folder = {0};
    enum status status = folder_read(directory, &folder);
    for (size_t k = 0; k < sizeof pages / sizeof *pages && status == STATUS_OK; k++) {
        char path[4096];
        struct text_file file;
        snprintf(path, sizeof path, "%s/%s", directory, pages[k].file);
        status = text_file_open(path, &file);
        if (status == STATUS_OK) {
            struct page page = {.stream = file.stream, .format = pages[k].format, .bytes_most = pages[k].bytes};
            status = text_file_close(&file, folder_show(&page, &folder));
        }
    }
    if (status == STATUS_OK)
        status = drawings_check(&folder);
    folder_free(&folder);
    return status;
}
