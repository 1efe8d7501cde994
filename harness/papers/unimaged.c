/* Numbers of scenes, plans and the polar-format filter (unimaged.h). */
#include "papers/unimaged.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "measure/filtering.h"
#include "imaging/imaging.h"
#include "papers/assumptions.h"
#include "wavenumber/wk.h"

const char *const planned_names[] = {
    [QUANTITY_SIZE_FACTOR] = "size_factor", [QUANTITY_UPSAMPLING] = "upsampling", NULL};
const char *const energy_names[] = {"kept_db", "changed_db", NULL};

/* ---- numbers already computed ---- */

static bool is_kept(const struct measured *measured, const struct scene_number *asked, double *value)
{
    for (int k = 0; k < measured->number_count; k++) {
        const struct scene_number *n = &measured->numbers[k];
        if (n->quantity == asked->quantity && n->target == asked->target && strcmp(n->scene, asked->scene) == 0
            && strcmp(n->spec, asked->spec) == 0) {
            *value = n->value;
            return true;
        }
    }
    return false;
}

/* Without room, the last place is used again. */
static void keep(struct measured *measured, const struct scene_number *asked, enum scene_quantity quantity,
                 double value)
{
    enum { ROOM = sizeof measured->numbers / sizeof *measured->numbers };
    int k = measured->number_count < ROOM ? measured->number_count++ : ROOM - 1;
    measured->numbers[k] = *asked;
    measured->numbers[k].quantity = quantity;
    measured->numbers[k].value = value;
}

/* ---- computing numbers ---- */

/* FLOPs of a plan, or its size factor. */
static enum status plan_find(struct measured *measured, const struct scene_number *asked, const struct scene *scene,
                             const struct spec *spec)
{
    const struct problem problem = scene_problem(scene, spec->precision);
    struct imaging imaging;
    if (asked->quantity == QUANTITY_SIZE_FACTOR && spec->algorithm->work != wk_work)
        return status_set(STATUS_INVALID, "%s has no size factor; wk_* have", spec->algorithm->name);
    enum status status = imaging_open(spec, &problem, &imaging);
    if (status != STATUS_OK)
        return status;
    const struct work work = spec->algorithm->work(imaging.plan);
    if (asked->quantity == QUANTITY_SIZE_FACTOR) {
        keep(measured, asked, QUANTITY_SIZE_FACTOR, wk_size_factor(imaging.plan));
    } else {
        keep(measured, asked, QUANTITY_FLOPS, work.flops);
        keep(measured, asked, QUANTITY_FLOPS_PUBLISHED, work.published[0].source ? work.published[0].flops : NAN);
    }
    imaging_close(&imaging);
    return STATUS_OK;
}

/* The upsampling factor, or both energies of a target. */
static enum status filter_find(struct measured *measured, const struct scene_number *asked, const struct scene *scene,
                               const struct spec *spec)
{
    struct filtering filtering;
    struct kept kept;
    if (strcmp(spec->algorithm->name, "wk_polar") != 0)
        return status_set(STATUS_INVALID, "%s does not filter; wk_polar does", spec->algorithm->name);
    if (asked->target >= scene->point_count)
        return status_set(STATUS_INVALID, "there is no point target %d", asked->target + 1);
    enum status status = filtering_open(&scene->acquisition, spec, &filtering);
    if (status != STATUS_OK)
        return status;
    if (asked->quantity == QUANTITY_UPSAMPLING) {
        keep(measured, asked, QUANTITY_UPSAMPLING, filtering.shape.upsampling);
    } else {
        status = filtering_target(&filtering, scene, asked->target, &kept);
        if (status == STATUS_OK && isnan(kept.kept_db))
            status = status_set(STATUS_FAILED, "no ping sees target %d", asked->target + 1);
        if (status == STATUS_OK) {
            keep(measured, asked, QUANTITY_KEPT_DB, kept.kept_db);
            keep(measured, asked, QUANTITY_CHANGED_DB, kept.changed_db);
        }
    }
    filtering_close(&filtering);
    return status;
}

double unimaged_value(struct measured *measured, const char *scene_name, const char *spec_text, int target,
                      enum scene_quantity quantity)
{
    struct scene_number asked = {.quantity = quantity, .target = target};
    struct scene scene;
    struct spec spec;
    double value = NAN;
    snprintf(asked.scene, sizeof asked.scene, "%s", assumed_scene_name(scene_name));
    snprintf(asked.spec, sizeof asked.spec, "%s", spec_text);
    if (is_kept(measured, &asked, &value))
        return value;
    enum status status = assumed_scene_load(scene_name, &scene);
    if (status == STATUS_OK) {
        status = spec_own(spec_text, &spec);
        if (status == STATUS_OK) {
            const bool filtered = quantity >= QUANTITY_UPSAMPLING && quantity <= QUANTITY_CHANGED_DB;
            status = (filtered ? filter_find : plan_find)(measured, &asked, &scene, &spec);
            spec_free(&spec);
        }
        scene_free(&scene);
    }
    return status == STATUS_OK && is_kept(measured, &asked, &value)
               ? value
               : measured_missing(measured, "%s with %s: %s", scene_name, spec_text, status_message());
}

double measured_flops(struct measured *measured, const char *scene, const char *spec, bool by_formula)
{
    const struct measurement *row = measured_row(measured, scene, spec);
    if (row)
        return by_formula ? row->flops_published : row->flops;
    return unimaged_value(measured, scene, spec, -1, by_formula ? QUANTITY_FLOPS_PUBLISHED : QUANTITY_FLOPS);
}

/* ---- of the acquisition ---- */

const char *const scene_number_names[] = {
    "bin_m",           "wavelength_m",   "tx_length_m",        "recording_s",        "speed_m_s",
    "sound_speed_m_s", "edge_phase_rad", "linear_2_bound_rad", "linear_8_bound_rad", NULL};

/* The error of linear upsampling by beta at the band's edge: the nearest of its points is at most 1/(beta + 1) as far
   away as a nearest sample, and a point's own phase, atan(t tan(edge)), differs from the line's, t edge. */
static double linear_bound_rad(double edge, int beta)
{
    double bent = 0;
    for (int k = 1 - beta; k < beta; k += 2) {
        const double t = (double)k / (beta + 1);
        bent = fmax(bent, fabs(atan(t * tan(edge)) - t * edge));
    }
    return edge / (beta + 1) + bent;
}

double scene_number_value(int place, const struct acquisition *a)
{
    struct straight_track track;
    const bool straight = acquisition_is_straight(a, &track);
    const double edge = acos(-1) * a->bandwidth / (2 * a->fs); /* the nearest sample's error, half a sample */
    const double numbers[] = {a->sound_speed / (2 * a->fs),
                              a->sound_speed / a->fc,
                              a->tx_length,
                              straight ? a->pings * track.spacing / track.speed : NAN,
                              straight ? track.speed : NAN,
                              a->sound_speed,
                              edge,
                              linear_bound_rad(edge, 2),
                              linear_bound_rad(edge, 8)};
    return numbers[place];
}
