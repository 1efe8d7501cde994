/* The table of all keys of a scene file with their bounds, and the reading of groups. */
#include "scene/keys.h"

#include <limits.h>
#include <string.h>

#include "text/text_append.h"
#include "scene/key_types.h"

#define SEED_MAX 1e15 /* seeds pass through a double, exactly up to 2^53 */

static const char *const pulse_names[] = {"lfm", "lfm_time", "flat", NULL};            /* enum pulse_kind */
static const char *const beam_names[] = {"rect", "txrx", NULL};                        /* enum beam_kind */
static const char *const motion_names[] = {"sway", "surge", "heave", "yaw", NULL};     /* enum motion_axis */
const char *const truncation_names[] = {"none", "tx", "mid", "doppler", "sine", NULL}; /* enum truncation_kind */

#define ANY             -DBL_MAX, DBL_MAX
#define POSITIVE        ABOVE_0, DBL_MAX
#define AT(type, field) offsetof(struct type, field)

/* All keys of all groups, with all bounds. "" is the file itself; "axis" serves every x and r. */
static const struct key keys[] = {
    {"", "base", "", &GROUP, AT(reading, base), 0, 0, 0, NULL},
    {"", "description", "", &TEXT, AT(reading, description), 0, 0, 0, NULL},
    {"", "echoes", "", &TEXT, AT(reading, echoes), 0, 0, 0, NULL},
    {"", "full_size", "", &BOOLEAN, AT(reading, scene.full_size), false, 0, 0, NULL},
    {"", "aperture_limit", "", &REAL, AT(reading, scene.acquisition.aperture_limit), INFINITY, ABOVE_0, 1, NULL},
    {"", "x_offset", "m", &REAL, AT(reading, x_offset_m), 0, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"", "sonar", "", &GROUP, AT(reading, sonar), 0, 0, 0, NULL},
    {"", "pulse", "", &GROUP, AT(reading, pulse), 0, 0, 0, NULL},
    {"", "array", "", &GROUP, AT(reading, array), 0, 0, 0, NULL},
    {"", "track", "", &GROUP, AT(reading, track), 0, 0, 0, NULL},
    {"", "record", "", &GROUP, AT(reading, record), 0, 0, 0, NULL},
    {"", "beam", "", &GROUP, AT(reading, beam), 0, 0, 0, NULL},
    {"", "area", "", &GROUP, AT(reading, area), 0, 0, 0, NULL},
    {"", "targets", "", &GROUP, AT(reading, targets), 0, 0, 0, NULL},
    {"", "noise", "", &GROUP, AT(reading, noise), 0, 0, 0, NULL},
    {"", "image", "", &GROUP, AT(reading, image), 0, 0, 0, NULL},
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
    {"track", "speed", "m/s", &REAL, AT(reading, speed_m_s), 0, ANY, NULL},
    {"track", "pri", "s", &REAL, AT(reading, scene.acquisition.pri), REQUIRED, POSITIVE, NULL},
    {"track", "spacing", "m", &REAL, AT(reading, spacing_m), 0, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"track", "pings", "", &INTEGER, AT(reading, scene.acquisition.pings), 0, 1, INT_MAX, NULL},
    {"track", "x_first", "m", &REAL, AT(reading, x_first_m), 0, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"track", "file", "", &TEXT, AT(reading, track_file), 0, 0, 0, NULL},
    {"track", "errors", "", &LIST, AT(reading, motion), 0, 0, 0, NULL},
    {"track", "errors_known", "", &BOOLEAN, AT(reading, errors_known), false, 0, 0, NULL},
    {"track.errors", "axis", "", &CHOICE, AT(motion_keys, axis), 0, 0, 0, motion_names},
    {"track.errors", "amplitude", "m, or degrees of yaw", &REAL, AT(motion_keys, amplitude), 0, -1e6, 1e6, NULL},
    {"track.errors", "period", "s", &REAL, AT(motion_keys, period_s), 0, POSITIVE, NULL},
    {"track.errors", "phase", "degrees", &REAL, AT(motion_keys, phase_deg), 0, -360, 360, NULL},
    {"track.errors", "walk", "m, or degrees of yaw", &REAL, AT(motion_keys, walk), 0, ABOVE_0, 1e6, NULL},
    {"track.errors", "seed", "", &SEED, AT(motion_keys, seed), 0, 0, SEED_MAX, NULL},
    {"record", "first_sample", "", &INTEGER, AT(reading, first_sample), REQUIRED, INT_MIN, INT_MAX, NULL},
    {"record", "time_offset", "s", &REAL, AT(reading, time_offset_s), 0, ANY, NULL},
    {"record", "samples", "", &INTEGER, AT(reading, scene.acquisition.samples), REQUIRED, 2, INT_MAX, NULL},
    {"beam", "kind", "", &CHOICE, AT(reading, scene.beam.kind), BEAM_RECT, 0, 0, beam_names},
    {"beam", "truncation", "", &CHOICE, AT(reading, scene.beam.truncation), TRUNCATION_NONE, 0, 0, truncation_names},
    {"beam", "limit", "", &REAL, AT(reading, scene.beam.limit), 0, POSITIVE, NULL},
    {"beam", "per_frequency", "", &BOOLEAN, AT(reading, scene.beam.per_frequency), false, 0, 0, NULL},
    {"beam", "squint", "degrees", &REAL, AT(reading, squint_deg), 0, -89.9, 89.9, NULL},
    {"area", "x", "m", &REAL, AT(reading, scene.acquisition.area.x), 0, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"area", "r", "m", &REAL, AT(reading, scene.acquisition.area.r), 0, ABOVE_0, COORDINATE_MAX_M, NULL},
    {"area", "half_x", "m", &REAL, AT(reading, scene.acquisition.area.half_x), 0, ABOVE_0, COORDINATE_MAX_M, NULL},
    {"area", "half_r", "m", &REAL, AT(reading, scene.acquisition.area.half_r), 0, ABOVE_0, COORDINATE_MAX_M, NULL},
    {"targets", "points", "", &LIST, AT(reading, points), 0, 0, 0, NULL},
    {"targets", "fields", "", &LIST, AT(reading, fields), 0, 0, 0, NULL},
    {"targets.points", "x", "m", &REAL, AT(target, x), REQUIRED, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"targets.points", "r", "m", &REAL, AT(target, r), REQUIRED, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"targets.points", "amplitude", "", &AMPLITUDE, AT(target, amplitude), 1, -1e300, 1e300, NULL},
    {"targets.fields", "x", "m", &SPAN, AT(scatter_field, x_m), REQUIRED, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"targets.fields", "r", "m", &SPAN, AT(scatter_field, r_m), REQUIRED, -COORDINATE_MAX_M, COORDINATE_MAX_M, NULL},
    {"targets.fields", "count", "", &INTEGER, AT(scatter_field, count), REQUIRED, 1, SCATTERERS_MAX, NULL},
    {"targets.fields", "seed", "", &SEED, AT(scatter_field, seed), REQUIRED, 0, SEED_MAX, NULL},
    {"noise", "std", "", &LEVEL, AT(reading, scene.noise_std), 0, 0, 1e300, NULL},
    {"noise", "seed", "", &SEED, AT(reading, scene.noise_seed), 0, 0, SEED_MAX, NULL},
    {"image", "angle", "degrees", &REAL, AT(reading, angle_deg), 0, -89.9, 89.9, NULL},
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

config_setting_t *key_member(const config_setting_t *group, const char *name)
{
    config_setting_t *member = NULL;
    for (; group && !member; group = config_setting_get_member(group, "base")) {
        member = config_setting_get_member(group, name);
    }
    return member;
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
        config_setting_t *member = key_member(setting, key->name);
        void *field = (char *)out + key->offset;
        if ((!member && isnan(key->initial)) || !key->type->read(key, member, field)) {
            char accepted[300] = "";
            key_accepted_append(accepted, sizeof accepted, key);
            return refuse(reading, setting, group, key->name, "%s", accepted);
        }
        if (key->type->bytes > 0) {
            hash_add(&reading->scene.hash, key->group, strlen(key->group) + 1);
            hash_add(&reading->scene.hash, key->name, strlen(key->name) + 1);
            hash_add(&reading->scene.hash, field, key->type->bytes);
        }
    }
    return STATUS_OK;
}

enum status groups_read(struct reading *reading, config_setting_t *root)
{
    const struct {
        const char *name;
        config_setting_t **setting;
        bool simulated, needed; /* left out with `echoes`; required without it */
    } groups[] = {
        {"sonar", &reading->sonar, true, true},   {"pulse", &reading->pulse, true, true},
        {"array", &reading->array, true, true},   {"track", &reading->track, true, true},
        {"record", &reading->record, true, true}, {"beam", &reading->beam, true, false},
        {"area", &reading->area, false, false},   {"targets", &reading->targets, false, false},
        {"noise", &reading->noise, true, false},  {"image", &reading->image, false, true},
    };
    reading->root = root;
    enum status status = group_read(reading, root, "", reading);
    for (size_t i = 0; i < sizeof groups / sizeof *groups && status == STATUS_OK; i++) {
        const bool left_out = *reading->echoes && groups[i].simulated, given = *groups[i].setting != NULL;
        if (left_out && given) {
            status = refuse(reading, root, "", groups[i].name, LEFT_OUT);
        } else if (!left_out && !given && groups[i].needed) {
            status = refuse(reading, root, "", groups[i].name, "%s%s", GROUP.accepts,
                            groups[i].simulated ? ", or `echoes` name an echo file" : "");
        }
    }
    for (size_t i = 0; i < sizeof groups / sizeof *groups && status == STATUS_OK; i++) {
        if (!*reading->echoes || !groups[i].simulated) {
            status = group_read(reading, *groups[i].setting, groups[i].name, reading);
        }
    }
    return status;
}
