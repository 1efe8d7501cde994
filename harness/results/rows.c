/* Header and rows of results on disk (rows.h). */
#include "results/rows.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "text/number.h"

const struct row_kind row_kinds[KINDS] = {
    {"measurements.csv", "sasbench measurements 1", measurement_columns},
    {"targets.csv", "sasbench targets 1", target_columns},
};

static const struct {
    const char *key;
    size_t offset;
    bool compared; /* rows with different values are not mixed */
} notes[] = {
    {"machine", offsetof(struct provenance, machine), true},
    {"isa", offsetof(struct provenance, isa), true},
    {"compiler", offsetof(struct provenance, compiler), false}, /* the hash of the program covers it */
    {"flags", offsetof(struct provenance, flags), false},
    {"libraries", offsetof(struct provenance, libraries), true},
    {"commit", offsetof(struct provenance, commit), true},
    {"program", offsetof(struct provenance, program), true},
    {"date", offsetof(struct provenance, date), false},
};

/* --- Writing ------------------------------------------------------------------------------------------------- */

void row_write(FILE *file, const struct column *columns, const void *row)
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

/* A comment is one line, whatever characters a name contains. */
static void comment_write(FILE *file, const char *key, const char *name, const char *value)
{
    const char *parts[] = {"# ", key, *name ? " " : "", name, ": ", value};
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        for (const char *at = parts[k]; *at; at++)
            fputc((unsigned char)*at < ' ' ? '?' : *at, file);
    fputc('\n', file);
}

void provenance_write(FILE *file, const struct provenance *provenance)
{
    for (size_t k = 0; k < sizeof notes / sizeof *notes; k++)
        comment_write(file, notes[k].key, "", (const char *)provenance + notes[k].offset);
}

void head_write(FILE *file, const struct row_kind *kind, const struct provenance *provenance, const char *note,
                const struct content *contents, int content_count)
{
    fprintf(file, "# %s\n", kind->format);
    if (provenance) {
        provenance_write(file, provenance);
        fprintf(file, "# threads: %d\n", provenance->threads);
    } else {
        fprintf(file, "# %s\n", note);
    }
    for (int k = 0; k < content_count; k++)
        comment_write(file, contents[k].kind, contents[k].name, contents[k].text);
    for (const struct column *column = kind->columns; column->name; column++)
        fprintf(file, "%s%s", column == kind->columns ? "" : ",", column->name);
    fputc('\n', file);
}

/* --- Reading ------------------------------------------------------------------------------------------------- */

bool kind_is(const struct csv *csv, const struct row_kind *kind)
{
    return csv->comment_count > 0 && strcmp(csv->comments[0], kind->format) == 0;
}

enum status header_check(const struct csv *csv, const struct row_kind *kind)
{
    int count = 0;
    while (kind->columns[count].name)
        count++;
    if (csv->column_count == 0)
        return status_set(STATUS_INVALID, "%s: no line names the columns; %d names from '%s' on are needed", csv->path,
                          count, kind->columns[0].name);
    for (int k = 0; k < count; k++) {
        const bool missing = k >= csv->column_count;
        if (missing && k >= KEY_COLUMNS) /* of a program that had fewer */
            return STATUS_OK;
        char found[64] = "missing";
        if (!missing)
            snprintf(found, sizeof found, "'%.60s'", csv->columns[k]);
        if (missing || strcmp(kind->columns[k].name, csv->columns[k]) != 0)
            return status_set(STATUS_INVALID, "%s: column %d is %s; '%s' is needed", csv->path, k + 1, found,
                              kind->columns[k].name);
    }
    if (csv->column_count > count)
        return status_set(STATUS_INVALID, "%s: column %d is '%.60s'; %d columns are needed", csv->path, count + 1,
                          csv->columns[count], count);
    return STATUS_OK;
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
    if (!*cell)
        column_clear(column, out);
    else if (integer)
        *(int *)field = (int)value;
    else
        *(double *)field = value;
    return STATUS_OK;
}

enum status row_parse(const struct csv *csv, int row, const struct row_kind *kind, void *out)
{
    enum status status = STATUS_OK;
    for (int k = 0; kind->columns[k].name && status == STATUS_OK; k++)
        if (k < csv->column_count)
            status = cell_parse(csv, row, k, &kind->columns[k], out);
        else
            column_clear(&kind->columns[k], out);
    return status;
}

void provenance_differs(const struct csv *csv, const struct provenance *provenance, char *text, size_t size)
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
