/* Checks of a scene file's keys against each other; the bounds of single keys are in keys.c. */
#include <math.h>

#include "scene/keys.h"

#define BYTES_MAX   0x1p40 /* of double samples */
#define RECORDS_MAX 0x1p26 /* pings times receivers */

static enum status check_beam(const struct reading *reading)
{
    const struct acquisition *a = &reading->scene.acquisition;
    const struct beam *beam = &reading->scene.beam;
    bool truncated = beam->truncation != TRUNCATION_NONE, tapered = beam->kind == BEAM_TXRX;
    if (truncated && !(beam->limit > 0)) {
        return refuse(reading, reading->beam, "beam", "limit", "a number > 0 with beam.truncation \"%s\"",
                      truncation_names[beam->truncation]);
    }
    if (!truncated && beam->limit > 0) {
        return refuse(reading, reading->beam, "beam", "limit", "left out with beam.truncation \"none\"");
    }
    if (beam->truncation == TRUNCATION_SINE && !(beam->limit <= 1)) {
        return refuse(reading, reading->beam, "beam", "limit", "a sine, > 0 and <= 1, with beam.truncation \"sine\"");
    }
    if (((truncated && beam->truncation != TRUNCATION_SINE) || tapered) && !(a->tx_length > 0)) {
        return refuse(reading, reading->array, "array", "tx_length",
                      "a number > 0 m with beam.kind \"txrx\" or a beam.truncation other than \"sine\"");
    }
    if (tapered && !(a->rx_length > 0)) {
        return refuse(reading, reading->array, "array", "rx_length", "a number > 0 m with beam.kind \"txrx\"");
    }
    return STATUS_OK;
}

static enum status check_pulse(const struct reading *reading)
{
    const struct scene *scene = &reading->scene;
    const struct acquisition *a = &scene->acquisition;
    if (scene->pulse_kind == PULSE_FLAT) {
        return scene->pulse_duration > 0
                   ? refuse(reading, reading->pulse, "pulse", "duration", "left out with pulse.kind \"flat\"")
                   : STATUS_OK;
    }
    if (!(scene->pulse_duration * a->fs <= a->samples) || !(scene->pulse_duration > 0)) {
        return refuse(reading, reading->pulse, "pulse", "duration",
                      "> 0 s and no longer than the record of %.10g s (record.samples/sonar.fs)", a->samples / a->fs);
    }
    return STATUS_OK;
}

/* The message names the largest factor, the most likely mistake, and shows all of them. */
static enum status check_sizes(const struct reading *reading)
{
    const struct acquisition *a = &reading->scene.acquisition;
    double records = (double)a->pings * a->receivers, bytes = records * a->samples * sizeof(double complex);
    bool by_receivers = a->receivers > a->pings;
    const config_setting_t *group = by_receivers ? reading->array : reading->track;
    const char *group_name = by_receivers ? "array" : "track", *name = by_receivers ? "receivers" : "pings";
    if (!(records <= RECORDS_MAX)) {
        return refuse(reading, group, group_name, name, "such that %d pings x %d receivers are at most %.10g records",
                      a->pings, a->receivers, RECORDS_MAX);
    }
    if (a->samples > a->receivers && a->samples > a->pings) {
        group = reading->record;
        group_name = "record";
        name = "samples";
    }
    if (!(bytes <= BYTES_MAX)) {
        return refuse(reading, group, group_name, name,
                      "such that %d samples x %d receivers x %d pings are at most %.10g samples (2^40 bytes)",
                      a->samples, a->receivers, a->pings, BYTES_MAX / sizeof(double complex));
    }
    return STATUS_OK;
}

/* Pings and receivers must stay within the bounds of coordinates. */
static enum status check_places(const struct reading *reading)
{
    if (reading->poses) {
        return STATUS_OK; /* measured, and checked when read */
    }
    const struct acquisition *a = &reading->scene.acquisition;
    double last_offset = reading->first_offset_m + (a->receivers - 1) * reading->pitch_m;
    double spacing = reading->spacing_m != 0 ? reading->spacing_m : reading->speed_m_s * a->pri;
    double last = reading->x_offset_m + reading->x_first_m + (a->pings - 1) * spacing;
    if (key_member(reading->track, "spacing")) {
        if (!(reading->spacing_m != 0)) {
            return refuse(reading, reading->track, "track", "spacing", "a number other than 0 m");
        }
        if (!(fabs(last) <= COORDINATE_MAX_M)) {
            return refuse(reading, reading->track, "track", "spacing",
                          "such that the last of %d pings, at %g m, stays within +-%g m", a->pings, last,
                          COORDINATE_MAX_M);
        }
    } else if (!(fabs(last) <= COORDINATE_MAX_M)) {
        return refuse(reading, reading->track, "track", "pri",
                      "such that the last of %d pings at %g m/s, at %g m, stays "
                      "within +-%g m",
                      a->pings, reading->speed_m_s, last, COORDINATE_MAX_M);
    }
    if (!(fabs(last_offset) <= COORDINATE_MAX_M)) {
        return refuse(reading, reading->array, "array", "pitch",
                      "such that the last of %d receivers, %g m ahead of the "
                      "transmitter, stays within +-%g m",
                      a->receivers, last_offset, COORDINATE_MAX_M);
    }
    return STATUS_OK;
}

/* A target area has all of its keys or none. */
static enum status check_area(const struct reading *reading)
{
    static const char *const names[] = {"x", "r", "half_x", "half_r"};
    for (size_t k = 0; reading->area && k < sizeof names / sizeof *names; k++) {
        if (!key_member(reading->area, names[k])) {
            return refuse(reading, reading->area, "area", names[k],
                          "a number: the target area is x, r, half_x, half_r");
        }
    }
    return STATUS_OK;
}

static enum status check_image_kind(const struct reading *reading)
{
    const char *one = "one of `x` with `r`, `around_targets`, `patches`";
    bool whole = reading->x && reading->r;
    if ((reading->x || reading->r) + (reading->around_targets != NULL) + (reading->patches != NULL) != 1) {
        return refuse(reading, reading->image, "image", NULL, "a group with exactly %s", one);
    }
    if (!whole && (reading->x || reading->r)) {
        return refuse(reading, reading->image, "image", reading->x ? "r" : "x", "given together with `%s`",
                      reading->x ? "x" : "r");
    }
    if (!whole && reading->reference) {
        return refuse(reading, reading->image, "image", "reference", "left out without `x` and `r`");
    }
    if (reading->patches && config_setting_length(reading->patches) == 0) {
        return refuse(reading, reading->image, "image", "patches", "a list of at least one patch");
    }
    bool needs_points = reading->around_targets || reading->reference;
    if (needs_points && !(reading->points && config_setting_length(reading->points) > 0)) {
        return refuse(reading, reading->targets, "targets", "points",
                      "a list of at least one target, with image.around_targets or image.reference");
    }
    return STATUS_OK;
}

/* Keys that contradict recorded echoes. */
static enum status check_recorded(const struct reading *reading)
{
    if (key_member(reading->root, "x_offset")) {
        return refuse(reading, reading->root, "", "x_offset", LEFT_OUT);
    }
    if (reading->fields) {
        return refuse(reading, reading->targets, "targets", "fields", LEFT_OUT);
    }
    for (int k = 0; reading->points && k < config_setting_length(reading->points); k++) {
        const config_setting_t *point = config_setting_get_elem(reading->points, (unsigned)k);
        if (config_setting_is_group(point) && key_member(point, "amplitude")) {
            return refuse(reading, point, "targets.points", "amplitude", LEFT_OUT);
        }
    }
    enum status status = check_area(reading);
    return status == STATUS_OK ? check_image_kind(reading) : status;
}

enum status keys_check(const struct reading *reading)
{
    const struct acquisition *a = &reading->scene.acquisition;
    if (*reading->echoes) {
        return check_recorded(reading);
    }
    if (!(a->fs >= a->bandwidth)) {
        return refuse(reading, reading->sonar, "sonar", "fs", "at least sonar.bandwidth (%.10g Hz)", a->bandwidth);
    }
    if (!(fabs(reading->speed_m_s) < a->sound_speed)) {
        return refuse(reading, reading->track, "track", "speed", "below sonar.sound_speed (%.10g m/s) in magnitude",
                      a->sound_speed);
    }
    if (a->receivers > 1 && reading->pitch_m == 0) {
        return refuse(reading, reading->array, "array", "pitch", "a number other than 0 m with %d receivers",
                      a->receivers);
    }
    enum status (*const checks[])(const struct reading *) = {check_beam,   check_pulse, check_sizes,
                                                             check_places, check_area,  check_image_kind};
    enum status status = STATUS_OK;
    for (size_t i = 0; i < sizeof checks / sizeof *checks && status == STATUS_OK; i++) {
        status = checks[i](reading);
    }
    return status;
}
