/* A results site: its folders, and its files (site.h). */
#include "report/site.h"

#include <ctype.h>
#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/folder.h"
#include "files/text_file.h"
#include "report/site_parts.h"

/* ---- The folders ---- */

/* "2026-11-29T01:16:30Z": dates are compared as texts. */
static bool is_date(const char *text)
{
    static const char form[] = "0000-00-00T00:00:00Z";
    size_t k = 0;
    while (form[k] && (form[k] == '0' ? isdigit((unsigned char)text[k]) : text[k] == form[k]))
        k++;
    return !form[k] && !text[k];
}

/* What a line of the file's head says: plain, and short enough to be compared whole. */
static enum status head_read(const struct csv *csv, const char *key, const char **value)
{
    *value = csv_comment(csv, key);
    if (!*value || !**value)
        return status_set(STATUS_INVALID, "%s: the line '# %s: ...' is missing; rows of a site say where they are from",
                          csv->path, key);
    if (strlen(*value) > HEAD_MOST)
        return status_set(STATUS_INVALID, "%s: the line '# %s: ...' has %zu characters; at most %d are accepted",
                          csv->path, key, strlen(*value), HEAD_MOST);
    if (strcmp(key, "date") == 0 && !is_date(*value))
        return status_set(STATUS_INVALID, "%s: the date is '%s'; one like 2026-11-29T01:16:30Z is needed", csv->path,
                          *value);
    return STATUS_OK;
}

/* Quartiles lie on both sides of the median, the shortest run below, and a gain cannot make the error larger. */
static enum status rows_check(const struct results *results)
{
    static const double DIGITS = 1e-6; /* relative: numbers of the file are rounded */
    char threads[16];
    for (int k = 0; k < results->csv.row_count; k++) {
        const struct measurement *row = &results->measurements[k];
        const struct {
            const char *name, *of;
            double value, most;
        } pairs[] = {{"run_min_s", "run_s", row->run_min_s, row->run_s},
                     {"run_q1_s", "run_s", row->run_q1_s, row->run_s},
                     {"run_s", "run_q3_s", row->run_s, row->run_q3_s},
                     {"error_gain", "error", row->error_gain, row->error}};
        for (size_t n = 0; n < sizeof pairs / sizeof *pairs; n++)
            if (pairs[n].value > pairs[n].most * (1 + DIGITS) + DIGITS * DIGITS)
                return status_set(STATUS_INVALID,
                                  "%s:%d: %s of %s by %s is %.9g; at most %s, %.9g, is accepted: rows are as `run` "
                                  "wrote them",
                                  results->csv.path, results->csv.lines[k], pairs[n].name, row->scene, row->algorithm,
                                  pairs[n].value, pairs[n].of, pairs[n].most);
        snprintf(threads, sizeof threads, "%d", row->threads);
        if (row->threads >= 0 && strcmp(threads, csv_comment(&results->csv, "threads")) != 0)
            return status_set(STATUS_INVALID, "%s:%d: %s of %s has %s threads, the head %s; the same are needed",
                              results->csv.path, results->csv.lines[k], row->algorithm, row->scene, threads,
                              csv_comment(&results->csv, "threads"));
    }
    return STATUS_OK;
}

/* A name stands for one scene, or one algorithm from outside, in both. */
static enum status contents_compare(const struct csv *a, const struct csv *b)
{
    for (int k = 0; k < a->comment_count; k++) {
        const char *one = a->comments[k], *other = comment_names_content(one) ? comment_like(b, one) : NULL;
        if (other && strcmp(one, other) != 0)
            return status_set(STATUS_INVALID, "%s has '%s', %s has '%s'; one content is accepted for a name", a->path,
                              one, b->path, other);
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
    snprintf(name, sizeof name, "%s, %s, %s %s", values[0], values[1], values[2],
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

/* The place of a cell among the newest rows; behind them: there is none. */
static int cell_find(const struct kind *kind, const struct measurement *row)
{
    int n = 0;
    while (n < kind->newest.csv.row_count && !site_is_cell(&kind->newest.measurements[n], row))
        n++;
    return n;
}

/* Add the rows of cells that no newer folder has measured. */
static enum status rows_add(struct kind *kind, const struct submission *submission)
{
    const int rows = submission->results.csv.row_count;
    const size_t room = (size_t)kind->newest.csv.row_count + (size_t)rows + 1;
    struct measurement *list = realloc(kind->newest.measurements, room * sizeof *list);
    if (list)
        kind->newest.measurements = list;
    struct origin *from = list ? realloc(kind->from, room * sizeof *from) : NULL;
    if (!from)
        return status_set(STATUS_FAILED, "%s: no memory for %d rows", submission->directory, rows);
    kind->from = from;
    for (int k = 0; k < rows; k++) {
        const struct measurement *row = &submission->results.measurements[k];
        const int n = cell_find(kind, row);
        const bool is_new = n == kind->newest.csv.row_count;
        if (!is_new && strcmp(from[n].submission->date, submission->date) == 0)
            return status_set(STATUS_INVALID, "%s:%d: %s has a row of %s by %s of the same date; one is accepted",
                              submission->results.csv.path, submission->results.csv.lines[k],
                              from[n].submission->results.csv.path, row->scene, row->algorithm);
        if (!is_new && (strcmp(list[n].status, "failed") != 0 || strcmp(row->status, "failed") == 0))
            continue;
        from[n] = (struct origin){submission, k};
        list[n] = *row;
        kind->newest.csv.row_count += is_new;
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
            status = kind_find(site, submission);
        if (status == STATUS_OK)
            status = rows_check(&submission->results);
        for (int n = 0; n < k && status == STATUS_OK; n++)
            status = contents_compare(&site->submissions[n].results.csv, &submission->results.csv);
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

/* The number of a scene's page, from 1; 0 for other names. */
static int page_number(const char *name)
{
    int number = 0, length = 0;
    return sscanf(name, "scene-%9d.html%n", &number, &length) == 1 && length > 0 && !name[length] ? number : 0;
}

/* Is it a site's index: by its title? */
static bool is_index(const char *path)
{
    char head[1000] = "";
    const int descriptor = place_read(path, 0);
    const ssize_t got = descriptor >= 0 ? read(descriptor, head, sizeof head - 1) : 0;
    if (descriptor >= 0)
        close(descriptor);
    return got > 0 && strstr(head, "<title>" SITE_TITLE "</title>");
}

/* The folder is empty, or an older site: whose pages above `scenes` are removed where that is not negative. */
static enum status out_check(const char *out, int scenes)
{
    char path[4500];
    enum status status = STATUS_OK;
    DIR *folder = opendir(out);
    if (!folder)
        return status_set(STATUS_INVALID, "%s: cannot be read", out);
    for (struct dirent *entry; status == STATUS_OK && (entry = readdir(folder));) {
        const int number = page_number(entry->d_name);
        snprintf(path, sizeof path, "%.4096s/%s", out, entry->d_name);
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        if (number == 0 && (strcmp(entry->d_name, "index.html") != 0 || !is_index(path)))
            status = status_set(STATUS_INVALID,
                                "%s is no page of a results site; a new folder, or an older site, is accepted", path);
        else if (scenes >= 0 && number > scenes)
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
        status = out_check(out, -1);
    for (int s = 0; s < site.scene_count && status == STATUS_OK; s++)
        status = page_write(&site, s, out);
    if (status == STATUS_OK)
        status = page_write(&site, -1, out);
    if (status == STATUS_OK)
        status = out_check(out, site.scene_count);
    folder_leave(lock);
    site_free(&site);
    return status;
}
