/* What plans carry and the polar-format filter keeps (filtered.h). */
#include "papers/filtered.h"

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

/* ---- what was worked out ---- */

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

/* The last place is used again where there are too many. */
static void keep(struct measured *measured, const struct scene_number *asked, enum scene_quantity quantity,
                 double value)
{
    enum { ROOM = sizeof measured->numbers / sizeof *measured->numbers };
    int k = measured->number_count < ROOM ? measured->number_count++ : ROOM - 1;
    measured->numbers[k] = *asked;
    measured->numbers[k].quantity = quantity;
    measured->numbers[k].value = value;
}

/* ---- working it out ---- */

static enum status size_find(struct measured *measured, const struct scene_number *asked, const struct scene *scene,
                             const struct spec *spec)
{
    const struct problem problem = scene_problem(scene, spec->precision);
    struct imaging imaging;
    if (spec->algorithm->work != wk_work)
        return status_set(STATUS_INVALID, "%s has no size factor; wk_* have", spec->algorithm->name);
    enum status status = imaging_open(spec, &problem, &imaging);
    if (status != STATUS_OK)
        return status;
    keep(measured, asked, QUANTITY_SIZE_FACTOR, wk_size_factor(imaging.plan));
    imaging_close(&imaging);
    return STATUS_OK;
}

/* Upsampling, or both energies of a target. */
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
        status = spec_parse(spec_text, &spec);
        if (status == STATUS_OK) {
            status = (quantity == QUANTITY_SIZE_FACTOR ? size_find : filter_find)(measured, &asked, &scene, &spec);
            spec_free(&spec);
        }
        scene_free(&scene);
    }
    return status == STATUS_OK && is_kept(measured, &asked, &value)
               ? value
               : measured_missing(measured, "%s with %s: %s", scene_name, spec_text, status_message());
}
