/* The claims of the papers: results/claims.csv is read strictly, and verdicts follow the numbers. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/paths.h"
#include "command/task.h"
#include "measure/session.h"
#include "claims/reproduce.h"
#include "papers/assumptions.h"
#include "tests/planted.h"

/* --- The file -------------------------------------------------------------------------------------------------- */

static void all_claims_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *paper;
        int count;
    } papers[] = {{"BP22", 42}, {"ZP15", 16}, {"LBF21", 77}, {"SQ18", 18}, {"PF05", 21}};
    struct claims claims;
    int row = 0;
    assert_int_equal(claims_read(data_path(DATA_CLAIMS), &claims), STATUS_OK);
    for (size_t p = 0; p < sizeof papers / sizeof *papers; p++)
        for (int k = 0; k < papers[p].count; k++, row++) {
            assert_true(row < claims.count);
            assert_string_equal(claims.claims[row].paper, papers[p].paper);
        }
    assert_int_equal(row, claims.count);
    for (int k = 0; k < claims.count; k++) /* a row is read at a glance */
        assert_true(strlen(claims.claims[k].arguments) <= 200);
    for (int k = 0; k < claims.numbers.row_count; k++)
        assert_true(strlen(csv_cell(&claims.numbers, k, NUMBER_DEFINITION)) <= 200);
    for (int k = 0; k < claims.count; k++) /* what nothing measured can decide is marked so */
        assert_true(claims.claims[k].phases || !comparison_decides(claims.claims[k].comparison)
                    || comparison_identity(claims.claims[k].comparison) == !claims.claims[k].measures);
    claims_free(&claims);
}

#define X "x = 1"
static const struct {
    const char *comparison, *arguments, *says[4];
} mistakes[] = {
    /* names and arithmetic */
    {"undecided", "1 = 2", {"line 2", "column arguments, character 1", "'1 = 2'", "a name"}},
    {"undecided", "max = 2", {"'max = 2'", "no function's"}},
    {"undecided", "error = 2", {"'error = 2'", "no function's"}},
    {"undecided", "pi = 3", {"'pi = 3'", "a name of its own"}},
    {"undecided", X "; x = 2", {"character 8", "'x = 2'", "a name of its own"}},
    {"undecided", X "; nearest_db = 2", {"'nearest_db = 2'", "not in numbers.csv"}},
    {"undecided", "x", {"character 2", "'='"}}, /* nor is it there */
    {"undecided", "x 1", {"character 3", "'='"}},
    {"undecided", "x =", {"character 4", "a number, a name, a function"}},
    {"undecided", "x = 1 2", {"character 7", "an operator, ';' or the end"}},
    {"undecided", "x = 1 +", {"a number, a name, a function"}},
    {"undecided", "x = (1", {"')' is needed"}},
    {"undecided", "x = 1e999", {"'1e999'", "a number"}},
    {"undecided", "x = 1.2.3", {"'1.2.3'", "a number"}},
    {"undecided", "x = 1; y = z", {"character 12", "'z'", "x, pi"}},
    {"undecided", "x = ((((((((((((((((((((1))))))))))))))))))))", {"nested more than 20"}},
    {"undecided", X ";", {"a name of its own"}},
    /* functions */
    {"undecided", "x = eror(bp22/speckle, bp_nearest)", {"'eror'", "min", "published", "metric of measurements.csv"}},
    {"undecided", "x = target_error(bp22/speckle, bp_nearest)", {"'target_error'", "targets.csv"}},
    {"undecided",
     "x = planned(sq18/squint_20, wk_squint, size)",
     {"'size' is not accepted", "size_factor, upsampling"}},
    {"undecided", "x = filtered(pf05/nine, wk_polar, kept, 1)", {"'kept' is not accepted", "kept_db, changed_db"}},
    {"undecided", "x = filtered(pf05/nine, wk_polar, kept_db, 0)", {"'0' is not accepted", "1 to 64"}},
    {"undecided", "x = max()", {"a number, a name, a function"}},
    {"undecided", "x = max(1 2)", {"an operator, ',' or ')'"}},
    {"undecided", "x = error(bp22/speckle, bp_nearest - bp_neerest)", {"character 38", "'bp_neerest'"}},
    {"undecided", "x = published(bp22_t3, T1..T6, sinc | sync, islr_db)", {"published.csv has no such number"}},
    {"undecided", "x = error(bp22/speckle)", {"error(scene, SPEC) is needed"}},
    {"undecided", "x = error(bp22/speckle, bp_nearest, pixel)", {"error(scene, SPEC) is needed"}},
    {"undecided", "x = error(bp22/spekle, bp_nearest)", {"character 11", "no scene 'bp22/spekle'", "below scenes/"}},
    {"undecided", "x = error(bp22/speckle, bp_neerest)", {"character 25", "'bp_neerest'", "bp_nearest"}},
    {"undecided", "x = error(bp22/speckle, bp_sinc:taps=many)", {"character 25", "taps"}},
    {"undecided", "x = error(bp22/speckle, 'bp_sinc:taps=8", {"never ends", "second quote"}},
    {"undecided", "x = target_islr_db(bp22/many, bp_nearest, pixl, 1)", {"'pixl'", "null, 3db, pixel"}},
    {"undecided", "x = target_islr_db(bp22/many, bp_nearest, pixel, 0..3)", {"'0..3'", "from 1 to 64"}},
    {"undecided", "x = target_islr_db(bp22/many, bp_nearest, pixel, 3..1)", {"'3..1'", "FIRST..LAST"}},
    {"undecided", "x = target_islr_db(bp22/many, bp_nearest, pixel, 1..nan)", {"'1..nan'", "FIRST..LAST"}},
    {"undecided", "x = target_islr_db(bp22/many, bp_nearest, pixel, 1..)", {"'1..'", "FIRST..LAST"}},
    {"undecided", "x = target_islr_db(bp22/many, bp_nearest, pixel, 1.5)", {"whole numbers"}},
    {"undecided",
     "x = target_islr_db(bp22/many, bp_nearest, pixel, 1..3) - target_islr_db(bp22/many, bp_nearest, "
     "pixel, 1..2)",
     {"lists of 3 and 2", "one length"}},
    {"undecided",
     "x = target_islr_db(bp22/many, bp_nearest | bp_sinc | bp_linear, pixel, 1..64)",
     {"more than 144 numbers"}},
    {"undecided", "x = stage(bp22/full, bp_nearest, )", {"name of a stage"}},
    {"undecided", "x = time(bp22_t3, sinc, fast engines)", {"'bp22_t3'", "accepted: 'bp22_t4', 'lbf21_t5'"}},
    {"undecided", "x = time(bp22_t4, sync, fast engines)", {"'sync'", "'nearest'", "'linear, beta 8'", "'sinc'"}},
    {"undecided",
     "x = time(bp22_t4, sinc, slow engines)",
     {"'slow engines'", "'fast engines'", "'plain engines, extrapolated'"}},
    {"undecided", "x = published(bp22_t4, '', nearest, time)", {"published.csv has no such number"}},
    {"undecided", "x = published(lbf21_t5, '', PCA, time_s)", {"published.csv has no such number"}},
    {"undecided", "x = phase(longer, first, pca, 50..300, 1)", {"'longer'", "short, long"}},
    {"undecided", "x = phase(long, second, pca, 50..300, 1)", {"'second'", "first, last"}},
    {"undecided", "x = phase(long, first, exact, 50..300, 1)", {"'exact'", "lbf_fc, lbf_F, lbf7_fc, pca"}},
    {"undecided", "x = phase(long, first, pca, 300..50, 1)", {"'300..50'", "FIRST..LAST"}},
    {"undecided", "x = phase(long, first, pca, 50..300, 2)", {"'2'", "from 0 to 1"}},
    {"undecided",
     "x = scene(bp22/full, length_m)",
     {"'length_m'", "bin_m, wavelength_m, tx_length_m, recording_s, speed_m_s"}},
    /* comparisons */
    {"over(x, 1)", X, {"column comparison, character 1", "no such comparison", "above, below", "undecided"}},
    {"above x, 1", X, {"above(value, limit) is needed"}},
    {"above(x)", X, {"above(value, limit) is needed"}},
    {"above(x, 1, 2)", X, {"character 11", "above(value, limit) is needed"}},
    {"above(x, target_islr_db(bp22/many, bp_nearest, pixel, 1..3))", X, {"3 numbers; one is needed"}},
    {"within(x, 1)", X, {"within(value, target, tolerance) is needed"}},
    {"rounds_to(x, 1)", X, {"rounds_to(value, printed number, its last digit) is needed"}},
    {"rising(x)", X, {"one value", "rising(two and more values) is needed"}},
    {"above(y, 1)", X, {"column comparison, character 7", "'y, 1)'", "x, pi"}},
    {"above(x, 1) or below(x, 1)", X, {"character 13", "'and', 'else' or the end"}},
    {"above(x, 1) else", X, {"no such comparison"}},
    {"above(x, 1) and", X, {"no such comparison"}},
    {"undecided()", X, {"no such comparison"}},
    {"clearly_above(x, 1)", X, {"clearly_above(value, limit, noise) is needed"}},
    {"above(x, 0)", X, {"line 2", "column comparison", "the claim has no measurement", "identity"}},
    {"identity above(x, 0)", "x = error(bp22/speckle, bp_nearest)", {"'identity' is for claims"}},
    {"identity above(x, 0) else above(x, 0)", X, {"an identity has no else"}},
    {"undecided", "x = time_noise(bp22_t3, fast engines)", {"'bp22_t3'", "accepted: 'bp22_t4', 'lbf21_t5'"}},
    {"undecided", "x = time_noise(bp22_t4, slow engines)", {"'slow engines'", "'fast engines'"}},
    {"above(list(1, 2 * x), 1)", "x = time(bp22_t4, sinc, fast engines)", {"'above", "a time", "clearly_above"}},
    {"rising(1, max(x))", "x = stage(bp22/full, bp_nearest, focus)", {"'rising", "a time", "clearly_above"}},
    {"clearly_above(x, 1, 0.1) else below(x, 1)", "x = run_s(bp22/full, bp_nearest)", {"'below", "a time"}},
};

/* Every kind of mistake has its message, which names the place and what is accepted. */
static void bad_rows_are_refused(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof mistakes / sizeof *mistakes; k++) {
        struct claims claims;
        if (planted_claim(mistakes[k].comparison, mistakes[k].arguments, &claims) != STATUS_INVALID)
            fail_msg("accepted: %s | %s", mistakes[k].comparison, mistakes[k].arguments);
        assert_non_null(strstr(status_message(), "bad.csv: line "));
        for (int n = 0; n < 4 && mistakes[k].says[n]; n++)
            if (!strstr(status_message(), mistakes[k].says[n]))
                fail_msg("%s | %s: '%s' is not in: %s", mistakes[k].comparison, mistakes[k].arguments,
                         mistakes[k].says[n], status_message());
        assert_null(claims.claims);
    }
}

/* Measurements are needed wherever a row asks for them, each once. */
static void needs_are_collected(void **state)
{
    (void)state;
    struct claims claims;
    assert_int_equal(planted_claim("above(max(error(bp22/speckle, bp_nearest), error(bp22/speckle, bp_linear:beta=8), "
                                   "error(zp15/speckle, bp_nearest)), x)",
                                   "x = flops(bp22/speckle, bp_nearest)", &claims),
                     STATUS_OK);
    assert_int_equal(claims.claims->need_count, 3); /* FLOPs come from the plan */
    assert_string_equal(claims.claims->needs[1].spec, "bp_linear:beta=8");
    assert_string_equal(claims.claims->needs[2].scene, "zp15/speckle");
    claims_free(&claims);
    /* LBF is measured in both schemes. */
    assert_int_equal(planted_claim("above(x, 0)", "x = error(lbf21/table3_near, LBF:blocks=16)", &claims), STATUS_OK);
    assert_int_equal(claims.claims->need_count, 2);
    assert_string_equal(claims.claims->needs[0].spec, "rma_lbf:variant=printed,spacing=uniform,blend=off,blocks=16");
    assert_string_equal(claims.claims->needs[1].spec, "rma_lbf:blocks=16");
    claims_free(&claims);
}

/* The test fails where the need's image is refused under the current assumptions. */
static void need_accepted(const struct need *need)
{
    struct scene scene;
    struct spec spec;
    struct condition list[CONDITIONS_MAX];
    const char *name = assumed_scene_name(need->scene);
    assert_int_equal(assumed_scene_load(need->scene, &scene), STATUS_OK);
    assert_int_equal(spec_own(need->spec, &spec), STATUS_OK);
    const struct problem problem = session_problem(&scene, spec.algorithm, spec.precision);
    int conditions = algorithm_conditions(spec.algorithm, &problem, spec.options, list, CONDITIONS_MAX);
    if (conditions_check(need->spec, list, conditions) != STATUS_OK)
        fail_msg("%s: %s", name, status_message());
    spec_free(&spec);
    scene_free(&scene);
}

/* What tables and claims measure is imaged: no algorithm refuses its scene, nor PCA, whose error is the largest, with
   the widest beam. */
static void needs_are_accepted(void **state)
{
    (void)state;
    struct claims claims;
    struct need needs[256];
    int count = 0, wide = 0;
    assert_int_equal(claims_read(data_path(DATA_CLAIMS), &claims), STATUS_OK);
    for (int k = 0; paper_tables[k].id; k++)
        count = table_needs(paper_tables[k].id, needs, count, 256);
    for (int n = 0; n < claims.count; n++)
        for (int k = 0; k < claims.claims[n].need_count; k++)
            count = need_add(needs, count, 256, claims.claims[n].needs[k]);
    for (int k = 0; k < count; k++)
        need_accepted(&needs[k]);
    const struct assumptions *set = assumption_sets;
    while (strcmp(set->name, "cut_500") != 0)
        set++;
    assumptions_choose(set);
    for (int k = 0; k < count; k++)
        if (strncmp(needs[k].spec, "rma_pca", 7) == 0 && strstr(assumed_scene_name(needs[k].scene), "@cut_500")
            && !strstr(needs[k].scene, "real_size")) {
            need_accepted(&needs[k]);
            wide++;
        }
    assumptions_choose(assumption_sets);
    assert_true(wide >= 8);
    claims_free(&claims);
}

/* Cells and columns. */
static void bad_files_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says[3];
    } cases[] = {
        {"id,paper,section,claim,comparison,arguments\n", {"bad.csv", "column 5 must be 'criterion'"}},
        {"id,paper,section,claim,criterion,comparison,arguments,changed\nx,BP22,4.1,c,c,undecided\n",
         {"bad.csv:2", "6 fields"}},
        {"id,paper,section,claim,criterion,comparison,arguments,changed\nx,BP22,,c,c,undecided,x = 1,\n",
         {"line 2", "column section is empty"}},
        {"id,paper,section,claim,criterion,comparison,arguments,changed\nx,BP22,4.1,c,c,,x = 1,\n",
         {"column comparison is empty"}},
        {"id,paper,section,claim,criterion,comparison,arguments,changed\nx,BP22,4.1,c,c,undecided,x = 1,\n"
         "x,BP22,4.1,c,c,undecided,x = 1,\n",
         {"line 3", "column id is 'x', as in line 2", "an id of its own"}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct claims claims;
        support_write("bad.csv", cases[k].text);
        assert_int_equal(claims_read(path_of("bad.csv"), &claims), STATUS_INVALID);
        for (int n = 0; n < 3 && cases[k].says[n]; n++)
            if (!strstr(status_message(), cases[k].says[n]))
                fail_msg("'%s' is not in: %s", cases[k].says[n], status_message());
    }
    struct claims claims;
    assert_int_equal(claims_read(path_of("none.csv"), &claims), STATUS_INVALID);
}

/* What would be written over the list of claims is not begun. */
static void the_list_is_not_written_over(void **state)
{
    (void)state;
    assert_int_equal(command_reproduce(&(struct task){.output = SASBENCH_ROOT "/results"}), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "claims.csv is the list of claims; another folder is accepted"));
    assert_int_not_equal(access(SASBENCH_ROOT "/results/measurements.csv", F_OK), 0);
}

/* --- Verdicts follow the numbers ------------------------------------------------------------------------------ */

/* "beta = 8 is within 0.07 dB ISLR of sinc" */
static void verdict_follows_the_threshold(void **state)
{
    (void)state;
    static const struct {
        double on_bins_db, between_db;
        enum claim_verdict verdict;
    } cases[] = {
        {0.05, 0.05, CLAIM_HOLDS},   {0.075, -0.075, CLAIM_HOLDS}, /* the last digit's rounding */
        {0.05, 0.30, CLAIM_ASSUMED}, {0.09, 0.05, CLAIM_FAILS},    {NAN, 0.05, CLAIM_UNDECIDED},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct measured measured;
        planted_begin();
        for (int n = 0; n < 2; n++) {
            const char *spec = n ? SINC_8 : LINEAR_8;
            planted_islr("bp22/table3", spec, 0, 6, -10 + (n ? 0 : cases[k].on_bins_db));
            planted_add("bp22/table3", spec, 1, "");
            planted_islr("bp22/many", spec, 0, 24, -10 + (n ? 0 : cases[k].on_bins_db));
            planted_islr("bp22/many", spec, 24, 24, -10 + (n ? 0 : cases[k].between_db));
            planted_add("bp22/many", spec, 1, "");
        }
        planted_end(&measured);
        expect(&measured, "bp22-4.1-11", cases[k].verdict);
        planted_clear(&measured);
    }
}

/* "falls slightly with range": behind else, from 135 m on and by pi/40 at most, not by any amount. */
static void slight_is_asked_for(void **state)
{
    (void)state;
    static const struct {
        double at_300_rad;
        enum claim_verdict verdict;
    } cases[] = {{0.301, CLAIM_ASSUMED}, {0.200, CLAIM_FAILS}, {0.345, CLAIM_FAILS}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const double range_m[] = {50, 135, 220, 300}, eq_7_rad[] = {0.650, 0.340, 0.299, cases[k].at_300_rad};
        struct measured measured;
        planted_begin();
        FILE *file = fopen(path_of("phase-lbf21__phase_long.csv"), "w");
        assert_non_null(file);
        fputs("receiver,r_m,nu_per_m,lbf_fc_error_rad,lbf_F_error_rad,lbf7_fc_error_rad,pca_error_rad\n", file);
        for (int receiver = 1; receiver <= 132; receiver += 131)
            for (int r = 0; r < 4; r++)
                fprintf(file, "%d,%g,10,%g,0.01,%g,0.1\n", receiver, range_m[r], 0.02 * (r + 1), eq_7_rad[r]);
        assert_int_equal(fclose(file), 0);
        planted_end(&measured);
        expect(&measured, "lbf21-3D-5", cases[k].verdict);
        planted_clear(&measured);
    }
}

/* Memory is not movement of data: that it stands for it is assumed, however much less it is. */
static void memory_stands_for_movement(void **state)
{
    (void)state;
    static const char *const others[] = {"wk_classic:unfold=stuff", "wk_classic:unfold=baseband", "wk_classic"};
    for (int more = 0; more < 2; more++) {
        struct measured measured;
        planted_begin();
        for (int k = 0; k < 4; k++) {
            struct spec spec;
            assert_int_equal(spec_parse(k < 3 ? others[k] : "wk_squint", &spec), STATUS_OK);
            struct measurement row = planted_row("sq18/squint_20", &spec);
            row.bytes = k < 3 ? 1e7 : more ? 2e7 : 1e4;
            assert_int_equal(results_folder_add(rows, &row), STATUS_OK);
            spec_free(&spec);
        }
        planted_end(&measured);
        expect(&measured, "sq18-4-2", more ? CLAIM_FAILS : CLAIM_ASSUMED);
        planted_clear(&measured);
    }
}

/* What failed or is unsupported decides nothing. */
static void failures_decide_nothing(void **state)
{
    (void)state;
    static const char *const statuses[] = {"failed", "unsupported"};
    for (int k = 0; k < 2; k++) {
        struct measured measured;
        struct spec spec;
        assert_int_equal(spec_parse(NEAREST, &spec), STATUS_OK);
        struct measurement row = planted_row("bp22/speckle", &spec);
        row.status = statuses[k];
        row.reason = "out of paper";
        planted_begin();
        assert_int_equal(results_folder_add(rows, &row), STATUS_OK);
        planted_end(&measured);
        expect(&measured, "bp22-5-1", CLAIM_UNDECIDED);
        assert_non_null(strstr(evaluation_of(&measured, "bp22-5-1", SCHEME_PRINTED).evidence, "out of paper"));
        planted_clear(&measured);
        spec_free(&spec);
    }
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, folder_make, folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_FOLDER(all_claims_are_read),           IN_FOLDER(bad_rows_are_refused),
        IN_FOLDER(needs_are_collected),           IN_FOLDER(needs_are_accepted),
        IN_FOLDER(bad_files_are_refused),         IN_FOLDER(the_list_is_not_written_over),
        IN_FOLDER(verdict_follows_the_threshold), IN_FOLDER(slight_is_asked_for),
        IN_FOLDER(memory_stands_for_movement),    IN_FOLDER(failures_decide_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
