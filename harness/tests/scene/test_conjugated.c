/* Recordings whose samples or pulse are conjugated are told, and others are not. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/random.h"
#include "scene/conjugated.h"
#include "scene/simulate.h"
#include "tests/support.h"

/* The echoes of a scene as if they had been recorded. */
static struct scene recorded(const char *name)
{
    struct scene scene;
    struct echoes echoes;
    if (scene_load(name, SASBENCH_ROOT "/scenes", &scene) != STATUS_OK || scene_echoes(&scene, &echoes) != STATUS_OK)
        fail_msg("%s: %s", name, status_message());
    scene.recorded = (double complex *)echoes.samples;
    return scene;
}

static void conjugate(double complex *values, size_t count)
{
    for (size_t n = 0; n < count; n++)
        values[n] = conj(values[n]);
}

static void samples_conjugate(struct scene *scene)
{
    const struct acquisition *a = &scene->acquisition;
    conjugate(scene->recorded, (size_t)a->pings * (size_t)a->receivers * (size_t)a->samples);
}

/* Told where `wanted` is a cure's beginning, else not. */
static void assert_told(const struct scene *scene, const char *what, const char *wanted)
{
    const struct condition condition = conjugated_condition(scene);
    print_message("%s: %.3g, %s\n", what, condition.value, condition.cure);
    if (condition_holds(&condition) != !wanted || (wanted && strncmp(condition.cure, wanted, strlen(wanted)) != 0))
        fail_msg("%s: %g, cure %s; %s expected", what, condition.value, condition.cure, wanted ? wanted : "none");
}

static void every_way_is_told(struct scene *scene, const char *what)
{
    const bool raw = !scene->acquisition.compressed;
    assert_told(scene, what, NULL);
    samples_conjugate(scene);
    assert_told(scene, what, "conj(samples): ");
    conjugate(scene->acquisition.pulse, (size_t)scene->acquisition.pulse_length);
    assert_told(scene, what, raw ? "conj(samples), conj(pulse): " : "conj(samples): ");
    samples_conjugate(scene);
    assert_told(scene, what, raw ? "conj(pulse): " : NULL);
    scene_free(scene);
}

static void shipped_scenes_are_told(void **state)
{
    (void)state;
    static const char *const names[] = {"study/quick", "gate/points",     "gate/field", "gate/squint",
                                        "study/swath", "sq18/squint_20",  "pf05/nine",  "study/point",
                                        "zp15/target", "lbf21/blocks_2_7"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        struct scene scene = recorded(names[k]);
        every_way_is_told(&scene, names[k]);
    }
}

/* Around the scene, from above it, echoes from everywhere, no lengths stated. */
static void circles_are_told(void **state)
{
    (void)state;
    char text[20000] = "x,y,z\n";
    for (int p = 0; p < 300; p++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "%.9g,%.9g,4\n", 15 * cos(2 * M_PI * p / 300),
                 15 * sin(2 * M_PI * p / 300));
    support_write("circle.csv", text);
    support_write("scene.cfg",
                  "sonar = { fc = 30e3; bandwidth = 8e3; fs = 12e3; };\npulse = { kind = \"lfm\"; duration = 4e-3; };\n"
                  "array = { receivers = 1; };\ntrack = { file = \"circle.csv\"; pri = 0.05; };\n"
                  "record = { first_sample = 150; samples = 250; };\n"
                  "targets = { points = ( { x = 0.7; r = -0.9; }, { x = -1.2; r = 0.4; amplitude = 0.5; } ); };\n"
                  "image = { x = { first = -2; step = 0.02; count = 200; }; r = { first = -2; step = 0.02; count = "
                  "200; }; };\n");
    struct scene scene = recorded(path_of("scene.cfg"));
    every_way_is_told(&scene, "circle");
}

static void noise_is_not_told(void **state)
{
    (void)state;
    static const char *const names[] = {"study/quick", "gate/field", "gate/squint"};
    for (int n = 0; n < 60; n++) {
        struct scene scene = recorded(names[n % 3]);
        struct acquisition *a = &scene.acquisition;
        struct random random = random_seed((uint64_t)n, 8);
        if (n < 20)
            a->pings = 1 + n % 4;
        if (n % 5 == 0)
            a->tx_length = 0;
        for (int k = 0; k < a->pings * a->receivers * a->samples; k++)
            scene.recorded[k] = random_normal(&random);
        assert_told(&scene, names[n % 3], NULL);
        memset(scene.recorded, 0, (size_t)(a->pings * a->receivers * a->samples) * sizeof *scene.recorded);
        assert_told(&scene, "silence", NULL);
        scene_free(&scene);
    }
}

/* One ping that stops and hops before a short array, and its image beside the target: where its mirror image is. */
static void mirror_images_are_not_told(void **state)
{
    (void)state;
    for (int n = 0; n < 24; n++) {
        char text[1000];
        const double x = n % 6 - 2.5;
        snprintf(text, sizeof text,
                 "sonar = { fc = 60e3; bandwidth = 10e3; fs = 20e3; };\npulse = { kind = \"flat\"; };\n"
                 "array = { receivers = %d; first_offset = %g; pitch = 0.012; };\n"
                 "track = { speed = 0.0; spacing = 0.4; pri = 0.1; pings = 1; };\n"
                 "record = { first_sample = 200; samples = 500; };\n"
                 "targets = { points = ( { x = %g; r = 12; } ); };\n"
                 "image = { x = { first = %g; step = 0.05; count = 60; }; r = { first = 10; step = 0.05; count = 80; "
                 "}; };\n",
                 n % 4 < 2 ? 64 : 24, n % 4 < 2 ? -0.378 : 0.1, x, n < 12 ? 0.0 : -3.0);
        support_write("scene.cfg", text);
        struct scene scene = recorded(path_of("scene.cfg"));
        assert_told(&scene, "one ping", NULL);
        scene_free(&scene);
    }
}

/* Images beside the targets, with a part of them, without any. */
static void moved_images_are_not_told(void **state)
{
    (void)state;
    static const char *const names[] = {"study/quick", "gate/points", "gate/squint", "study/point", "pf05/nine"};
    struct random random = random_seed(7, 9);
    for (int n = 0; n < 100; n++) {
        struct scene scene = recorded(names[n % 5]);
        struct grid *g = &scene.patches[0];
        g->x_first += (4 * random_uniform(&random) - 2) * g->x_count * g->x_step;
        g->r_first += (random_uniform(&random) - 0.5) * g->r_count * g->r_step;
        g->x_count = 1 + (int)(random_uniform(&random) * g->x_count);
        g->r_count = 1 + (int)(random_uniform(&random) * g->r_count);
        assert_told(&scene, names[n % 5], NULL);
        scene_free(&scene);
    }
}

/* Ultrasound of pins in water, and a radar from above (docs/echo_files.md says where tests look for them). */
static void recordings_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *name, *grid;
    } files[] = {{"pins_in_water.mat", "-0.01554:0.00014:222,0.029624:9.2e-05:281"},
                 {"gotcha_4deg.mat", "-25.28:0.16:317,-25.28:0.16:317"}};
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        struct scene scene;
        struct grid grid;
        char path[1000];
        if (!support_recording(files[k].name, path, sizeof path))
            skip();
        assert_int_equal(grid_parse(files[k].grid, &grid), STATUS_OK);
        if (scene_from_echoes(path, &grid, "grid", true, &scene) != STATUS_OK)
            fail_msg("%s: %s", path, status_message());
        every_way_is_told(&scene, files[k].name);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shipped_scenes_are_told),
        cmocka_unit_test(recordings_are_told),
        cmocka_unit_test_setup_teardown(circles_are_told, folder_make, folder_remove),
        cmocka_unit_test(noise_is_not_told),
        cmocka_unit_test_setup_teardown(mirror_images_are_not_told, folder_make, folder_remove),
        cmocka_unit_test(moved_images_are_not_told),
    };
    return cmocka_run_group_tests_name("conjugated", tests, NULL, NULL);
}
