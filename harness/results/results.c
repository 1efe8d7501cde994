/* Finished files of results (results.h). */
#include "results/results.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/text_file.h"
#include "results/rows.h"

/* No invalid time may enter a figure. */
static enum status times_check(const struct csv *csv, int row, const struct measurement *measurement)
{
    const struct {
        const char *name;
        double seconds;
    } times[] = {{"run_s", measurement->run_s},
                 {"run_min_s", measurement->run_min_s},
                 {"run_q1_s", measurement->run_q1_s},
                 {"run_q3_s", measurement->run_q3_s},
                 {"control_s", measurement->control_s}};
    for (size_t k = 0; k < sizeof times / sizeof *times; k++)
        if (times[k].seconds <= 0)
            return status_set(STATUS_INVALID, "%s:%d: %s is '%s'; a number > 0 or nothing is needed", csv->path,
                              csv->lines[row], times[k].name, csv_cell(csv, row, csv_column(csv, times[k].name)));
    return STATUS_OK;
}

static enum status measurement_check(const struct csv *csv, int row, const struct measurement *measurement)
{
    static const char *const known[] = {"ok", "unsupported", "failed"};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strcmp(measurement->status, known[k]) == 0)
            return times_check(csv, row, measurement);
    return status_set(STATUS_INVALID, "%s:%d: status is '%s'; ok, unsupported or failed is needed", csv->path,
                      csv->lines[row], measurement->status);
}

static enum status results_parse(struct results *results, const struct row_kind *kind)
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
        status = row_parse(csv, row, kind, out);
        for (int k = 0; k < csv->column_count && !status; k++) {
            const struct column *column = &kind->columns[k];
            if (column->type == COLUMN_REAL && *csv_cell(csv, row, k)
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
    int kind = 0;
    while (kind < KINDS && !kind_is(&results->csv, &row_kinds[kind]))
        kind++;
    if (kind == KINDS) {
        status =
            status_set(STATUS_INVALID, "%s:1: the first line is '%s%.60s'; '# %s' or '# %s' is needed", path,
                       *first ? "# " : "", first, row_kinds[KIND_MEASUREMENTS].format, row_kinds[KIND_TARGETS].format);
    } else {
        results->targets = kind == KIND_TARGETS;
        status = header_check(&results->csv, &row_kinds[kind]);
    }
    if (!status)
        status = results_parse(results, &row_kinds[kind]);
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

struct content content_scene(char *name, uint64_t hash)
{
    struct content content = {"scene", name, ""};
    snprintf(content.text, sizeof content.text, "%016" PRIx64, hash);
    return content;
}

enum status measurements_write(const char *path, const char *note, const struct content *contents, int content_count,
                               const struct measurement *rows, int row_count)
{
    struct text_file text;
    enum status status = text_file_open_named(path, &text);
    if (status)
        return status;
    head_write(text.stream, &row_kinds[KIND_MEASUREMENTS], NULL, note, contents, content_count);
    for (int k = 0; k < row_count; k++)
        row_write(text.stream, row_kinds[KIND_MEASUREMENTS].columns, &rows[k]);
    return text_file_close(&text, STATUS_OK);
}

/* ---- Lines of the head ---- */

bool comment_names_content(const char *comment)
{
    return strncmp(comment, "scene ", strlen("scene ")) == 0
           || strncmp(comment, "algorithm ", strlen("algorithm ")) == 0;
}

size_t comment_key_length(const char *comment)
{
    const char *end = comment_names_content(comment) ? strrchr(comment, ':') : strchr(comment, ':');
    return end ? (size_t)(end - comment) : strlen(comment);
}

const char *comment_like(const struct csv *csv, const char *comment)
{
    const size_t length = comment_key_length(comment);
    for (int k = 0; k < csv->comment_count; k++)
        if (comment_key_length(csv->comments[k]) == length && strncmp(csv->comments[k], comment, length) == 0)
            return csv->comments[k];
    return NULL;
}
