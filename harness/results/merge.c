/* Results folders as one (merge.h). Its files are CSV: comments of where they are from, and rows, the first columns of
   which identify a row. */
#include "results/merge.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/csv.h"
#include "files/folder.h"
#include "files/text_file.h"
#include "results/results.h"

/* Targets are written ahead of their measurements: a cut between the two leaves rows that the next run drops. */
static const struct {
    const char *name;
    int keys;   /* columns that identify a row; 0: all of them */
    bool needs; /* a measurement in the same folder */
} files[] = {
    {"targets.csv", 7, true},   {"plans.csv", 0, true},      {"measurements.csv", 4, false},
    {"expected.csv", 4, false}, {"stability.csv", 4, false},
};
enum { FILES = sizeof files / sizeof *files, MEASUREMENTS = 2, STABILITY = 4, MEASUREMENT_KEYS = 4 };

struct source {
    const char *directory;
    int lock, kind;
    struct csv csv[FILES]; /* without a path: no such file */
};

struct merger {
    struct source *sources; /* [count]: those given, and the places of the result */
    int count, given;
};

static const char *comment_of(const struct source *source, const char *key)
{
    const char *text = csv_comment(&source->csv[MEASUREMENTS], key);
    text = text ? text : csv_comment(&source->csv[STABILITY], key);
    return text ? text : "unknown";
}

static bool same_kind(const struct source *a, const struct source *b)
{
    return strcmp(comment_of(a, "machine"), comment_of(b, "machine")) == 0
           && strcmp(comment_of(a, "isa"), comment_of(b, "isa")) == 0;
}

static enum status source_read(const char *directory, struct source *source)
{
    char path[4400];
    *source = (struct source){.directory = directory, .lock = -1};
    enum status status = folder_take(directory, &source->lock);
    for (int f = 0; f < FILES && status == STATUS_OK; f++) {
        snprintf(path, sizeof path, "%s/%s", directory, files[f].name);
        if (access(path, F_OK) == 0)
            status = csv_read(path, CSV_TAIL_DROP, &source->csv[f]);
    }
    return status;
}

static bool source_holds(const struct source *source)
{
    return source->csv[MEASUREMENTS].path || source->csv[STABILITY].path;
}

static void merger_free(struct merger *merger)
{
    for (int s = 0; s < merger->count; s++) {
        for (int f = 0; f < FILES; f++)
            csv_free(&merger->sources[s].csv[f]);
        folder_leave(merger->sources[s].lock);
    }
    free(merger->sources);
}

/* ---- what the files are from ---- */

/* May it differ between folders that are merged? */
static bool comment_is_free(const char *comment)
{
    static const char *const keys[] = {"date", "machine", "isa"}; /* each kind of machine has a folder */
    bool is_free = false;
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        is_free |= comment_key_length(comment) == strlen(keys[k]) && strncmp(comment, keys[k], strlen(keys[k])) == 0;
    return is_free;
}

static enum status comments_check(const struct csv *csv, const struct csv *first)
{
    for (int k = 0; k < first->comment_count; k++) {
        const char *wanted = first->comments[k], *found = comment_like(csv, wanted);
        if (comment_is_free(wanted) || (found ? strcmp(found, wanted) == 0 : comment_names_content(wanted)))
            continue;
        return status_set(STATUS_INVALID,
                          "%s: has '# %.200s', must be '# %.200s' as in %s; other results are not merged", csv->path,
                          found ? found : "", wanted, first->path);
    }
    return STATUS_OK;
}

static enum status columns_check(const struct csv *csv, const struct csv *first)
{
    bool same = csv->column_count == first->column_count;
    for (int k = 0; same && k < csv->column_count; k++)
        same = strcmp(csv->columns[k], first->columns[k]) == 0;
    return same ? STATUS_OK
                : status_set(STATUS_INVALID, "%s: its columns are not those of %s; other results are not merged",
                             csv->path, first->path);
}

/* All files of one name. */
static enum status heads_check(const struct merger *merger, int file)
{
    enum status status = STATUS_OK;
    for (int s = 0; s < merger->count && status == STATUS_OK; s++)
        for (int t = 0; t < s && status == STATUS_OK; t++) {
            const struct csv *csv = &merger->sources[s].csv[file], *first = &merger->sources[t].csv[file];
            if (!csv->path || !first->path)
                continue;
            status = comments_check(csv, first);
            if (status == STATUS_OK)
                status = columns_check(csv, first);
        }
    return status;
}

/* ---- rows ---- */

struct row {
    const struct csv *csv;
    int row;
    uint64_t hash; /* of what identifies it */
};
struct rows {
    struct row *list;
    int count;
};

static uint64_t key_hash(const struct csv *csv, int row, int keys)
{
    uint64_t hash = 0xcbf29ce484222325u; /* FNV-1a */
    for (int k = 0; k < keys; k++) {
        const char *cell = csv_cell(csv, row, k);
        for (size_t n = 0; n <= strlen(cell); n++)
            hash = (hash ^ (unsigned char)cell[n]) * 0x100000001b3u;
    }
    return hash;
}

static bool cells_equal(const struct row *a, const struct row *b, int count)
{
    for (int k = 0; k < count; k++)
        if (strcmp(csv_cell(a->csv, a->row, k), csv_cell(b->csv, b->row, k)) != 0)
            return false;
    return true;
}

static struct row *row_find(const struct rows *rows, const struct row *wanted, int keys)
{
    for (int k = 0; k < rows->count; k++)
        if (rows->list[k].hash == wanted->hash && cells_equal(&rows->list[k], wanted, keys))
            return &rows->list[k];
    return NULL;
}

static bool is_failed(const struct row *row)
{
    const int column = csv_column(row->csv, "status");
    return column >= 0 && strcmp(csv_cell(row->csv, row->row, column), "failed") == 0;
}

/* Does a folder have the measurement of a row of targets.csv or plans.csv, which has those of `auto`? */
static bool is_measured(const struct csv *measurements, const struct csv *csv, int row)
{
    const bool plan = strcmp(csv->columns[1], "options") == 0;
    const char *const keys[] = {csv_cell(csv, row, 0), plan ? "auto" : csv_cell(csv, row, 1),
                                csv_cell(csv, row, plan ? 1 : 2), csv_cell(csv, row, plan ? 2 : 3)};
    for (int k = 0; k < measurements->row_count; k++) {
        bool same = true;
        for (int n = 0; n < MEASUREMENT_KEYS && same; n++)
            same = strcmp(csv_cell(measurements, k, n), keys[n]) == 0;
        if (same)
            return true;
    }
    return false;
}

/* One more row; what an earlier folder has stays. */
static enum status row_add(struct rows *rows, const struct row *row, int keys)
{
    struct row *same = row_find(rows, row, keys);
    if (!same) {
        rows->list[rows->count++] = *row;
        return STATUS_OK;
    }
    if (is_failed(same))
        *same = *row;
    else if (!is_failed(row) && !cells_equal(same, row, row->csv->column_count))
        return status_set(
            STATUS_INVALID, "%s:%d: another row of %.80s with %.80s:%.200s than %s:%d; each cell is in one folder",
            row->csv->path, row->csv->lines[row->row], csv_cell(row->csv, row->row, 0), csv_cell(row->csv, row->row, 1),
            csv_cell(row->csv, row->row, 2), same->csv->path, same->csv->lines[same->row]);
    return STATUS_OK;
}

/* The rows of a file of all folders of a kind. */
static enum status rows_unite(const struct merger *merger, int kind, int file, struct rows *rows)
{
    size_t room = 1;
    enum status status = STATUS_OK;
    for (int s = 0; s < merger->count; s++)
        room += (size_t)merger->sources[s].csv[file].row_count;
    *rows = (struct rows){calloc(room, sizeof *rows->list), 0};
    if (!rows->list)
        return status_set(STATUS_FAILED, "%s: no memory for %zu rows", files[file].name, room);
    for (int s = 0; s < merger->count; s++) {
        const struct csv *csv = &merger->sources[s].csv[file], *measured = &merger->sources[s].csv[MEASUREMENTS];
        for (int row = 0; row < csv->row_count && merger->sources[s].kind == kind && status == STATUS_OK; row++) {
            const int keys = files[file].keys ? files[file].keys : csv->column_count;
            const struct row one = {csv, row, key_hash(csv, row, keys)};
            if (!files[file].needs || is_measured(measured, csv, row))
                status = row_add(rows, &one, keys);
        }
    }
    return status;
}

/* The comments of all folders: the first's, and the scenes that others add. */
static void comments_write(const struct merger *merger, int kind, int file, FILE *stream)
{
    for (int s = 0; s < merger->count; s++) {
        const struct csv *csv = &merger->sources[s].csv[file];
        for (int k = 0; k < csv->comment_count && merger->sources[s].kind == kind; k++) {
            bool written = false;
            for (int t = 0; t < s && !written; t++)
                written =
                    merger->sources[t].kind == kind && comment_like(&merger->sources[t].csv[file], csv->comments[k]);
            if (!written)
                fprintf(stream, "# %s\n", csv->comments[k]);
        }
    }
}

static enum status file_write(const struct merger *merger, int kind, int file, const char *directory,
                              const struct rows *rows)
{
    const struct csv *first = NULL;
    struct text_file text;
    for (int s = merger->count - 1; s >= 0; s--)
        if (merger->sources[s].kind == kind && merger->sources[s].csv[file].path)
            first = &merger->sources[s].csv[file];
    if (!first)
        return STATUS_OK;
    const enum status status = text_file_in(directory, files[file].name, &text);
    if (status != STATUS_OK)
        return status;
    comments_write(merger, kind, file, text.stream);
    for (int k = 0; k < first->column_count; k++)
        fprintf(text.stream, "%s%c", first->columns[k], k < first->column_count - 1 ? ',' : '\n');
    for (int n = 0; n < rows->count; n++)
        for (int k = 0; k < first->column_count; k++) {
            csv_write_text(text.stream, csv_cell(rows->list[n].csv, rows->list[n].row, k));
            fputc(k < first->column_count - 1 ? ',' : '\n', text.stream);
        }
    return text_file_close(&text, STATUS_OK);
}

/* ---- folders ---- */

/* `written`: else only whether all rows agree is found. */
static enum status kind_merge(const struct merger *merger, int kind, bool written, struct merged *merged)
{
    enum status status = STATUS_OK;
    merged->cells = merged->folders = 0;
    for (int s = 0; s < merger->given; s++)
        merged->folders += merger->sources[s].kind == kind;
    for (int f = 0; f < FILES && status == STATUS_OK; f++) {
        struct rows rows;
        status = rows_unite(merger, kind, f, &rows);
        if (status == STATUS_OK && written)
            status = file_write(merger, kind, f, merged->directory, &rows);
        merged->cells += f == MEASUREMENTS || f == STABILITY ? rows.count : 0;
        free(rows.list);
    }
    return status;
}

static enum status kinds_merge(const struct merger *merger, int kinds, bool written,
                               struct merged merged[KINDS_OF_MACHINES])
{
    enum status status = STATUS_OK;
    for (int f = 0; f < FILES && status == STATUS_OK; f++)
        status = heads_check(merger, f);
    for (int k = 0; k < kinds && status == STATUS_OK; k++)
        status = kind_merge(merger, k, written, &merged[k]);
    return status;
}

/* Number the kinds of machine by their first folders. */
static enum status kinds_find(struct merger *merger, struct merged merged[KINDS_OF_MACHINES], int *count)
{
    for (int s = 0; s < merger->count; s++) {
        struct source *source = &merger->sources[s];
        int same = 0;
        while (same < s && !same_kind(source, &merger->sources[same]))
            same++;
        source->kind = same < s ? merger->sources[same].kind : *count;
        if (same < s)
            continue;
        if (*count == KINDS_OF_MACHINES)
            return status_set(STATUS_INVALID, "%s: of more than %d kinds of machines", source->directory, *count);
        snprintf(merged[*count].machine, sizeof merged[*count].machine, "%s, %s", comment_of(source, "machine"),
                 comment_of(source, "isa"));
        ++*count;
    }
    return STATUS_OK;
}

/* The place of a kind's rows: what it has is kept. */
static enum status place_take(struct merger *merger, int kind, const char *directory)
{
    struct source *place = &merger->sources[merger->count];
    const struct source *first = merger->sources;
    while (first->kind != kind)
        first++;
    for (int s = 0; s < merger->count; s++)
        if (strcmp(merger->sources[s].directory, directory) == 0)
            return STATUS_OK;
    enum status status = directory_make(directory);
    if (status != STATUS_OK)
        return status;
    merger->count++;
    status = source_read(directory, place);
    place->kind = kind;
    if (status == STATUS_OK && source_holds(place) && !same_kind(place, first))
        status = status_set(STATUS_INVALID, "%s: holds rows of '%s', must be empty or of '%s'; name another folder",
                            directory, comment_of(place, "machine"), comment_of(first, "machine"));
    return status;
}

enum status results_merge(int count, const char *const *folders, const char *directory,
                          struct merged merged[KINDS_OF_MACHINES], int *merged_count)
{
    struct merger merger = {calloc((size_t)count + KINDS_OF_MACHINES, sizeof *merger.sources), 0, count};
    enum status status = merger.sources ? STATUS_OK : status_set(STATUS_FAILED, "no memory for %d folders", count);
    *merged_count = 0;
    for (int s = 0; s < count && status == STATUS_OK; s++) {
        struct source *source = &merger.sources[merger.count++];
        status = source_read(folders[s], source);
        if (status == STATUS_OK && !source_holds(source))
            status = status_set(STATUS_INVALID,
                                "%s: has neither measurements.csv nor stability.csv; a results folder is needed",
                                folders[s]);
    }
    if (status == STATUS_OK)
        status = kinds_find(&merger, merged, merged_count);
    const int kinds = status == STATUS_OK ? *merged_count : 0;
    if (status == STATUS_OK) /* before a folder is made */
        status = kinds_merge(&merger, kinds, false, merged);
    for (int k = 0; k < kinds && status == STATUS_OK; k++) {
        snprintf(merged[k].directory, sizeof merged[k].directory, kinds > 1 ? "%s/%d" : "%s", directory, k + 1);
        status = place_take(&merger, k, merged[k].directory);
    }
    for (int written = 0; written < 2 && status == STATUS_OK; written++)
        status = kinds_merge(&merger, kinds, written, merged);
    merger_free(&merger);
    return status;
}
