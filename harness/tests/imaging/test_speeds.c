/* Pings with a sound speed each: the image of the moved records is that of the true speeds. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "echoes/speeds.h"
#include "imaging/imaging.h"
#include "scene/simulate.h"
#include "tests/support.h"

enum { PINGS_MOST = 32 };

static struct image image_of(const struct scene *scene, const struct acquisition *a, enum precision precision,
                             const void *samples)
{
    struct scene part = *scene;
    struct image image;
    struct spec spec;
    part.acquisition = *a;
    const struct problem problem = scene_problem(&part, PRECISION_DOUBLE);
    const struct echoes given = {a, precision, samples, 0};
    struct echoes echoes;
    assert_int_equal(echoes_convert(&given, PRECISION_DOUBLE, &echoes), STATUS_OK);
    assert_int_equal(spec_parse("reference:precision=double", &spec), STATUS_OK);
    assert_int_equal(imaging_form(&spec, &problem, &echoes, &image, NULL), STATUS_OK);
    echoes_free(&echoes);
    spec_free(&spec);
    return image;
}

/* Relative L2. */
static double error_of(const struct image *image, const double complex *truth, size_t count)
{
    double off = 0, all = 0;
    for (size_t k = 0; k < count; k++) {
        off += pow(cabs(((const double complex *)image->pixels[0])[k] - truth[k]), 2);
        all += pow(cabs(truth[k]), 2);
    }
    return sqrt(off / all);
}

/* Of a simulated scene, whose ping p is simulated at its own speed: the truth is the sum of the images of the pings,
   each at that speed. */
static void images_are_those_of_the_true_speeds(void **state)
{
    const char *name = *state;
    struct scene scene;
    assert_int_equal(scene_load(name, SASBENCH_ROOT "/scenes", &scene), STATUS_OK);
    struct acquisition *a = &scene.acquisition;
    const size_t each = (size_t)a->receivers * (size_t)a->samples;
    const size_t pixels = grid_pixels(&scene.patches[0]);
    double complex *all = calloc((size_t)a->pings * each, sizeof *all), *truth = calloc(pixels, sizeof *truth);
    float complex *single = calloc((size_t)a->pings * each, sizeof *single);
    double speeds[PINGS_MOST];
    assert_true(a->pings <= PINGS_MOST && all && truth && single);
    for (int p = 0; p < a->pings; p++) {
        struct echoes echoes;
        a->sound_speed = speeds[p] = 1500 * (1 + 2e-3 * sin(5 * p));
        assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
        memcpy(all + (size_t)p * each, (const double complex *)echoes.samples + (size_t)p * each, each * sizeof *all);
        echoes_free(&echoes);
        const struct acquisition one = acquisition_part(a, p, 1);
        struct image image = image_of(&scene, &one, PRECISION_DOUBLE, all + (size_t)p * each);
        for (size_t k = 0; k < pixels; k++)
            truth[k] += ((const double complex *)image.pixels[0])[k];
        image_free(&image);
    }
    for (size_t k = 0; k < (size_t)a->pings * each; k++)
        single[k] = (float complex)all[k];

    const int length = a->pulse_length;
    double complex *pulse = length > 0 ? calloc((size_t)length, sizeof *pulse) : NULL;
    if (pulse)
        memcpy(pulse, a->pulse, (size_t)length * sizeof *pulse);
    a->sound_speed = 1500;
    struct image still = image_of(&scene, a, PRECISION_DOUBLE, all);
    assert_int_equal(speeds_unite("file", speeds, a), STATUS_OK);
    assert_true(a->compressed && a->pulse_length == 0 && a->velocity[0].x > 0);
    assert_int_equal(speeds_move(a, speeds, length, pulse, NULL, PRECISION_DOUBLE, all), STATUS_OK);
    assert_int_equal(speeds_move(a, speeds, length, pulse, NULL, PRECISION_FLOAT, single), STATUS_OK);
    struct image moved = image_of(&scene, a, PRECISION_DOUBLE, all);
    struct image in_float = image_of(&scene, a, PRECISION_FLOAT, single);
    const double error = error_of(&moved, truth, pixels), of_float = error_of(&in_float, truth, pixels);
    print_message("%s: moved %.2e, in float %.2e, at one speed %.2e\n", name, error, of_float,
                  error_of(&still, truth, pixels));
    assert_true(error < 1e-3 && of_float < 1e-3 && error_of(&still, truth, pixels) > 0.1);
    image_free(&still);
    image_free(&moved);
    image_free(&in_float);
    free(pulse);
    free(single);
    free(truth);
    free(all);
    scene_free(&scene);
}

static void faults_are_refused(void **state)
{
    (void)state;
    static const struct {
        double speed;
        const char *says;
    } cases[] = {{0, "file: sound_speed is 0 m/s at ping 2"},
                 {-1500, "file: sound_speed is -1500 m/s at ping 2"},
                 {NAN, "file: sound_speed is nan m/s at ping 2"},
                 {2e9, "file: sound_speed is 2e+09 m/s at ping 2"},
                 {1200, "which moves the echoes' band by"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct acquisition a = support_acquisition(3, 1, 64);
        const double bandwidth = a.bandwidth;
        assert_int_equal(speeds_unite("file", (double[]){1500, cases[k].speed, 1500}, &a), STATUS_INVALID);
        if (!strstr(status_message(), cases[k].says))
            fail_msg("%s", status_message());
        assert_int_equal(speeds_unite("file", (double[]){1400, 1400, 1400}, &a), STATUS_OK);
        assert_true(a.sound_speed == 1400 && a.bandwidth == bandwidth);
        acquisition_free(&a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(images_are_those_of_the_true_speeds, "study/quick"),
        cmocka_unit_test_prestate(images_are_those_of_the_true_speeds, "gate/points"),
        cmocka_unit_test(faults_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
