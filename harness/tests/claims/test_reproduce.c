/* The papers' tables and claims: all printed numbers are there, nothing is said without a measurement, verdicts
   change with a fault in an algorithm, and finished measurements are kept. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files/paths.h"
#include "command/task.h"
#include "measure/outcome.h"
#include "papers/assumptions.h"
#include "tests/planted.h"

/* --- Tables and claims as such -------------------------------------------------------------------------------- */

static void all_printed_numbers_are_there(void **state)
{
    (void)state;
    static const struct {
        const char *table;
        int rows, numbers; /* ZP15's figures and some of LBF21's come without numbers */
    } wanted[] = {
        {"bp22_t1", 4, 4},    {"bp22_t3", 48, 48},      {"bp22_t4", 4, 4},     {"bp22_eq20", 1, 1},
        {"bp22_f8", 0, 0},    {"bp22_f9", 0, 0},        {"bp22_f10", 0, 0},    {"zp15_f3", 6, 0},
        {"zp15_f4", 9, 0},    {"zp15_f4_close", 0, 0},  {"lbf21_t2", 16, 16},  {"lbf21_t3", 36, 36},
        {"lbf21_t4", 36, 36}, {"lbf21_t5", 5, 3},       {"lbf21_flops", 4, 4}, {"lbf21_f2", 1, 1},
        {"lbf21_f3", 1, 1},   {"lbf21_f4", 1, 0},       {"lbf21_f5", 1, 1},    {"lbf21_f6", 2, 2},
        {"lbf21_f7", 1, 1},   {"lbf21_f8", 1, 1},       {"lbf21_f9", 1, 1},    {"lbf21_f11", 0, 0},
        {"lbf21_f12", 0, 0},  {"lbf21_f13", 0, 0},      {"lbf21_f14", 0, 0},   {"lbf21_f15", 0, 0},
        {"lbf21_f16", 0, 0},  {"lbf21_f17", 0, 0},      {"lbf21_f18", 0, 0},   {"pf05_t1", 4, 4},
        {"pf05_f5", 36, 0},   {"pf05_f5_echoes", 0, 0}, {"sq18_f3a", 5, 0},    {"sq18_f3b", 3, 0},
        {"claims", 22, 22},
    };
    struct measured measured;
    assert_int_equal(measured_read(folder, &measured), STATUS_OK);
    const struct csv *csv = &measured.published;
    int total = 0;
    for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++) {
        int count = 0, numbers = 0;
        assert_non_null(paper_tables[k].id);
        assert_string_equal(paper_tables[k].id, wanted[k].table);
        for (int row = 0; row < csv->row_count; row++)
            if (strcmp(csv_cell(csv, row, PUBLISHED_TABLE), wanted[k].table) == 0) {
                double number;
                assert_true(csv_number(csv_cell(csv, row, PUBLISHED_PAPER), &number));
                assert_true(*csv_cell(csv, row, PUBLISHED_SOURCE) != '\0');
                numbers += isfinite(number);
                count++;
            }
        if (count != wanted[k].rows || numbers != wanted[k].numbers)
            fail_msg("%s: %d rows, %d numbers", wanted[k].table, count, numbers);
        total += count;
    }
    assert_null(paper_tables[sizeof wanted / sizeof *wanted].id);
    assert_int_equal(total, csv->row_count);
    measured_free(&measured);
}

/* The largest distances from back projection or sinc that sentences quote are those of the tables; where one is not, a
   claim says so (lbf21-5C-5, lbf21-5C-10). */
static void sentences_quote_the_tables(void **state)
{
    (void)state;
    static const struct {
        const char *claim, *table, *targets, *method, *base;
    } quotes[] = {
        {"bp22-4.1-9", "bp22_t3", "T1..T6", "nearest", "sinc"},
        {"bp22-4.1-10", "bp22_t3", "T1..T6", "linear, beta 2", "sinc"},
        {"bp22-4.1-11", "bp22_t3", "T1..T6", "linear, beta 8", "sinc"},
        {"lbf21-5B-2", "lbf21_t3", "PT1..PT2", "LBF", "BP"},
        {"lbf21-5B-3", "lbf21_t3", "PT1..PT2", "PCA", "BP"},
        {"lbf21-5B-4", "lbf21_t3", "PT3..PT6", "LBF", "BP"},
        {"lbf21-5B-5", "lbf21_t3", "PT3..PT6", "PCA", "BP"},
        {"lbf21-5C-2", "lbf21_t4", "PT9..PT10", "LBF", "BP"},
        {"lbf21-5C-3", "lbf21_t4", "PT9..PT10", "PCA", "BP"},
        {"lbf21-5C-4", "lbf21_t4", "PT9..PT10", "Wu", "BP"},
    };
    static const char *const losses[] = {"pslr_loss_db", "islr_loss_db"}, *const lobes[] = {"pslr_db", "islr_db"};
    struct measured measured;
    int compared = 0;
    assert_int_equal(measured_read(folder, &measured), STATUS_OK);
    for (size_t k = 0; k < sizeof quotes / sizeof *quotes; k++)
        for (int lobe = 0; lobe < 2; lobe++) {
            double quoted, ours[8], base[8], largest = 0;
            const struct csv *csv = &measured.published;
            if (published_values(csv, "claims", quotes[k].claim, quotes[k].method, losses[lobe], &quoted, 1) == 0)
                continue;
            int count =
                published_values(csv, quotes[k].table, quotes[k].targets, quotes[k].method, lobes[lobe], ours, 8);
            assert_int_equal(
                published_values(csv, quotes[k].table, quotes[k].targets, quotes[k].base, lobes[lobe], base, 8), count);
            for (int n = 0; n < count; n++)
                largest = fmax(largest, fabs(ours[n] - base[n]));
            bool other = (strcmp(quotes[k].claim, "lbf21-5C-3") == 0 && lobe == 1)
                         || (strcmp(quotes[k].claim, "lbf21-5C-4") == 0 && lobe == 0);
            if ((fabs(largest - quoted) < 1e-6) == other)
                fail_msg("%s %s: %g in the sentence, %g in the table", quotes[k].claim, losses[lobe], quoted, largest);
            compared++;
        }
    assert_int_equal(compared, 17);
    measured_free(&measured);
}

/* The FLOPs that the papers give as formulas. */
static void printed_formulas_are_right(void **state)
{
    (void)state;
    const double a = 2880, r = 4800, first = 10 * a * r * log2(r) + 6 * a * r + 6 * a * a * r; /* BP22 Eq. (11) */
    const double n = 3200, s = 4096, m = 48, taps = 8, log_s = log2(s), log_n = log2(n);
    const struct {
        const char *table, *method;
        double flops;
    } wanted[] = {
        {"bp22_t1", "nearest", first},
        {"bp22_t1", "linear, beta 2", first + 6 * 2 * a * (r - 1)},
        {"bp22_t1", "linear, beta 8", first + 6 * 8 * a * (r - 1)},
        {"bp22_t1", "sinc", first + 2 * (2 * 8 - 1) * a * a * r},
        {"lbf21_flops", "LBF", n * s * (3 * (m + 1) * log_s + 2 * (m + 1) + 1.5 * (m + 1) * log_n + 2 * taps - 1)},
        {"lbf21_flops", "PCA", n * s * (3 * (m + 1) * log_s + m + 2 + 1.5 * (m + 1) * log_n + 2 * (2 * taps - 1))},
        {"lbf21_flops", "Wu", n * s * (3 * (2 * m + 1) * log_s + 3 * log_n + 2 * (m + 1) + 2 * taps - 1)},
        {"lbf21_flops", "BP", n * s * (1.5 * log_s + 1 + 1.5 * taps * log2(taps * s))},
    };
    struct measured measured;
    assert_int_equal(measured_read(folder, &measured), STATUS_OK);
    for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++) {
        double printed = published_value(&measured, wanted[k].table, "", wanted[k].method, "flops");
        if (!(fabs(printed / wanted[k].flops - 1) < 1e-4))
            fail_msg("%s, %s: %g instead of %g", wanted[k].table, wanted[k].method, printed, wanted[k].flops);
    }
    measured_free(&measured);
}

static void rate_of_eq20(void **state)
{
    (void)state;
    assert_int_equal(upsampling_rate(0.025, 0.04, 0.01), 3); /* BP22 Table 2: 2 b/3 = .01667 is not below .016 */
    assert_int_equal(upsampling_rate(0.025, 0.041, 0.01), 2);
    assert_int_equal(upsampling_rate(0.0001, 0.04, 0.01), 0);
}

/* Every number comes from a measurement: without any, nothing is decided and no value is there. */
static void nothing_is_said_without_measurements(void **state)
{
    (void)state;
    struct measured measured;
    struct reproduced *lines;
    struct claims claims;
    int count;
    assert_int_equal(measured_read(folder, &measured), STATUS_OK);
    assert_int_equal(claims_read(data_path(DATA_CLAIMS), &claims), STATUS_OK);
    for (int k = 0; k < claims.count; k++) {
        if (claim_has(&claims, &claims.claims[k], "flops") /* from plans of full-size scenes, which take seconds */
            || claim_has(&claims, &claims.claims[k], "planned(") || claim_has(&claims, &claims.claims[k], "filtered("))
            continue;
        struct evaluation found = claim_evaluate(&claims, &claims.claims[k], SCHEME_PRINTED, &measured);
        bool formula = comparison_identity(claims.claims[k].comparison) && !claims.claims[k].phases;
        if ((found.verdict == CLAIM_UNDECIDED) == formula || !*found.evidence)
            fail_msg("%s: %s, %s", claims.claims[k].id, claim_verdict_names[found.verdict], found.evidence);
    }
    bool asked[64] = {false};
    assert_int_equal(tables_evaluate(&measured, asked, &lines, &count), STATUS_OK);
    assert_true(count > 2 * (measured.published.row_count - 40)); /* those of plans and sentences are left out */
    for (int k = 0; k < count; k++)
        if (strcmp(lines[k].definition, "rho_a = D_tx/2") != 0 && (isfinite(lines[k].ours) || !*lines[k].missing))
            fail_msg("%s %s %s: %g without a measurement", lines[k].table, lines[k].target, lines[k].method,
                     lines[k].ours);
    claims_free(&claims);
    free(lines);
    measured_free(&measured);
}

/* A measurement of everything that a table may want of this need, and all its targets. */
static void need_plant(const struct need *need)
{
    static const char *const definitions[] = {"null", "3db", "pixel", "null"}; /* the last one along range */
    struct spec spec;
    struct scene scene;
    assert_int_equal(assumed_scene_load(need->scene, &scene), STATUS_OK);
    assert_int_equal(spec_own(need->spec, &spec), STATUS_OK);
    for (int target = 0; target < scene.point_count; target++)
        for (int d = 0; d < 4; d++) {
            struct target_row row = {need->scene,
                                     spec.algorithm->name,
                                     spec.text,
                                     precision_name(spec.precision),
                                     target,
                                     d < 3 ? "azimuth" : "range",
                                     definitions[d],
                                     3,
                                     0,
                                     0,
                                     0.04,
                                     -15,
                                     -10};
            assert_int_equal(results_folder_targets(rows, &row, 1), STATUS_OK);
        }
    struct measurement row = planted_row(need->scene, &spec);
    row.stages = "compress=1;bulk=1;differential=1;reconstruct=1;focus=1";
    row.run_s = row.run_min_s = row.control_s = row.flops = row.flops_published = row.bytes = row.entropy =
        row.peak_over_median = row.error = row.phase_rms_rad = row.width_m = 10;
    row.pslr_db = row.islr_db = -10;
    assert_int_equal(results_folder_add(rows, &row), STATUS_OK);
    spec_free(&spec);
    scene_free(&scene);
}

static void assert_all_measured(const struct measured *measured, const struct reproduced *lines, int count)
{
    int printed = 0;
    for (int row = 0; row < measured->published.row_count; row++) /* what is said in words has no table */
        printed += strcmp(csv_cell(&measured->published, row, PUBLISHED_TABLE), "claims") != 0;
    for (int k = 0, of_row = 0; k < count; k++) {
        bool phase = strcmp(lines[k].quantity, "phase_error_rad") == 0; /* comes from the phase study */
        if (!phase && !isfinite(lines[k].ours))
            fail_msg("%s %s %s: %s", lines[k].table, lines[k].target, lines[k].method, lines[k].missing);
        of_row += k == 0 || lines[k].target != lines[k - 1].target || lines[k].method != lines[k - 1].method
                  || lines[k].quantity != lines[k - 1].quantity;
        if (k == count - 1)
            assert_true(of_row >= printed);
    }
}

/* Each printed number has its line, and each line its measurement among the needs of its table. */
static void every_line_can_be_measured(void **state)
{
    (void)state;
    struct measured measured;
    struct reproduced *lines;
    struct claims claims;
    struct need needs[256];
    int count, need_count = 0;
    assert_int_equal(claims_read(data_path(DATA_CLAIMS), &claims), STATUS_OK);
    for (int k = 0; paper_tables[k].id; k++)
        need_count = table_needs(paper_tables[k].id, needs, need_count, 256);
    for (int n = 0; n < claims.count; n++)
        for (int k = 0; k < claims.claims[n].need_count; k++)
            need_count = need_add(needs, need_count, 256, claims.claims[n].needs[k]);
    assert_true(need_count < 256);
    planted_begin();
    for (int k = 0; k < need_count; k++)
        need_plant(&needs[k]);
    planted_end(&measured);
    assert_int_equal(tables_evaluate(&measured, NULL, &lines, &count), STATUS_OK);
    assert_all_measured(&measured, lines, count);
    for (int k = 0; k < claims.count; k++) {
        struct evaluation found = claim_evaluate(&claims, &claims.claims[k], SCHEME_PRINTED, &measured);
        if (strstr(found.evidence, "was not measured") || strstr(found.evidence, "is undefined"))
            fail_msg("%s: %s", claims.claims[k].id, found.evidence);
        assert_true(strlen(found.evidence) < sizeof found.evidence - 1); /* nothing was cut off */
    }
    claims_free(&claims);
    free(lines);
    measured_free(&measured);
}

/* Times of a part are scaled stage by stage, and evaluated by the paper's ratio with a margin for noise. */
static void times_are_scaled(void **state)
{
    (void)state;
    static const struct {
        double sinc_s;
        const char *stages;
        enum claim_verdict verdict;
    } cases[] = {
        {5.25, "compress=0.25;focus=5", CLAIM_ASSUMED},     /* the planted work does not count so */
        {3.75, "compress=0.25;focus=3.5", CLAIM_UNDECIDED}, /* 3.5 times, which noise may be */
        {3.25, "compress=0.25;focus=3", CLAIM_FAILS},
    };
    static const char *const lines[] = {NEAREST, LINEAR_2, LINEAR_8};
    for (int n = 0; n < 3; n++) {
        struct measured measured;
        planted_begin();
        for (int k = 0; k < 3; k++) {
            char spec[200];
            snprintf(spec, sizeof spec, "%s%s" PLAIN_BP, lines[k], k ? "," : ":");
            planted_add("bp22/full_columns", spec, 1.25, "compress=0.25;focus=1");
        }
        planted_add("bp22/full_columns", SINC_8 "," PLAIN_BP, cases[n].sinc_s, cases[n].stages);
        planted_add("bp22/full_columns", "bp_zeropad:factor=9," PLAIN_BP, 2, "compress=1;focus=1"); /* upsampled once */
        planted_add("lbf21/real_size_part", "rma_lbf:variant=printed,spacing=uniform,blend=off,blocks=16," PLAIN_RMA,
                    10, "compress=1;bulk=2;differential=3;reconstruct=2;stolt=2");
        static const char *const scenes[] = {"bp22/full", "bp22/full_limited"};
        for (int k = 0; k < 2; k++) {
            for (int l = 0; l < 3; l++)
                planted_add(scenes[k], lines[l], 1, "compress=0.1;focus=0.9");
            planted_add(scenes[k], "bp_zeropad:factor=9", 2, "compress=1.1;focus=0.9");
            planted_add(scenes[k], SINC_8, 3, "");
        }
        planted_end(&measured);
        const enum scheme scheme = SCHEME_PRINTED;
        assert_close(table_seconds(&measured, scheme, "bp22_t4", "linear, beta 8", PLAIN_TIMES), 48 * 1 + 0.25, 1e-9);
        assert_close(table_seconds(&measured, scheme, "lbf21_t5", "LBF, 16 blocks", PLAIN_TIMES), 36 * 7 + 6 * 3, 1e-9);
        assert_close(table_seconds(&measured, scheme, "bp22_t4", "sinc", FAST_TIMES), 3, 1e-9);
        assert_close(table_noise(&measured, "bp22_t4", FAST_TIMES), 0.1, 1e-9);
        expect(&measured, "bp22-4.2-5", cases[n].verdict);
        planted_clear(&measured);
    }
}

/* Noise is a tenth at least, and what a method's runs or the loop timed beside them differ by. */
static void noise_is_measured(void **state)
{
    (void)state;
    static const char *const specs[] = {NEAREST, LINEAR_2, LINEAR_8, SINC_8};
    static const struct {
        double slowest_s, control_s, noise;
    } cases[] = {{1, 1, 0.1}, {1.25, 1, 0.25}, {1, 1.5, 0.5}};
    for (int n = 0; n < 3; n++) {
        struct measured measured;
        planted_begin();
        for (int k = 0; k < 4; k++) {
            struct spec spec;
            assert_int_equal(spec_parse(specs[k], &spec), STATUS_OK);
            struct measurement row = planted_row("bp22/full", &spec);
            row.run_min_s = 1;
            row.run_s = k == 1 ? cases[n].slowest_s : 1;
            row.control_s = k == 2 ? cases[n].control_s : 1;
            assert_int_equal(results_folder_add(rows, &row), STATUS_OK);
            spec_free(&spec);
        }
        planted_end(&measured);
        assert_close(table_noise(&measured, "bp22_t4", FAST_TIMES), cases[n].noise, 1e-9);
        planted_clear(&measured);
    }
}

/* --- The command ---------------------------------------------------------------------------------------------- */

static char *text_read(const char *name)
{
    static char text[1 << 20];
    char path[300];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    return text;
}

/* A results file's text without the second at which its head was written. */
static char *undated(char *text)
{
    char *date = strstr(text, "\n# date: ");
    assert_non_null(date);
    for (date++; *date != '\n'; date++)
        *date = '-';
    return text;
}

static void unknown_table_is_refused(void **state)
{
    (void)state;
    char results[300];
    snprintf(results, sizeof results, "%s/results", folder);
    const char *const names[] = {"bp22_eq20", "bp22_t2"};
    assert_int_equal(command_reproduce(&(struct task){.names = names, .name_count = 2, .output = results}),
                     STATUS_INVALID);
    assert_non_null(strstr(status_message(), "'bp22_t2'"));
    for (int k = 0; paper_tables[k].id; k++)
        assert_non_null(strstr(status_message(), paper_tables[k].id));
    assert_int_not_equal(access(results, F_OK), 0);
}

/* The papers' targets by their names, and those that our scenes add. */
static void layouts_are_drawn(void **state)
{
    (void)state;
    const char *const names[] = {"lbf21_f16"};
    assert_int_equal(command_reproduce(&(struct task){.names = names, .name_count = 1, .output = folder}), STATUS_OK);
    assert_string_equal(text_read("figure-lbf21_f16.csv"), "target,x_m,r_m,added\nPT7,14,50,0\nPT8,16,80,0\n,15,65,1\n"
                                                           ",13.5,95,1\nPT9,14,225,0\nPT10,16,260,0\n,15,245,1\n"
                                                           ",13.5,270,1\n");
    assert_int_equal(access(path_of("figure-lbf21_f16.png"), F_OK), 0);
    assert_int_equal(access(path_of("figure-lbf21_f16.svg"), F_OK), 0);
}

/* A finished measurement is not made again, and what is said comes from it. */
static void finished_measurements_are_kept(void **state)
{
    (void)state;
    struct scene scene;
    struct spec spec;
    support_scene("bp22/table3", &scene);
    assert_int_equal(spec_parse(SINC_8, &spec), STATUS_OK);
    planted_begin();
    assert_int_equal(results_folder_scene(rows, scene.name, scene.hash), STATUS_OK);
    struct measurement row = planted_row(scene.name, &spec);
    row.width_m = 0.0625; /* Eq. (20): 2 bins in three are below .039 m, so beta = 1 */
    assert_int_equal(results_folder_add(rows, &row), STATUS_OK);
    results_folder_close(rows);
    char *before = strdup(undated(text_read("measurements.csv")));
    const char *const names[] = {"bp22_eq20", "lbf21_f2", "lbf21-3C-1"};
    assert_int_equal(command_reproduce(&(struct task){.names = names, .name_count = 3, .output = folder}), STATUS_OK);
    assert_string_equal(undated(text_read("measurements.csv")), before);
    const char *text = text_read("reproduced.csv");
    assert_non_null(strstr(text, "table,item,quantity,definition,unit,paper,ours,difference,assumption\n"));
    assert_non_null(strstr(text, "\nbp22_eq20,linear,upsampling_rate,rho_a = D_tx/2,1,2,3,1,"));
    assert_non_null(strstr(text, "\nbp22_eq20,linear,upsampling_rate,rho_a = measured -3 dB width,1,2,1,-1,"));
    assert_non_null(strstr(text, "\nlbf21_f2,\"1st receiver, 50 to 300 m, LBF\",phase_error_rad,"
                                 "\"Eq. (5), theta by fc\",rad,0.02,0.014"));
    text = text_read("claims.csv");
    assert_non_null(strstr(text, "id,paper,section,claim,verdict,corrected,basis,evidence\n"));
    assert_non_null(strstr(text, "\nlbf21-3C-1,LBF21,\"III-C, Fig. 2\",\"LBF, first receiver: the largest error is "
                                 "0.02 rad\",holds under stated assumption,,measured,"));
    assert_null(strstr(text, "\nbp22-4.1-10,")); /* not asked for */
    free(before);
    spec_free(&spec);
    scene_free(&scene);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, folder_make, folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_FOLDER(all_printed_numbers_are_there),
        IN_FOLDER(sentences_quote_the_tables),
        IN_FOLDER(printed_formulas_are_right),
        cmocka_unit_test(rate_of_eq20),
        IN_FOLDER(noise_is_measured),
        IN_FOLDER(nothing_is_said_without_measurements),
        IN_FOLDER(every_line_can_be_measured),
        IN_FOLDER(times_are_scaled),
        IN_FOLDER(unknown_table_is_refused),
        IN_FOLDER(finished_measurements_are_kept),
        IN_FOLDER(layouts_are_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
