/* Measure what the papers' tables and claims rest on, set their numbers beside ours, and judge what they say
   (reproduce.h). */
#include "papers/reproduce.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "data/paths.h"
#include "data/text_file.h"
#include "measure/spec.h"
#include "papers/claims.h"
#include "scene/scene.h"
#include "study/batch.h"
#include "study/phase.h"

enum { NEEDS_MAX = 256, TABLES_MAX = 64, COLUMNS_MAX = 8 };

static enum status tables_select(const char *const *ids, int count, bool selected[TABLES_MAX])
{
    for (int n = 0; n < count; n++) {
        char accepted[512] = "";
        bool known = false;
        for (int k = 0; paper_tables[k].id; k++) {
            bool same = strcmp(paper_tables[k].id, ids[n]) == 0;
            known |= same;
            selected[k] |= same;
            text_append(accepted, sizeof accepted, "%s%s", k ? ", " : "", paper_tables[k].id);
        }
        if (!known)
            return status_set(STATUS_INVALID, "reproduce: '%s' is not a table; accepted: %s", ids[n], accepted);
    }
    for (int k = 0; paper_tables[k].id; k++)
        selected[k] |= count == 0;
    return STATUS_OK;
}

/* All needs of one scene; those of `needs` that are done lose their scene. */
static enum status scene_measure(struct batch *batch, struct need *needs, int count)
{
    struct scene scene;
    struct spec specs[NEEDS_MAX];
    int spec_count = 0;
    const char *name = needs[0].scene;
    enum status status = scene_load(name, SCENE_DIRECTORY, &scene);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < count && status == STATUS_OK; k++)
        if (needs[k].scene && strcmp(needs[k].scene, name) == 0) {
            status = spec_parse(needs[k].spec, &specs[spec_count]);
            spec_count += status == STATUS_OK;
            needs[k].scene = NULL;
        }
    if (status == STATUS_OK)
        status = batch_scene(batch, &scene, spec_count, specs);
    for (int k = 0; k < spec_count; k++)
        spec_free(&specs[k]);
    scene_free(&scene);
    return status;
}

/* ---- what is written and printed ---- */

/* Ahead of what is worked out: where, when and with what it was measured. */
static void head_write(FILE *file, const char *what, const struct measured *measured)
{
    const struct csv *csv = &measured->measurements.csv;
    fprintf(file, "# sasbench %s 1\n", what);
    for (int k = 0; k < csv->comment_count; k++)
        if (strncmp(csv->comments[k], "sasbench ", 9) != 0 && strncmp(csv->comments[k], "scene ", 6) != 0)
            fprintf(file, "# %s\n", csv->comments[k]);
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
        bool said = strcmp(l->table, table->id) != 0 || !*l->note;
        for (int n = 0; n < k && !said; n++)
            said = lines[n].table == l->table && strcmp(lines[n].note, l->note) == 0
                   && strcmp(lines[n].target, l->target) == 0;
        if (!said)
            printf("  %s: %s\n", *l->target ? l->target : "paper", l->note);
    }
}

/* One table, a row a printed number, a column a definition. */
static void table_print(const struct paper_table *table, const struct reproduced *lines, int count)
{
    const char *definitions[COLUMNS_MAX];
    int columns = 0;
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
    printf("  assumed: %s\n  %-36s %-15s %10s", table->assumption, "", "", "paper");
    for (int c = 0; c < columns; c++)
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
            for (int c = 0; c < columns; c++) {
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
    notes_print(table, lines, count);
}

/* Into claims.csv, and printed when `print`. */
static enum status claims_write(const char *directory, const struct claims *claims, struct measured *measured,
                                bool print)
{
    char path[4200];
    struct text_file file;
    int counts[CLAIM_VERDICTS] = {0};
    snprintf(path, sizeof path, "%s/claims.csv", directory);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    head_write(file.stream, "claims", measured);
    fputs("id,paper,section,claim,verdict,evidence\n", file.stream);
    for (int n = 0; n < claims->count; n++) {
        const struct claim *claim = &claims->claims[n];
        struct judgement judgement = claim_judge(claims, claim, measured);
        const char *const texts[] = {
            claim->id,         claim->paper, claim->section, claim->claim, claim_verdict_names[judgement.verdict],
            judgement.evidence};
        for (int k = 0; k < 6; k++) {
            csv_write_text(file.stream, texts[k]);
            fputc(k < 5 ? ',' : '\n', file.stream);
        }
        counts[judgement.verdict]++;
        if (print)
            printf("\n%-17s %s\n  %s: %s\n", claim->id, claim->claim, claim_verdict_names[judgement.verdict],
                   judgement.evidence);
    }
    if (print) {
        printf("\nClaims:");
        for (int k = 0; k < CLAIM_VERDICTS; k++)
            printf("%s %d %s", k ? "," : "", counts[k], claim_verdict_names[k]);
        printf(".\n");
    }
    return text_file_close(&file, STATUS_OK);
}

/* Everything is worked out from the folder, so that a part that was measured earlier stays in the files. */
static enum status report(const char *directory, const struct claims *claims, const bool selected[TABLES_MAX])
{
    struct measured measured;
    struct reproduced *lines = NULL;
    int count = 0;
    enum status status = measured_read(directory, &measured);
    if (status == STATUS_OK)
        status = tables_evaluate(&measured, &lines, &count);
    if (status == STATUS_OK)
        status = reproduced_write(directory, &measured, lines, count);
    for (int k = 0; paper_tables[k].id && status == STATUS_OK; k++) {
        if (strcmp(paper_tables[k].id, "claims") == 0)
            status = claims_write(directory, claims, &measured, selected[k]);
        else if (selected[k])
            table_print(&paper_tables[k], lines, count);
    }
    if (status == STATUS_OK)
        printf("\nResults: %s/reproduced.csv, claims.csv, measurements.csv, targets.csv, phase figures.\n", directory);
    free(lines);
    measured_free(&measured);
    return status;
}

/* What we write is named as what we read: the folder of the latter is none for the former. */
static enum status directory_check(const char *directory)
{
    char path[4200];
    struct stat ours, theirs;
    snprintf(path, sizeof path, "%s/claims.csv", directory);
    if (stat(path, &theirs) == 0 && stat(CLAIMS_FILE, &ours) == 0 && ours.st_dev == theirs.st_dev
        && ours.st_ino == theirs.st_ino)
        return status_set(STATUS_INVALID,
                          "reproduce: -o %s: its claims.csv is the list of claims; another folder is "
                          "accepted",
                          directory);
    return STATUS_OK;
}

/* All that the tables rest on; the claims rest on all tables and on more. */
static int needs_collect(const bool selected[TABLES_MAX], const struct claims *claims, struct need needs[NEEDS_MAX])
{
    int count = 0;
    for (int k = 0; paper_tables[k].id; k++) {
        bool all = selected[k] && strcmp(paper_tables[k].id, "claims") == 0;
        if (selected[k])
            count = table_needs(paper_tables[k].id, needs, count, NEEDS_MAX);
        for (int n = 0; all && n < claims->need_count; n++)
            count = need_add(needs, count, NEEDS_MAX, claims->needs[n]);
    }
    return count;
}

enum status papers_reproduce(const char *const *ids, int count, const char *directory)
{
    bool selected[TABLES_MAX] = {false};
    struct need needs[NEEDS_MAX];
    struct claims claims = {0};
    struct batch batch = {0};
    enum status status = tables_select(ids, count, selected);
    if (status == STATUS_OK)
        status = directory_check(directory);
    if (status == STATUS_OK)
        status = claims_read(CLAIMS_FILE, &claims);
    if (status != STATUS_OK)
        return status;
    int need_count = needs_collect(selected, &claims, needs);
    status = batch_open(directory, need_count, false, &batch);
    for (int k = 0; k < need_count && status == STATUS_OK; k++)
        if (needs[k].scene)
            status = scene_measure(&batch, needs + k, need_count - k);
    if (status == STATUS_OK)
        status = phase_study(directory, true);
    if (status == STATUS_OK)
        status = report(directory, &claims, selected);
    claims_free(&claims);
    return batch_close(&batch, status);
}
