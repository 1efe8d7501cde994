/* What becomes of the papers' tables and claims: files in the folder, and text on the terminal (reproduced.h). */
#include "claims/reproduced.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/csv.h"
#include "text/text_append.h"
#include "files/text_file.h"
#include "claims/verdicts.h"
#include "show/table.h"

enum { COLUMNS_MAX = 12 };

/* Ahead of what is worked out: where, when and with what it was measured. */
static void head_write(FILE *file, const char *what, const struct measured *measured)
{
    const struct csv *csv = &measured->measurements.csv;
    fprintf(file, "# sasbench %s 1\n", what);
    for (int k = 0; k < csv->comment_count; k++)
        if (strncmp(csv->comments[k], "sasbench ", 9) != 0 && strncmp(csv->comments[k], "scene ", 6) != 0)
            fprintf(file, "# %s\n", csv->comments[k]);
    fprintf(file, "# load: %.2f a processor (average of 15 minutes when evaluated)\n", measured->load);
}

static enum status reproduced_write(const char *directory, const struct measured *measured,
                                    const struct reproduced *lines, int count)
{
    char path[4200];
    struct text_file file;
    snprintf(path, sizeof path, "%s/reproduced.csv", directory);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    head_write(file.stream, "reproduced", measured);
    fputs("table,item,quantity,definition,unit,paper,ours,difference,assumption\n", file.stream);
    for (int k = 0; k < count; k++) {
        const struct reproduced *l = &lines[k];
        char item[160], assumption[1200];
        snprintf(item, sizeof item, "%s%s%s", l->target, *l->target ? ", " : "", l->method);
        snprintf(assumption, sizeof assumption, "%s%s%s%s%s", l->assumption, *l->note ? "; " : "", l->note,
                 *l->missing ? "; no value: " : "", l->missing);
        const char *const texts[] = {l->table, item, l->quantity, l->definition, l->unit};
        const double numbers[] = {l->paper, l->ours, l->ours - l->paper};
        for (int n = 0; n < 5; n++) {
            csv_write_text(file.stream, texts[n]);
            fputc(',', file.stream);
        }
        for (int n = 0; n < 3; n++) {
            csv_write_number(file.stream, numbers[n]);
            fputc(',', file.stream);
        }
        csv_write_text(file.stream, assumption);
        fputc('\n', file.stream);
    }
    return text_file_close(&file, STATUS_OK);
}

/* A number and, behind it, how far it is from the paper's. */
static void cell_print(double value, double paper)
{
    char text[40] = "-", difference[40] = "";
    double size = fmax(fabs(value), fabs(paper));
    if (isfinite(value))
        snprintf(text, sizeof text, size > 1e4 || size < 0.1 ? "%.4g" : "%.3f", value);
    if (isfinite(value) && isfinite(paper))
        snprintf(difference, sizeof difference, size > 1e4 || size < 0.1 ? "(%+.1e)" : "(%+.3f)", value - paper);
    printf(" %10s %-10s", text, difference);
}

/* What published.csv notes on the table's numbers, once for each target. */
static void notes_print(const struct paper_table *table, const struct reproduced *lines, int count)
{
    for (int k = 0; k < count; k++) {
        const struct reproduced *l = &lines[k];
        bool printed = strcmp(l->table, table->id) != 0 || !*l->note;
        for (int n = 0; n < k && !printed; n++)
            printed = lines[n].table == l->table && strcmp(lines[n].note, l->note) == 0
                      && strcmp(lines[n].target, l->target) == 0;
        if (!printed)
            printf("  %s: %s\n", *l->target ? l->target : "paper", l->note);
    }
}

/* Claims and pictures have none. */
static bool table_has_lines(const struct paper_table *table, const struct reproduced *lines, int count)
{
    bool has = false;
    for (int k = 0; k < count; k++)
        has |= strcmp(lines[k].table, table->id) == 0;
    return has;
}

/* A row a printed number, a column each of `columns` definitions from `first` on. */
static void columns_print(const struct paper_table *table, const struct reproduced *lines, int count,
                          const char *const *definitions, int first, int columns)
{
    printf("  %-36s %-15s %10s", "", "", "paper");
    for (int c = first; c < first + columns; c++)
        printf(" %10s %-10s", (char[]){'(', (char)('1' + c), ')', '\0'}, "");
    printf("\n");
    for (int k = 0; k < count;) {
        const struct reproduced *l = &lines[k];
        int end = k + 1;
        while (end < count && lines[end].table == l->table && lines[end].target == l->target
               && lines[end].method == l->method && lines[end].quantity == l->quantity)
            end++;
        if (strcmp(l->table, table->id) == 0) {
            char item[160], paper[40] = "";
            snprintf(item, sizeof item, "%s%s%s", l->target, *l->target ? ", " : "", l->method);
            if (isfinite(l->paper))
                snprintf(paper, sizeof paper, "%.5g", l->paper);
            printf("  %-36s %-15s %10s", item, l->quantity, paper);
            for (int c = first; c < first + columns; c++) {
                int n = k;
                while (n < end && strcmp(lines[n].definition, definitions[c]) != 0)
                    n++;
                if (n < end)
                    cell_print(lines[n].ours, lines[n].paper);
                else
                    printf(" %10s %-10s", "", "");
            }
            printf("\n");
        }
        k = end;
    }
}

/* One table, in bands of as many definitions as a line holds. */
static void table_print(const struct paper_table *table, const struct reproduced *lines, int count)
{
    const char *definitions[COLUMNS_MAX];
    char assumed[1000];
    int columns = 0, band = 2;
    for (int k = 0; k < count; k++) {
        int c = 0;
        while (c < columns && strcmp(definitions[c], lines[k].definition) != 0)
            c++;
        if (strcmp(lines[k].table, table->id) == 0 && c == columns && columns < COLUMNS_MAX)
            definitions[columns++] = lines[k].definition;
    }
    printf("\n%s  %s\n", table->id, table->title);
    for (int c = 0; c < columns; c++)
        printf("  (%d) %s\n", c + 1, definitions[c]);
    snprintf(assumed, sizeof assumed, "assumed: %s", table->assumption);
    table_text(stdout, 2, assumed);
    while (65 + 22 * (band + 1) <= table_width(stdout))
        band++;
    for (int c = 0; c < columns || c == 0; c += band)
        columns_print(table, lines, count, definitions, c, columns - c < band ? columns - c : band);
    notes_print(table, lines, count);
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
                                 evidence};
    for (int k = 0; k < 8; k++) {
        csv_write_text(stream, texts[k]);
        fputc(k < 7 ? ',' : '\n', stream);
    }
}

static void claim_print(const struct claim *claim, const struct evaluation evaluations[SCHEMES])
{
    printf("\n%-17s %s\n", claim->id, claim->claim);
    for (enum scheme scheme = 0; scheme < (claim->by_scheme ? SCHEMES : 1); scheme++)
        printf("  %s%s%s: %s\n", claim->by_scheme ? scheme_names[scheme] : "", claim->by_scheme ? ": " : "",
               claim_verdict_names[evaluations[scheme].verdict], evaluations[scheme].evidence);
}

/* Where all claims were asked for: how many have each verdict, as a page. */
static enum status verdicts_page(const char *directory, const struct verdicts *verdicts,
                                 const struct measured *measured)
{
    const struct csv *csv = &measured->measurements.csv;
    const char *date = csv_comment(csv, "date"), *commit = csv_comment(csv, "commit"),
               *machine = csv_comment(csv, "machine");
    char path[4200], head[600];
    for (int k = 0; k < verdicts->claims->count; k++)
        if (!verdicts->evaluated[k])
            return STATUS_OK;
    snprintf(path, sizeof path, "%s/verdicts.md", directory);
    snprintf(head, sizeof head, "%s, commit %s, %s, load %.2f a processor.", date ? date : "no date",
             commit ? commit : "unknown", machine ? machine : "unknown machine", measured->load);
    return verdicts_write(path, head, verdicts);
}

/* Into claims.csv: the claims asked for, which are printed, too, and those that the folder can decide already. */
static enum status claims_report(const char *directory, const struct selection *selection, struct measured *measured)
{
    char path[4200];
    struct text_file file;
    static struct verdicts verdicts;
    int asked = 0;
    verdicts = (struct verdicts){.claims = selection->claims};
    snprintf(path, sizeof path, "%s/claims.csv", directory);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    head_write(file.stream, "claims", measured);
    fputs("id,paper,section,claim,verdict,corrected,basis,evidence\n", file.stream);
    for (int n = 0; n < selection->claims->count; n++) {
        const struct claim *claim = &selection->claims->claims[n];
        struct evaluation evaluations[SCHEMES] = {0};
        bool there = claim->need_count > 0;
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
        verdicts_add(&verdicts, n, evaluations);
        asked++;
    }
    if (asked)
        verdicts_print(stdout, &verdicts);
    status = text_file_close(&file, STATUS_OK);
    return status == STATUS_OK ? verdicts_page(directory, &verdicts, measured) : status;
}

/* Lines of tables that were not asked for stay if the folder has all of them. */
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

/* A processor, over the last 15 minutes; 0 where the system does not tell it. What was evaluated before with the
   same program keeps the load of that time: times that were measured on a busy machine do not get better on a quiet
   one. */
static double load_average(const char *directory, const struct measured *measured)
{
    double loads[3], load = 0, before = 0;
    char path[4200];
    struct csv csv;
    if (getloadavg(loads, 3) == 3)
        load = loads[2] / (double)sysconf(_SC_NPROCESSORS_ONLN);
    snprintf(path, sizeof path, "%s/claims.csv", directory);
    if (access(path, R_OK) != 0 || csv_read(path, CSV_TAIL_KEEP, &csv) != STATUS_OK)
        return load;
    const char *program = csv_comment(&csv, "program"), *text = csv_comment(&csv, "load");
    const char *ours = csv_comment(&measured->measurements.csv, "program");
    if (program && ours && text && strcmp(program, ours) == 0) /* with another program all is measured again */
        before = strtod(text, NULL);
    csv_free(&csv);
    return fmax(load, before);
}

enum status reproduced_report(const char *directory, const struct selection *selection)
{
    struct measured measured;
    struct reproduced *lines = NULL;
    int count = 0;
    enum status status = measured_read(directory, &measured);
    measured.load = status == STATUS_OK ? load_average(directory, &measured) : 0;
    if (status == STATUS_OK)
        status = tables_evaluate(&measured, selection->tables, &lines, &count);
    if (status == STATUS_OK) {
        lines_keep(selection, lines, &count);
        status = reproduced_write(directory, &measured, lines, count);
    }
    for (int k = 0; paper_tables[k].id && status == STATUS_OK; k++)
        if (selection->tables[k] && table_has_lines(&paper_tables[k], lines, count))
            table_print(&paper_tables[k], lines, count);
    if (status == STATUS_OK)
        status = claims_report(directory, selection, &measured);
    if (status == STATUS_OK)
        printf("\nResults: %s/reproduced.csv, claims.csv, measurements.csv, targets.csv, figures.\n", directory);
    free(lines);
    measured_free(&measured);
    return status;
}
