#include "choice/candidates.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contract/param.h"

/* THE list: an algorithm with a forecast, its fixed settings, and the values of one parameter; `budget`: the planner
   sets it. */
static const struct {
    const char *algorithm, *fixed, *varied, *values; /* "key=value,key=value", "key", "value value" */
} families[] = {
    {"bp_nearest", "", "", ""},
    {"bp_linear", "", "beta", "1 2 4 8 16 32"},
    {"bp_linear", "preemphasis=on", "beta", "2 4 8 16 32"},
    {"bp_zeropad", "", "factor", "2 4 8 16 32 64"},
    {"bp_farrow", "", "degree", "2 3 4 5 6 7 8 9"},
    {"bp_farrow", "factor=2", "degree", "2 3 4 5 6"},
    {"bp_sinc", "window=none", "taps", "4 8 16"},
    {"bp_sinc", "window=kaiser", "taps", "4 8 16 32"},
    {"bp_sinc", "window=kaiser_band", "taps", "4 6 8 10 12 16 32"},
    {"bp_fitted", "", "taps", "2 4 6 8 10 12 16"},
    {"bp_fitted", "factor=2", "taps", "2 4 6 8 12"},
    {"bp_fitted", "factor=4", "taps", "2 4 6 8"},
    {"bp_linear", "engine=general", "beta", "2 8"},
    {"bp_farrow", "engine=general", "degree", "2 3 4 5"},
    {"bp_sinc", "window=kaiser_band,engine=general", "taps", "4 6 8"},
    {"bp_fitted", "engine=general", "taps", "2 4 6 8 10 12"},
    {"bp_factorised", "", "error", "budget"},
    {"rma_delay", "taps=8", "terms", "1 2"},
    {"rma_delay", "", "terms", "1 2"},
    {"rma_delay", "taps=24", "terms", "2 3"},
    {"rma_lbf", "", "limit", "0.785 0.1 0.01"},
    {"rma_pca", "", "limit", "0.785 0.1"},
    {"rma_wu", "", "limit", "0.785 0.1"},
    {"rma_numeric", "", "limit", "0.785 0.1 0.01"},
    {"wk_squint", "", "taps", "4 6 8"},
};

/* Set a parameter of the table by its text. False where it is unknown, or does not accept the value. */
static bool setting_store(const struct algorithm *algorithm, void *options, const char *key, const char *value)
{
    for (const struct param *param = algorithm->params; param && param->name; param++)
        if (strcmp(param->name, key) == 0) {
            const double number = param->type == PARAM_CHOICE ? param_choice(param, value) : strtod(value, NULL);
            if (!(number >= param->min && number <= param->max))
                return false;
            param_store(param, options, number);
            return true;
        }
    return false;
}

bool candidate_set(struct candidate *candidate, const char *key, const char *value)
{
    char *settings = candidate->settings;
    const size_t length = strlen(settings), room = sizeof candidate->settings - length;
    if (!setting_store(candidate->algorithm, candidate->options, key, value))
        return false;
    return (size_t)snprintf(settings + length, room, "%s%s=%s", length > 0 ? "," : "", key, value) < room;
}

bool candidate_set_error(struct candidate *candidate, double error)
{
    char text[16];
    const double unit = pow(10, floor(log10(error)) - 1);
    for (const struct param *param = candidate->algorithm->params; param && param->name; param++)
        if (strcmp(param->name, "error") == 0) {
            snprintf(text, sizeof text, "%.1e", fmin(floor(error / unit) * unit, param->max));
            return candidate_set(candidate, "error", text);
        }
    return false;
}

/* One candidate of a family; false where the algorithm does not accept its settings. */
static bool candidate_fill(int family, const char *value, struct candidate *candidate)
{
    const struct algorithm *algorithm = algorithm_find(families[family].algorithm);
    const char *varied = families[family].varied;
    char fixed[48], *key, *rest = fixed;
    if (!algorithm || !algorithm->forecast || algorithm->options_size > sizeof candidate->options)
        return false;
    *candidate = (struct candidate){.algorithm = algorithm, .family = family};
    options_fill(algorithm, candidate->options);
    snprintf(fixed, sizeof fixed, "%s", families[family].fixed);
    while ((key = strsep(&rest, "=")) && *key)
        if (!candidate_set(candidate, key, strsep(&rest, ",")))
            return false;
    candidate->budgeted = strcmp(value, "budget") == 0;
    return !*varied || candidate->budgeted || candidate_set(candidate, varied, value);
}

int candidates_fill(struct candidate *list)
{
    int count = 0;
    for (size_t k = 0; k < sizeof families / sizeof *families; k++) {
        char values[80], *rest = values;
        snprintf(values, sizeof values, "%s", families[k].values);
        do {
            const char *value = strsep(&rest, " ");
            if (count < CANDIDATES_MAX && candidate_fill((int)k, value, &list[count]))
                count++;
        } while (rest);
    }
    return count;
}
