/* The results folder: two CSV files that are appended to row by row and taken up again after a cut. */
#include "measure/results.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/folder.h"
#include "data/shown_text.h"
#include "data/text_file.h"

/* The braces are an initializer's. */
/* clang-format off */
#define METRIC(struct_name, name, unit, title, better, class, of_float, of_double, relative) \
    {#name, unit, title, better, class, {of_float, of_double}, relative, offsetof(struct struct_name, name)}
/* clang-format on */
#define M_METRIC(...) METRIC(measurement, __VA_ARGS__)
#define T_METRIC(...) METRIC(target_row, __VA_ARGS__)

/* Slacks of quality are about a hundred times what compilers and instruction sets make of the same source: rounding, 1e-8
   of an error (results/README.md). Work is exact. Two runs at different times can only tell a factor in time;
   `compare --ab` tells per cents. */
const struct metric metrics[] = {
    M_METRIC(run_s, "s", "Run time", BETTER_LOWER, CLASS_TIME, 0, 0, 1),
    M_METRIC(flops_published, "FLOP", "Operations by the paper's formula", BETTER_NONE, CLASS_WORK, 0, 0, 0),
    M_METRIC(flops, "FLOP", "Operations", BETTER_LOWER, CLASS_WORK, 0, 0, 0),
    M_METRIC(pairs, "pairs", "Pixel-pulse pairs", BETTER_NONE, CLASS_WORK, 0, 0, 0),
    M_METRIC(bytes, "B", "Memory of the plan", BETTER_LOWER, CLASS_WORK, 0, 0, 0),
    M_METRIC(error, "1", "Error", BETTER_LOWER, CLASS_QUALITY, 2e-6, 1e-9, 1e-3),
    M_METRIC(error_gain, "1", "Error after one gain", BETTER_LOWER, CLASS_QUALITY, 2e-6, 1e-9, 1e-3),
    M_METRIC(phase_rms_rad, "rad", "Phase error, rms", BETTER_LOWER, CLASS_QUALITY, 2e-6, 1e-9, 1e-3),
    M_METRIC(width_m, "m", "-3 dB width", BETTER_LOWER, CLASS_QUALITY, 0, 0, 1e-4),
    M_METRIC(pslr_db, "dB", "PSLR", BETTER_LOWER, CLASS_QUALITY, 2e-3, 2e-3, 0),
    M_METRIC(islr_db, "dB", "ISLR", BETTER_LOWER, CLASS_QUALITY, 2e-3, 2e-3, 0),
    {.name = NULL},
};

const struct metric target_metrics[] = {
    T_METRIC(extent_m, "m", "Reach of the slice", BETTER_NONE, CLASS_QUALITY, 0, 0, 1e-6),
    T_METRIC(position_error_m, "m", "Position error", BETTER_SMALL, CLASS_QUALITY, 1e-6, 1e-6, 0),
    T_METRIC(phase_error_rad, "rad", "Phase error at the target", BETTER_SMALL, CLASS_QUALITY, 1e-5, 1e-7, 0),
    T_METRIC(width_m, "m", "-3 dB width", BETTER_LOWER, CLASS_QUALITY, 0, 0, 1e-4),
    T_METRIC(pslr_db, "dB", "PSLR", BETTER_LOWER, CLASS_QUALITY, 2e-3, 2e-3, 0),
    T_METRIC(islr_db, "dB", "ISLR", BETTER_LOWER, CLASS_QUALITY, 2e-3, 2e-3, 0),
    {.name = NULL},
};

/* One column: where the value lies in the row's struct. Header, writer and reader all come from these tables. */
struct column {
    const char *name; /* NULL ends the table */
    enum { COLUMN_TEXT, COLUMN_INTEGER, COLUMN_REAL } type;
    size_t offset;
};

/* The braces are an initializer's. */
/* clang-format off */
#define M_TEXT(name) {#name, COLUMN_TEXT, offsetof(struct measurement, name)}
#define M_INTEGER(name) {#name, COLUMN_INTEGER, offsetof(struct measurement, name)}
#define M_REAL(name) {#name, COLUMN_REAL, offsetof(struct measurement, name)}
#define T_TEXT(name) {#name, COLUMN_TEXT, offsetof(struct target_row, name)}
#define T_INTEGER(name) {#name, COLUMN_INTEGER, offsetof(struct target_row, name)}
#define T_REAL(name) {#name, COLUMN_REAL, offsetof(struct target_row, name)}
/* clang-format on */

/* Both tables begin with the columns that tell one measurement from another. */
#define KEY_COLUMNS 4

static const struct column measurement_columns[] = {
    M_TEXT(scene),           M_TEXT(algorithm),     M_TEXT(options), M_TEXT(precision), M_INTEGER(threads),
    M_TEXT(engine),          M_TEXT(status),        M_TEXT(reason),  M_TEXT(skipped),   M_REAL(plan_s),
    M_REAL(run_s),           M_REAL(run_min_s),     M_INTEGER(runs), M_REAL(control_s), M_TEXT(stages),
    M_REAL(flops_published), M_REAL(flops),         M_REAL(pairs),   M_REAL(bytes),     M_REAL(error),
    M_REAL(error_gain),      M_REAL(phase_rms_rad), M_REAL(width_m), M_REAL(pslr_db),   M_REAL(islr_db),
    {.name = NULL},
};

static const struct column target_columns[] = {
    T_TEXT(scene),   T_TEXT(algorithm),  T_TEXT(options),  T_TEXT(precision),        T_INTEGER(target),
    T_TEXT(axis),    T_TEXT(definition), T_REAL(extent_m), T_REAL(position_error_m), T_REAL(phase_error_rad),
    T_REAL(width_m), T_REAL(pslr_db),    T_REAL(islr_db),  {.name = NULL},
};

enum { SHEET_MEASUREMENTS, SHEET_TARGETS, SHEETS };

static const struct sheet {
    const char *file, *format; /* the format is the first line: by it we know a file as ours */
    const struct column *columns;
} sheets[SHEETS] = {
    {"measurements.csv", "sasbench measurements 1", measurement_columns},
    {"targets.csv", "sasbench targets 1", target_columns},
};

static const struct {
    const char *key;
    size_t offset;
    bool compared; /* rows of different values are not mixed */
} notes[] = {
    {"machine", offsetof(struct provenance, machine), true},
    {"isa", offsetof(struct provenance, isa), true},
    {"compiler", offsetof(struct provenance, compiler), false}, /* the program's bytes tell */
    {"flags", offsetof(struct provenance, flags), false},
    {"libraries", offsetof(struct provenance, libraries), true},
    {"commit", offsetof(struct provenance, commit), true},
    {"program", offsetof(struct provenance, program), true},
    {"date", offsetof(struct provenance, date), false},
};

/* What tells one measurement from another; an algorithm of NULL stands for all of the scene. */
struct key {
    const char *scene, *algorithm, *options, *precision;
};

struct record {
    int lock; /* of the folder */
    struct provenance provenance;
    char *prefix, *paths[SHEETS]; /* "FOLDER/", and the files in it */
    FILE *files[SHEETS];          /* open for appending */
    struct scene_hash *scenes;    /* content of every scene that has rows */
    int scene_count;
    struct csv earlier;       /* measurements.csv as the earlier run left it; rows point into it */
    struct measurement *rows; /* [earlier.row_count] */
    bool *dropped;            /* [earlier.row_count] the scene's content has changed since, or it is replaced */
};

/* --- Writing ------------------------------------------------------------------------------------------------- */

static void row_write(FILE *file, const struct column *columns, const void *row)
{
    for (const struct column *column = columns; column->name; column++) {
        const void *field = (const char *)row + column->offset;
        if (column != columns)
            fputc(',', file);
        if (column->type == COLUMN_TEXT)
            csv_write_text(file, *(const char *const *)field);
        else if (column->type == COLUMN_REAL)
            csv_write_number(file, *(const double *)field);
        else if (*(const int *)field >= 0)
            fprintf(file, "%d", *(const int *)field);
    }
    fputc('\n', file);
}

/* A comment is one line, whatever a name holds. */
static void comment_write(FILE *file, const char *key, const char *name, const char *value)
{
    const char *parts[] = {"# ", key, name, ": ", value};
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        for (const char *at = parts[k]; *at; at++)
            fputc((unsigned char)*at < ' ' ? '?' : *at, file);
    fputc('\n', file);
}

/* The lines ahead of the rows; without a provenance, `note` stands in its place. */
static void head_write(FILE *file, const struct sheet *sheet, const struct provenance *provenance, const char *note,
                       const struct scene_hash *scenes, int scene_count)
{
    fprintf(file, "# %s\n", sheet->format);
    for (size_t k = 0; provenance && k < sizeof notes / sizeof *notes; k++)
        comment_write(file, notes[k].key, "", (const char *)provenance + notes[k].offset);
    if (provenance)
        fprintf(file, "# threads: %d\n", provenance->threads);
    else
        fprintf(file, "# %s\n", note);
    for (int k = 0; k < scene_count; k++) {
        char hash[17];
        snprintf(hash, sizeof hash, "%016" PRIx64, scenes[k].hash);
        comment_write(file, "scene ", scenes[k].scene, hash);
    }
    for (const struct column *column = sheet->columns; column->name; column++)
        fprintf(file, "%s%s", column == sheet->columns ? "" : ",", column->name);
    fputc('\n', file);
}

static enum status flush_check(FILE *file, const char *path)
{
    if (fflush(file) != 0 || ferror(file))
        return status_set(STATUS_FAILED, "%s: cannot be written: %s", path, strerror(errno));
    return STATUS_OK;
}

static char *text_join(const char *a, const char *b)
{
    size_t size = strlen(a) + strlen(b) + 1;
    char *joined = malloc(size);
    if (joined)
        snprintf(joined, size, "%s%s", a, b);
    return joined;
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

static bool key_matches(const struct key *key, const char *scene, const char *algorithm, const char *options,
                        const char *precision)
{
    return strcmp(key->scene, scene) == 0
           && (!key->algorithm
               || (strcmp(key->algorithm, algorithm) == 0 && strcmp(key->options, options) == 0
                   && strcmp(key->precision, precision) == 0));
}

/* One file anew from the rows of `old`, without those of `except` (NULL: of none) and without rows of targets whose
   measurement is missing, made beside the old file and renamed when whole. */
static enum status sheet_write(const struct record *record, int sheet, const struct csv old[SHEETS],
                               const struct key *except)
{
    struct text_file text;
    enum status status = text_file_open(record->paths[sheet], &text);
    if (status != STATUS_OK)
        return status;
    FILE *file = text.stream;
    head_write(file, &sheets[sheet], &record->provenance, NULL, record->scenes, record->scene_count);
    for (int row = 0; row < old[sheet].row_count; row++) {
        if (except
            && key_matches(except, csv_cell(&old[sheet], row, 0), csv_cell(&old[sheet], row, 1),
                           csv_cell(&old[sheet], row, 2), csv_cell(&old[sheet], row, 3)))
            continue;
        if (!measurement_present(&old[SHEET_MEASUREMENTS], &old[sheet], row))
            continue;
        for (int k = 0; k < old[sheet].column_count; k++) {
            if (k)
                fputc(',', file);
            csv_write_text(file, csv_cell(&old[sheet], row, k));
        }
        fputc('\n', file);
    }
    return text_file_close(&text, STATUS_OK);
}

/* Both files anew. The measurements come first: a cut between the two leaves targets without a measurement, which the
   next run drops. */
static enum status record_rewrite(struct record *record, const struct csv old[SHEETS], const struct key *except)
{
    for (int k = 0; k < SHEETS; k++) {
        if (record->files[k])
            fclose(record->files[k]);
        record->files[k] = NULL;
        enum status status = sheet_write(record, k, old, except);
        if (status)
            return status;
        record->files[k] = fopen(record->paths[k], "a");
        if (!record->files[k])
            return status_set(STATUS_INVALID, "%s: cannot be written: %s", record->paths[k], strerror(errno));
    }
    return STATUS_OK;
}

/* --- Taking up an earlier run -------------------------------------------------------------------------------- */

static struct scene_hash *scene_hash_find(const struct record *record, const char *scene)
{
    for (int k = 0; k < record->scene_count; k++)
        if (strcmp(record->scenes[k].scene, scene) == 0)
            return &record->scenes[k];
    return NULL;
}

static enum status scene_hash_set(struct record *record, const char *scene, uint64_t hash)
{
    struct scene_hash *known = scene_hash_find(record, scene);
    if (known) {
        known->hash = hash;
        return STATUS_OK;
    }
    struct scene_hash *scenes = realloc(record->scenes, ((size_t)record->scene_count + 1) * sizeof *scenes);
    char *name = strdup(scene);
    if (scenes)
        record->scenes = scenes;
    if (!scenes || !name) {
        free(name);
        return status_set(STATUS_FAILED, "no memory for the scene %s", scene);
    }
    scenes[record->scene_count++] = (struct scene_hash){name, hash};
    return STATUS_OK;
}

/* The comments "scene NAME: HEX"; what does not read as one is no hash, and the scene's rows are measured again. */
static enum status scene_hashes_read(struct record *record, const struct csv *csv)
{
    enum status status = STATUS_OK;
    for (int k = 0; k < csv->comment_count && !status; k++) {
        char *name = strdup(csv->comments[k]), *value = name ? strrchr(name, ':') : NULL, *end = NULL;
        if (!name)
            return status_set(STATUS_FAILED, "%s: no memory", csv->path);
        if (value && strncmp(name, "scene ", strlen("scene ")) == 0) {
            *value++ = '\0';
            uint64_t hash = strtoull(value, &end, 16);
            if (end != value && !*end)
                status = scene_hash_set(record, name + strlen("scene "), hash);
        }
        free(name);
    }
    return status;
}

static enum status cell_parse(const struct csv *csv, int row, int index, const struct column *column, void *out)
{
    const char *cell = csv_cell(csv, row, index);
    void *field = (char *)out + column->offset;
    double value = NAN;
    bool integer = column->type == COLUMN_INTEGER;
    if (column->type == COLUMN_TEXT) {
        *(const char **)field = cell;
        return STATUS_OK;
    }
    if (!csv_number(cell, &value) || (integer && *cell && !(value >= 0 && value <= 1e9 && value == floor(value))))
        return status_set(STATUS_INVALID, "%s:%d: %s is '%s'; %s or nothing is needed", csv->path, csv->lines[row],
                          column->name, cell, integer ? "a whole number" : "a number");
    if (integer)
        *(int *)field = *cell ? (int)value : -1;
    else
        *(double *)field = value;
    return STATUS_OK;
}

/* Read one file of an earlier run, if there is one. Errors: STATUS_INVALID when it is not ours. */
static enum status sheet_read(const char *path, const struct sheet *sheet, struct csv *csv)
{
    struct stat info;
    *csv = (struct csv){0};
    if (lstat(path, &info) != 0 && errno == ENOENT)
        return STATUS_OK;
    enum status status = csv_read(path, CSV_TAIL_DROP, csv);
    if (status)
        return status;
    if (csv->comment_count > 0 && strcmp(csv->comments[0], sheet->format) == 0)
        return STATUS_OK;
    csv_free(csv);
    return status_set(STATUS_INVALID,
                      "%s:1: not a file of ours, whose first line is '# %s'; it is left as it is, "
                      "name another folder",
                      path, sheet->format);
}

/* Why rows of `csv` are not gone on with: text is empty when they are. */
static void other_run(const struct csv *csv, const struct provenance *provenance, char *text, size_t size)
{
    const char *threads = csv_comment(csv, "threads");
    *text = '\0';
    for (size_t k = 0; k < sizeof notes / sizeof *notes && !*text; k++) {
        const char *then = csv_comment(csv, notes[k].key), *now = (const char *)provenance + notes[k].offset;
        if (notes[k].compared && (!then || strcmp(then, now) != 0))
            snprintf(text, size, "measured with %s '%.120s', now with '%.120s'", notes[k].key, then ? then : "unknown",
                     now);
    }
    if (!*text && (!threads || strtol(threads, NULL, 10) != provenance->threads))
        snprintf(text, size, "measured with threads '%.20s', now with '%d'", threads ? threads : "unknown",
                 provenance->threads);
}

static enum status header_check(const struct csv *csv, const struct sheet *sheet)
{
    int count = 0;
    while (sheet->columns[count].name)
        count++;
    for (int k = 0; k < count || k < csv->column_count; k++) {
        const char *needed = k < count ? sheet->columns[k].name : "no more";
        const char *found = k < csv->column_count ? csv->columns[k] : "missing";
        if (strcmp(needed, found) != 0)
            return status_set(STATUS_INVALID,
                              "%s: the header line names '%.60s' as column %d; '%s' is needed (another "
                              "version?)",
                              csv->path, found, k + 1, needed);
    }
    return STATUS_OK;
}

static enum status rows_parse(struct record *record)
{
    const struct csv *csv = &record->earlier;
    if (csv->row_count == 0)
        return STATUS_OK;
    record->rows = calloc((size_t)csv->row_count, sizeof *record->rows);
    record->dropped = calloc((size_t)csv->row_count, sizeof *record->dropped);
    enum status status = STATUS_OK;
    if (!record->rows || !record->dropped)
        status = status_set(STATUS_FAILED, "%s: no memory for %d rows", csv->path, csv->row_count);
    for (int row = 0; row < csv->row_count; row++)
        for (int k = 0; !status && measurement_columns[k].name; k++)
            status = cell_parse(csv, row, k, &measurement_columns[k], &record->rows[row]);
    return status;
}

/* "measurements.3.csv" */
static void kept_name(int sheet, int number, char *name, size_t size)
{
    snprintf(name, size, "%.*s.%d.csv", (int)strcspn(sheets[sheet].file, "."), sheets[sheet].file, number);
}

/* Under another name; the file stays where it is until it is replaced, except where a file system knows no links. */
static enum status file_keep(const char *path, const char *kept)
{
    struct stat info;
    if (lstat(path, &info) != 0 || link(path, kept) == 0 || rename(path, kept) == 0)
        return STATUS_OK;
    return status_set(STATUS_INVALID, "%s: cannot be kept as %s: %s; name another folder", path, kept, strerror(errno));
}

/* Keep the files under the next free number before they are begun anew, and tell why. */
static enum status files_keep(const struct record *record, const char *why)
{
    char names[SHEETS][64], told[SHEETS * 64] = "";
    enum status status = STATUS_OK;
    bool taken = true;
    for (int number = 1; taken && !status; number++) {
        taken = false;
        for (int k = 0; k < SHEETS && !status; k++) {
            struct stat info;
            kept_name(k, number, names[k], sizeof names[k]);
            char *kept = text_join(record->prefix, names[k]);
            taken |= kept && lstat(kept, &info) == 0;
            status = kept ? STATUS_OK : status_set(STATUS_FAILED, "%s: no memory", names[k]);
            free(kept);
        }
    }
    for (int k = 0; k < SHEETS && !status; k++) {
        char *kept = text_join(record->prefix, names[k]);
        status = kept ? file_keep(record->paths[k], kept) : status_set(STATUS_FAILED, "%s: no memory", names[k]);
        if (!status && access(kept, F_OK) == 0)
            snprintf(told + strlen(told), sizeof told - strlen(told), "%s%s", *told ? " and " : "", names[k]);
        free(kept);
    }
    if (!status) {
        fprintf(stderr, "sasbench: %s: ", record->paths[SHEET_MEASUREMENTS]);
        shown_write(stderr, why); /* it quotes the file */
        fprintf(stderr, "; the old rows are kept in %s\n", told);
    }
    return status;
}

/* Why the rows of the folder cannot be gone on with; empty when they can, or when there are none. */
static void resume_refusal(const struct record *record, const struct csv old[SHEETS], char *why, size_t size)
{
    *why = '\0';
    for (int k = 0; k < SHEETS && !*why; k++)
        if (!old[k].path && old[SHEETS - 1 - k].row_count > 0)
            snprintf(why, size, "%s is missing", sheets[k].file);
    for (int k = 0; k < SHEETS && !*why; k++)
        if (old[k].row_count > 0)
            other_run(&old[k], &record->provenance, why, size);
}

static enum status record_begin(struct record *record, const char *directory)
{
    struct csv old[SHEETS] = {0};
    char why[400] = "";
    enum status status = directory_make(directory);
    if (!status)
        status = folder_take(directory, &record->lock);
    if (!status && !(record->prefix = text_join(directory, "/")))
        status = status_set(STATUS_FAILED, "%s: no memory", directory);
    for (int k = 0; k < SHEETS && !status; k++) {
        record->paths[k] = text_join(record->prefix, sheets[k].file);
        status = record->paths[k] ? sheet_read(record->paths[k], &sheets[k], &old[k])
                                  : status_set(STATUS_FAILED, "%s: no memory", directory);
    }
    if (!status)
        resume_refusal(record, old, why, sizeof why);
    for (int k = 0; k < SHEETS && !status; k++) {
        char other[400] = "";
        if (old[k].path)
            other_run(&old[k], &record->provenance, other, sizeof other);
        if (*why || *other)
            csv_free(&old[k]);
        else if (old[k].path)
            status = header_check(&old[k], &sheets[k]);
    }
    /* All of it is read before anything is written, so that a file with a fault is left as it is. */
    record->earlier = old[SHEET_MEASUREMENTS];
    if (!status)
        status = scene_hashes_read(record, &record->earlier);
    if (!status)
        status = rows_parse(record);
    if (!status && *why)
        status = files_keep(record, why);
    if (!status)
        status = record_rewrite(record, old, NULL);
    csv_free(&old[SHEET_TARGETS]);
    return status;
}

enum status record_open(const char *directory, const struct provenance *provenance, struct record **record)
{
    *record = calloc(1, sizeof **record);
    if (!*record)
        return status_set(STATUS_FAILED, "%s: no memory", directory);
    (*record)->provenance = *provenance;
    (*record)->lock = -1;
    enum status status = record_begin(*record, directory);
    if (status) {
        record_close(*record);
        *record = NULL;
    }
    return status;
}

/* Both files without the rows of `key`. */
static enum status rows_drop(struct record *record, const struct key *key)
{
    struct csv now[SHEETS] = {0};
    enum status status = STATUS_OK;
    for (int row = 0; row < record->earlier.row_count; row++) {
        const struct measurement *found = &record->rows[row];
        record->dropped[row] |= key_matches(key, found->scene, found->algorithm, found->options, found->precision);
    }
    for (int k = 0; k < SHEETS && !status; k++) {
        status = csv_read(record->paths[k], CSV_TAIL_DROP, &now[k]);
        if (!status)
            status = header_check(&now[k], &sheets[k]);
    }
    if (!status)
        status = record_rewrite(record, now, key);
    for (int k = 0; k < SHEETS; k++)
        csv_free(&now[k]);
    return status;
}

static int earlier_find(const struct record *record, const struct key *key)
{
    for (int row = 0; row < record->earlier.row_count; row++) {
        const struct measurement *found = &record->rows[row];
        if (!record->dropped[row] && key_matches(key, found->scene, found->algorithm, found->options, found->precision))
            return row;
    }
    return -1;
}

enum status record_scene(struct record *record, const char *scene, uint64_t hash)
{
    const struct key key = {.scene = scene};
    struct scene_hash *known = scene_hash_find(record, scene);
    enum status status = STATUS_OK;
    if (known && known->hash == hash)
        return STATUS_OK;
    if (earlier_find(record, &key) >= 0) {
        char why[400];
        snprintf(why, sizeof why, "the scene %.300s has changed", scene);
        status = files_keep(record, why);
    }
    if (!status)
        status = scene_hash_set(record, scene, hash);
    return status ? status : rows_drop(record, &key);
}

const struct measurement *record_find(const struct record *record, const char *scene, const char *algorithm,
                                      const char *options, const char *precision)
{
    int row = earlier_find(record, &(struct key){scene, algorithm, options, precision});
    return row >= 0 && strcmp(record->rows[row].status, "failed") != 0 ? &record->rows[row] : NULL;
}

/* A row that an earlier run left gives way to a new one. */
static enum status earlier_replace(struct record *record, const struct key *key)
{
    return earlier_find(record, key) < 0 ? STATUS_OK : rows_drop(record, key);
}

static enum status rows_append(struct record *record, int sheet, const void *rows, int count, size_t row_size)
{
    FILE *file = record->files[sheet];
    if (!file)
        return status_set(STATUS_FAILED, "%s: no row can be added, since the file could not be rewritten before",
                          record->paths[sheet]);
    for (int k = 0; k < count; k++)
        row_write(file, sheets[sheet].columns, (const char *)rows + (size_t)k * row_size);
    return flush_check(file, record->paths[sheet]);
}

enum status record_targets(struct record *record, const struct target_row *rows, int count)
{
    enum status status = STATUS_OK;
    for (int k = 0; k < count && !status; k++)
        status = earlier_replace(record,
                                 &(struct key){rows[k].scene, rows[k].algorithm, rows[k].options, rows[k].precision});
    return status ? status : rows_append(record, SHEET_TARGETS, rows, count, sizeof *rows);
}

enum status record_add(struct record *record, const struct measurement *row)
{
    enum status status =
        earlier_replace(record, &(struct key){row->scene, row->algorithm, row->options, row->precision});
    return status ? status : rows_append(record, SHEET_MEASUREMENTS, row, 1, sizeof *row);
}

void record_close(struct record *record)
{
    if (!record)
        return;
    for (int k = 0; k < SHEETS; k++) {
        if (record->files[k])
            fclose(record->files[k]);
        free(record->paths[k]);
    }
    for (int k = 0; k < record->scene_count; k++)
        free(record->scenes[k].scene);
    free(record->scenes);
    free(record->rows);
    free(record->dropped);
    free(record->prefix);
    csv_free(&record->earlier);
    folder_leave(record->lock);
    free(record);
}

/* --- Finished files ------------------------------------------------------------------------------------------ */

static enum status measurement_check(const struct csv *csv, int row, const struct measurement *measurement)
{
    static const char *const known[] = {"ok", "unsupported", "failed"};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strcmp(measurement->status, known[k]) == 0)
            return STATUS_OK;
    return status_set(STATUS_INVALID, "%s:%d: status is '%s'; ok, unsupported or failed is needed", csv->path,
                      csv->lines[row], measurement->status);
}

static enum status results_parse(struct results *results, const struct sheet *sheet)
{
    const struct csv *csv = &results->csv;
    size_t count = (size_t)csv->row_count + 1,
           size = results->targets ? sizeof *results->target_rows : sizeof *results->measurements;
    char *rows = calloc(count, size);
    if (!rows)
        return status_set(STATUS_FAILED, "%s: no memory for %d rows", csv->path, csv->row_count);
    if (results->targets)
        results->target_rows = (struct target_row *)rows;
    else
        results->measurements = (struct measurement *)rows;
    enum status status = STATUS_OK;
    for (int row = 0; row < csv->row_count && !status; row++) {
        void *out = rows + (size_t)row * size;
        for (int k = 0; sheet->columns[k].name && !status; k++) {
            const struct column *column = &sheet->columns[k];
            status = cell_parse(csv, row, k, column, out);
            if (!status && column->type == COLUMN_REAL && *csv_cell(csv, row, k)
                && !isfinite(*(double *)((char *)out + column->offset)))
                status = status_set(STATUS_INVALID, "%s:%d: %s is '%s'; a finite number or nothing is needed",
                                    csv->path, csv->lines[row], column->name, csv_cell(csv, row, k));
        }
        if (!status && !results->targets)
            status = measurement_check(csv, row, out);
    }
    return status;
}

enum status results_read(const char *path, struct results *results)
{
    *results = (struct results){0};
    enum status status = csv_read(path, CSV_TAIL_KEEP, &results->csv);
    if (status)
        return status;
    const char *first = results->csv.comment_count > 0 ? results->csv.comments[0] : "";
    int sheet = 0;
    while (sheet < SHEETS && strcmp(first, sheets[sheet].format) != 0)
        sheet++;
    if (sheet == SHEETS) {
        status = status_set(STATUS_INVALID, "%s:1: the first line is '%s%.60s'; '# %s' or '# %s' is needed", path,
                            *first ? "# " : "", first, sheets[SHEET_MEASUREMENTS].format, sheets[SHEET_TARGETS].format);
    } else {
        results->targets = sheet == SHEET_TARGETS;
        status = header_check(&results->csv, &sheets[sheet]);
    }
    if (!status)
        status = results_parse(results, &sheets[sheet]);
    if (status)
        results_free(results);
    return status;
}

void results_free(struct results *results)
{
    free(results->measurements);
    free(results->target_rows);
    csv_free(&results->csv);
    *results = (struct results){0};
}

enum status measurements_write(const char *path, const char *note, const struct scene_hash *scenes, int scene_count,
                               const struct measurement *rows, int row_count)
{
    struct text_file text;
    enum status status = text_file_open(path, &text);
    if (status)
        return status;
    head_write(text.stream, &sheets[SHEET_MEASUREMENTS], NULL, note, scenes, scene_count);
    for (int k = 0; k < row_count; k++)
        row_write(text.stream, measurement_columns, &rows[k]);
    return text_file_close(&text, STATUS_OK);
}
