/* SPEC parsing, driven by the algorithms' param tables. */
#include "imaging/spec.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "text/number.h"
#include "text/suggestion.h"
#include "text/text_append.h"
#include "contract/param.h"
#include "guests/guests.h"

/* Every algorithm takes `precision` beside its own table; it goes to spec.precision. */
static const char *const precision_names[] = {[PRECISION_FLOAT] = "float", [PRECISION_DOUBLE] = "double", NULL};

static const struct param precision_param = {
    .name = "precision",
    .summary = "of samples, sums and pixels",
    .type = PARAM_CHOICE,
    .initial = PRECISION_FLOAT,
    .choices = precision_names,
};

/* Names for a message, "a, b, c", and the one that was probably meant. Truncates where the message would anyway. */
struct name_list {
    char text[512], meant[SUGGESTION_TEXT];
    struct suggestion suggestion;
};

static void name_list_add(struct name_list *list, const char *name)
{
    text_append(list->text, sizeof list->text, "%s%s", *list->text ? ", " : "", name);
    suggestion_offer(&list->suggestion, name);
}

static const char *name_list_meant(struct name_list *list)
{
    suggestion_text(&list->suggestion, list->meant);
    return list->meant;
}

static int choice_count(const struct param *param)
{
    int count = 0;
    while (param->choices[count])
        count++;
    return count;
}

void param_format(const struct param *param, double value, char *text, size_t size)
{
    if (param->type == PARAM_CHOICE) {
        int index = (int)value;
        snprintf(text, size, "%s", index >= 0 && index < choice_count(param) ? param->choices[index] : "?");
        return;
    }
    /* Plain text that reads back as the same number, so that equal settings have equal text. */
    char number[32];
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(number, sizeof number, "%.*g", digits, value);
        if (strtod(number, NULL) == value)
            break;
    }
    snprintf(text, size, "%s", number);
}

/* The value as a double, or NAN when it is not a number of the kind that the param takes. */
static double value_number(const struct param *param, const char *value)
{
    double number = NAN;
    long long whole = 0;
    const char *end =
        param->type == PARAM_INTEGER ? whole_read(value, INT_MIN, INT_MAX, &whole) : number_read(value, &number);
    if (!end || *end)
        return NAN;
    return param->type == PARAM_INTEGER ? (double)whole : number;
}

static enum status choice_read(const char *place, const struct param *param, const char *value, double *out)
{
    struct name_list accepted = {.suggestion = suggestion_begin(value)};
    *out = param_choice(param, value);
    if (*out >= 0)
        return STATUS_OK;
    for (int i = 0; param->choices[i]; i++)
        name_list_add(&accepted, param->choices[i]);
    return status_set(STATUS_INVALID, "SPEC '%.100s': %s is '%.100s'%s accepted: %s", place, param->name, value,
                      name_list_meant(&accepted), accepted.text);
}

static enum status value_read(const char *place, const struct param *param, const char *value, double *out)
{
    if (param->type == PARAM_CHOICE)
        return choice_read(place, param, value, out);
    *out = value_number(param, value);
    if (*out >= param->min && *out <= param->max)
        return STATUS_OK;
    char min[32], max[32];
    param_format(param, param->min, min, sizeof min);
    param_format(param, param->max, max, sizeof max);
    return status_set(STATUS_INVALID, "SPEC '%.100s': %s is '%.100s'; accepted: %s number from %s to %s", place,
                      param->name, value, param->type == PARAM_INTEGER ? "a whole" : "a", min, max);
}

static enum status text_store(const char *place, const struct param *param, const char *value, char *field)
{
    if (strlen(value) >= param->size)
        return status_set(STATUS_INVALID, "SPEC '%.100s': %s has %zu characters, must have at most %zu", place,
                          param->name, strlen(value), param->size - 1);
    snprintf(field, param->size, "%s", value);
    return STATUS_OK;
}

/* One key=value (modified in place). */
static enum status setting_read(const char *place, char *setting, struct spec *spec)
{
    char *value = strchr(setting, '=');
    if (!value)
        return status_set(STATUS_INVALID, "SPEC '%.100s': '%.100s' is not a setting; accepted: key=value,key=value",
                          place, setting);
    *value++ = '\0';

    struct name_list accepted = {.suggestion = suggestion_begin(setting)};
    int index = 0;
    const struct param *param = spec->algorithm->params;
    for (; param && param->name && strcmp(param->name, setting) != 0; param++, index++)
        if (!param->hidden)
            name_list_add(&accepted, param->name);
    bool is_precision = !param || !param->name;
    if (is_precision) {
        name_list_add(&accepted, precision_param.name);
        if (strcmp(setting, precision_param.name) != 0)
            return status_set(STATUS_INVALID, "SPEC '%.100s': unknown key '%.100s'%s accepted: %s", place, setting,
                              name_list_meant(&accepted), accepted.text);
        param = &precision_param;
    }
    uint64_t bit = UINT64_C(1) << index;
    if (spec->given & bit)
        return status_set(STATUS_INVALID, "SPEC '%.100s': %s is given twice; accepted: each key once", place, setting);
    spec->given |= bit;

    if (param->type == PARAM_TEXT)
        return text_store(place, param, value, (char *)spec->options + param->offset);
    double number = 0;
    enum status status = value_read(place, param, value, &number);
    if (status != STATUS_OK)
        return status;
    if (is_precision)
        spec->precision = (enum precision)number;
    else
        param_store(param, spec->options, number);
    return STATUS_OK;
}

/* Every param in the order of the table, whether it was given or not; terse ones only when they differ from the
   default. */
static enum status text_build(struct spec *spec)
{
    size_t length = 0;
    *spec->text = '\0';
    for (const struct param *param = spec->algorithm->params; param && param->name; param++) {
        char value[sizeof spec->text];
        if (param->terse && param_load(param, spec->options) == param->initial)
            continue;
        if (param->type == PARAM_TEXT)
            snprintf(value, sizeof value, "%s", (const char *)spec->options + param->offset);
        else
            param_format(param, param_load(param, spec->options), value, sizeof value);
        int added =
            snprintf(spec->text + length, sizeof spec->text - length, "%s%s=%s", length ? "," : "", param->name, value);
        length += (size_t)added;
        if (length >= sizeof spec->text)
            return status_set(STATUS_INVALID, "algorithm %s: its options must have at most %zu characters as text",
                              spec->algorithm->name, sizeof spec->text - 1);
    }
    return STATUS_OK;
}

/* `copy` is the SPEC again, cut up in place; `place` stays whole for messages. */
static enum status spec_read(const char *place, char *copy, struct spec *spec)
{
    const char *behind;
    spec->algorithm = guest_find(copy, &behind);
    char *rest = *behind ? copy + (behind - copy) : NULL;
    if (rest)
        *rest++ = '\0';
    if (!spec->algorithm) {
        struct name_list accepted = {.suggestion = suggestion_begin(copy)};
        for (int i = 0; algorithms[i]; i++)
            name_list_add(&accepted, algorithms[i]->name);
        return status_set(STATUS_INVALID,
                          "SPEC '%.100s': unknown algorithm '%.100s'%s accepted: %s, PLUGIN.so, external:COMMAND",
                          place, copy, name_list_meant(&accepted), accepted.text);
    }
    if (spec->algorithm->options_size > 0) {
        spec->options = calloc(1, spec->algorithm->options_size);
        if (!spec->options)
            return status_set(STATUS_FAILED, "SPEC '%.100s': out of memory", place);
    }
    options_fill(spec->algorithm, spec->options);

    while (rest) {
        char *setting = strsep(&rest, ",");
        enum status status = setting_read(place, setting, spec);
        if (status != STATUS_OK)
            return status;
    }
    return text_build(spec);
}

enum status spec_parse(const char *text, struct spec *spec)
{
    *spec = (struct spec){.precision = PRECISION_FLOAT};
    char *copy = strdup(text);
    if (!copy)
        return status_set(STATUS_FAILED, "SPEC '%.100s': out of memory", text);
    enum status status = spec_read(text, copy, spec);
    free(copy);
    if (status != STATUS_OK)
        spec_free(spec);
    return status;
}

enum status spec_asked(const char *text, struct spec *spec)
{
    *spec = (struct spec){.algorithm = NULL};
    char *settled = guest_settle(text);
    enum status status = settled ? guest_invite(settled) : status_set(STATUS_FAILED, "SPEC '%.100s': no memory", text);
    if (status == STATUS_OK)
        status = spec_parse(settled, spec);
    free(settled);
    if (status != STATUS_OK || !spec->algorithm->filter)
        return status;
    spec_free(spec);
    return status_set(STATUS_INVALID, "SPEC '%.100s' is a filter; an algorithm must follow it: '%.100s | bp_sinc'",
                      text, text);
}

enum status spec_own(const char *text, struct spec *spec)
{
    *spec = (struct spec){.algorithm = NULL};
    return guest_foreign(text)
               ? status_set(STATUS_INVALID, "SPEC '%.100s': algorithms of this program alone are accepted", text)
               : spec_asked(text, spec);
}

void spec_free(struct spec *spec)
{
    free(spec->options);
    *spec = (struct spec){.algorithm = NULL};
}

enum status spec_copy(const struct spec *spec, struct spec *copy)
{
    size_t size = spec->algorithm->options_size;
    *copy = *spec;
    copy->options = size > 0 ? malloc(size) : NULL;
    if (size > 0 && !copy->options) {
        *copy = (struct spec){.algorithm = NULL};
        return status_set(STATUS_FAILED, "SPEC '%s': out of memory", spec->algorithm->name);
    }
    if (size > 0)
        memcpy(copy->options, spec->options, size);
    return STATUS_OK;
}

enum status spec_vary(const struct spec *spec, const char *key, const char *value, struct spec *varied)
{
    char setting[128];
    snprintf(setting, sizeof setting, "%s=%s", key, value);
    enum status status = spec_copy(spec, varied);
    if (status != STATUS_OK)
        return status;
    status = setting_read(spec->algorithm->name, setting, varied);
    if (status == STATUS_OK)
        status = text_build(varied);
    if (status != STATUS_OK)
        spec_free(varied);
    return status;
}

bool spec_given(const struct spec *spec, const char *key)
{
    int index = 0;
    const struct param *param = spec->algorithm->params;
    for (; param && param->name && strcmp(param->name, key) != 0; param++)
        index++;
    bool known = (param && param->name) || strcmp(key, precision_param.name) == 0;
    return known && spec->given >> index & 1;
}

bool spec_equal(const struct spec *a, const struct spec *b)
{
    return a->algorithm == b->algorithm && a->precision == b->precision && strcmp(a->text, b->text) == 0;
}
