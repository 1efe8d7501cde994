/* Tables of stability (stability_table.h). */
#include "stability/stability_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "files/csv.h"
#include "echoes/echo_data.h"
#include "files/text_file.h"
#include "results/rows.h"

enum { WORD = 80, REASONS_MOST = 24 };

void stability_table_head(void)
{
    printf("Digits that a scene's images lose at most, against the same sums in extended\n"
           "precision, of all rounding modes and targets; up to %g is accepted.\n\n"
           "%-18s %6s %6s  %-13s %s\n",
           DIGITS_MOST, "scene", "images", "digits", "of", "refused by");
}

/* Common to some SPECs of a scene: the condition that refuses, or "degrade". */
struct reason {
    char name[WORD];
    int count;
};

static void reason_count(struct reason *reasons, const char *name)
{
    int k = 0;
    while (k < REASONS_MOST - 1 && reasons[k].count && strcmp(reasons[k].name, name) != 0)
        k++;
    snprintf(reasons[k].name, WORD, "%s", name);
    reasons[k].count++;
}

/* A SPEC in both precisions counts once for each. */
void stability_table_line(int spec_count, const struct stability_row *rows)
{
    const char *slash = strrchr(rows[0].scene, '/');
    const struct stability_row *worst = NULL;
    struct reason reasons[REASONS_MOST] = {0};
    char digits[24] = "-";
    int images = 0;
    for (int k = 0; k < spec_count; k++) {
        const struct stability_verdict *v = &rows[k].verdict;
        images += v->kind == VERDICT_WORKS || v->kind == VERDICT_DEGRADES;
        if (v->kind == CANDIDATE_REFUSED)
            reason_count(reasons, v->why);
        else if (v->kind != VERDICT_WORKS)
            reason_count(reasons, v->kind == VERDICT_FAILS ? "FAILS" : "degrades");
        if (isfinite(v->digits) && (!worst || v->digits > worst->verdict.digits))
            worst = &rows[k];
    }
    if (worst)
        snprintf(digits, sizeof digits, "%.1f", worst->verdict.digits);
    printf("%-18.18s %6d %6s  %-13s", slash ? slash + 1 : rows[0].scene, images, digits,
           worst ? worst->spec->algorithm->name : "");
    for (int k = 0; k < REASONS_MOST && reasons[k].count; k++)
        printf("%s%s %d", k ? ", " : " ", reasons[k].name, reasons[k].count);
    printf("\n");
    fflush(stdout);
}

/* ---- files ---- */

static void row_name_write(FILE *file, const struct stability_row *row)
{
    const struct spec *spec = row->spec;
    csv_write_fields(
        file,
        (const char *const[]){row->scene, spec->algorithm->name, spec->text, precision_name(spec->precision), NULL},
        NULL, 0, false);
}

static bool has_image(const struct stability_verdict *verdict)
{
    return verdict->kind == VERDICT_WORKS || verdict->kind == VERDICT_DEGRADES || isfinite(verdict->spread);
}

static void stability_row_write(FILE *file, int mode_count, const struct stability_row *row)
{
    const struct stability_verdict *v = &row->verdict;
    double numbers[] = {v->error, v->error_most, v->difference, v->conditioning, v->digits, v->spread};
    char text[200], flags[16] = "";
    row_name_write(file, row);
    fprintf(file, "%d,", mode_count);
    verdict_text(v, text, sizeof text);
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        numbers[k] = isfinite(numbers[k]) ? numbers[k] : NAN;
    csv_write_fields(file, (const char *const[]){v->engine, text, NULL}, numbers, 6, false);
    if (has_image(v))
        snprintf(flags, sizeof flags, "%d", v->exceptions);
    const char *const same = v->same_bits ? "yes" : "no", *const finite = v->finite ? "yes" : "no";
    csv_write_fields(
        file, (const char *const[]){has_image(v) ? same : "", has_image(v) ? finite : "", flags, v->message, NULL},
        NULL, 0, true);
}

enum status stability_write(const char *path, int mode_count, int count, const struct stability_row *rows)
{
    struct text_file file;
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    struct provenance provenance;
    provenance_fill(&provenance, 2);
    fputs("# sasbench stability 1\n", file.stream);
    provenance_write(file.stream, &provenance);
    fprintf(file.stream,
            "# threads: 1 and 2\nscene,algorithm,options,precision,modes,engine,verdict,error,error_bound,difference,"
            "conditioning,digits,spread,same_bits,finite,exceptions,reason\n");
    for (int k = 0; k < count; k++)
        stability_row_write(file.stream, mode_count, &rows[k]);
    return text_file_close(&file, STATUS_OK);
}

/* The committed bound: promises unchanged, the error of a degraded image with a quarter of room. */
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

/* ---- comparison with the expected rows ---- */

enum { SCENE, ALGORITHM, OPTIONS, PRECISION, VERDICT, ERROR_BOUND, DIGITS_BOUND, COLUMNS };
static const char *const column_names[] = {"scene",   "algorithm",   "options",      "precision",
                                           "verdict", "error_bound", "digits_bound", NULL};

/* The row of the file for the same image, -1 without one. */
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

/* How a row differs from the expected one, into *fault; false: not at all. */
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
    if (status == STATUS_OK)
        status = csv_columns(&csv, column_names, columns);
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        char fault[300];
        int expected = row_find(&csv, columns, &rows[k]);
        if (row_differs(&csv, columns, expected, &rows[k], fault, sizeof fault)) {
            const struct spec *spec = rows[k].spec;
            printf("%s %s%s%s %s: %s\n    %s\n", rows[k].scene, spec->algorithm->name, *spec->text ? ":" : "",
                   spec->text, precision_name(spec->precision), fault, rows[k].verdict.message);
            ++*differ;
        } else {
            *unknown += expected < 0;
        }
    }
    csv_free(&csv);
    return status;
}
