/* CSV files after RFC 4180, without line ends in fields: a reader that holds the whole file in memory, and the writer
   of single fields. */
#include "files/csv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "text/shown_text.h"
#include "files/text_read.h"

static const char byte_order_mark[] = "\xef\xbb\xbf"; /* as spreadsheets write it */

/* Far above what years of runs write; a bound, so that a wrong path cannot fill the memory. */
#define SIZE_MAX_BYTES ((size_t)256 << 20)

/* Make room for one more element in an array that grows by doubling; `array` is the address of the pointer to it,
   copied bytewise since its type varies. */
static bool array_grow(void *array, int count, size_t element_size)
{
    if (count & (count - 1))
        return true;
    void *elements;
    memcpy(&elements, array, sizeof elements);
    elements = realloc(elements, (count ? 2 * (size_t)count : 1) * element_size);
    if (elements)
        memcpy(array, &elements, sizeof elements);
    return elements;
}

static enum status file_load(const char *path, char **text)
{
    char reason[TEXT_REASON_SIZE];
    size_t length;
    const enum status status = text_read(path, SIZE_MAX_BYTES, text, &length, reason);
    return status == STATUS_OK ? STATUS_OK : status_set(status, "%s: %s; a readable CSV file is needed", path, reason);
}

/* The parser's state. Fields are unquoted in place: what is written never overtakes what is read. */
struct cursor {
    const char *path;
    char *at;
    int line;
};

/* One field; its text ends where the separator stood, which is returned: ',', '\n', or 0 for the end of the file. */
static enum status field_read(struct cursor *cursor, char **field, char *separator)
{
    char *at = cursor->at, *out = at;
    *field = out;
    if (*at == '"') {
        for (at++; *at != '"' || at[1] == '"'; at++) {
            if (!*at || *at == '\n') {
                *separator = 0;
                return status_set(STATUS_INVALID,
                                  "%s:%d: a quoted field never ends; '\"' is missing before the end of "
                                  "its line",
                                  cursor->path, cursor->line);
            }
            at += *at == '"';
            *out++ = *at;
        }
        at++;
    } else {
        for (; !strchr(",\"\r\n", *at); at++) /* strchr finds the terminating zero, too */
            *out++ = *at;
    }
    if (at[0] == '\r' && at[1] == '\n')
        at++;
    *separator = *at;
    if (*at && *at != ',' && *at != '\n')
        return status_set(STATUS_INVALID,
                          "%s:%d: stray character 0x%02x in a field; ',' or a line end may follow a "
                          "field, and quotes and carriage returns stand in quoted fields only",
                          cursor->path, cursor->line, (unsigned char)*at);
    cursor->line += *at == '\n';
    cursor->at = *at ? at + 1 : at;
    *out = '\0';
    return STATUS_OK;
}

static enum status comment_read(struct cursor *cursor, struct csv *csv)
{
    char *text = cursor->at + 1, *end = text + strcspn(text, "\n");
    text += *text == ' ';
    cursor->at = *end ? end + 1 : end;
    cursor->line += *end == '\n';
    while (end > text && end[-1] == '\r')
        end--;
    *end = '\0';
    if (!array_grow(&csv->comments, csv->comment_count, sizeof *csv->comments))
        return status_set(STATUS_FAILED, "%s: no memory", cursor->path);
    csv->comments[csv->comment_count++] = text;
    return STATUS_OK;
}

/* The header or a row. The cells of all rows lie in one array, which *cell_count measures. */
static enum status row_read(struct cursor *cursor, struct csv *csv, int *cell_count)
{
    int line = cursor->line, count = 0;
    bool header = !csv->columns;
    char separator = ',';
    while (separator == ',') {
        char *field;
        enum status status = field_read(cursor, &field, &separator);
        if (status)
            return status;
        char ***array = header ? &csv->columns : &csv->cells;
        int length = header ? count : *cell_count + count;
        if (!array_grow(array, length, sizeof **array))
            return status_set(STATUS_FAILED, "%s: no memory", cursor->path);
        (*array)[length] = field;
        count++;
    }
    if (header) {
        csv->column_count = count;
        return count > 1 || !strchr(csv->columns[0], ';')
                   ? STATUS_OK
                   : status_set(STATUS_INVALID,
                                "%s:%d: ';' stands between the names of the columns; ',' is needed, and a point in "
                                "numbers",
                                cursor->path, line);
    }
    if (count != csv->column_count)
        return status_set(STATUS_INVALID, "%s:%d: %d fields in the row; the header names %d", cursor->path, line, count,
                          csv->column_count);
    if (!array_grow(&csv->lines, csv->row_count, sizeof *csv->lines))
        return status_set(STATUS_FAILED, "%s: no memory", cursor->path);
    csv->lines[csv->row_count++] = line;
    *cell_count += count;
    return STATUS_OK;
}

/* Texts go to terminals, web pages and gnuplot, where control characters are commands: only line ends are accepted. */
static enum status controls_refuse(const char *path, const char *text)
{
    int line = 1;
    uint32_t code;
    const char *start = text;
    for (const char *at = text; *at; at++) {
        if (*at == '\n') {
            line++;
            start = at + 1;
        } else if (control_length(at, &code) > 0 && !(*at == '\r' && at[1] == '\n')) {
            return status_set(STATUS_INVALID, "%s:%d:%td: control character 0x%02x; text is needed", path, line,
                              at - start + 1, (unsigned)code);
        }
    }
    return STATUS_OK;
}

enum status csv_read(const char *path, enum csv_tail tail, struct csv *csv)
{
    *csv = (struct csv){0};
    enum status status = file_load(path, &csv->text);
    if (!status && !(csv->path = strdup(path)))
        status = status_set(STATUS_FAILED, "%s: no memory", path);
    if (!status && tail == CSV_TAIL_DROP) {
        char *newline = strrchr(csv->text, '\n');
        *(newline ? newline + 1 : csv->text) = '\0';
    }
    struct cursor cursor = {path, csv->text, 1};
    if (!status && strncmp(csv->text, byte_order_mark, strlen(byte_order_mark)) == 0)
        cursor.at += strlen(byte_order_mark);
    if (!status)
        status = controls_refuse(path, cursor.at);
    int cell_count = 0;
    while (!status && *cursor.at) {
        if (*cursor.at == '#') {
            status = comment_read(&cursor, csv);
        } else if (cursor.at[0] == '\n' || (cursor.at[0] == '\r' && cursor.at[1] == '\n')) {
            cursor.at += cursor.at[0] == '\n' ? 1 : 2;
            cursor.line++;
        } else {
            status = row_read(&cursor, csv, &cell_count);
        }
    }
    if (status)
        csv_free(csv);
    return status;
}

void csv_free(struct csv *csv)
{
    free(csv->path);
    free(csv->columns);
    free(csv->cells);
    free(csv->lines);
    free(csv->comments);
    free(csv->text);
    *csv = (struct csv){0};
}

int csv_column(const struct csv *csv, const char *name)
{
    for (int i = 0; i < csv->column_count; i++)
        if (strcmp(csv->columns[i], name) == 0)
            return i;
    return -1;
}

enum status csv_columns(const struct csv *csv, const char *const *names, int *places)
{
    for (int k = 0; names[k]; k++) {
        const int place = csv_column(csv, names[k]);
        if (!places && place != k)
            return status_set(STATUS_INVALID, "%s: column %d must be '%s'", csv->path, k + 1, names[k]);
        if (place < 0)
            return status_set(STATUS_INVALID, "%s: there is no column '%s', which is needed", csv->path, names[k]);
        if (places)
            places[k] = place;
    }
    return STATUS_OK;
}

const char *csv_cell(const struct csv *csv, int row, int column)
{
    return csv->cells[(size_t)row * (size_t)csv->column_count + (size_t)column];
}

const char *csv_comment(const struct csv *csv, const char *key)
{
    size_t length = strlen(key);
    for (int i = 0; i < csv->comment_count; i++)
        if (strncmp(csv->comments[i], key, length) == 0 && strncmp(csv->comments[i] + length, ": ", 2) == 0)
            return csv->comments[i] + length + 2;
    return NULL;
}

bool csv_number(const char *cell, double *value)
{
    *value = NAN;
    if (!*cell)
        return true;
    if (strchr(" \t\r\n\v\f", *cell))
        return false;
    char *end;
    *value = strtod(cell, &end);
    return !*end;
}

void csv_write_text(FILE *file, const char *text)
{
    if (!text)
        return;
    bool quoted = *text == '#' || strpbrk(text, ",\"");
    if (quoted)
        fputc('"', file);
    for (size_t length; *text; text += length > 0 ? length : 1) {
        uint32_t code;
        length = control_length(text, &code);
        if (*text == '"')
            fputc('"', file);
        fputc(length > 0 ? '?' : *text, file);
    }
    if (quoted)
        fputc('"', file);
}

void csv_write_number(FILE *file, double value)
{
    if (!isnan(value))
        fprintf(file, "%.9g", value);
}

void csv_write_fields(FILE *file, const char *const *texts, const double *numbers, int number_count, bool ends)
{
    for (int k = 0; texts[k]; k++) {
        csv_write_text(file, texts[k]);
        fputc(texts[k + 1] || number_count || !ends ? ',' : '\n', file);
    }
    for (int k = 0; k < number_count; k++) {
        csv_write_number(file, numbers[k]);
        fputc(k < number_count - 1 || !ends ? ',' : '\n', file);
    }
}
