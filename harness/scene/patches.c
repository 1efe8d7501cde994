/* The image of a scene from its keys: its patches, and the part where the exact image is formed. */
#include "scene/contents.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

/* One axis of a patch with its target on the middle pixel. */
static enum status axis_around(const struct reading *reading, const char *half_key, double centre, double half,
                               double step, double *first, int *count)
{
    double reach = round(half / step);
    if (!(reach <= INT_MAX / 2)) {
        return refuse(reading, reading->around_targets, "image.around_targets", half_key, "at most %d steps of %g m",
                      INT_MAX / 2, step);
    }
    *first = centre - reach * step;
    *count = 2 * (int)reach + 1;
    return STATUS_OK;
}

/* A target's place in the image's axes. */
static struct vector target_place(const struct reading *reading, const struct target *target)
{
    const struct grid axes = {.angle_rad = reading->angle_deg * M_PI / 180};
    return grid_coordinates(&axes, target->x, target->r);
}

static enum status patches_around_targets(struct reading *reading)
{
    struct scene *scene = &reading->scene;
    struct around_keys around;
    enum status status = group_read(reading, reading->around_targets, "image.around_targets", &around);
    for (; scene->patch_count < scene->point_count && status == STATUS_OK; scene->patch_count++) {
        const struct vector target = target_place(reading, &scene->targets[scene->patch_count]);
        struct grid *grid = &scene->patches[scene->patch_count];
        *grid = (struct grid){.x_step = around.x_step_m, .r_step = around.r_step_m};
        status =
            axis_around(reading, "half_x", target.x, around.half_x_m, grid->x_step, &grid->x_first, &grid->x_count);
        if (status == STATUS_OK) {
            status =
                axis_around(reading, "half_r", target.y, around.half_r_m, grid->r_step, &grid->r_first, &grid->r_count);
        }
    }
    return status;
}

/* The pixels of an axis within `half` of the pixel nearest to `centre`; false if there are none. */
static bool axis_cut(double centre, double half, double *first, double step, int *count)
{
    double middle = round((centre - *first) / step), reach = round(half / step);
    double begin = fmax(0, middle - reach), end = fmin(*count - 1, middle + reach);
    if (!(begin <= end)) {
        return false;
    }
    *first += begin * step;
    *count = (int)(end - begin) + 1;
    return true;
}

static enum status reference_fill(struct reading *reading)
{
    struct scene *scene = &reading->scene;
    struct around_keys around;
    enum status status = group_read(reading, reading->reference, "image.reference", &around);
    if (status != STATUS_OK) {
        return status;
    }
    scene->reference_patches = calloc((size_t)scene->point_count, sizeof *scene->reference_patches);
    if (!scene->reference_patches) {
        return scene_out_of_memory(reading);
    }
    for (int i = 0; i < scene->point_count; i++) {
        struct grid cut = scene->patches[0];
        const struct vector target = target_place(reading, &scene->targets[i]);
        if (axis_cut(target.x, around.half_x_m, &cut.x_first, cut.x_step, &cut.x_count)
            && axis_cut(target.y, around.half_r_m, &cut.r_first, cut.r_step, &cut.r_count)) {
            scene->reference_patches[scene->reference_count++] = cut;
        }
    }
    return scene->reference_count > 0 ? STATUS_OK
                                      : refuse(reading, reading->reference, "image.reference", NULL,
                                               "such that it holds a pixel of the image");
}

static enum status grid_read(struct reading *reading, config_setting_t *x, config_setting_t *r, struct grid *grid)
{
    struct axis_keys along, across;
    enum status status = group_read(reading, x, "axis", &along);
    if (status == STATUS_OK) {
        status = group_read(reading, r, "axis", &across);
    }
    if (status == STATUS_OK) {
        const struct grid axes = {.angle_rad = reading->angle_deg * M_PI / 180};
        const struct vector offset = grid_coordinates(&axes, reading->x_offset_m, 0);
        *grid = (struct grid){.x_first = along.first_m + offset.x,
                              .x_step = along.step_m,
                              .x_count = along.count,
                              .r_first = across.first_m + offset.y,
                              .r_step = across.step_m,
                              .r_count = across.count};
    }
    return status;
}

enum status image_fill(struct reading *reading)
{
    struct scene *scene = &reading->scene;
    int patches = reading->patches ? config_setting_length(reading->patches) : 0;
    int most = patches > scene->point_count ? patches : scene->point_count;
    scene->patches = calloc((size_t)most + 1, sizeof *scene->patches);
    if (!scene->patches) {
        return scene_out_of_memory(reading);
    }
    enum status status = STATUS_OK;
    if (reading->around_targets) {
        status = patches_around_targets(reading);
    } else if (reading->patches) {
        for (; scene->patch_count < patches && status == STATUS_OK; scene->patch_count++) {
            struct patch_keys patch;
            status = group_read(reading, config_setting_get_elem(reading->patches, (unsigned)scene->patch_count),
                                "image.patches", &patch);
            if (status == STATUS_OK) {
                status = grid_read(reading, patch.x, patch.r, &scene->patches[scene->patch_count]);
            }
        }
    } else {
        scene->patch_count = 1;
        status = grid_read(reading, reading->x, reading->r, &scene->patches[0]);
    }
    for (int i = 0; i < scene->patch_count && status == STATUS_OK; i++) {
        scene->patches[i].angle_rad = reading->angle_deg * M_PI / 180;
        status = grid_check(&scene->patches[i], reading->path);
    }
    if (status == STATUS_OK && reading->reference) {
        status = reference_fill(reading);
    }
    return status == STATUS_OK
               ? grid_meets_records(&scene->acquisition, scene->patch_count, scene->patches, reading->path)
               : status;
}
