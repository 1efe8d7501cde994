/* The command `compare`. */
#include <math.h>
#include <stdio.h>

#include "command/task.h"
#include "gate/ab.h"
#include "gate/diff.h"
#include "echoes/echo_data.h"
#include "echoes/matfile.h"
#include "metrics/metrics.h"

static enum status compare_sides(const struct task *task, struct diff *diff)
{
    const char *const *names = task->names;
    if (task->ab)
        return ab_run(names[0], names[1], names + 2, task->name_count - 2, task->specs, task->spec_count, &ab_usual,
                      diff);
    *diff = (struct diff){0};
    if (task->name_count > 2 || task->spec_count > 0)
        return status_set(STATUS_INVALID,
                          "compare: '%s' is one argument too many without --ab: sasbench compare OLD NEW",
                          task->name_count > 2 ? names[2] : "--algorithm");
    return diff_results(names[0], names[1], diff);
}

struct number {
    char text[24];
};

static struct number number(double value, int digits)
{
    struct number number;
    if (isfinite(value))
        snprintf(number.text, sizeof number.text, "%.*g", digits, value);
    else
        snprintf(number.text, sizeof number.text, "undefined");
    return number;
}

static void differences_print(const struct error_metrics *e, const struct shift *shift)
{
    if (*e->reason)
        printf("%s\n", e->reason);
    printf("Relative error %s, after one complex gain %s; largest difference %s of the peak.\n",
           number(e->error, 3).text, number(e->error_gain, 3).text, number(e->peak_ratio, 3).text);
    printf("Gain %s at %s rad; phase %s rad rms of strong pixels; shift %s m along x, %s m along r.\n",
           number(cabs(e->gain), 6).text, number(carg(e->gain), 4).text, number(e->phase_rms_rad, 3).text,
           number(shift->x_m, 3).text, number(shift->r_m, 3).text);
}

/* Two image files: the difference of the first from the second. */
static enum status compare_images(const struct task *task)
{
    struct image_file files[2] = {{.patches = NULL}, {.patches = NULL}};
    const char *const *names = task->names;
    enum status status = task->output ? picture_check("compare", task->output) : STATUS_OK;
    if (status == STATUS_OK && (task->name_count > 2 || task->spec_count > 0 || task->markdown || task->json))
        status = status_set(STATUS_INVALID, "compare: of images two files and -o FILE.png are accepted");
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        status = image_file_open_whole(names[k], &files[k]);
    const struct image *image = &files[0].image, *reference = &files[1].image;
    if (status == STATUS_OK)
        status = metrics_cover(image, reference->patch_count, reference->patches);
    if (status == STATUS_OK)
        status = metrics_cover(reference, image->patch_count, image->patches);
    if (status == STATUS_INVALID && reference->patch_count > 0)
        status = status_set(STATUS_INVALID, "compare: %s does not fit %s: %s", names[0], names[1], status_message());
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        if (!image_is_finite(&files[k].image))
            status = status_set(STATUS_INVALID, "compare: %s has pixels that are not finite", names[k]);
    if (status == STATUS_OK) {
        const struct error_metrics e = metrics_error(image, reference);
        const struct shift shift = metrics_shift(image, reference);
        differences_print(&e, &shift);
        if (task->output)
            status = picture_differ(task->output, image, reference, names);
    }
    for (int k = 0; k < 2; k++)
        image_file_close(&files[k]);
    return status;
}

enum status command_compare(const struct task *task)
{
    struct diff diff;
    if (!task->ab && (has_extension(task->names[0], ".mat") || has_extension(task->names[0], ".npy")))
        return compare_images(task);
    if (task->output)
        return status_set(STATUS_INVALID, "compare: -o %s is for two image files", task->output);
    enum status status = compare_sides(task, &diff);
    if (status == STATUS_OK && task->markdown)
        status = diff_markdown(&diff, task->markdown);
    if (status == STATUS_OK && task->json)
        status = diff_json(&diff, task->json);
    if (status == STATUS_OK) {
        diff_print(&diff, stdout);
        status = diff_status(&diff);
    }
    diff_free(&diff);
    return status;
}

/* The command `measure`, which `compare --ab` starts. */
enum status command_measure(const struct task *task)
{
    (void)task;
    return ab_worker_serve();
}
