/* A results site: its folders, and its files (site.h). */
#include "report/site.h"

#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "files/folder.h"
#include "files/text_file.h"
#include "report/site_parts.h"

/* ---- The folders ---- */

/* What a line of the file's head says. Errors: STATUS_INVALID where it is not there, or empty. */
static enum status head_read(const struct csv *csv, const char *key, const char **value)
{
    *value = csv_comment(csv, key);
    return *value && **value ? STATUS_OK
                             : status_set(STATUS_INVALID,
                                          "%s: the line '# %s: ...' is missing; rows of a site say where they are from",
                                          csv->path, key);
}

/* Quartiles lie on both sides of the median, the shortest run below, and a gain cannot make the error larger. */
static enum status rows_check(const struct results *results)
{
    static const double DIGITS = 1e-6; /* relative: numbers of the file are rounded */
    for (int k = 0; k < results->csv.row_count; k++) {
        const struct measurement *row = &results->measurements[k];
        const double most = row->run_s * (1 + DIGITS);
        const char *fault = row->run_min_s > most                       ? "run_min_s is above run_s"
                            : row->run_q1_s > most                      ? "run_q1_s is above run_s"
                            : row->run_q3_s < row->run_s * (1 - DIGITS) ? "run_q3_s is below run_s"
                            : row->error_gain > row->error * (1 + DIGITS) + DIGITS * DIGITS
                                ? "error_gain, after the best gain, is above error"
                                : NULL;
        if (fault)
            return status_set(STATUS_INVALID, "%s:%d: %s of %s: %s; a row is as `run` wrote it", results->csv.path,
                              results->csv.lines[k], row->scene, row->algorithm, fault);
    }
    return STATUS_OK;
}

static enum status kind_find(struct site *site, struct submission *submission)
{
    static const char *const keys[] = {"machine", "isa", "threads", "commit", "date", "program"};
    const struct csv *csv = &submission->results.csv;
    const char *values[sizeof keys / sizeof *keys];
    char name[sizeof site->kinds->name];
    enum status status = STATUS_OK;
    for (size_t k = 0; k < sizeof keys / sizeof *keys && status == STATUS_OK; k++)
        status = head_read(csv, keys[k], &values[k]);
    if (status != STATUS_OK)
        return status;
    submission->commit = values[3];
    submission->date = values[4];
    snprintf(name, sizeof name, "%.200s, %.40s, %.40s %s", values[0], values[1], values[2],
             strcmp(values[2], "1") == 0 ? "thread" : "threads");
    for (int k = 0; k < site->kind_count; k++)
        if (strcmp(site->kinds[k].name, name) == 0) {
            submission->kind = k;
            return STATUS_OK;
        }
    submission->kind = site->kind_count++;
    memcpy(site->kinds[submission->kind].name, name, sizeof name);
    return STATUS_OK;
}

static int newest_first(const void *a, const void *b)
{
    const struct submission *one = a, *other = b;
    const int order = strcmp(other->date, one->date); /* 2026-11-29T01:16:30Z */
    return order ? order : strcmp(one->directory, other->directory);
}

bool site_is_cell(const struct measurement *a, const struct measurement *b)
{
    return strcmp(a->scene, b->scene) == 0 && strcmp(a->algorithm, b->algorithm) == 0
           && strcmp(a->options, b->options) == 0 && strcmp(a->precision, b->precision) == 0;
}

/* Add the rows of cells that no newer folder has. */
static enum status rows_add(struct kind *kind, const struct submission *submission)
{
    const int rows = submission->results.csv.row_count, before = kind->newest.csv.row_count;
    const size_t room = (size_t)before + (size_t)rows + 1;
    struct measurement *list = realloc(kind->newest.measurements, room * sizeof *list);
    if (list)
        kind->newest.measurements = list;
    struct origin *from = list ? realloc(kind->from, room * sizeof *from) : NULL;
    if (!from)
        return status_set(STATUS_FAILED, "%s: no memory for %d rows", submission->directory, rows);
    kind->from = from;
    for (int k = 0; k < rows; k++) {
        const struct measurement *row = &submission->results.measurements[k];
        int n = 0;
        while (n < before && !site_is_cell(&list[n], row))
            n++;
        if (n < before)
            continue;
        from[kind->newest.csv.row_count] = (struct origin){submission, k};
        list[kind->newest.csv.row_count++] = *row;
    }
    return STATUS_OK;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Of all kinds, each once. */
static enum status scenes_join(struct site *site)
{
    size_t rows = 1;
    for (int k = 0; k < site->kind_count; k++)
        rows += (size_t)site->kinds[k].newest.csv.row_count;
    site->scenes = calloc(rows, sizeof *site->scenes);
    if (!site->scenes)
        return status_set(STATUS_FAILED, "no memory for %zu rows", rows);
    int count = 0;
    for (int k = 0; k < site->kind_count; k++)
        for (int n = 0; n < site->kinds[k].newest.csv.row_count; n++)
            site->scenes[count++] = site->kinds[k].newest.measurements[n].scene;
    qsort(site->scenes, (size_t)count, sizeof *site->scenes, by_name);
    for (int k = 0; k < count; k++)
        if (k == 0 || strcmp(site->scenes[k], site->scenes[k - 1]) != 0)
            site->scenes[site->scene_count++] = site->scenes[k];
    return STATUS_OK;
}

enum status site_read(int count, const char *const *folders, struct site *site)
{
    char path[4200];
    enum status status = STATUS_OK;
    *site = (struct site){
        calloc((size_t)count, sizeof *site->submissions), calloc((size_t)count, sizeof *site->kinds), NULL, 0, 0, 0};
    if (!site->submissions || !site->kinds)
        return status_set(STATUS_FAILED, "no memory for %d folders", count);
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        struct submission *submission = &site->submissions[site->submission_count++];
        submission->directory = folders[k];
        snprintf(path, sizeof path, "%.4096s/measurements.csv", folders[k]);
        status = results_read(path, &submission->results);
        if (status == STATUS_OK)
            status = rows_check(&submission->results);
        if (status == STATUS_OK)
            status = kind_find(site, submission);
    }
    if (status != STATUS_OK)
        return status;
    qsort(site->submissions, (size_t)count, sizeof *site->submissions, newest_first);
    for (int k = 0; k < count && status == STATUS_OK; k++)
        status = rows_add(&site->kinds[site->submissions[k].kind], &site->submissions[k]);
    return status == STATUS_OK ? scenes_join(site) : status;
}

void site_free(struct site *site)
{
    for (int k = 0; k < site->submission_count; k++)
        results_free(&site->submissions[k].results);
    for (int k = 0; k < site->kind_count; k++) {
        free(site->kinds[k].newest.measurements);
        free(site->kinds[k].from);
    }
    free(site->submissions);
    free(site->kinds);
    free(site->scenes);
}

/* ---- The files ---- */

static bool is_page(const char *name)
{
    const size_t length = strspn(name + (strncmp(name, "scene-", 6) == 0 ? 6 : 0), "0123456789");
    return strcmp(name, "index.html") == 0
           || (strncmp(name, "scene-", 6) == 0 && length > 0 && strcmp(name + 6 + length, ".html") == 0);
}

/* Nothing but an older site is in the folder; its pages are removed where `clear`. */
static enum status out_clear(const char *out, bool clear)
{
    char path[4500];
    enum status status = STATUS_OK;
    DIR *folder = opendir(out);
    if (!folder)
        return status_set(STATUS_INVALID, "%s: cannot be read", out);
    for (struct dirent *entry; status == STATUS_OK && (entry = readdir(folder));) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        snprintf(path, sizeof path, "%.4096s/%s", out, entry->d_name);
        if (!is_page(entry->d_name))
            status = status_set(STATUS_INVALID,
                                "%s is no page of a results site; a new folder, or an older site, is accepted", path);
        else if (clear)
            place_clear(path);
    }
    closedir(folder);
    return status;
}

/* A scene's page, or with scene -1 the index. */
static enum status page_write(const struct site *site, int scene, const char *out)
{
    char path[4200];
    struct text_file file;
    if (scene < 0)
        snprintf(path, sizeof path, "%.4096s/index.html", out);
    else
        snprintf(path, sizeof path, "%.4096s/scene-%d.html", out, scene + 1);
    const enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    struct page page = {.stream = file.stream};
    return text_file_close(&file, scene < 0 ? site_index_show(&page, site)
                                            : site_scene_show(&page, site, site->scenes[scene]));
}

enum status site_write(int count, const char *const *folders, const char *out)
{
    struct site site;
    int lock = -1;
    enum status status = site_read(count, folders, &site);
    if (status == STATUS_OK)
        status = directory_make(out);
    if (status == STATUS_OK)
        status = folder_take(out, &lock);
    if (status == STATUS_OK)
        status = out_clear(out, false);
    if (status == STATUS_OK)
        status = out_clear(out, true);
    for (int s = 0; s < site.scene_count && status == STATUS_OK; s++)
        status = page_write(&site, s, out);
    if (status == STATUS_OK)
        status = page_write(&site, -1, out);
    folder_leave(lock);
    site_free(&site);
    return status;
}
