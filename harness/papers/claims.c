/* The claims of results/claims.csv: read, checked and judged (claims.h). */
#include "papers/claims.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "measure/timing.h"

static const struct {
    const char *name;
    size_t offset;
} columns[] = {
    {"id", offsetof(struct claim, id)},
    {"paper", offsetof(struct claim, paper)},
    {"section", offsetof(struct claim, section)},
    {"claim", offsetof(struct claim, claim)},
    {"criterion", offsetof(struct claim, criterion)},
    {"judge", offsetof(struct claim, judge)},
    {"arguments", offsetof(struct claim, arguments)},
};
enum { COLUMNS = sizeof columns / sizeof *columns };

/* ---- reading ---- */

static enum status row_read(const struct csv *csv, int row, struct claim *claim)
{
    *claim = (struct claim){.line = csv->lines[row]};
    for (int k = 0; k < COLUMNS; k++) {
        const char *cell = csv_cell(csv, row, k);
        if (!*cell)
            return status_set(STATUS_INVALID, "%s: line %d: column %s is empty; a text is needed", csv->path,
                              csv->lines[row], columns[k].name);
        memcpy((char *)claim + columns[k].offset, &cell, sizeof cell);
    }
    for (int other = 0; other < row; other++)
        if (strcmp(csv_cell(csv, other, 0), claim->id) == 0)
            return status_set(STATUS_INVALID,
                              "%s: line %d: column id is '%s', as in line %d; an id of its own is "
                              "needed",
                              csv->path, csv->lines[row], claim->id, csv->lines[other]);
    return STATUS_OK;
}

/* Room for all needs was made for the number of commas in the file, of which each measurement has one at least. */
static void need_keep(void *to, const char *scene, const char *spec)
{
    struct claims *claims = to;
    for (int k = 0; k < claims->need_count; k++)
        if (strcmp(claims->needs[k].scene, scene) == 0 && strcmp(claims->needs[k].spec, spec) == 0)
            return;
    claims->needs[claims->need_count++] = (struct need){strdup(scene), strdup(spec)};
}

static enum status rows_read(struct claims *claims, const struct csv *published)
{
    struct csv *csv = &claims->csv;
    size_t commas = 0;
    for (int row = 0; row < csv->row_count; row++)
        for (int column = COLUMNS - 2; column < COLUMNS; column++) /* judge and arguments */
            for (const char *at = csv_cell(csv, row, column); *at; at++)
                commas += *at == ',';
    claims->claims = calloc((size_t)csv->row_count + 1, sizeof *claims->claims);
    claims->needs = calloc(commas + 1, sizeof *claims->needs);
    if (!claims->claims || !claims->needs)
        return status_set(STATUS_FAILED, "%s: no memory for %d claims", csv->path, csv->row_count);
    enum status status = STATUS_OK;
    for (int row = 0; row < csv->row_count && status == STATUS_OK; row++) {
        struct claim *claim = &claims->claims[claims->count++];
        struct formula formula = {
            .published = published, .path = csv->path, .line = csv->lines[row], .need = need_keep, .to = claims};
        struct judgement judgement = {.evidence = ""};
        status = row_read(csv, row, claim);
        if (status == STATUS_OK)
            status = quantities_read(&formula, "arguments", claim->arguments);
        if (status == STATUS_OK)
            status = judges_read(&formula, "judge", claim->judge, &judgement);
    }
    for (int k = 0; k < claims->need_count && status == STATUS_OK; k++)
        if (!claims->needs[k].scene || !claims->needs[k].spec)
            status = status_set(STATUS_FAILED, "%s: no memory for %d measurements", csv->path, claims->need_count);
    return status;
}

enum status claims_read(const char *path, struct claims *claims)
{
    struct csv published = {0};
    *claims = (struct claims){0};
    enum status status = csv_read(path, CSV_TAIL_KEEP, &claims->csv);
    for (int k = 0; k < COLUMNS && status == STATUS_OK; k++)
        if (csv_column(&claims->csv, columns[k].name) != k)
            status = status_set(STATUS_INVALID, "%s: column %d must be '%s'", path, k + 1, columns[k].name);
    if (status == STATUS_OK)
        status = published_read(&published);
    if (status == STATUS_OK)
        status = rows_read(claims, &published);
    csv_free(&published);
    if (status != STATUS_OK)
        claims_free(claims);
    return status;
}

void claims_free(struct claims *claims)
{
    for (int k = 0; k < claims->need_count; k++) {
        free((char *)claims->needs[k].scene);
        free((char *)claims->needs[k].spec);
    }
    free(claims->needs);
    free(claims->claims);
    csv_free(&claims->csv);
    *claims = (struct claims){0};
}

/* ---- judging ---- */

/* "NAME = 0.452, NAME = 0.01 to 0.45 (median 0.2); criterion: ..." */
static void evidence_begin(struct judgement *judgement, const struct formula *formula, const struct claim *claim)
{
    size_t size = sizeof judgement->evidence;
    for (int k = 0; k < formula->count; k++) {
        struct values values = formula->named[k].values;
        text_append(judgement->evidence, size, "%s%s = ", k ? ", " : "", formula->named[k].name);
        values_append(judgement->evidence, size, &values);
        if (values.count > 1)
            text_append(judgement->evidence, size, " (median %.4g)", median(values.at, values.count));
    }
    text_append(judgement->evidence, size, "; %s%s", judge_decides(claim->judge) ? "criterion: " : "",
                claim->criterion);
}

struct judgement claim_judge(const struct claims *claims, const struct claim *claim, struct measured *measured)
{
    struct formula formula = {
        .measured = measured, .published = &measured->published, .path = claims->csv.path, .line = claim->line};
    struct judgement judgement = {.evidence = ""};
    *measured->missing = '\0';
    enum status status = quantities_read(&formula, "arguments", claim->arguments);
    if (status == STATUS_OK) {
        evidence_begin(&judgement, &formula, claim);
        status = judges_read(&formula, "judge", claim->judge, &judgement);
    }
    if (status == STATUS_OK && !*measured->missing)
        return judgement;
    judgement.verdict = CLAIM_UNDECIDED;
    snprintf(judgement.evidence, sizeof judgement.evidence, "%s",
             status == STATUS_OK ? measured->missing : status_message());
    return judgement;
}
