/* The comparisons (claims.h). Each compares so that NaN disagrees. */
#include "claims/claims.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "text/text_append.h"

/* ---- comparisons: v[0] is what is evaluated, v[1] and v[2] are single numbers ---- */

static bool above(const struct values *v)
{
    return values_extreme(v, false) > v[1].at[0];
}

static bool at_least(const struct values *v)
{
    return values_extreme(v, false) >= v[1].at[0];
}

static bool below(const struct values *v)
{
    return values_extreme(v, true) < v[1].at[0];
}

static bool at_most(const struct values *v)
{
    return values_extreme(v, true) <= v[1].at[0];
}

static bool within(const struct values *v)
{
    bool all = true;
    for (int k = 0; k < v->count; k++)
        all = all && fabs(v->at[k] - v[1].at[0]) <= v[2].at[0];
    return all;
}

static bool rounds_to(const struct values *v)
{
    double half = v[2].at[0] / 2;
    return values_extreme(v, false) >= v[1].at[0] - half && values_extreme(v, true) < v[1].at[0] + half;
}

static bool rising(const struct values *v)
{
    bool all = true;
    for (int k = 1; k < v->count; k++)
        all = all && v->at[k] > v->at[k - 1];
    return all;
}

static bool falling(const struct values *v)
{
    bool all = true;
    for (int k = 1; k < v->count; k++)
        all = all && v->at[k] < v->at[k - 1];
    return all;
}

/* ---- comparisons that noise leaves open: v[2] is the noise, relative ---- */

static bool clearly_above(const struct values *v)
{
    return values_extreme(v, false) > v[1].at[0] * (1 + v[2].at[0]);
}

static bool clearly_below(const struct values *v)
{
    return values_extreme(v, true) < v[1].at[0] / (1 + v[2].at[0]);
}

static bool not_clear(const struct values *v)
{
    double low = v[1].at[0] / (1 + v[2].at[0]), high = v[1].at[0] * (1 + v[2].at[0]);
    bool open = false;
    for (int k = 0; k < v->count; k++)
        open |= v->at[k] >= low && v->at[k] <= high;
    return open;
}

/* ---- the table ---- */

static const struct comparison {
    const char *name;
    int count; /* of expressions; 0: a list of two numbers and more */
    bool (*agrees)(const struct values *v);
    const char *accepted, *words[2];      /* between the numbers of the evidence */
    bool (*open)(const struct values *v); /* does noise hide the answer? NULL: never */
} comparisons[] = {
    {"above", 2, above, "value, limit", {" above "}, NULL},
    {"below", 2, below, "value, limit", {" below "}, NULL},
    {"at_least", 2, at_least, "value, limit", {" at least "}, NULL},
    {"at_most", 2, at_most, "value, limit", {" at most "}, NULL},
    {"clearly_above", 3, clearly_above, "value, limit, noise", {" above ", " by more than a noise of "}, not_clear},
    {"clearly_below", 3, clearly_below, "value, limit, noise", {" below ", " by more than a noise of "}, not_clear},
    {"within", 3, within, "value, target, tolerance", {" from ", " by at most "}, NULL},
    {"rounds_to", 3, rounds_to, "value, printed number, its last digit", {" rounds to ", " by steps of "}, NULL},
    {"rising", 0, rising, "two and more values", {" < "}, NULL},
    {"falling", 0, falling, "two and more values", {" > "}, NULL},
};
enum { COMPARISONS = sizeof comparisons / sizeof *comparisons };

static enum status comparison_find(const struct formula *formula, const char *at, const char *name,
                                   const struct comparison **comparison)
{
    char accepted[400] = "";
    for (int k = 0; k < COMPARISONS; k++) {
        *comparison = &comparisons[k];
        if (strcmp(comparisons[k].name, name) == 0)
            return STATUS_OK;
        text_append(accepted, sizeof accepted, "%s, ", comparisons[k].name);
    }
    return formula_error(formula, at, "there is no such comparison; %sundecided are accepted", accepted);
}

/* Read the comparison's expressions and the closing parenthesis. */
static enum status comparison_values(struct formula *formula, const struct comparison *comparison, struct values v[3])
{
    if (!comparison->count) {
        const char *at = formula->at;
        enum status status = quantity_list_read(formula, v);
        return status != STATUS_OK || v->count > 1
                   ? status
                   : formula_error(formula, at, "one value; %s(%s) is needed", comparison->name, comparison->accepted);
    }
    for (int k = 0; k < comparison->count; k++) {
        const char *at = formula->at;
        enum status status = quantity_read(formula, &v[k]);
        if (status == STATUS_OK && k && v[k].count > 1)
            status = formula_error(formula, at, "%d numbers; one is needed here", v[k].count);
        if (status == STATUS_OK && !formula_take(formula, k < comparison->count - 1 ? ',' : ')'))
            status = formula_error(formula, formula->at, "%s(%s) is needed", comparison->name, comparison->accepted);
        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

/* Values that are not finite decide nothing. */
static void finite_check(const struct formula *formula, const struct comparison *comparison, const struct values *v)
{
    for (int k = 0; k < (comparison->count ? comparison->count : 1); k++)
        for (int n = 0; n < v[k].count; n++)
            if (formula->measured && !isfinite(v[k].at[n]))
                measured_missing(formula->measured, "%s compares a number that is not finite", comparison->name);
}

/* A part's answer: no if one comparison's is no, else open if noise hides one's. */
enum answer { ANSWER_NO, ANSWER_OPEN, ANSWER_YES };

/* One call; its numbers and its answer go into `text`. */
static enum status comparison_read(struct formula *formula, enum answer *answer, char *text, size_t size)
{
    static const char *const words[] = {[ANSWER_NO] = "no", [ANSWER_OPEN] = "within the noise", [ANSWER_YES] = "yes"};
    char name[40];
    const struct comparison *comparison;
    struct values v[3];
    formula_blanks(formula);
    const char *at = formula->at;
    formula_word(formula, name, sizeof name);
    enum status status = comparison_find(formula, at, name, &comparison);
    if (status == STATUS_OK && !formula_take(formula, '('))
        status = formula_error(formula, at, "%s(%s) is needed", comparison->name, comparison->accepted);
    if (status == STATUS_OK)
        status = comparison_values(formula, comparison, v);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < (comparison->count ? comparison->count : 1); k++)
        if (v[k].timed && !comparison->open)
            return formula_error(formula, at,
                                 "%s compares a time, which noise moves; clearly_above and clearly_below are accepted",
                                 comparison->name);
    finite_check(formula, comparison, v);
    *answer = comparison->agrees(v) ? ANSWER_YES : comparison->open && comparison->open(v) ? ANSWER_OPEN : ANSWER_NO;
    if (comparison->count)
        values_append(text, size, v);
    for (int k = 1; k < comparison->count; k++) {
        text_append(text, size, "%s", comparison->words[k - 1]);
        values_append(text, size, &v[k]);
    }
    for (int k = 0; k < v->count && !comparison->count; k++)
        text_append(text, size, "%s%.4g", k ? comparison->words[0] : "", v->at[k]);
    text_append(text, size, ": %s", words[*answer]);
    return STATUS_OK;
}

/* Comparisons joined by `and`; *word is what stands behind them. */
static enum status part_read(struct formula *formula, enum answer *answer, char word[40], char *text, size_t size)
{
    *answer = ANSWER_YES;
    do {
        enum answer one = ANSWER_NO;
        text_append(text, size, "; ");
        enum status status = comparison_read(formula, &one, text, size);
        if (status != STATUS_OK)
            return status;
        *answer = one < *answer ? one : *answer;
        formula_blanks(formula);
        const char *at = formula->at;
        formula_word(formula, word, 40);
        if (*at && strcmp(word, "and") != 0 && strcmp(word, "else") != 0)
            return formula_error(formula, at, "'and', 'else' or the end is needed here");
    } while (strcmp(word, "and") == 0);
    return STATUS_OK;
}

bool comparison_decides(const char *text)
{
    return strcmp(text, "undecided") != 0;
}

bool comparison_identity(const char *text)
{
    return strncmp(text, "identity ", 9) == 0;
}

enum status comparisons_read(struct formula *formula, const char *column, const char *text,
                             struct evaluation *evaluation)
{
    char word[40];
    bool strict = true, decided = false;
    formula_begin(formula, column, text);
    if (!comparison_decides(text)) {
        evaluation->verdict = CLAIM_UNDECIDED;
        return STATUS_OK;
    }
    enum claim_verdict verdict = comparison_identity(text) ? CLAIM_IDENTITY : CLAIM_HOLDS;
    evaluation->verdict = CLAIM_FAILS;
    if (comparison_identity(text))
        formula->at += 9;
    if (strncmp(formula->at, "else ", 5) == 0) {
        formula->at += 5;
        strict = false;
    }
    do {
        char checks[sizeof evaluation->evidence] = "";
        enum answer answer;
        formula_blanks(formula);
        if (!strict && !comparison_decides(formula->at)) { /* what no part holds is open */
            evaluation->verdict = decided ? evaluation->verdict : CLAIM_UNDECIDED;
            return STATUS_OK;
        }
        enum status status = part_read(formula, &answer, word, checks, sizeof checks);
        if (status != STATUS_OK)
            return status;
        if (comparison_identity(text) && *word)
            return formula_error(formula, text, "an identity has no else; `and` is accepted");
        if (!decided)
            text_append(evaluation->evidence, sizeof evaluation->evidence, "%s", checks);
        if (!decided && answer == ANSWER_YES)
            evaluation->verdict = strict ? verdict : CLAIM_ASSUMED;
        else if (!decided && answer == ANSWER_OPEN)
            evaluation->verdict = CLAIM_UNDECIDED;
        decided = decided || answer == ANSWER_YES;
        strict = false;
    } while (*word);
    return STATUS_OK;
}
