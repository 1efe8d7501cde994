/* The command `report`: a results folder as one HTML page (report.h). */
#include "report/report.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "show/plot.h"
#include "show/plot_points.h"
#include "results/results.h"
#include "report/report_parts.h"
#include "files/paths.h"
#include "files/text_file.h"

/* --- The folder ------------------------------------------------------------------------------------------------ */

struct folder {
    const char *directory;
    struct results results;
    const char **scenes;   /* [scene_count] borrowed, in the order of their first rows */
    struct points *points; /* [scene_count] */
    int scene_count;
    struct csv csvs[REPORT_TABLES]; /* column_count 0: not there */
    struct dirent **files;          /* [file_count] PNG files that belong to no single scene, by name */
    int file_count;
};

/* Has the folder measurements, or only the files of `stability`? */
static bool is_measured(const struct folder *folder)
{
    return folder->results.csv.column_count > 0;
}

static void folder_free(struct folder *folder)
{
    for (int k = 0; k < folder->scene_count && folder->points; k++)
        points_free(&folder->points[k]);
    results_free(&folder->results);
    for (int k = 0; k < REPORT_TABLES; k++)
        csv_free(&folder->csvs[k]);
    for (int k = 0; k < folder->file_count; k++)
        free(folder->files[k]);
    free(folder->files);
    free(folder->points);
    free(folder->scenes);
}

static bool ends_with(const char *name, const char *end)
{
    const size_t length = strlen(name), size = strlen(end);
    return length > size && strcmp(name + length - size, end) == 0;
}

static int is_figure(const struct dirent *entry)
{
    const char *name = entry->d_name;
    return strcmp(name, "stability.png") == 0 || strcmp(name, "predicted.png") == 0
           || ends_with(name, "-upsampling.png")
           || ((strncmp(name, "phase-", 6) == 0 || strncmp(name, "figure-", 7) == 0) && ends_with(name, ".png"));
}

static enum status folder_read(const char *directory, struct folder *folder)
{
    char path[4096];
    *folder = (struct folder){.directory = directory};
    snprintf(path, sizeof path, "%s/measurements.csv", directory);
    /* The files of `stability` suffice. */
    const bool there = access(path, F_OK) == 0;
    enum status status = STATUS_OK;
    if (!there)
        status = report_table_read(directory, &report_tables[REPORT_STABILITY], &folder->csvs[REPORT_STABILITY]);
    if (status == STATUS_OK && (there || folder->csvs[REPORT_STABILITY].column_count == 0))
        status = results_read(path, &folder->results);
    for (int k = 0; k < REPORT_TABLES && status == STATUS_OK; k++)
        if (folder->csvs[k].column_count == 0)
            status = report_table_read(directory, &report_tables[k], &folder->csvs[k]);
    if (status == STATUS_OK)
        status = scenes_find(&folder->results, &folder->scenes, &folder->scene_count);
    if (status == STATUS_OK && !(folder->points = calloc((size_t)folder->scene_count + 1, sizeof *folder->points)))
        status = status_set(STATUS_FAILED, "%s: no memory for %d scenes", directory, folder->scene_count);
    for (int s = 0; s < folder->scene_count && status == STATUS_OK; s++)
        status = points_find(&folder->results, folder->scenes[s], &folder->points[s]);
    if (status != STATUS_OK)
        return status;
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
    page_table_begin(page, 2, columns);
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        const char *value =
            csv_comment(is_measured(folder) ? &folder->results.csv : &folder->csvs[REPORT_STABILITY], keys[k]);
        page_row(page, (struct page_cell[]){{keys[k], NULL}, {value ? value : "unknown", NULL}});
    }
    page_table_end(page);
}

/* The pictures of `phase`, `reproduce`, `stability` and `sweep`: as SVG where it exists. */
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
            status = report_picture_show(page, path, -1, name, &count);
    }
    report_left_out_show(page, &count);
    return status;
}

static bool any_points(const struct folder *folder)
{
    for (int s = 0; s < folder->scene_count; s++)
        if (folder->points[s].count > 0)
            return true;
    return false;
}

/* Links to the sections, in their order. */
static void contents_show(struct page *page, const struct folder *folder)
{
    fputs("<nav>\n", page->stream);
    if (any_points(folder)) {
        page_link(page, "overview", "All scenes");
        page_link(page, "fronts", "Pareto fronts");
        page_link(page, "fastest", "The fastest");
    }
    for (int k = 0; k < REPORT_TABLES; k++)
        if (folder->csvs[k].row_count > 0)
            page_link(page, report_tables[k].id, report_tables[k].title);
    if (is_measured(folder))
        page_link(page, "measurements", "Measurements");
    if (folder->file_count)
        page_link(page, "figures", "Figures");
    page_link(page, "images", "Slices and images");
    page_link(page, "machine", "Machine");
    fputs("</nav>\n", page->stream);
}

static enum status folder_show(struct page *page, const struct folder *folder)
{
    enum status status = STATUS_OK;
    char title[4200];
    snprintf(title, sizeof title, "sasbench: %s", folder->directory);
    page_begin(page, title);
    if (is_measured(folder))
        report_sentences_show(page, &folder->results, folder->scene_count, folder->scenes);
    contents_show(page, folder);
    if (any_points(folder)) {
        report_overview_show(page, folder->points, folder->scene_count);
        status = report_fronts_show(page, folder->points, folder->scene_count);
        report_cheapest_show(page, "fastest", &folder->results, folder->points, folder->scene_count);
    }
    report_warnings_show(page, &folder->results);
    for (int k = 0; k < REPORT_TABLES; k++)
        report_table_show(page, &report_tables[k], &folder->csvs[k]);
    if (is_measured(folder))
        report_measurements_show(page, &folder->results, folder->scene_count, folder->scenes);
    if (status == STATUS_OK)
        status = figures_show(page, folder);
    if (status == STATUS_OK)
        status = report_pictures_show(page, folder->directory, &folder->results, folder->scene_count, folder->scenes);
    machine_show(page, folder);
    page_end(page);
    return status;
}

enum status report_write(const char *directory)
{
    struct folder folder = {0};
    struct text_file file;
    enum status status = folder_read(directory, &folder);
    if (status == STATUS_OK)
        status = text_file_in(directory, "report.html", &file);
    if (status == STATUS_OK) {
        struct page page = {.stream = file.stream};
        status = text_file_close(&file, folder_show(&page, &folder));
    }
    folder_free(&folder);
    return status;
}
