/* Plans, kept beside measurements (plans.h). */
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
                                      "verdict", "seconds", "error",     "text",      NULL};
enum { COLUMNS = sizeof columns / sizeof *columns - 1, KEYS = 3 };

struct joined {
    char text[1600];
};

/* "one; other". */
static void line_join(void *to, const char *text)
{
    struct joined *joined = to;
    text_append(joined->text, sizeof joined->text, "%s%s", *joined->text ? "; " : "left out: ", text);
}

static void row_write(const struct plans *plans, const struct candidate *candidate, const char *text, FILE *file)
{
    const char *const texts[] = {plans->scene->name,
                                 plans->spec->text,
                                 precision_name(plans->spec->precision),
                                 candidate->algorithm->name,
                                 candidate->settings,
                                 plan_verdict_names[candidate->verdict],
                                 NULL};
    const double numbers[] = {isinf(candidate->seconds) ? NAN : candidate->seconds,
                              isinf(candidate->error) ? NAN : candidate->error};
    csv_write_fields(file, texts, numbers, 2, false);
    csv_write_fields(file, (const char *const[]){text, NULL}, NULL, 0, true);
}

/* The first of its algorithm among those within the budget: the fastest. */
static bool is_fastest(const struct choice *choice, int k)
{
    for (int n = 0; n < k; n++)
        if (choice->list[n].algorithm == choice->list[k].algorithm)
            return false;
    return choice->list[k].verdict == CANDIDATE_SLOWER;
}

/* The chosen one, and the best of every other algorithm. */
static void rows_write(const struct plans *plans, FILE *file)
{
    const struct choice *choice = plans->choice;
    const struct problem problem = scene_problem(plans->scene, plans->spec->precision);
    for (int k = 0; k < choice->count; k++) {
        const struct candidate *candidate = &choice->list[k];
        struct joined joined = {""};
        if (candidate->verdict == CANDIDATE_CHOSEN) {
            planned_left_out(&problem, candidate, line_join, &joined);
            row_write(plans, candidate, joined.text, file);
        } else if (is_fastest(choice, k) || planned_nearest(choice, k)) {
            row_write(plans, candidate, candidate->reason, file);
        }
    }
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
    return status == STATUS_OK && csv->column_count > 0 ? csv_columns(csv, columns, NULL) : status;
}

enum status plans_keep(const char *directory, const struct plans *plans)
{
    char path[4200];
    struct csv older = {0};
    struct text_file file;
    struct provenance provenance;
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
        rows_write(plans, file.stream);
        status = text_file_close(&file, STATUS_OK);
    }
    csv_free(&older);
    return status;
}
