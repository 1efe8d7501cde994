#include "choice/candidates.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contract/param.h"
#include "guests/guests.h"

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

/* One candidate; false where the algorithm does not accept its settings. */
static bool candidate_fill(const struct algorithm *algorithm, const struct candidate_family *family, int number,
                           const char *value, struct candidate *candidate)
{
    const char *varied = family->varied;
    char fixed[48], *key, *rest = fixed;
    if (!algorithm->cost || algorithm->options_size > sizeof candidate->options)
        return false;
    *candidate = (struct candidate){.algorithm = algorithm, .family = number};
    options_fill(algorithm, candidate->options);
    snprintf(fixed, sizeof fixed, "%s", family->fixed);
    while ((key = strsep(&rest, "=")) && *key)
        if (!candidate_set(candidate, key, strsep(&rest, ",")))
            return false;
    candidate->budgeted = strcmp(value, "budget") == 0;
    return !*varied || candidate->budgeted || candidate_set(candidate, varied, value);
}

/* Behind motion compensation every range migration has one receiver at the transmitter, and the same image. */
static bool chain_fill(int number, struct candidate *candidate)
{
    static const struct candidate_family family = {"", "", ""};
    static const char name[] = "monostatic | rma_delay";
    const char *rest;
    return guest_invite(name) == STATUS_OK && candidate_fill(guest_find(name, &rest), &family, number, "", candidate);
}

int candidates_fill(const struct acquisition *acquisition, struct candidate *list)
{
    int count = 0, number = 0;
    for (int k = 0; algorithms[k]; k++)
        for (const struct candidate_family *f = algorithms[k]->candidates; f && f->fixed; f++, number++) {
            char values[80], *rest = values;
            snprintf(values, sizeof values, "%s", f->values);
            do {
                const char *value = strsep(&rest, " ");
                if (count < CANDIDATES_MAX && candidate_fill(algorithms[k], f, number, value, &list[count]))
                    count++;
            } while (rest);
        }
    if (!acquisition_is_straight(acquisition, NULL) && count < CANDIDATES_MAX && chain_fill(number, &list[count]))
        count++;
    return count;
}
