#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "../simulate.h"

#define CHECK(status) \
    do { \
        if ((status) != STATUS_OK) \
            fail_msg("%s", status_message()); \
    } while (0)

void support_scene(const char *name, struct scene *scene)
{
    CHECK(scene_load(name, SASBENCH_ROOT "/scenes", scene));
}

void support_echoes(const struct scene *scene, struct echoes *echoes)
{
    CHECK(scene_simulate(scene, echoes));
}

enum status support_image(const char *text, struct problem problem, const struct echoes *echoes, struct image *image)
{
    struct spec spec;
    struct echoes converted;
    struct stages stages;
    void *plan;
    CHECK(spec_parse(text, &spec));
    problem.precision = spec.precision;
    enum status status = spec.algorithm->plan(&problem, spec.options, &plan);
    if (status == STATUS_OK) {
        CHECK(echoes_convert(echoes, spec.precision, &converted));
        CHECK(image_allocate(problem.patch_count, problem.patches, spec.precision, image));
        stages_begin(&stages);
        status = spec.algorithm->execute(plan, &converted, image, &stages);
        assert_int_equal(status, STATUS_OK);
        spec.algorithm->destroy(plan);
        echoes_free(&converted);
    }
    spec_free(&spec);
    return status;
}

double support_difference(const struct image *a, const struct image *b)
{
    double difference = 0, norm = 0;
    for (int k = 0; k < b->patch_count; k++)
        for (int i = 0; i < b->patches[k].r_count; i++)
            for (int j = 0; j < b->patches[k].x_count; j++) {
                double complex exact = image_pixel(b, k, i, j), delta = image_pixel(a, k, i, j) - exact;
                difference += creal(delta) * creal(delta) + cimag(delta) * cimag(delta);
                norm += creal(exact) * creal(exact) + cimag(exact) * cimag(exact);
            }
    return sqrt(norm > 0 ? difference / norm : difference);
}

double support_peak(const struct image *image)
{
    double peak = 0;
    for (int k = 0; k < image->patch_count; k++)
        for (int i = 0; i < image->patches[k].r_count; i++)
            for (int j = 0; j < image->patches[k].x_count; j++)
                peak = fmax(peak, cabs(image_pixel(image, k, i, j)));
    return peak;
}

char folder[256];

int folder_make(void **state)
{
    (void)state;
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/sasbench-XXXXXX", base ? base : "/tmp");
    return mkdtemp(folder) ? 0 : -1;
}

int folder_remove(void **state)
{
    (void)state;
    char command[300];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

const char *path_of(const char *name)
{
    static char paths[4][400];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}
