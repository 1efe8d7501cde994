/* Criteria that the papers' own printed numbers meet: their tables are planted as if they had been measured, and each
   claim that needs nothing else has to hold, unless the paper contradicts itself. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "files/paths.h"
#include "papers/assumptions.h"
#include "tests/planted.h"

/* Scenes whose targets are those of a table, again and again. */
static const struct {
    const char *scene, *table;
    int first, count; /* of the table's targets, "T1" or "PT1" on; 0: it has one, without a number */
} layouts[] = {
    {"bp22/table3", "bp22_t3", 1, 6},       {"bp22/many", "bp22_t3", 1, 6},
    {"lbf21/blocks", "lbf21_t2", 0, 1},     {"lbf21/table3_near", "lbf21_t3", 1, 2},
    {"lbf21/table3_far", "lbf21_t3", 3, 4}, {"lbf21/table4_near", "lbf21_t4", 7, 2},
    {"lbf21/table4_far", "lbf21_t4", 9, 2},
};
enum { HELD = 57 }; /* claims, twice where they have two schemes, that the tables decide */
enum { LAYOUTS = sizeof layouts / sizeof *layouts };

static bool begins(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

/* The paper's name in `table` of what is measured with SPEC; records upsampled once, by zeros, are those of linear
   upsampling. */
static const char *method_of(const char *table, const char *scene, const char *spec)
{
    const struct source *source;
    const char *found = NULL;
    if (begins(spec, "rma_pca:blocks=16,")) /* the paper's PCA has no blocks */
        spec = "rma_pca:blocks=16";
    const bool by_3 = begins(spec, "bp_zeropad:factor=3"), by_9 = begins(spec, "bp_zeropad:factor=9");
    if (begins(table, "bp22") && (by_3 || by_9))
        return by_3 ? "linear, beta 2" : "linear, beta 8";
    for (int k = 0; (source = source_at(k)); k++)
        if (strcmp(source->table, table) == 0 && strcmp(source->spec, spec) == 0
            && (!source->scene || strcmp(table, "lbf21_t2") != 0 || strcmp(source->scene, scene) == 0))
            found = source->method;
    return found;
}

static double number(const char *table, const char *target, const char *method, const char *quantity)
{
    static struct csv published;
    double value;
    if (!published.row_count)
        assert_int_equal(csv_read(SASBENCH_ROOT "/results/published.csv", CSV_TAIL_KEEP, &published), STATUS_OK);
    return method && published_values(&published, table, target, method, quantity, &value, 1) ? value : NAN;
}

/* Of all targets that the scene has at most. Errors are not printed; LBF's is less than PCA's in words. */
static void targets_plant(const struct need *need, const struct spec *spec, struct measurement *image)
{
    static const char *const definitions[] = {"null", "3db", "pixel"};
    int l = LAYOUTS - 1;
    while (l >= 0 && !begins(need->scene, layouts[l].scene))
        l--;
    if (l < 0)
        return;
    const char *table = layouts[l].table, *method = method_of(table, need->scene, need->spec);
    if (begins(table, "lbf21") && layouts[l].first)
        image->error = method && strcmp(method, "LBF") == 0 ? 0.01 : 0.1;
    for (int target = 0; target < 48; target++)
        for (int d = 0; d < 3; d++) {
            char name[20] = "(260 m; 16 m)";
            if (layouts[l].first)
                snprintf(name, sizeof name, "%sT%d", begins(table, "bp22") ? "" : "P",
                         layouts[l].first + target % layouts[l].count);
            const double shift_m = number(table, name, method, "offset_m");
            const struct target_row row = {.scene = need->scene,
                                           .algorithm = spec->algorithm->name,
                                           .options = spec->text,
                                           .precision = precision_name(spec->precision),
                                           .target = target,
                                           .axis = "azimuth",
                                           .definition = definitions[d],
                                           .extent_m = 3,
                                           .position_error_m = isnan(shift_m) ? 0 : shift_m,
                                           .width_m = NAN,
                                           .pslr_db = number(table, name, method, "pslr_db"),
                                           .islr_db = number(table, name, method, "islr_db")};
            assert_int_equal(results_folder_targets(rows, &row, 1), STATUS_OK);
        }
}

/* Times of whole tasks; those of parts are scaled by the focus stage alone. */
static void times_plant(const struct need *need, struct measurement *row, char stages[100])
{
    const bool is_bp22 = begins(need->scene, "bp22/full");
    const char *table = is_bp22 ? "bp22_t4" : "lbf21_t5";
    const char *method = method_of(table, need->scene, need->spec);
    const double seconds = number(table, "", method, "time_s");
    const double part = strstr(need->scene, "_columns") ? (is_bp22 ? 48 : 40) : strstr(need->scene, "_part") ? 36 : 1;
    row->run_s = row->run_min_s = seconds / part;
    row->control_s = 1;
    snprintf(stages, 100, "compress=0;focus=%.9g;bulk=%.9g;differential=0;reconstruct=0", seconds / part,
             seconds / part);
    row->stages = stages;
    row->flops = is_bp22 ? number("bp22_t1", "", method_of("bp22_t1", need->scene, need->spec), "flops") : seconds;
    row->flops_published = row->flops;
}

static void claim_plant(const struct claim *claim)
{
    planted_begin();
    for (int k = 0; k < claim->need_count; k++) {
        struct spec spec;
        char stages[100] = "";
        assert_int_equal(spec_own(claim->needs[k].spec, &spec), STATUS_OK);
        struct measurement row = planted_row(claim->needs[k].scene, &spec);
        targets_plant(&claim->needs[k], &spec, &row);
        if (strstr(row.scene, "/full") || strstr(row.scene, "/real_size"))
            times_plant(&claim->needs[k], &row, stages);
        assert_int_equal(results_folder_add(rows, &row), STATUS_OK);
        spec_free(&spec);
    }
}

/* What the printed numbers do not make hold, and why. */
static const struct {
    const char *claim, *why;
} exceptions[] = {
    {"bp22-3.1-1b", "no time of interpolation by FFT is printed; that of linear upsampling stands for it here"},
    {"bp22-5-4", "the sentence contradicts Table 4"},
    {"bp22-5-5", "by Table 4 an image takes longer than its pings"},
    {"zp15-abstract-2", "ZP15 prints no times"},
};

static bool is_exception(const char *id)
{
    for (size_t k = 0; k < sizeof exceptions / sizeof *exceptions; k++)
        if (strcmp(exceptions[k].claim, id) == 0)
            return true;
    return false;
}

static void printed_numbers_hold(void **state)
{
    (void)state;
    struct claims claims;
    int held = 0;
    assert_int_equal(claims_read(data_path(DATA_CLAIMS), &claims), STATUS_OK);
    for (int k = 0; k < claims.count; k++) {
        const struct claim *claim = &claims.claims[k];
        struct measured measured;
        if (!comparison_decides(claim->comparison) || !claim->need_count || claim->phases || claim->rules
            || strcmp(claim->paper, "SQ18") == 0 || strcmp(claim->paper, "PF05") == 0)
            continue;
        claim_plant(claim);
        planted_end(&measured);
        for (enum scheme scheme = 0; scheme < (claim->by_scheme ? SCHEMES : 1); scheme++) {
            const struct evaluation found = claim_evaluate(&claims, claim, scheme, &measured);
            const bool holds = found.verdict == CLAIM_HOLDS || found.verdict == CLAIM_ASSUMED;
            held += holds;
            if (!*measured.missing && holds == is_exception(claim->id))
                fail_msg("%s: %s; %s", claim->id, claim_verdict_names[found.verdict], found.evidence);
        }
        planted_clear(&measured);
    }
    assert_int_equal(held, HELD);
    claims_free(&claims);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, folder_make, folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_FOLDER(printed_numbers_hold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
