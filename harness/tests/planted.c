#include "tests/planted.h"
#include "files/paths.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "measure/outcome.h"

struct results_folder *rows;

void planted_begin(void)
{
    struct provenance provenance;
    provenance_fill(&provenance, omp_get_max_threads());
    assert_int_equal(results_folder_open(folder, &provenance, &rows), STATUS_OK);
}

void planted_end(struct measured *measured)
{
    results_folder_close(rows);
    assert_int_equal(measured_read(folder, measured), STATUS_OK);
}

struct measurement planted_row(const char *scene, const struct spec *spec)
{
    struct measurement row = measurement_empty(scene, spec->algorithm->name, spec->text, spec->precision);
    row.threads = omp_get_max_threads();
    row.engine = row.skipped = row.reason = row.stages = "";
    return row;
}

void planted_add(const char *scene, const char *spec_text, double run_s, const char *stages)
{
    struct spec spec;
    assert_int_equal(spec_parse(spec_text, &spec), STATUS_OK);
    struct measurement row = planted_row(scene, &spec);
    row.run_s = row.run_min_s = run_s;
    row.control_s = 1;
    row.stages = stages;
    row.flops_published = row.flops = 1;
    assert_int_equal(results_folder_add(rows, &row), STATUS_OK);
    spec_free(&spec);
}

void planted_islr(const char *scene, const char *spec_text, int first, int count, double islr_db)
{
    struct spec spec;
    assert_int_equal(spec_parse(spec_text, &spec), STATUS_OK);
    for (int k = first; k < first + count; k++) {
        struct target_row target = {scene,     spec.algorithm->name,
                                    spec.text, precision_name(spec.precision),
                                    k,         "azimuth",
                                    "pixel",   3,
                                    0,         0,
                                    0.04,      -15,
                                    islr_db};
        assert_int_equal(results_folder_targets(rows, &target, 1), STATUS_OK);
    }
    spec_free(&spec);
}

void planted_clear(struct measured *measured)
{
    measured_free(measured);
    folder_remove(NULL);
    assert_int_equal(mkdir(folder, 0700), 0);
}

struct evaluation evaluation_of(struct measured *measured, const char *id, enum scheme scheme)
{
    struct claims claims;
    struct evaluation evaluation = {.evidence = ""};
    bool found = false;
    assert_int_equal(claims_read(data_path(DATA_CLAIMS), &claims), STATUS_OK);
    for (int k = 0; k < claims.count && !found; k++)
        if (strcmp(claims.claims[k].id, id) == 0) {
            evaluation = claim_evaluate(&claims, &claims.claims[k], scheme, measured);
            found = true;
        }
    claims_free(&claims);
    if (!found)
        fail_msg("there is no claim %s", id);
    return evaluation;
}

static void expect_scheme(struct measured *measured, const char *id, enum scheme scheme, enum claim_verdict verdict)
{
    struct evaluation evaluation = evaluation_of(measured, id, scheme);
    if (evaluation.verdict != verdict)
        fail_msg("%s, %s: '%s' instead of '%s'; %s", id, scheme_names[scheme], claim_verdict_names[evaluation.verdict],
                 claim_verdict_names[verdict], evaluation.evidence);
}

void expect(struct measured *measured, const char *id, enum claim_verdict verdict)
{
    expect_scheme(measured, id, SCHEME_PRINTED, verdict);
}

void expect_corrected(struct measured *measured, const char *id, enum claim_verdict verdict)
{
    expect_scheme(measured, id, SCHEME_CORRECTED, verdict);
}

/* In a cell, or in the first rows of numbers.csv that it names. */
static bool cell_has(const struct claims *claims, const struct claim *claim, const char *cell, int above,
                     const char *text)
{
    const struct csv *numbers = &claims->numbers;
    bool has = strstr(cell, text) != NULL;
    for (int row = 0; row < above && !has; row++) {
        const char *of = csv_cell(numbers, row, NUMBER_OF);
        if ((strcmp(of, claim->id) == 0 || strcmp(of, claim->paper) == 0)
            && strstr(cell, csv_cell(numbers, row, NUMBER_NAME)))
            has = cell_has(claims, claim, csv_cell(numbers, row, NUMBER_DEFINITION), row, text);
    }
    return has;
}

bool claim_has(const struct claims *claims, const struct claim *claim, const char *text)
{
    const int all = claims->numbers.row_count;
    return cell_has(claims, claim, claim->arguments, all, text)
           || cell_has(claims, claim, claim->comparison, all, text);
}

enum status planted_claim(const char *comparison, const char *arguments, struct claims *claims)
{
    char text[2000];
    snprintf(text, sizeof text,
             "id,paper,section,claim,criterion,comparison,arguments,changed\n"
             "x-1,BP22,4.1,a sentence,a criterion,\"%s\",\"%s\",\n",
             comparison, arguments);
    support_write("bad.csv", text);
    return claims_read(path_of("bad.csv"), claims);
}
