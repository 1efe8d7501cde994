/* The library's images, planned once and formed as often as wanted (libsasbench.h). */
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "choice/choice.h"
#include "echoes/echo_data.h"
#include "imaging/imaging.h"
#include "library/library.h"

struct sasbench_plan {
    struct sasbench_scene *scene;
    struct spec spec;
    struct problem problem;
    struct imaging imaging;
    pthread_mutex_t one; /* image at a time */
};

static enum status spec_take(const char *text, int precision, struct spec *spec)
{
    struct budget budget;
    enum status status = precision_check(precision);
    if (status == STATUS_OK)
        status = spec_own(text, spec);
    if (status != STATUS_OK)
        return status;
    if (!spec_given(spec, "precision"))
        spec->precision = (enum precision)precision;
    return choice_asked(spec, &budget)
               ? status_set(STATUS_INVALID,
                            "SPEC '%.100s': a plan needs an algorithm by name; `sasbench plan` and runs "
                            "choose one",
                            text)
               : STATUS_OK;
}

int sasbench_plan(struct sasbench_scene *scene, const char *spec, int precision, struct sasbench_plan **plan)
{
    const int threads = turn_begin(scene->context, TURN_ALONE);
    struct sasbench_plan *made = calloc(1, sizeof *made);
    enum status status = made ? STATUS_OK : status_set(STATUS_FAILED, "no memory for a plan");
    if (status == STATUS_OK)
        status = spec_take(spec, precision, &made->spec);
    if (status == STATUS_OK) {
        made->scene = scene;
        made->problem = scene_problem(&scene->scene, made->spec.precision);
        status = imaging_open(&made->spec, &made->problem, &made->imaging);
    }
    *plan = NULL;
    if (status == STATUS_OK) {
        pthread_mutex_init(&made->one, NULL);
        *plan = made;
    } else if (made) {
        spec_free(&made->spec);
        free(made);
    }
    return turn_end(threads, status);
}

int sasbench_plan_precision(const struct sasbench_plan *plan)
{
    return (int)plan->spec.precision;
}

/* Images of extreme echoes are in double whatever the plan's precision. */
static enum status image_fit(const struct sasbench_plan *plan, const struct image *image)
{
    double largest = 0;
    for (int k = 0; k < image->patch_count; k++)
        largest = fmax(largest, largest_part(image->pixels[k], PRECISION_DOUBLE, grid_pixels(&image->patches[k])));
    return single_holds(largest)
               ? STATUS_OK
               : status_set(STATUS_INVALID,
                            "%s: the image's largest part is %g, beyond single precision; double is needed",
                            plan->spec.algorithm->name, largest);
}

static enum status image_put(const struct sasbench_plan *plan, const struct image *image, void *const *pixels)
{
    const bool convert = image->precision != plan->spec.precision;
    const enum status status = convert ? image_fit(plan, image) : STATUS_OK;
    for (int k = 0; k < image->patch_count && status == STATUS_OK; k++) {
        const size_t count = grid_pixels(&image->patches[k]);
        const double *both = image->pixels[k];
        float *single = pixels[k];
        if (!convert)
            memcpy(pixels[k], image->pixels[k], count * precision_size(image->precision));
        for (size_t n = 0; n < 2 * count && convert; n++)
            single[n] = (float)both[n];
    }
    return status;
}

int sasbench_execute(struct sasbench_plan *plan, int precision, const void *samples, void *const *pixels)
{
    const struct acquisition *a = plan->problem.acquisition;
    const int threads = turn_begin(plan->scene->context, TURN_BESIDE);
    struct echoes echoes = {0};
    struct image image = {0};
    struct stages stages;
    pthread_mutex_lock(&plan->one);
    enum status status = precision_check(precision);
    if (status == STATUS_OK)
        status = samples_check(a, (enum precision)precision, samples);
    if (status == STATUS_OK)
        status =
            echoes_convert(&(struct echoes){a, (enum precision)precision, samples, 0}, plan->spec.precision, &echoes);
    if (status == STATUS_OK && plan->imaging.image.patch_count == 0)
        status = image_allocate(plan->problem.patch_count, plan->problem.patches, plan->spec.precision,
                                &plan->imaging.image);
    stages_begin(&stages);
    if (status == STATUS_OK)
        status = imaging_execute(&plan->imaging, &echoes, &stages);
    if (status == STATUS_OK)
        status = imaging_finish(&plan->imaging, &echoes, &image);
    if (status == STATUS_OK)
        status = image_put(plan, &image, pixels);
    image_free(&image);
    echoes_free(&echoes);
    pthread_mutex_unlock(&plan->one);
    return turn_end(threads, status);
}

void sasbench_plan_free(struct sasbench_plan *plan)
{
    if (!plan)
        return;
    const int threads = turn_begin(plan->scene->context, TURN_ALONE);
    imaging_close(&plan->imaging);
    spec_free(&plan->spec);
    pthread_mutex_destroy(&plan->one);
    free(plan);
    turn_end(threads, STATUS_OK);
}
