/* What was planned, beside what was measured (plans.h). */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "advise/plans.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/csv.h"
#include "echoes/echo_data.h"
#include "text/text_append.h"
#include "files/text_file.h"
#include "results/provenance.h"
#include "advise/planned.h"

static const char *const columns[] = {"scene",   "options", "precision", "algorithm", "settings",
                                      "verdict", "seconds", "error",     "text"};
enum { COLUMNS = sizeof columns / sizeof *columns, KEYS = 3 };

struct joined {
    char text[1600];
};

/* "one; other". */
static void line_join(void *to, const char *text)
{
    struct joined *joined = to;
    text_append(joined->text, sizeof joined->text, "%s%s", *joined->text ? "; " : "left out: ", text);
}

static void row_write(struct plans *plans, const struct candidate *candidate, const char *text)
{
    const char *const texts[] = {
        plans->scene->name,         plans->spec->text,   precision_name(plans->spec->precision),
        candidate->algorithm->name, candidate->settings, plan_verdict_names[candidate->verdict]};
    for (int k = 0; k < COLUMNS - KEYS; k++) {
        csv_write_text(plans->stream, texts[k]);
        fputc(',', plans->stream);
    }
    csv_write_number(plans->stream, isinf(candidate->seconds) ? NAN : candidate->seconds);
    fputc(',', plans->stream);
    csv_write_number(plans->stream, isinf(candidate->error) ? NAN : candidate->error);
    fputc(',', plans->stream);
    csv_write_text(plans->stream, text);
    fputc('\n', plans->stream);
}

/* The first of its algorithm among those within the budget: the fastest. */
static bool is_fastest(const struct choice *choice, int k)
{
    for (int n = 0; n < k; n++)
        if (choice->list[n].algorithm == choice->list[k].algorithm)
            return false;
    return choice->list[k].verdict == VERDICT_SLOWER;
}

/* The chosen one, and the best of every other algorithm. */
static void choice_hear(void *to, const struct problem *problem, const struct budget *budget,
                        const struct choice *choice)
{
    struct plans *plans = to;
    (void)budget;
    if (!plans->stream)
        plans->stream = open_memstream(&plans->rows, &plans->size);
    if (!plans->stream)
        return;
    rewind(plans->stream);
    for (int k = 0; k < choice->count; k++) {
        const struct candidate *candidate = &choice->list[k];
        struct joined joined = {""};
        if (candidate->verdict == VERDICT_CHOSEN) {
            planned_left_out(problem, candidate, line_join, &joined);
            row_write(plans, candidate, joined.text);
        } else if (is_fastest(choice, k) || planned_nearest(choice, k)) {
            row_write(plans, candidate, candidate->reason);
        }
    }
}

void plans_listen(const struct scene *scene, const struct spec *spec, struct plans *plans)
{
    *plans = (struct plans){.scene = scene, .spec = spec};
    if (strcmp(spec->algorithm->name, "auto") == 0)
        automatic_tell(choice_hear, plans);
}

/* Rows of other images, where the same program wrote them. */
static void others_write(const struct csv *csv, const struct plans *plans, const char *program, FILE *file)
{
    const char *by = csv_comment(csv, "program");
    if (!by || strcmp(by, program) != 0)
        return;
    const char *const keys[KEYS] = {plans->scene->name, plans->spec->text, precision_name(plans->spec->precision)};
    for (int row = 0; row < csv->row_count; row++) {
        bool same = true;
        for (int k = 0; k < KEYS; k++)
            same &= strcmp(csv_cell(csv, row, k), keys[k]) == 0;
        for (int k = 0; k < COLUMNS && !same; k++) {
            csv_write_text(file, csv_cell(csv, row, k));
            fputc(k < COLUMNS - 1 ? ',' : '\n', file);
        }
    }
}

static enum status older_read(const char *path, struct csv *csv)
{
    enum status status = access(path, F_OK) == 0 ? csv_read(path, CSV_TAIL_KEEP, csv) : STATUS_OK;
    for (int k = 0; k < COLUMNS && status == STATUS_OK && csv->column_count > 0; k++)
        if (csv_column(csv, columns[k]) != k)
            status = status_set(STATUS_INVALID, "%s: column %d must be '%s'", path, k + 1, columns[k]);
    return status;
}

enum status plans_keep(const char *directory, struct plans *plans)
{
    char path[4200];
    struct csv older = {0};
    struct text_file file;
    struct provenance provenance;
    automatic_tell(NULL, NULL);
    if (!plans->stream)
        return STATUS_OK;
    fclose(plans->stream);
    provenance_fill(&provenance, 1);
    snprintf(path, sizeof path, "%s/plans.csv", directory);
    enum status status = older_read(path, &older);
    if (status == STATUS_OK)
        status = text_file_open(path, &file);
    if (status == STATUS_OK) {
        fprintf(file.stream, "# sasbench plans 1\n# program: %s\n", provenance.program);
        for (int k = 0; k < COLUMNS; k++)
            fprintf(file.stream, "%s%c", columns[k], k < COLUMNS - 1 ? ',' : '\n');
        others_write(&older, plans, provenance.program, file.stream);
        fputs(plans->rows, file.stream);
        status = text_file_close(&file, STATUS_OK);
    }
    csv_free(&older);
    free(plans->rows);
    *plans = (struct plans){.stream = NULL};
    return status;
}
