/* The table of a scene file's keys, the readers of their types, and the messages when they are wrong. */
#include "scene/keys.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define FNV_PRIME 1099511628211u

#define LEVEL_MIN 1e-100 /* of amplitudes, unless they are 0 */
#define SEED_MAX  1e15   /* seeds pass through a double, exactly up to 2^53 */

struct key {
    const char *group, *name, *unit;
    const struct type *type;
    size_t offset;              /* of the field in the group's struct */
    double initial, min, max;   /* default (REQUIRED: none) and closed bounds */
    const char *const *choices; /* NULL-terminated, else NULL */
};

/* read: a setting into its field, or the default when the setting is NULL; false when it is not acceptable. */
struct type {
    const char *accepts;
    bool (*read)(const struct key *key, config_setting_t *setting, void *field);
    size_t bytes; /* of the field that enter the hash; 0 = none */
};

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

/* Where neither squares nor sums leave double; nothing at all is fine too. */
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

static const struct type REAL = {"a number", read_real, sizeof(double)};
static const struct type INTEGER = {"an integer", read_integer, sizeof(int)};
static const struct type SEED = {"an integer", read_seed, sizeof(uint64_t)};
static const struct type BOOLEAN = {"true or false", read_boolean, sizeof(bool)};
static const struct type CHOICE = {"one of", read_choice, sizeof(int)};
static const struct type TEXT = {"a text of one line", read_text, 0};
static const struct type SPAN = {"[min, max] with min <= max, each", read_span, 2 * sizeof(double)};
static const struct type AMPLITUDE = {"0 or of magnitude >= 1e-100, a number or [re, im], each", read_amplitude,
                                      sizeof(double complex)};
static const struct type LEVEL = {"0 or >= 1e-100, a number", read_level, sizeof(double)};
static const struct type GROUP = {"a group { ... }", read_group, 0};
static const struct type LIST = {"a list ( ... )", read_list, 0};

static const char *const pulse_names[] = {"lfm", "lfm_time", "flat", NULL};    /* enum pulse_kind */
static const char *const beam_names[] = {"rect", "txrx", NULL};                /* enum beam_kind */
const char *const truncation_names[] = {"none", "tx", "mid", "doppler", NULL}; /* enum truncation_kind */

#define REQUIRED        NAN
#define ABOVE_0         DBL_TRUE_MIN /* as a lower bound: > 0 */
#define ANY             -DBL_MAX, DBL_MAX
#define POSITIVE        ABOVE_0, DBL_MAX
#define AT(type, field) offsetof(struct type, field)

/* All keys of all groups, and the only place where bounds are. "" is the file itself; "axis" serves every x and r. */
static const struct key keys[] = {
    {"", "base", "", &GROUP, AT(reading, base), 0, 0, 0, NULL},
    {"", "description", "", &TEXT, AT(reading, description), 0, 0, 0, NULL},
    {"", "full_size", "", &BOOLEAN, AT(reading, scene.full_size), false, 0, 0, NULL},
    {"", "aperture_limit", "", &REAL, AT(reading, scene.acquisition.aperture_limit), INFINITY, ABOVE_0, 1, NULL},
    {"", "sonar", "", &GROUP, AT(reading, sonar), REQUIRED, 0, 0, NULL},
    {"", "pulse", "", &GROUP, AT(reading, pulse), REQUIRED, 0, 0, NULL},
    {"", "array", "", &GROUP, AT(reading, array), REQUIRED, 0, 0, NULL},
    {"", "track", "", &GROUP, AT(reading, track), REQUIRED, 0, 0, NULL},
    {"", "record", "", &GROUP, AT(reading, record), REQUIRED, 0, 0, NULL},
    {"", "beam", "", &GROUP, AT(reading, beam), 0, 0, 0, NULL},
    {"", "targets", "", &GROUP, AT(reading, targets), 0, 0, 0, NULL},
    {"", "noise", "", &GROUP, AT(reading, noise), 0, 0, 0, NULL},
    {"", "image", "", &GROUP, AT(reading, image), REQUIRED, 0, 0, NULL},
    {"sonar", "sound_speed", "m/s", &REAL, AT(reading, scene.acquisition.sound_speed), 1500, ABOVE_0, 1e9, NULL},
    {"sonar", "fc", "Hz", &REAL, AT(reading, scene.acquisition.fc), REQUIRED, POSITIVE, NULL},
    {"sonar", "fs", "Hz", &REAL, AT(reading, scene.acquisition.fs), REQUIRED, POSITIVE, NULL},
    {"sonar", "bandwidth", "Hz", &REAL, AT(reading, scene.acquisition.bandwidth), REQUIRED, POSITIVE, NULL},
    {"pulse", "kind", "", &CHOICE, AT(reading, scene.pulse_kind), PULSE_LFM, 0, 0, pulse_names},
    {"pulse", "duration", "s", &REAL, AT(reading, scene.pulse_duration), 0, POSITIVE, NULL},
    {"array", "tx_length", "m", &REAL, AT(reading, scene.acquisition.tx_length), 0, ABOVE_0, COORDINATE_MAX_M, NULL},
    {"array", "rx_length", "m", &REAL, AT(reading, scene.acquisition.rx_length), 0, ABOVE_0, COORDINATE_MAX_M, NULL},
    {"array", "receivers", "", &INTEGER, AT(reading, scene.acquisition.receivers), REQUIRED, 1, INT_MAX, NULL},
    {"array", "first_offset", "m", &REAL, AT(reading, first_offset_m), 0, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"array", "pitch", "m", &REAL, AT(reading, pitch_m), 0, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"track", "speed", "m/s", &REAL, AT(reading, speed_m_s), REQUIRED, ANY, NULL},
    {"track", "pri", "s", &REAL, AT(reading, pri_s), REQUIRED, POSITIVE, NULL},
    {"track", "pings", "", &INTEGER, AT(reading, scene.acquisition.pings), REQUIRED, 1, INT_MAX, NULL},
    {"track", "x_first", "m", &REAL, AT(reading, x_first_m), 0, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"record", "first_sample", "", &INTEGER, AT(reading, first_sample), REQUIRED, INT_MIN, INT_MAX, NULL},
    {"record", "samples", "", &INTEGER, AT(reading, scene.acquisition.samples), REQUIRED, 2, INT_MAX, NULL},
    {"beam", "kind", "", &CHOICE, AT(reading, scene.beam.kind), BEAM_RECT, 0, 0, beam_names},
    {"beam", "truncation", "", &CHOICE, AT(reading, scene.beam.truncation), TRUNCATION_NONE, 0, 0, truncation_names},
    {"beam", "limit", "", &REAL, AT(reading, scene.beam.limit), 0, POSITIVE, NULL},
    {"beam", "per_frequency", "", &BOOLEAN, AT(reading, scene.beam.per_frequency), false, 0, 0, NULL},
    {"targets", "points", "", &LIST, AT(reading, points), 0, 0, 0, NULL},
    {"targets", "fields", "", &LIST, AT(reading, fields), 0, 0, 0, NULL},
    {"targets.points", "x", "m", &REAL, AT(target, x), REQUIRED, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"targets.points", "r", "m", &REAL, AT(target, r), REQUIRED, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"targets.points", "amplitude", "", &AMPLITUDE, AT(target, amplitude), 1, -1e100, 1e100, NULL},
    {"targets.fields", "x", "m", &SPAN, AT(scatter_field, x_m), REQUIRED, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"targets.fields", "r", "m", &SPAN, AT(scatter_field, r_m), REQUIRED, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"targets.fields", "count", "", &INTEGER, AT(scatter_field, count), REQUIRED, 1, SCATTERERS_MAX, NULL},
    {"targets.fields", "seed", "", &SEED, AT(scatter_field, seed), REQUIRED, 0, SEED_MAX, NULL},
    {"noise", "std", "", &LEVEL, AT(reading, scene.noise_std), 0, 0, 1e100, NULL},
    {"noise", "seed", "", &SEED, AT(reading, scene.noise_seed), 0, 0, SEED_MAX, NULL},
    {"image", "x", "", &GROUP, AT(reading, x), 0, 0, 0, NULL},
    {"image", "r", "", &GROUP, AT(reading, r), 0, 0, 0, NULL},
    {"image", "reference", "", &GROUP, AT(reading, reference), 0, 0, 0, NULL},
    {"image", "around_targets", "", &GROUP, AT(reading, around_targets), 0, 0, 0, NULL},
    {"image", "patches", "", &LIST, AT(reading, patches), 0, 0, 0, NULL},
    {"axis", "first", "m", &REAL, AT(axis_keys, first_m), REQUIRED, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"axis", "step", "m", &REAL, AT(axis_keys, step_m), REQUIRED, POSITIVE, NULL},
    {"axis", "count", "", &INTEGER, AT(axis_keys, count), REQUIRED, 1, INT_MAX, NULL},
    {"image.patches", "x", "", &GROUP, AT(patch_keys, x), REQUIRED, 0, 0, NULL},
    {"image.patches", "r", "", &GROUP, AT(patch_keys, r), REQUIRED, 0, 0, NULL},
    {"image.around_targets", "half_x", "m", &REAL, AT(around_keys, half_x_m), REQUIRED, 0, COORDINATE_MAX_M, NULL},
    {"image.around_targets", "half_r", "m", &REAL, AT(around_keys, half_r_m), REQUIRED, 0, COORDINATE_MAX_M, NULL},
    {"image.around_targets", "x_step", "m", &REAL, AT(around_keys, x_step_m), REQUIRED, POSITIVE, NULL},
    {"image.around_targets", "r_step", "m", &REAL, AT(around_keys, r_step_m), REQUIRED, POSITIVE, NULL},
    {"image.reference", "half_x", "m", &REAL, AT(around_keys, half_x_m), REQUIRED, 0, COORDINATE_MAX_M, NULL},
    {"image.reference", "half_r", "m", &REAL, AT(around_keys, half_r_m), REQUIRED, 0, COORDINATE_MAX_M, NULL},
};
#define KEY_COUNT (sizeof keys / sizeof *keys)

/* printf at the end of a text that is cut at `size` bytes. */
static void __attribute__((format(printf, 3, 4))) text_append(char *text, size_t size, const char *format, ...)
{
    size_t used = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + used, size - used, format, arguments);
    va_end(arguments);
}

/* "targets.points[2].x" */
static void append_setting_path(char *text, size_t size, const config_setting_t *setting)
{
    const config_setting_t *parent = config_setting_parent(setting);
    if (!parent) {
        return;
    }
    append_setting_path(text, size, parent);
    if (config_setting_name(setting)) {
        text_append(text, size, "%s%s", *text ? "." : "", config_setting_name(setting));
    } else {
        text_append(text, size, "[%d]", config_setting_index(setting));
    }
}

static void append_value(char *text, size_t size, const config_setting_t *setting)
{
    char number[40];
    const char *string;
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT: text_append(text, size, "%d", config_setting_get_int(setting)); break;
    case CONFIG_TYPE_INT64: text_append(text, size, "%lld", config_setting_get_int64(setting)); break;
    case CONFIG_TYPE_FLOAT:
        snprintf(number, sizeof number, "%.10g", config_setting_get_float(setting));
        text_append(text, size, "%s%s", number, strpbrk(number, ".en") ? "" : ".0"); /* 40.0 is no integer */
        break;
    case CONFIG_TYPE_BOOL: text_append(text, size, "%s", config_setting_get_bool(setting) ? "true" : "false"); break;
    case CONFIG_TYPE_STRING:
        string = config_setting_get_string(setting);
        text_append(text, size, "\"%.*s\"", (int)strcspn(string, "\r\n"), string);
        break;
    default:
        text_append(text, size, "%s",
                    config_setting_is_group(setting)  ? "a group { ... }"
                    : config_setting_is_list(setting) ? "a list ( ... )"
                                                      : "an array [ ... ]");
        for (int i = 0; config_setting_is_array(setting) && i < config_setting_length(setting) && i < 3; i++) {
            text_append(text, size, "%s", i == 0 ? " of " : ", ");
            append_value(text, size, config_setting_get_elem(setting, (unsigned)i));
        }
    }
}

static void append_accepted(char *text, size_t size, const struct key *key)
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

/* A setting of a group, or of the nearest scene that the group's `base` holds. */
static config_setting_t *member_find(const config_setting_t *group, const char *name)
{
    config_setting_t *member = NULL;
    for (; group && !member; group = config_setting_get_member(group, "base")) {
        member = config_setting_get_member(group, name);
    }
    return member;
}

void place_format(const struct reading *reading, unsigned line, char *text, size_t size)
{
    if (line == 0) {
        snprintf(text, size, "%.300s", reading->path);
        return;
    }
    const struct text_piece *piece = reading->text.pieces + reading->text.piece_count - 1;
    while (piece > reading->text.pieces && piece->first_line > (int)line) {
        piece--;
    }
    snprintf(text, size, "%.300s:%d", piece->path, piece->line + (int)line - piece->first_line);
}

enum status refuse(const struct reading *reading, const config_setting_t *group, const char *group_name,
                   const char *name, const char *format, ...)
{
    const config_setting_t *setting = name ? member_find(group, name) : group, *near = setting ? setting : group;
    char place[320], path[200] = "", value[200] = "", accepted[400];
    if (near) {
        place_format(reading, config_setting_source_line(near), place, sizeof place);
        append_setting_path(path, sizeof path, near);
    } else {
        place_format(reading, 0, place, sizeof place);
        text_append(path, sizeof path, "%s", group_name);
    }
    if (!setting) {
        text_append(path, sizeof path, "%s%s", *path ? "." : "", name);
        text_append(value, sizeof value, "missing");
    } else {
        append_value(value, sizeof value, setting);
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(accepted, sizeof accepted, format, arguments);
    va_end(arguments);
    return status_set(STATUS_INVALID, "%s: key '%s' is %s, must be %s", place, path, value, accepted);
}

static void hash_bytes(uint64_t *hash, const void *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        *hash = (*hash ^ ((const unsigned char *)bytes)[i]) * FNV_PRIME;
    }
}

static enum status check_names(const struct reading *reading, const config_setting_t *setting, const char *group)
{
    for (int i = 0; i < config_setting_length(setting); i++) {
        const char *name = config_setting_name(config_setting_get_elem(setting, (unsigned)i));
        char known[400] = "";
        bool found = false;
        for (size_t k = 0; k < KEY_COUNT && !found; k++) {
            if (strcmp(keys[k].group, group) == 0) {
                text_append(known, sizeof known, "%s%s", *known ? ", " : "", keys[k].name);
                found = strcmp(keys[k].name, name) == 0;
            }
        }
        if (!found) {
            return refuse(reading, setting, group, name, "left out: unknown, accepted are %s", known);
        }
    }
    return STATUS_OK;
}

enum status group_read(struct reading *reading, config_setting_t *setting, const char *group, void *out)
{
    for (const config_setting_t *layer = setting; layer; layer = config_setting_get_member(layer, "base")) {
        if (!config_setting_is_group(layer)) {
            return refuse(reading, layer, group, NULL, "%s", GROUP.accepts);
        }
        enum status status = check_names(reading, layer, group);
        if (status != STATUS_OK) {
            return status;
        }
    }
    for (const struct key *key = keys; key < keys + KEY_COUNT; key++) {
        if (strcmp(key->group, group) != 0) {
            continue;
        }
        config_setting_t *member = member_find(setting, key->name);
        void *field = (char *)out + key->offset;
        if ((!member && isnan(key->initial)) || !key->type->read(key, member, field)) {
            char accepted[300] = "";
            append_accepted(accepted, sizeof accepted, key);
            return refuse(reading, setting, group, key->name, "%s", accepted);
        }
        if (key->type->bytes > 0) {
            hash_bytes(&reading->scene.hash, key->group, strlen(key->group) + 1);
            hash_bytes(&reading->scene.hash, key->name, strlen(key->name) + 1);
            hash_bytes(&reading->scene.hash, field, key->type->bytes);
        }
    }
    return STATUS_OK;
}

enum status groups_read(struct reading *reading, config_setting_t *root)
{
    const struct {
        const char *name;
        config_setting_t **setting; /* filled by the first */
    } groups[] = {
        {"", &root},
        {"sonar", &reading->sonar},
        {"pulse", &reading->pulse},
        {"array", &reading->array},
        {"track", &reading->track},
        {"record", &reading->record},
        {"beam", &reading->beam},
        {"targets", &reading->targets},
        {"noise", &reading->noise},
        {"image", &reading->image},
    };
    enum status status = STATUS_OK;
    for (size_t i = 0; i < sizeof groups / sizeof *groups && status == STATUS_OK; i++) {
        status = group_read(reading, *groups[i].setting, groups[i].name, reading);
    }
    return status;
}
