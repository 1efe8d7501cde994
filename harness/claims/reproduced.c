/* The papers' tables and claims as files in the folder, and as text on the terminal (reproduce.h). */
#include "claims/reproduce.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/csv.h"
#include "text/text_append.h"
#include "files/text_file.h"
#include "show/table.h"

void reproduced_head(FILE *file, const char *what, const struct measured *measured)
{
    const struct csv *csv = &measured->measurements.csv;
    double load = NAN;
    fprintf(file, "# sasbench %s 1\n", what);
    for (int k = 0; k < csv->comment_count; k++)
        if (strncmp(csv->comments[k], "sasbench ", 9) != 0 && strncmp(csv->comments[k], "scene ", 6) != 0)
            fprintf(file, "# %s\n", csv->comments[k]);
    for (int k = 0; k < csv->row_count; k++)
        load = fmax(load, measured->measurements.measurements[k].load);
    if (isfinite(load))
        fprintf(file, "# load: at most %.2f ready processes while measured (the rows' column load)\n", load);
}

static void item_format(const struct reproduced *line, char *item, size_t size)
{
    snprintf(item, size, "%s%s%s", line->target, *line->target ? ", " : "", line->method);
}

static enum status reproduced_write(const char *directory, const struct measured *measured,
                                    const struct reproduced *lines, int count)
{
    struct text_file file;
    enum status status = text_file_in(directory, "reproduced.csv", &file);
    if (status != STATUS_OK)
        return status;
    reproduced_head(file.stream, "reproduced", measured);
    fputs("table,item,quantity,definition,unit,paper,ours,difference,assumption\n", file.stream);
    for (int k = 0; k < count; k++) {
        const struct reproduced *l = &lines[k];
        char item[160], assumption[1200];
        item_format(l, item, sizeof item);
        snprintf(assumption, sizeof assumption, "%s%s%s%s%s", l->assumption, *l->note ? "; " : "", l->note,
                 *l->missing ? "; no value: " : "", l->missing);
        csv_write_fields(file.stream, (const char *const[]){l->table, item, l->quantity, l->definition, l->unit, NULL},
                         (double[]){l->paper, l->ours, l->ours - l->paper}, 3, false);
        csv_write_fields(file.stream, (const char *const[]){assumption, NULL}, NULL, 0, true);
    }
    return text_file_close(&file, STATUS_OK);
}

/* One table: a line for each number and definition. A note is printed once, ahead of the numbers of its target. */
static void table_print(const struct paper_table *table, const struct reproduced *lines, int count)
{
    char text[1000];
    const struct reproduced *before = NULL;
    int first = 0;
    while (first < count && strcmp(lines[first].table, table->id) != 0)
        first++;
    if (first == count)
        return; /* claims and pictures have no lines */
    printf("\n%s  %s\n", table->id, table->title);
    snprintf(text, sizeof text, "assumed: %s", table->assumption);
    table_text(stdout, 2, text);
    printf("  %-34s %-16s %10s %10s %10s  definition\n", "", "", "paper", "ours", "difference");
    for (const struct reproduced *l = lines + first; l < lines + count; l++) {
        if (strcmp(l->table, table->id) != 0)
            continue;
        if (*l->note && (!before || strcmp(before->note, l->note) != 0 || strcmp(before->target, l->target) != 0)) {
            snprintf(text, sizeof text, "%s: %s", *l->target ? l->target : "paper", l->note);
            table_text(stdout, 2, text);
        }
        item_format(l, text, sizeof text);
        printf("  %-34s %-16s", text, l->quantity);
        const double numbers[] = {l->paper, l->ours, l->ours - l->paper};
        for (int k = 0; k < 3; k++)
            printf(isfinite(numbers[k]) ? (k < 2 ? " %10.5g" : " %+10.2g") : "          -", numbers[k]);
        printf("  %s\n", l->definition);
        before = l;
    }
}

/* ---- claims ---- */

static void claim_write(FILE *stream, const struct claim *claim, const struct evaluation evaluations[SCHEMES])
{
    char evidence[2 * sizeof evaluations->evidence + 40];
    const char *corrected = "";
    snprintf(evidence, sizeof evidence, "%s", evaluations[SCHEME_PRINTED].evidence);
    if (claim->by_scheme) {
        corrected = claim_verdict_names[evaluations[SCHEME_CORRECTED].verdict];
        text_append(evidence, sizeof evidence, " | corrected: %s", evaluations[SCHEME_CORRECTED].evidence);
    }
    const char *const texts[] = {claim->id,
                                 claim->paper,
                                 claim->section,
                                 claim->claim,
                                 claim_verdict_names[evaluations[SCHEME_PRINTED].verdict],
                                 corrected,
                                 claim->measures && !comparison_identity(claim->comparison) ? "measured" : "formula",
                                 evidence,
                                 NULL};
    csv_write_fields(stream, texts, NULL, 0, true);
}

static void claim_print(const struct claim *claim, const struct evaluation evaluations[SCHEMES])
{
    printf("\n%-17s %s\n", claim->id, claim->claim);
    for (enum scheme scheme = 0; scheme < (claim->by_scheme ? SCHEMES : 1); scheme++)
        printf("  %s%s%s: %s\n", claim->by_scheme ? scheme_names[scheme] : "", claim->by_scheme ? ": " : "",
               claim_verdict_names[evaluations[scheme].verdict], evaluations[scheme].evidence);
}

/* Counts of the requested claims. */
struct verdicts {
    int of[SCHEMES][CLAIM_VERDICTS]; /* corrected: of claims that name a scheme alone */
    int by_formula, noisy;           /* as printed: fail without a measurement; lie within the noise of their run */
};

static void verdicts_add(struct verdicts *verdicts, const struct claim *claim,
                         const struct evaluation evaluations[SCHEMES])
{
    for (enum scheme scheme = 0; scheme < (claim->by_scheme ? SCHEMES : 1); scheme++)
        verdicts->of[scheme][evaluations[scheme].verdict]++;
    verdicts->by_formula += !claim->measures && evaluations->verdict == CLAIM_FAILS;
    verdicts->noisy += evaluations->verdict == CLAIM_UNDECIDED && strstr(evaluations->evidence, ": within the noise");
}

static void verdicts_print(const struct verdicts *verdicts)
{
    printf("\nVerdicts\n");
    for (enum scheme scheme = 0; scheme < SCHEMES; scheme++) {
        int total = 0;
        printf("  %-10s", scheme_names[scheme]);
        for (int k = 0; k < CLAIM_VERDICTS; k++) {
            printf("%s %d %s", k ? "," : "", verdicts->of[scheme][k], claim_verdict_names[k]);
            total += verdicts->of[scheme][k];
        }
        printf(scheme ? " (of the %d that depend on LBF21's scheme).\n" : " (of %d).\n", total);
    }
    printf("As printed %d of those that do not hold fail by the papers' formulas and numbers alone;\n%d of those that "
           "cannot be decided are times, or rest on them, that lie within the noise of their run.\n",
           verdicts->by_formula, verdicts->noisy);
}

/* Write claims.csv: the requested claims, which are printed, too, and those that the folder can decide already. */
static enum status claims_report(const char *directory, const struct selection *selection, struct measured *measured)
{
    struct text_file file;
    struct verdicts verdicts = {.noisy = 0};
    int asked = 0;
    enum status status = text_file_in(directory, "claims.csv", &file);
    if (status != STATUS_OK)
        return status;
    reproduced_head(file.stream, "claims", measured);
    fputs("id,paper,section,claim,verdict,corrected,basis,evidence\n", file.stream);
    for (int n = 0; n < selection->claims->count; n++) {
        const struct claim *claim = &selection->claims->claims[n];
        struct evaluation evaluations[SCHEMES] = {0};
        bool there = claim->need_count > 0;
        for (int k = 0; k < claim->need_count; k++)
            there = there && measured_row(measured, claim->needs[k].scene, claim->needs[k].spec);
        if (!selection->asked[n] && !there)
            continue;
        for (enum scheme scheme = 0; scheme < (claim->by_scheme ? SCHEMES : 1); scheme++) {
            evaluations[scheme] = claim_evaluate(selection->claims, claim, scheme, measured);
            there = there && !*measured->missing;
        }
        if (selection->asked[n] || there)
            claim_write(file.stream, claim, evaluations);
        if (!selection->asked[n])
            continue;
        claim_print(claim, evaluations);
        verdicts_add(&verdicts, claim, evaluations);
        asked++;
    }
    if (asked)
        verdicts_print(&verdicts);
    return text_file_close(&file, STATUS_OK);
}

/* Lines of tables that were not requested stay if the folder has all of them. */
static void lines_keep(const struct selection *selection, struct reproduced *lines, int *count)
{
    int kept = 0;
    bool whole[TABLES_MAX] = {false};
    for (int k = 0; paper_tables[k].id; k++) {
        whole[k] = true;
        for (int n = 0; n < *count; n++)
            whole[k] = whole[k] && (strcmp(lines[n].table, paper_tables[k].id) != 0 || isfinite(lines[n].ours));
    }
    for (int n = 0; n < *count; n++)
        for (int k = 0; paper_tables[k].id; k++)
            if (strcmp(lines[n].table, paper_tables[k].id) == 0 && (selection->tables[k] || whole[k]))
                lines[kept++] = lines[n];
    *count = kept;
}

enum status reproduced_report(const char *directory, const struct selection *selection)
{
    struct measured measured;
    struct reproduced *lines = NULL;
    int count = 0;
    enum status status = measured_read(directory, &measured);
    if (status == STATUS_OK)
        status = tables_evaluate(&measured, selection->tables, &lines, &count);
    if (status == STATUS_OK) {
        lines_keep(selection, lines, &count);
        status = reproduced_write(directory, &measured, lines, count);
    }
    for (int k = 0; paper_tables[k].id && status == STATUS_OK; k++)
        if (selection->tables[k])
            table_print(&paper_tables[k], lines, count);
    if (status == STATUS_OK)
        status = claims_report(directory, selection, &measured);
    if (status == STATUS_OK)
        printf("\nResults: %s/reproduced.csv, claims.csv, measurements.csv, targets.csv, figures.\n", directory);
    free(lines);
    measured_free(&measured);
    return status;
}
