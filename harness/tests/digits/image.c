/* usage: image SCENE SPEC: form one image, for .ci/digits, which builds the algorithms with a numerical sanitizer. */
#include <stdio.h>

#include "echoes/echo_data.h"
#include "imaging/spec.h"
#include "scene/scene.h"
#include "scene/simulate.h"

static enum status image_form(const struct scene *scene, const struct spec *spec)
{
    struct problem problem = problem_make(&scene->acquisition, scene->patch_count, scene->patches, spec->precision);
    struct echoes echoes, converted;
    struct image image;
    struct stages stages;
    void *plan;
    enum status status = scene_simulate(scene, &echoes);
    if (status == STATUS_OK)
        status = echoes_convert(&echoes, spec->precision, &converted);
    if (status == STATUS_OK)
        status = image_allocate(problem.patch_count, problem.patches, spec->precision, &image);
    if (status == STATUS_OK)
        status = algorithm_plan(spec->algorithm, &problem, spec->options, &plan);
    if (status == STATUS_OK) {
        stages_begin(&stages);
        status = spec->algorithm->execute(plan, &converted, &image, &stages);
    }
    return status == STATUS_OK && !image_is_finite(&image) ? status_set(STATUS_FAILED, "the image is not finite")
                                                           : status;
}

int main(int count, char **arguments)
{
    struct scene scene;
    struct spec spec;
    enum status status = count == 3 ? STATUS_OK : status_set(STATUS_INVALID, "usage: image SCENE SPEC");
    if (status == STATUS_OK)
        status = scene_load(arguments[1], SASBENCH_ROOT "/scenes", &scene);
    if (status == STATUS_OK)
        status = spec_parse(arguments[2], &spec);
    if (status == STATUS_OK)
        status = image_form(&scene, &spec);
    if (status != STATUS_OK)
        fprintf(stderr, "%s\n", status_message());
    return status != STATUS_OK;
}
