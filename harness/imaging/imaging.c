/* Plan, execute, check, destroy (imaging.h). */
#include "imaging/imaging.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/pairs/pairs.h"
#include "common/memory.h"
#include "contract/param.h"
#include "echoes/echo_data.h"

enum { FENCE = 4096, FENCE_BYTE = 0xa5 }; /* how many, and what they hold */

static size_t patch_bytes(const struct image *image, int k)
{
    return grid_pixels(&image->patches[k]) * precision_size(image->precision);
}

/* Ahead of each patch and behind: a guest that writes beside its image would break what others do later. */
static enum status fences_set(struct imaging *imaging)
{
    for (int k = 0; k < imaging->image.patch_count; k++) {
        const size_t bytes = patch_bytes(&imaging->image, k);
        char *block = memory_columns(64, bytes + 2 * FENCE);
        if (!block)
            return status_set(STATUS_FAILED, "%s: no memory for its image", imaging->algorithm->name);
        memset(block, FENCE_BYTE, bytes + 2 * FENCE);
        free(imaging->image.pixels[k]);
        imaging->image.pixels[k] = memset(block + FENCE, 0, bytes);
        imaging->fenced++;
    }
    return STATUS_OK;
}

bool imaging_is_fenced(const struct imaging *imaging)
{
    bool held = true;
    for (int k = 0; k < imaging->fenced; k++) {
        const size_t bytes = patch_bytes(&imaging->image, k);
        const unsigned char *pixels = imaging->image.pixels[k], *before = pixels - FENCE;
        for (size_t n = 0; n < FENCE; n++)
            held = held && before[n] == FENCE_BYTE && pixels[bytes + n] == FENCE_BYTE;
    }
    return held;
}

static bool fences_drop(struct imaging *imaging)
{
    const bool held = imaging_is_fenced(imaging);
    for (int k = 0; k < imaging->fenced; k++) {
        unsigned char *pixels = imaging->image.pixels[k];
        imaging->image.pixels[k] = memmove(pixels - FENCE, pixels, patch_bytes(&imaging->image, k));
    }
    imaging->fenced = 0;
    return held;
}

enum status imaging_open(const struct spec *spec, const struct problem *problem, struct imaging *imaging)
{
    *imaging = (struct imaging){.algorithm = spec->algorithm};
    if (problem->window && !(problem->patch_count == 1 && spec->algorithm->traits & TRAIT_WINDOW))
        return status_set(STATUS_UNSUPPORTED, "%s: forms no window of an image, or not of several patches",
                          spec->algorithm->name);
    if (problem->window)
        imaging->part = grid_part(problem->patches, problem->window);
    const struct grid *patches = problem->window ? &imaging->part : problem->patches;
    enum status status = image_allocate(problem->patch_count, patches, problem->precision, &imaging->image);
    if (status == STATUS_OK && spec->algorithm->origin)
        status = fences_set(imaging);
    if (status == STATUS_OK) {
        double begin = seconds_now();
        status = algorithm_plan(spec->algorithm, problem, spec->options, &imaging->plan);
        imaging->plan_s = seconds_now() - begin;
    }
    if (status != STATUS_OK) {
        imaging->plan = NULL;
        imaging_close(imaging);
    }
    return status;
}

void imaging_reads(const struct imaging *imaging, const struct problem *problem, bool *read)
{
    for (int p = 0; p < problem->acquisition->pings; p++)
        read[p] = true;
    if (imaging->algorithm->reads)
        imaging->algorithm->reads(imaging->plan, read);
}

enum status imaging_execute(struct imaging *imaging, const struct echoes *echoes, struct stages *stages)
{
    return imaging->algorithm->execute(imaging->plan, echoes, &imaging->image, stages);
}

enum status imaging_finish(struct imaging *imaging, const struct echoes *echoes, struct image *image)
{
    const char *name = imaging->algorithm->name;
    const bool held = fences_drop(imaging);
    enum status status = held ? STATUS_OK : status_set(STATUS_FAILED, "%s wrote outside its image", name);
    *image = imaging->image;
    imaging->image = (struct image){0};
    if (status == STATUS_OK && !image_is_finite(image))
        status = status_set(STATUS_FAILED,
                            "%s left pixels unwritten, or made values that are not finite of finite echoes", name);
    if (status != STATUS_OK)
        image_free(image);
    return status == STATUS_OK ? imaging_scale(name, echoes->exponent, image) : status;
}

enum status imaging_scale(const char *name, int exponent, struct image *image)
{
    enum status status = image_scale(image, exponent);
    if (status == STATUS_OK && exponent != 0 && !image_is_finite(image))
        status = status_set(STATUS_INVALID,
                            "the image of %s is beyond the range of double; the echoes (targets.points.amplitude of a "
                            "scene, variable `samples` of a file) must be smaller",
                            name);
    if (status != STATUS_OK)
        image_free(image);
    return status;
}

void imaging_close(struct imaging *imaging)
{
    if (imaging->plan)
        imaging->algorithm->destroy(imaging->plan);
    fences_drop(imaging);
    image_free(&imaging->image);
    *imaging = (struct imaging){0};
}

enum status imaging_form(const struct spec *spec, const struct problem *problem, const struct echoes *echoes,
                         struct image *image, struct work *work)
{
    struct imaging imaging;
    struct stages stages;
    *image = (struct image){0};
    enum status status = imaging_open(spec, problem, &imaging);
    if (status != STATUS_OK)
        return status;
    if (work)
        *work = imaging.algorithm->work(imaging.plan);
    stages_begin(&stages);
    status = imaging_execute(&imaging, echoes, &stages);
    if (status == STATUS_OK)
        status = imaging_finish(&imaging, echoes, image);
    imaging_close(&imaging);
    return status;
}

/* Where no pairs are summed at least a product a sample, or a pair where these are fewer: samples that no pixel needs
   may be left out. Not twice the work of summing every sample for each pair and transforming each record: ours take
   .001 to .8 of that. */
struct work_bounds work_bounds(const struct algorithm *algorithm, const void *options, const struct problem *problem,
                               const struct work *work)
{
    const struct acquisition *a = problem->acquisition;
    struct acquisition limited = *a;
    struct problem own = *problem;
    for (const struct param *param = algorithm->origin ? NULL : algorithm->params; param && param->name; param++)
        if (strcmp(param->name, "aperture") == 0 && param_load(param, options) < 1) /* 1: all */
            limited.aperture_limit = fmin(limited.aperture_limit, param_load(param, options));
    own.acquisition = &limited;
    const double pairs = pairs_count(&own), samples = a->samples + a->pulse_length;
    const double records = (double)a->pings * a->receivers;
    return (struct work_bounds){pairs, work->pairs > 0 ? 8 * work->pairs : 2 * fmin(records * a->samples, pairs),
                                2 * (pairs * 8 * samples + records * 5 * samples * log2(samples))};
}

enum status work_check(const char *name, const struct work_bounds *bounds, const struct work *work)
{
    if (isnan(work->flops) && isnan(work->pairs))
        return STATUS_OK;
    if (work->pairs != 0 && work->pairs != bounds->pairs)
        return status_set(STATUS_FAILED, "%s: its work has %.9g pairs, must be 0 or %.9g", name, work->pairs,
                          bounds->pairs);
    if (!(work->flops >= bounds->flops_least && work->flops <= bounds->flops_most))
        return status_set(STATUS_FAILED, "%s: its work has %.3g FLOPs, must be %.3g to %.3g", name, work->flops,
                          bounds->flops_least, bounds->flops_most);
    if (!(work->bytes >= 0 && isfinite(work->bytes)))
        return status_set(STATUS_FAILED, "%s: its work has %.3g bytes, must be at least 0", name, work->bytes);
    return STATUS_OK;
}
