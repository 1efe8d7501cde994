/* The results folder: two CSV files, written row by row and continued after an interruption. */
#define _GNU_SOURCE /* asprintf */
#include "results/results_folder.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files/folder.h"
#include "text/shown_text.h"
#include "files/text_file.h"
#include "results/rows.h"

/* Identifies a measurement; NULL stands for all. */
struct key {
    const char *scene, *algorithm, *options, *precision;
};

struct results_folder {
    int lock; /* of the folder */
    struct provenance provenance;
    char *paths[KINDS];       /* of its files */
    FILE *files[KINDS];       /* open for appending */
    struct content *contents; /* of everything that has rows */
    int content_count;
    struct csv earlier;       /* measurements.csv as the earlier run left it; rows point into it */
    struct measurement *rows; /* [earlier.row_count] */
    bool *dropped;            /* [earlier.row_count] the scene's content has changed since, or a new row replaces it */
};

/* A finished row survives a power cut. */
static enum status rows_done(FILE *file, const char *path)
{
    if (!stream_flush(file) || !place_sync(fileno(file)))
        return status_set(STATUS_FAILED, "%s: cannot be written: %s", path, strerror(errno));
    return STATUS_OK;
}

static char *path_join(const char *directory, const char *name)
{
    char *joined;
    return asprintf(&joined, "%s/%s", directory, name) < 0 ? NULL : joined;
}

static bool key_equal(const struct csv *a, int row_a, const struct csv *b, int row_b)
{
    for (int k = 0; k < KEY_COLUMNS; k++)
        if (strcmp(csv_cell(a, row_a, k), csv_cell(b, row_b, k)) != 0)
            return false;
    return true;
}

static bool measurement_present(const struct csv *measurements, const struct csv *csv, int row)
{
    for (int k = 0; k < measurements->row_count; k++)
        if (key_equal(measurements, k, csv, row))
            return true;
    return false;
}

static bool part_matches(const char *part, const char *text)
{
    return !part || strcmp(part, text) == 0;
}

static bool key_matches(const struct key *key, const char *scene, const char *algorithm, const char *options,
                        const char *precision)
{
    return part_matches(key->scene, scene) && part_matches(key->algorithm, algorithm)
           && part_matches(key->options, options) && part_matches(key->precision, precision);
}

/* Rewrite one file from the rows of `old`, without those of `except` (NULL: all stay) and without rows of targets
   whose measurement is missing. It is made beside the old file and renamed when complete; later rows are appended. */
static enum status file_rewrite(struct results_folder *folder, int kind, const struct csv old[KINDS],
                                const struct key *except)
{
    struct text_file text;
    enum status status = text_file_open(folder->paths[kind], &text);
    if (status != STATUS_OK)
        return status;
    FILE *file = text.stream;
    head_write(file, &row_kinds[kind], &folder->provenance, NULL, folder->contents, folder->content_count);
    for (int row = 0; row < old[kind].row_count; row++) {
        if (except
            && key_matches(except, csv_cell(&old[kind], row, 0), csv_cell(&old[kind], row, 1),
                           csv_cell(&old[kind], row, 2), csv_cell(&old[kind], row, 3)))
            continue;
        if (!measurement_present(&old[KIND_MEASUREMENTS], &old[kind], row))
            continue;
        for (int k = 0; row_kinds[kind].columns[k].name; k++) {
            if (k)
                fputc(',', file);
            csv_write_text(file, k < old[kind].column_count ? csv_cell(&old[kind], row, k) : "");
        }
        fputc('\n', file);
    }
    return text_file_keep(&text, &folder->files[kind]);
}

/* Rewrite both files. The measurements come first: a cut between the two leaves targets without a measurement, which
   the next run drops. */
static enum status folder_rewrite(struct results_folder *folder, const struct csv old[KINDS], const struct key *except)
{
    for (int k = 0; k < KINDS; k++) {
        if (folder->files[k])
            fclose(folder->files[k]);
        folder->files[k] = NULL;
        enum status status = file_rewrite(folder, k, old, except);
        if (status)
            return status;
    }
    return STATUS_OK;
}

/* --- Taking up an earlier run -------------------------------------------------------------------------------- */

static struct content *content_find(const struct results_folder *folder, const char *kind, const char *name)
{
    for (int k = 0; k < folder->content_count; k++)
        if (strcmp(folder->contents[k].kind, kind) == 0 && strcmp(folder->contents[k].name, name) == 0)
            return &folder->contents[k];
    return NULL;
}

/* Takes over the name. */
static enum status content_set(struct results_folder *folder, struct content content)
{
    struct content *known = content_find(folder, content.kind, content.name);
    if (known) {
        memcpy(known->text, content.text, sizeof known->text);
        free(content.name);
        return STATUS_OK;
    }
    struct content *contents = realloc(folder->contents, ((size_t)folder->content_count + 1) * sizeof *contents);
    if (!contents) {
        free(content.name);
        return status_set(STATUS_FAILED, "no memory for the %s's content", content.kind);
    }
    folder->contents = contents;
    contents[folder->content_count++] = content;
    return STATUS_OK;
}

/* The comments "scene NAME: HASH" and "algorithm NAME: ORIGIN": the last colon ends the name. */
static enum status contents_read(struct results_folder *folder, const struct csv *csv)
{
    static const char *const kinds[] = {"scene", "algorithm"};
    enum status status = STATUS_OK;
    for (int k = 0; k < 2 * csv->comment_count && !status; k++) {
        const char *comment = csv->comments[k / 2], *kind = kinds[k % 2], *colon = strrchr(comment, ':');
        const char *name = comment + strlen(kind) + 1;
        if (strncmp(comment, kind, strlen(kind)) != 0 || comment[strlen(kind)] != ' ' || !colon || colon < name)
            continue;
        struct content content = {kind, strndup(name, (size_t)(colon - name)), ""};
        snprintf(content.text, sizeof content.text, "%s", colon + 1 + strspn(colon + 1, " "));
        status = content.name ? content_set(folder, content) : status_set(STATUS_FAILED, "%s: no memory", csv->path);
    }
    return status;
}

/* Read one file of an earlier run, if there is one. Errors: STATUS_INVALID when it is not ours. */
static enum status file_read(const char *path, const struct row_kind *kind, struct csv *csv)
{
    struct stat info;
    *csv = (struct csv){0};
    if (lstat(path, &info) != 0 && errno == ENOENT)
        return STATUS_OK;
    enum status status = csv_read(path, CSV_TAIL_DROP, csv);
    if (status)
        return status;
    if (kind_is(csv, kind))
        return STATUS_OK;
    csv_free(csv);
    return status_set(STATUS_INVALID,
                      "%s:1: the first line is not '# %s', so another program wrote it; name another folder", path,
                      kind->format);
}

static enum status rows_parse(struct results_folder *folder)
{
    const struct csv *csv = &folder->earlier;
    if (csv->row_count == 0)
        return STATUS_OK;
    folder->rows = calloc((size_t)csv->row_count, sizeof *folder->rows);
    folder->dropped = calloc((size_t)csv->row_count, sizeof *folder->dropped);
    enum status status = STATUS_OK;
    if (!folder->rows || !folder->dropped)
        status = status_set(STATUS_FAILED, "%s: no memory for %d rows", csv->path, csv->row_count);
    for (int row = 0; row < csv->row_count; row++)
        if (!status)
            status = row_parse(csv, row, &row_kinds[KIND_MEASUREMENTS], &folder->rows[row]);
    return status;
}

/* "measurements.3.csv" */
static void kept_name(int kind, int number, char *name, size_t size)
{
    snprintf(name, size, "%.*s.%d.csv", (int)strcspn(row_kinds[kind].file, "."), row_kinds[kind].file, number);
}

static bool file_is(const struct results_folder *folder, const char *name)
{
    struct stat info;
    return fstatat(folder->lock, name, &info, AT_SYMLINK_NOFOLLOW) == 0;
}

/* Link the file under another name; it stays in place until it is replaced. File systems without links rename it. */
static enum status file_keep(const struct results_folder *folder, int kind, const char *kept)
{
    const int at = folder->lock;
    const char *file = row_kinds[kind].file;
    if (!file_is(folder, file) || linkat(at, file, at, kept, 0) == 0 || renameat(at, file, at, kept) == 0)
        return STATUS_OK;
    return status_set(STATUS_INVALID, "%s: cannot be kept as %s: %s; name another folder", folder->paths[kind], kept,
                      strerror(errno));
}

/* Keep the files under the next free number before they are begun anew, and report why. */
static enum status files_keep(const struct results_folder *folder, const char *why)
{
    char names[KINDS][64], told[KINDS * 64] = "";
    enum status status = STATUS_OK;
    bool taken = true;
    for (int number = 1; taken; number++) {
        taken = false;
        for (int k = 0; k < KINDS; k++) {
            kept_name(k, number, names[k], sizeof names[k]);
            taken |= file_is(folder, names[k]);
        }
    }
    for (int k = 0; k < KINDS && !status; k++) {
        status = file_keep(folder, k, names[k]);
        if (!status && file_is(folder, names[k]))
            snprintf(told + strlen(told), sizeof told - strlen(told), "%s%s", *told ? " and " : "", names[k]);
    }
    if (!status) {
        fprintf(stderr, "sasbench: %s: ", folder->paths[KIND_MEASUREMENTS]);
        shown_write(stderr, why); /* it quotes the file */
        fprintf(stderr, "; the old rows are kept in %s\n", told);
    }
    return status;
}

/* Why the rows of the folder cannot be continued; empty when they can, or when there are none. */
static void resume_refusal(const struct results_folder *folder, const struct csv old[KINDS], char *why, size_t size)
{
    *why = '\0';
    for (int k = 0; k < KINDS && !*why; k++)
        if (!old[k].path && old[KINDS - 1 - k].row_count > 0)
            snprintf(why, size, "%s is missing", row_kinds[k].file);
    for (int k = 0; k < KINDS && !*why; k++)
        if (old[k].row_count > 0)
            provenance_differs(&old[k], &folder->provenance, why, size);
}

static enum status folder_begin(struct results_folder *folder, const char *directory)
{
    struct csv old[KINDS] = {0};
    char why[400] = "";
    enum status status = directory_make(directory);
    if (!status)
        status = folder_take(directory, &folder->lock);
    for (int k = 0; k < KINDS && !status; k++) {
        folder->paths[k] = path_join(directory, row_kinds[k].file);
        status = folder->paths[k] ? file_read(folder->paths[k], &row_kinds[k], &old[k])
                                  : status_set(STATUS_FAILED, "%s: no memory", directory);
    }
    if (!status)
        resume_refusal(folder, old, why, sizeof why);
    for (int k = 0; k < KINDS && !status; k++) {
        char other[400] = "";
        if (old[k].path)
            provenance_differs(&old[k], &folder->provenance, other, sizeof other);
        if (*why || *other)
            csv_free(&old[k]);
        else if (old[k].path)
            status = header_check(&old[k], &row_kinds[k]);
    }
    /* Everything is read before anything is written, so that a faulty file stays unchanged. */
    folder->earlier = old[KIND_MEASUREMENTS];
    if (!status)
        status = contents_read(folder, &folder->earlier);
    if (!status)
        status = rows_parse(folder);
    if (!status && *why)
        status = files_keep(folder, why);
    if (!status)
        status = folder_rewrite(folder, old, NULL);
    csv_free(&old[KIND_TARGETS]);
    return status;
}

enum status results_folder_open(const char *directory, const struct provenance *provenance,
                                struct results_folder **folder)
{
    *folder = calloc(1, sizeof **folder);
    if (!*folder)
        return status_set(STATUS_FAILED, "%s: no memory", directory);
    (*folder)->provenance = *provenance;
    (*folder)->lock = -1;
    enum status status = folder_begin(*folder, directory);
    if (status) {
        (void)results_folder_close(*folder);
        *folder = NULL;
    }
    return status;
}

/* Both files without the rows of `key`. */
static enum status rows_drop(struct results_folder *folder, const struct key *key)
{
    struct csv now[KINDS] = {0};
    enum status status = STATUS_OK;
    for (int row = 0; row < folder->earlier.row_count; row++) {
        const struct measurement *found = &folder->rows[row];
        folder->dropped[row] |= key_matches(key, found->scene, found->algorithm, found->options, found->precision);
    }
    for (int k = 0; k < KINDS && !status; k++) {
        status = csv_read(folder->paths[k], CSV_TAIL_DROP, &now[k]);
        if (!status)
            status = header_check(&now[k], &row_kinds[k]);
    }
    if (!status)
        status = folder_rewrite(folder, now, key);
    for (int k = 0; k < KINDS; k++)
        csv_free(&now[k]);
    return status;
}

static int earlier_find(const struct results_folder *folder, const struct key *key)
{
    for (int row = 0; row < folder->earlier.row_count; row++) {
        const struct measurement *found = &folder->rows[row];
        if (!folder->dropped[row] && key_matches(key, found->scene, found->algorithm, found->options, found->precision))
            return row;
    }
    return -1;
}

/* The rows of `key` are those of this content; from now on, if they were not. */
static enum status content_declare(struct results_folder *folder, struct content content, const struct key *key)
{
    const struct content *known = content_find(folder, content.kind, content.name);
    enum status status = STATUS_OK;
    if (known && strcmp(known->text, content.text) == 0)
        return STATUS_OK;
    if (earlier_find(folder, key) >= 0) {
        char why[400];
        snprintf(why, sizeof why, "the %s %.300s has changed", content.kind, content.name);
        status = files_keep(folder, why);
    }
    content.name = strdup(content.name);
    if (!content.name)
        return status_set(STATUS_FAILED, "no memory for the %s's content", content.kind);
    const enum status set = content_set(folder, content);
    status = status ? status : set;
    return status ? status : rows_drop(folder, key);
}

enum status results_folder_scene(struct results_folder *folder, const char *scene, uint64_t hash)
{
    return content_declare(folder, content_scene((char *)scene, hash), &(struct key){.scene = scene});
}

enum status results_folder_algorithm(struct results_folder *folder, const char *algorithm, const char *origin)
{
    struct content content = {"algorithm", (char *)algorithm, ""};
    snprintf(content.text, sizeof content.text, "%s", origin);
    return content_declare(folder, content, &(struct key){.algorithm = algorithm});
}

const struct measurement *results_folder_find(const struct results_folder *folder, const char *scene,
                                              const char *algorithm, const char *options, const char *precision)
{
    int row = earlier_find(folder, &(struct key){scene, algorithm, options, precision});
    return row >= 0 && strcmp(folder->rows[row].status, "failed") != 0 ? &folder->rows[row] : NULL;
}

/* A new row replaces that of an earlier run. */
static enum status earlier_replace(struct results_folder *folder, const struct key *key)
{
    return earlier_find(folder, key) < 0 ? STATUS_OK : rows_drop(folder, key);
}

static enum status rows_append(struct results_folder *folder, int kind, const void *rows, int count, size_t row_size)
{
    FILE *file = folder->files[kind];
    if (!file)
        return status_set(STATUS_FAILED, "%s: no row can be added, since the file could not be rewritten before",
                          folder->paths[kind]);
    for (int k = 0; k < count; k++)
        row_write(file, row_kinds[kind].columns, (const char *)rows + (size_t)k * row_size);
    return rows_done(file, folder->paths[kind]);
}

enum status results_folder_targets(struct results_folder *folder, const struct target_row *rows, int count)
{
    enum status status = STATUS_OK;
    for (int k = 0; k < count && !status; k++)
        status = earlier_replace(folder,
                                 &(struct key){rows[k].scene, rows[k].algorithm, rows[k].options, rows[k].precision});
    return status ? status : rows_append(folder, KIND_TARGETS, rows, count, sizeof *rows);
}

enum status results_folder_add(struct results_folder *folder, const struct measurement *row)
{
    struct measurement stamped = *row;
    char host[HOST_NAME_MAX + 1] = "";
    if (gethostname(host, sizeof host - 1) == 0)
        stamped.host = host;
    if (getloadavg(&stamped.load, 1) != 1)
        stamped.load = NAN;
    enum status status =
        earlier_replace(folder, &(struct key){row->scene, row->algorithm, row->options, row->precision});
    return status ? status : rows_append(folder, KIND_MEASUREMENTS, &stamped, 1, sizeof stamped);
}

enum status results_folder_close(struct results_folder *folder)
{
    enum status status = STATUS_OK;
    if (!folder)
        return STATUS_OK;
    for (int k = 0; k < KINDS; k++) {
        if (folder->files[k] && !stream_close(folder->files[k]))
            status = status_set(STATUS_FAILED, "%s: cannot be closed: %s", folder->paths[k], strerror(errno));
        free(folder->paths[k]);
    }
    for (int k = 0; k < folder->content_count; k++)
        free(folder->contents[k].name);
    free(folder->contents);
    free(folder->rows);
    free(folder->dropped);
    csv_free(&folder->earlier);
    folder_leave(folder->lock);
    free(folder);
    return status;
}
