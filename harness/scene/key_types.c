/* Types of keys: reading a setting into its field, and the values that a type accepts. */
#include "scene/key_types.h"

#include <complex.h>
#include <stdint.h>
#include <string.h>

#include "text/text_append.h"

#define LEVEL_MIN 1e-300 /* of amplitudes, unless they are 0 */

static bool within(const struct key *key, double value)
{
    return value >= key->min && value <= key->max;
}

static bool read_real(const struct key *key, config_setting_t *setting, void *field)
{
    double value = key->initial;
    if (setting) {
        value = config_setting_get_float(setting); /* whole numbers are converted (config_set_auto_convert) */
    }
    *(double *)field = value;
    return !setting || (config_setting_is_number(setting) && within(key, value));
}

static bool read_whole(const struct key *key, config_setting_t *setting, double *value)
{
    return (!setting || config_setting_type(setting) != CONFIG_TYPE_FLOAT) && read_real(key, setting, value);
}

static bool read_integer(const struct key *key, config_setting_t *setting, void *field)
{
    double value;
    if (!read_whole(key, setting, &value)) {
        return false;
    }
    *(int *)field = (int)value;
    return true;
}

static bool read_seed(const struct key *key, config_setting_t *setting, void *field)
{
    double value;
    if (!read_whole(key, setting, &value)) {
        return false;
    }
    *(uint64_t *)field = (uint64_t)value;
    return true;
}

static bool read_boolean(const struct key *key, config_setting_t *setting, void *field)
{
    *(bool *)field = setting ? config_setting_get_bool(setting) : key->initial != 0;
    return !setting || config_setting_type(setting) == CONFIG_TYPE_BOOL;
}

static bool read_choice(const struct key *key, config_setting_t *setting, void *field)
{
    *(int *)field = (int)key->initial;
    if (!setting) {
        return true;
    }
    const char *text = config_setting_get_string(setting);
    for (int i = 0; text && key->choices[i]; i++) {
        if (strcmp(text, key->choices[i]) == 0) {
            *(int *)field = i;
            return true;
        }
    }
    return false;
}

static bool read_text(const struct key *key, config_setting_t *setting, void *field)
{
    (void)key;
    const char *text = setting ? config_setting_get_string(setting) : "";
    *(const char **)field = text;
    return text && !strpbrk(text, "\r\n");
}

static bool read_two(const struct key *key, config_setting_t *setting, double *two)
{
    return (config_setting_is_array(setting) || config_setting_is_list(setting)) && config_setting_length(setting) == 2
           && read_real(key, config_setting_get_elem(setting, 0), &two[0])
           && read_real(key, config_setting_get_elem(setting, 1), &two[1]);
}

static bool read_span(const struct key *key, config_setting_t *setting, void *field)
{
    double *span = field;
    return read_two(key, setting, span) && span[0] <= span[1];
}

static bool read_complex(const struct key *key, config_setting_t *setting, void *field)
{
    double parts[2] = {0, 0};
    bool good = setting && config_setting_is_aggregate(setting) ? read_two(key, setting, parts)
                                                                : read_real(key, setting, &parts[0]);
    *(double complex *)field = parts[0] + I * parts[1];
    return good;
}

/* Amplitudes whose squares and sums stay within double; 0 is accepted, too. */
static bool is_level(double magnitude)
{
    return magnitude == 0 || magnitude >= LEVEL_MIN;
}

static bool read_amplitude(const struct key *key, config_setting_t *setting, void *field)
{
    return read_complex(key, setting, field) && is_level(cabs(*(double complex *)field));
}

static bool read_level(const struct key *key, config_setting_t *setting, void *field)
{
    return read_real(key, setting, field) && is_level(*(double *)field);
}

static bool read_group(const struct key *key, config_setting_t *setting, void *field)
{
    (void)key;
    *(config_setting_t **)field = setting;
    return !setting || config_setting_is_group(setting);
}

static bool read_list(const struct key *key, config_setting_t *setting, void *field)
{
    (void)key;
    *(config_setting_t **)field = setting;
    return !setting || config_setting_is_list(setting);
}

const struct type REAL = {"a number", read_real, sizeof(double)};
const struct type INTEGER = {"an integer", read_integer, sizeof(int)};
const struct type SEED = {"an integer", read_seed, sizeof(uint64_t)};
const struct type BOOLEAN = {"true or false", read_boolean, sizeof(bool)};
const struct type CHOICE = {"one of", read_choice, sizeof(int)};
const struct type TEXT = {"a text of one line", read_text, 0};
const struct type SPAN = {"[min, max] with min <= max, each", read_span, 2 * sizeof(double)};
const struct type AMPLITUDE = {"0 or of magnitude >= 1e-300, a number or [re, im], each", read_amplitude,
                               sizeof(double complex)};
const struct type LEVEL = {"0 or >= 1e-300, a number", read_level, sizeof(double)};
const struct type GROUP = {"a group { ... }", read_group, 0};
const struct type LIST = {"a list ( ... )", read_list, 0};

void key_accepted_append(char *text, size_t size, const struct key *key)
{
    text_append(text, size, "%s", key->type->accepts);
    for (int i = 0; key->choices && key->choices[i]; i++) {
        text_append(text, size, "%s \"%s\"", i == 0 ? "" : ",", key->choices[i]);
    }
    if (key->min == key->max) {
        return; /* types without bounds */
    }
    if (key->min == -DBL_MAX) {
        text_append(text, size, " that is finite");
    } else if (key->max == DBL_MAX) {
        text_append(text, size, key->min == ABOVE_0 ? " > 0" : " >= %.10g", key->min);
    } else if (key->min == ABOVE_0) {
        text_append(text, size, " > 0 and <= %.10g", key->max);
    } else {
        text_append(text, size, " from %.10g to %.10g", key->min, key->max);
    }
    text_append(text, size, "%s%s", *key->unit ? " " : "", key->unit);
}
