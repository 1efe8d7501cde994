/* Tables of stability (table.h). */
#include "stability/stability_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "files/csv.h"
#include "echoes/echo_data.h"
#include "files/text_file.h"
#include "results/provenance.h"

enum { NAME_WIDTH = 18, CELL_WIDTH = 12 };

/* "bp_nearest:exact=true", without what every row of the algorithm says. */
static void spec_label(const struct spec *spec, char *label, size_t size)
{
    snprintf(label, size, "%s%s%s", spec->algorithm->name, *spec->text ? ":" : "", spec->text);
}

/* Is the SPEC the first of those that differ in precision only? */
static bool begins_column(const struct spec *specs, int k)
{
    return k == 0 || specs[k].algorithm != specs[k - 1].algorithm || strcmp(specs[k].text, specs[k - 1].text) != 0;
}

void stability_table_head(int spec_count, const struct spec *specs)
{
    int column = 0;
    printf("Digits lost against the method's own sum in extended precision, the worst of float and double, of rounding "
           "modes and\ntargets; up to %g is accepted. d: the method degrades; a name: the condition that refuses.\n\n",
           DIGITS_MOST);
    for (int k = 0; k < spec_count; k++)
        if (begins_column(specs, k)) {
            char label[400];
            spec_label(&specs[k], label, sizeof label);
            printf("  %2d  %s\n", ++column, label);
        }
    printf("\n%-*s", NAME_WIDTH, "");
    for (int k = 1; k <= column; k++)
        printf(" %*d", CELL_WIDTH, k);
    printf("\n");
}

/* The worse of a column's precisions. */
static const struct stability_verdict *worse_of_two(const struct stability_verdict *a,
                                                    const struct stability_verdict *b)
{
    if (a->kind != b->kind)
        return a->kind > b->kind ? a : b;
    return isnan(a->digits) || b->digits > a->digits ? b : a;
}

void stability_table_line(int spec_count, const struct stability_row *rows)
{
    const char *slash = strrchr(rows[0].scene, '/');
    printf("%-*.*s", NAME_WIDTH, NAME_WIDTH, slash ? slash + 1 : rows[0].scene);
    for (int k = 0; k < spec_count;) {
        char cell[40];
        const struct stability_verdict *worst = &rows[k].verdict;
        const int first = k++;
        for (; k < spec_count && rows[k].spec->algorithm == rows[first].spec->algorithm
               && strcmp(rows[k].spec->text, rows[first].spec->text) == 0;
             k++)
            worst = worse_of_two(worst, &rows[k].verdict);
        if (worst->kind == CANDIDATE_REFUSED)
            snprintf(cell, sizeof cell, "%.*s", CELL_WIDTH, worst->why);
        else if (worst->kind == VERDICT_FAILS)
            snprintf(cell, sizeof cell, "FAILS");
        else if (isnan(worst->digits))
            snprintf(cell, sizeof cell, "%s", worst->kind == VERDICT_DEGRADES ? "d" : "works");
        else
            snprintf(cell, sizeof cell, "%s%.1f", worst->kind == VERDICT_DEGRADES ? "d " : "", worst->digits);
        printf(" %*s", CELL_WIDTH, cell);
    }
    printf("\n");
    fflush(stdout);
}

/* ---- files ---- */

static void row_name_write(FILE *file, const struct stability_row *row)
{
    csv_write_text(file, row->scene);
    fprintf(file, ",%s,", row->spec->algorithm->name);
    csv_write_text(file, row->spec->text);
    fprintf(file, ",%s,", precision_name(row->spec->precision));
}

static bool has_image(const struct stability_verdict *verdict)
{
    return verdict->kind == VERDICT_WORKS || verdict->kind == VERDICT_DEGRADES || isfinite(verdict->spread);
}

static void row_write(FILE *file, int mode_count, const struct stability_row *row)
{
    const struct stability_verdict *v = &row->verdict;
    const double numbers[] = {v->error, v->error_most, v->difference, v->conditioning, v->digits, v->spread};
    char text[200];
    row_name_write(file, row);
    fprintf(file, "%d,", mode_count);
    csv_write_text(file, v->engine);
    verdict_text(v, text, sizeof text);
    fputc(',', file);
    csv_write_text(file, text);
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        if (isfinite(numbers[k]))
            fprintf(file, ",%.3g", numbers[k]);
        else
            fputc(',', file);
    if (has_image(v))
        fprintf(file, ",%s,%s,%d,", v->same_bits ? "yes" : "no", v->finite ? "yes" : "no", v->exceptions);
    else
        fprintf(file, ",,,,");
    csv_write_text(file, v->message);
    fputc('\n', file);
}

enum status stability_write(const char *path, int mode_count, int count, const struct stability_row *rows)
{
    struct text_file file;
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    struct provenance provenance;
    provenance_fill(&provenance, 2);
    fprintf(file.stream,
            "# sasbench stability 1\n# machine: %s\n# isa: %s\n# compiler: %s\n# flags: %s\n# libraries: %s\n"
            "# commit: %s\n# date: %s\n# threads: 1 and 2\n",
            provenance.machine, provenance.isa, provenance.compiler, provenance.flags, provenance.libraries,
            provenance.commit, provenance.date);
    fprintf(file.stream, "scene,algorithm,options,precision,modes,engine,verdict,error,error_bound,difference,"
                         "conditioning,digits,spread,same_bits,finite,exceptions,reason\n");
    for (int k = 0; k < count; k++)
        row_write(file.stream, mode_count, &rows[k]);
    return text_file_close(&file, STATUS_OK);
}

/* What is committed: promises as they are, what degrades with a quarter of room. */
static double bound_of(const struct stability_verdict *verdict)
{
    double bound = verdict->kind == VERDICT_DEGRADES ? 1.25 * verdict->error : verdict->error_most;
    return verdict->kind == VERDICT_WORKS || verdict->kind == VERDICT_DEGRADES ? bound : NAN;
}

enum status stability_expected_write(const char *path, int count, const struct stability_row *rows)
{
    struct text_file file;
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    fprintf(file.stream, "# sasbench expected stability 1\n"
                         "# Verdicts and bounds that `sasbench stability` must keep. It writes this file anew as "
                         "DIR/expected.csv: docs/stability.md.\n"
                         "scene,algorithm,options,precision,verdict,error_bound,digits_bound\n");
    for (int k = 0; k < count; k++) {
        const double bound = bound_of(&rows[k].verdict);
        char text[200];
        row_name_write(file.stream, &rows[k]);
        verdict_text(&rows[k].verdict, text, sizeof text);
        csv_write_text(file.stream, text);
        if (isfinite(bound))
            fprintf(file.stream, ",%.3g,%g\n", bound, DIGITS_MOST);
        else
            fprintf(file.stream, ",,\n");
    }
    return text_file_close(&file, STATUS_OK);
}

/* ---- against what is expected ---- */

enum { SCENE, ALGORITHM, OPTIONS, PRECISION, VERDICT, ERROR_BOUND, DIGITS_BOUND, COLUMNS };
static const char *const column_names[COLUMNS] = {"scene",   "algorithm",   "options",     "precision",
                                                  "verdict", "error_bound", "digits_bound"};

/* The row of the file that is about the same image, -1 if there is none. */
static int row_find(const struct csv *csv, const int *columns, const struct stability_row *row)
{
    for (int k = 0; k < csv->row_count; k++)
        if (strcmp(csv_cell(csv, k, columns[SCENE]), row->scene) == 0
            && strcmp(csv_cell(csv, k, columns[ALGORITHM]), row->spec->algorithm->name) == 0
            && strcmp(csv_cell(csv, k, columns[OPTIONS]), row->spec->text) == 0
            && strcmp(csv_cell(csv, k, columns[PRECISION]), precision_name(row->spec->precision)) == 0)
            return k;
    return -1;
}

/* What of a row is not as expected, into *fault; false: nothing. */
static bool row_differs(const struct csv *csv, const int *columns, int expected, const struct stability_row *row,
                        char *fault, size_t size)
{
    const struct stability_verdict *v = &row->verdict;
    char text[200];
    double error_bound, digits_bound;
    verdict_text(v, text, sizeof text);
    if (expected < 0) {
        snprintf(fault, size, "%s", text);
        return v->kind == VERDICT_FAILS;
    }
    const char *wanted = csv_cell(csv, expected, columns[VERDICT]);
    if (strcmp(text, wanted) != 0) {
        snprintf(fault, size, "%s, expected: %s", text, wanted);
        return true;
    }
    csv_number(csv_cell(csv, expected, columns[ERROR_BOUND]), &error_bound);
    csv_number(csv_cell(csv, expected, columns[DIGITS_BOUND]), &digits_bound);
    if (v->error > error_bound)
        snprintf(fault, size, "error %.3g, bound %.3g", v->error, error_bound);
    else if (v->digits > digits_bound)
        snprintf(fault, size, "%.1f digits lost, bound %.1f", v->digits, digits_bound);
    return v->error > error_bound || v->digits > digits_bound;
}

enum status stability_compare(const char *path, int count, const struct stability_row *rows, int *differ, int *unknown)
{
    struct csv csv;
    int columns[COLUMNS];
    enum status status = csv_read(path, CSV_TAIL_KEEP, &csv);
    *differ = *unknown = 0;
    for (int k = 0; k < COLUMNS && status == STATUS_OK; k++) {
        columns[k] = csv_column(&csv, column_names[k]);
        if (columns[k] < 0)
            status = status_set(STATUS_INVALID, "%s: has no column %s, must be what `stability` wrote", path,
                                column_names[k]);
    }
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        char label[400], fault[300];
        int expected = row_find(&csv, columns, &rows[k]);
        if (row_differs(&csv, columns, expected, &rows[k], fault, sizeof fault)) {
            spec_label(rows[k].spec, label, sizeof label);
            printf("%s %s %s: %s\n    %s\n", rows[k].scene, label, precision_name(rows[k].spec->precision), fault,
                   rows[k].verdict.message);
            ++*differ;
        } else {
            *unknown += expected < 0;
        }
    }
    csv_free(&csv);
    return status;
}
