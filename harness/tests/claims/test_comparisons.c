/* The language of results/claims.csv: its arithmetic, each comparison on planted numbers, what is known of the
   rules. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "measure/session.h"
#include "papers/rules.h"
#include "tests/planted.h"

/* Two lone numbers and a list that arguments can ask for: errors A and B in speckle, ISLR of three targets. */
static void numbers_plant(double a, double b, const double islr_db[3], struct measured *measured)
{
    static const char *const specs[] = {NEAREST, LINEAR_8};
    planted_begin();
    for (int k = 0; k < 2; k++) {
        struct spec spec;
        assert_int_equal(spec_parse(specs[k], &spec), STATUS_OK);
        struct measurement row = planted_row("bp22/speckle", &spec);
        row.error = k ? b : a;
        assert_int_equal(results_folder_add(rows, &row), STATUS_OK);
        spec_free(&spec);
    }
    for (int k = 0; k < 3; k++)
        planted_islr("bp22/many", NEAREST, k, 1, islr_db[k]);
    planted_add("bp22/many", NEAREST, 1, "");
    planted_end(measured);
}

#define LANGUAGE_A "a = error(bp22/speckle, bp_nearest); b = error(bp22/speckle, bp_linear:beta=8)"
#define LANGUAGE_V "v = target_islr_db(bp22/many, bp_nearest, pixel, 1..3)"

static struct evaluation comparison(const char *cell, const char *arguments, struct measured *measured)
{
    struct claims claims;
    if (planted_claim(cell, arguments, &claims) != STATUS_OK)
        fail_msg("%s", status_message());
    struct evaluation evaluation = claim_evaluate(&claims, claims.claims, SCHEME_PRINTED, measured);
    claims_free(&claims);
    return evaluation;
}

static void arithmetic_is_right(void **state)
{
    (void)state;
    static const struct {
        const char *expression;
        double value;
    } cases[] = {
        {"1 + 2 * 3 - 4 / 8", 6.5},
        {"(1 + 2) * -3", -9},
        {"2 - 3 - 4", -5},
        {"8 / 4 / 2", 1},
        {"1e-3 * 2", 2e-3},
        {"a", 3},
        {"a / b - 1", 0.5},
        {"pi", 3.14159265358979},
        {"min(v)", -12},
        {"max(v)", -3},
        {"median(v)", -10},
        {"magnitude(v)", 12},
        {"magnitude(1, -2)", 2},
        {"min(list(1, 2), v, 3)", -12},
        {"max(abs(v + 10))", 7},
        {"sqrt(9)", 3},
        {"min(2 * v + v)", -36},
        {"published(bp22_t4, '', sinc, time_s)", 31276},
        {"max(published(lbf21_t4, PT9..PT10, PCA, offset_m))", 0.003},
        {"max(published(bp22_t3, T1..T6, nearest - sinc, islr_db))", 0.59},
        {"max(published(bp22_t3, T1..T6, 'linear, beta 2 | nearest - sinc', islr_db))", 0.59},
        {"error(bp22/speckle, bp_nearest - bp_linear:beta=8)", 1},
        {"min(error(bp22/speckle, bp_nearest | bp_linear:beta=8))", 2},
        {"max(error(bp22/speckle, bp_linear:beta=8 | bp_nearest - bp_linear:beta=8))", 1},
        {"2 * beta_8_error", 4}, /* a row of numbers.csv */
        {"scene(bp22/speckle, linear_2_bound_rad)", 0.321750554396642},
        {"scene(bp22/speckle, linear_8_bound_rad)", 0.158032653993471},
        {"scene(bp22/table3, bin_m)", 0.025},
        {"scene(bp22/table3, wavelength_m)", 0.01},
        {"planned(sq18/squint_20, wk_classic:unfold=stuff, size_factor)", 7},
        {"planned(pf05/nine, wk_polar:subapertures=1, upsampling)", 4},
        {"max(filtered(pf05/nine, wk_polar:subapertures=1, kept_db, 4), -17)", -17}, /* the target at the edge: -17.9 */
        {"min(filtered(pf05/nine, wk_polar:subapertures=1, changed_db, 4), -1)", -1}, /* -0.07 */
        {"min(filtered(pf05/nine, wk_polar:subapertures=1, kept_db, 1..3), -1)", -1}, /* -0.01 */
    };
    struct measured measured;
    numbers_plant(3, 2, (double[]){-10, -3, -12}, &measured);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char cell[300];
        snprintf(cell, sizeof cell, "within(%s, %.15g, 1e-12)", cases[k].expression, cases[k].value);
        struct evaluation evaluation = comparison(cell, LANGUAGE_A "; " LANGUAGE_V, &measured);
        if (evaluation.verdict != CLAIM_HOLDS)
            fail_msg("%s: %s", cell, evaluation.evidence);
    }
    planted_clear(&measured);
}

/* Each comparison both ways, at its edge, and on what is not a number. */
static void numbers_are_compared(void **state)
{
    (void)state;
    const enum claim_verdict yes = CLAIM_HOLDS, no = CLAIM_FAILS;
    const struct {
        const char *comparison;
        double a, b;
        enum claim_verdict verdict;
    } cases[] = {
        {"above(a, b)", 2, 1, yes},
        {"above(a, b)", 1, 1, no},
        {"below(a, b)", 1, 2, yes},
        {"below(a, b)", 1, 1, no},
        {"at_least(a, b)", 1, 1, yes},
        {"at_least(a, b)", 0.5, 1, no},
        {"at_most(a, b)", 1, 1, yes},
        {"at_most(a, b)", 2, 1, no},
        {"within(a, b, 0.5)", 1.5, 1, yes},
        {"within(a, b, 0.5)", 0.5, 1, yes},
        {"within(a, b, 0.5)", 1.75, 1, no},
        {"within(a, b, 0.5)", 0.25, 1, no},
        {"rounds_to(a, b, 0.5)", 0.75, 1, yes},
        {"rounds_to(a, b, 0.5)", 1.25, 1, no},
        {"rounds_to(a, b, 0.5)", 0.625, 1, no},
        {"clearly_above(a, b, 0.25)", 1.26, 1, yes},
        {"clearly_above(a, b, 0.25)", 1.25, 1, CLAIM_UNDECIDED},
        {"clearly_above(a, b, 0.25)", 0.8, 1, CLAIM_UNDECIDED},
        {"clearly_above(a, b, 0.25)", 0.79, 1, no},
        {"clearly_below(a, b, 0.25)", 0.79, 1, yes},
        {"clearly_below(a, b, 0.25)", 0.8, 1, CLAIM_UNDECIDED},
        {"clearly_below(a, b, 0.25)", 1.26, 1, no},
        {"rising(a, b)", 1, 2, yes},
        {"rising(a, b)", 1, 1, no},
        {"falling(a, b)", 2, 1, yes},
        {"falling(a, b)", 1, 1, no},
        {"undecided", 1, 1, CLAIM_UNDECIDED},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (int hole = 0; hole < 2; hole++) {
            struct measured measured;
            numbers_plant(hole ? NAN : cases[k].a, cases[k].b, (double[]){1, 2, 3}, &measured);
            struct evaluation evaluation = comparison(cases[k].comparison, LANGUAGE_A, &measured);
            if (evaluation.verdict != (hole ? CLAIM_UNDECIDED : cases[k].verdict))
                fail_msg("%s of %g and %g: %s; %s", cases[k].comparison, hole ? NAN : cases[k].a, cases[k].b,
                         claim_verdict_names[evaluation.verdict], evaluation.evidence);
            if (hole)
                assert_non_null(strstr(evaluation.evidence, "error is undefined"));
            planted_clear(&measured);
        }
}

/* Of a list, every element has to agree. */
static void lists_are_compared(void **state)
{
    (void)state;
    static const struct {
        const char *comparison;
        double v[3];
        enum claim_verdict verdict;
    } cases[] = {
        {"above(v, 0)", {1, 2, 3}, CLAIM_HOLDS},
        {"above(v, 0)", {1, 0, 3}, CLAIM_FAILS},
        {"below(v, 4)", {1, 2, 3}, CLAIM_HOLDS},
        {"below(v, 4)", {1, 4, 3}, CLAIM_FAILS},
        {"at_least(v, 1)", {1, 2, 3}, CLAIM_HOLDS},
        {"at_least(v, 1)", {1, 2, 0.5}, CLAIM_FAILS},
        {"at_most(v, 3)", {1, 2, 3}, CLAIM_HOLDS},
        {"at_most(v, 3)", {3.5, 2, 3}, CLAIM_FAILS},
        {"within(v, 2, 1)", {1, 2, 3}, CLAIM_HOLDS},
        {"within(v, 2, 1)", {1, 2, 3.5}, CLAIM_FAILS},
        {"rounds_to(v, 2, 1)", {1.5, 2, 2.4}, CLAIM_HOLDS},
        {"rounds_to(v, 2, 1)", {1.4, 2, 2.4}, CLAIM_FAILS},
        {"rising(v)", {1, 2, 3}, CLAIM_HOLDS},
        {"rising(v)", {2, 1, 3}, CLAIM_FAILS},
        {"falling(v)", {3, 2, 1}, CLAIM_HOLDS},
        {"falling(v)", {3, 2, 2}, CLAIM_FAILS},
        {"above(v, 1)", {1, 2, 3}, CLAIM_FAILS}, /* the first one */
        {"below(v, 3)", {3, 1, 2}, CLAIM_FAILS},
        {"at_least(v, 1)", {0.5, 2, 3}, CLAIM_FAILS},
        {"at_most(v, 3)", {3.5, 2, 1}, CLAIM_FAILS},
        {"within(v, 2, 1)", {3.5, 2, 1}, CLAIM_FAILS},
        {"within(v, 2, 1)", {0.5, 2, 1}, CLAIM_FAILS},
        {"rounds_to(v, 2, 1)", {2, 2, 2.5}, CLAIM_FAILS},
        {"rising(v)", {1, 3, 3}, CLAIM_FAILS},
        {"falling(v)", {3, 3, 1}, CLAIM_FAILS},
        {"clearly_above(v, 2, 0.25)", {2.1, 3, 4}, CLAIM_UNDECIDED},
        {"clearly_above(v, 2, 0.25)", {4, 3, 2.1}, CLAIM_UNDECIDED},
        {"clearly_below(v, 2, 0.25)", {1.9, 1, 0.5}, CLAIM_UNDECIDED},
        {"above(v, 0)", {1, NAN, 3}, CLAIM_UNDECIDED},
        {"rising(v)", {1, 2, NAN}, CLAIM_UNDECIDED},
        {"falling(v)", {3, NAN, 1}, CLAIM_UNDECIDED},
        {"above(v / 0, 0)", {1, 2, 3}, CLAIM_UNDECIDED},
        {"below(0 / v, 1)", {1, 0, 3}, CLAIM_UNDECIDED},
        {"below(max(0 / v), 1)", {1, 0, 3}, CLAIM_UNDECIDED},
        {"above(min(0 / v), -1)", {0, 1, 3}, CLAIM_UNDECIDED},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct measured measured;
        numbers_plant(1, 1, cases[k].v, &measured);
        struct evaluation evaluation = comparison(cases[k].comparison, LANGUAGE_V, &measured);
        if (evaluation.verdict != cases[k].verdict)
            fail_msg("%s, case %zu: %s; %s", cases[k].comparison, k, claim_verdict_names[evaluation.verdict],
                     evaluation.evidence);
        planted_clear(&measured);
    }
}

/* `and` needs both, `else` is for the assumption, a cell that begins with it has no other way. */
static void comparisons_are_joined(void **state)
{
    (void)state;
    static const struct {
        const char *comparison;
        enum claim_verdict verdict;
    } cases[] = {
        {"above(a, 0) and above(b, 0)", CLAIM_HOLDS},
        {"above(a, 0) and above(b, 9)", CLAIM_FAILS},
        {"above(a, 9) and above(b, 0)", CLAIM_FAILS},
        {"above(a, 9) else above(b, 0)", CLAIM_ASSUMED},
        {"above(a, 0) else above(b, 0)", CLAIM_HOLDS},
        {"above(a, 9) else above(b, 9)", CLAIM_FAILS},
        {"above(a, 9) else above(a, 8) else above(b, 0)", CLAIM_ASSUMED},
        {"above(a, 9) else above(a, 0) and above(b, 9)", CLAIM_FAILS},
        {"else above(a, 0)", CLAIM_ASSUMED},
        {"else above(a, 9)", CLAIM_FAILS},
        {"clearly_above(a, b, 1) and above(a, 9)", CLAIM_FAILS}, /* a no is a no, whatever noise hides */
        {"clearly_above(a, b, 1) and above(a, 0)", CLAIM_UNDECIDED},
        {"clearly_above(a, b, 1) else above(a, 0)", CLAIM_ASSUMED},
        {"clearly_above(a, b, 1) else above(a, 9)", CLAIM_UNDECIDED},
    };
    struct measured measured;
    numbers_plant(3, 2, (double[]){1, 2, 3}, &measured);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct evaluation evaluation = comparison(cases[k].comparison, LANGUAGE_A, &measured);
        if (evaluation.verdict != cases[k].verdict)
            fail_msg("%s: %s", cases[k].comparison, claim_verdict_names[evaluation.verdict]);
    }
    assert_int_equal(comparison("identity above(3, 0)", "x = 1", &measured).verdict, CLAIM_IDENTITY);
    assert_int_equal(comparison("identity else above(3, 0)", "x = 1", &measured).verdict, CLAIM_ASSUMED);
    assert_int_equal(comparison("identity else above(3, 9)", "x = 1", &measured).verdict, CLAIM_FAILS);
    assert_string_equal(
        comparison("above(a, 9) else within(b, a, 0.5) else above(v, 0)", LANGUAGE_A "; " LANGUAGE_V, &measured)
            .evidence,
        "a = 3, b = 2, v = 1 to 3 (median 2); criterion: a criterion; 3 above 9: no; 2 from 3 by at "
        "most 0.5: no; 1 to 3 above 0: yes; settings: bp_nearest, bp_linear:beta=8; scenes: bp22/speckle (c "
        "1500 m/s, beam rect cut by the middle angle at 0.405), bp22/many (c 1500 m/s, beam rect cut by the "
        "middle angle at 0.405); slices: pixel");
    assert_non_null(strstr(comparison("undecided", LANGUAGE_A, &measured).evidence,
                           "a = 3, b = 2; no criterion: a criterion; settings: "));
    planted_clear(&measured);
}

/* Shares and quantiles over the scenes of a rule; a refused setting meets no budget. */
static void rules_are_counted(void **state)
{
    (void)state;
    struct measured measured;
    support_write(RULES_FILE, "seed,rule,algorithm,options,oversampling,error_gain,rate,rate_enough\n"
                              "1,bp22_eq20,bp_linear,beta=3,2,0.05,4,2\n1,zp15_eighth,bp_zeropad,factor=8,2,0.01,8,4\n"
                              "2,bp22_eq20,bp_linear,beta=0,1.9,0.3,1,4\n"
                              "2,zp15_eighth,bp_zeropad,factor=6,1.9,0.02,6,6\n"
                              "3,bp22_eq20,bp_linear,beta=7,3,0.1,8,\n3,zp15_eighth,bp_zeropad,factor=2,3,,2,1\n");
    assert_int_equal(measured_read(folder, &measured), STATUS_OK);
    assert_close(rule_value(&measured, "bp22_eq20", "met", 0.1), 2.0 / 3, 1e-12);
    assert_close(rule_value(&measured, "bp22_eq20", "met", 0.04), 0, 0);
    assert_close(rule_value(&measured, "zp15_eighth", "met", 0.1), 2.0 / 3, 1e-12);
    assert_close(rule_value(&measured, "bp22_eq20", "met_2b", 0.1), 1, 1e-12);
    assert_close(rule_value(&measured, "bp22_eq20", "met_2b", 0.05), 0.5, 1e-12);
    assert_close(rule_value(&measured, "zp15_eighth", "met_2b", 0.1), 0.5, 1e-12);
    assert_close(rule_value(&measured, "bp22_eq20", "error", 0.5), 0.1, 1e-12);
    assert_close(rule_value(&measured, "bp22_eq20", "overpaid", 0), 0.25, 1e-12);
    assert_close(rule_value(&measured, "bp22_eq20", "overpaid", 1), 2, 1e-12);
    assert_close(rule_value(&measured, "zp15_eighth", "overpaid", 0.5), 1.5, 1e-12);
    assert_true(!*measured.missing && isnan(rule_value(&measured, "none", "met", 0.1)) && *measured.missing);
    measured_free(&measured);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, folder_make, folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_FOLDER(arithmetic_is_right),    IN_FOLDER(numbers_are_compared), IN_FOLDER(lists_are_compared),
        IN_FOLDER(comparisons_are_joined), IN_FOLDER(rules_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
