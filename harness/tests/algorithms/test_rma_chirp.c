/* Range migration by chirp transforms. Rows that are summed one by one prove the transforms: the same rows in patches
   of three are the same image within a quarter of `limit`, the bound at the worst pixel. Against the exact image it is
   as good as rma_delay. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support.h"

static const double rounding[] = {4e-6, 1e-10};

/* An image's patches as parts of at most three rows, which share the swath. */
static int parts_of(const struct grid *patches, int count, struct grid *parts)
{
    int made = 0;
    for (int k = 0; k < count; k++)
        for (int i = 0; i < patches[k].r_count; i += 3) {
            parts[made] = patches[k];
            parts[made].r_first = patches[k].r_first + i * patches[k].r_step;
            parts[made++].r_count = patches[k].r_count - i < 3 ? patches[k].r_count - i : 3;
        }
    return made;
}

/* |a - b|_2 / |b|_2, b in parts. */
static double parts_difference(const struct image *a, const struct image *b)
{
    double off = 0, all = 0;
    int part = 0;
    for (int k = 0; k < a->patch_count; k++)
        for (int i = 0; i < a->patches[k].r_count; i += 3, part++)
            for (int n = 0; n < b->patches[part].r_count * a->patches[k].x_count; n++) {
                const int at = i * a->patches[k].x_count + n;
                const double complex x = a->precision == PRECISION_DOUBLE ? ((double complex *)a->pixels[k])[at]
                                                                          : ((float complex *)a->pixels[k])[at];
                const double complex y = b->precision == PRECISION_DOUBLE ? ((double complex *)b->pixels[part])[n]
                                                                          : ((float complex *)b->pixels[part])[n];
                off += pow(cabs(x - y), 2);
                all += pow(cabs(y), 2);
            }
    return sqrt(off / all);
}

/* False where rma_delay refuses the scene, as rma_chirp then does. */
static bool compare(const char *name, const struct scene *scene)
{
    static const double limits[] = {1e-2, 1e-9};
    const struct problem problem = scene_problem(scene, PRECISION_DOUBLE);
    struct echoes echoes;
    struct image exact, plain, image;
    support_echoes(scene, &echoes);
    if (support_image("rma_delay", problem, &echoes, &plain) != STATUS_OK) {
        assert_int_equal(support_image("rma_chirp", problem, &echoes, &image), STATUS_UNSUPPORTED);
        echoes_free(&echoes);
        return false;
    }
    assert_int_equal(support_image("reference", problem, &echoes, &exact), STATUS_OK);
    const double error = support_difference(&plain, &exact);
    image_free(&plain);
    int rows = 0;
    for (int k = 0; k < problem.patch_count; k++)
        rows += problem.patches[k].r_count;
    struct grid *grids = malloc((size_t)rows * sizeof *grids);
    struct problem parts = problem;
    assert_non_null(grids);
    parts.patches = grids;
    parts.patch_count = parts_of(problem.patches, problem.patch_count, grids);
    for (int k = 0; k < 4; k++) {
        char spec[80];
        snprintf(spec, sizeof spec, "rma_chirp:limit=%g,precision=%s", limits[k / 2], k % 2 ? "double" : "float");
        assert_int_equal(support_image(spec, problem, &echoes, &image), STATUS_OK);
        assert_int_equal(support_image(spec, parts, &echoes, &plain), STATUS_OK);
        const double difference = parts_difference(&image, &plain), own = support_difference(&image, &exact);
        print_message("    %-18s %-39s %.1e from sums, error %.2e; rma_delay %.2e\n", name, spec, difference, own,
                      error);
        assert_up_to(difference, limits[k / 2] / 4 + rounding[k % 2], "%s on %s, from sums of its rows", spec, name);
        assert_up_to(own, 1.03 * error + limits[k / 2] / 4 + 1e-4, "error of %s on %s", spec, name);
        image_free(&image);
        image_free(&plain);
    }
    image_free(&exact);
    echoes_free(&echoes);
    free(grids);
    return true;
}

static void random_scenes(void **state)
{
    (void)state;
    int compared = 0;
    for (int seed = 1; seed <= 30; seed++) {
        struct scene scene;
        char name[40];
        support_random_scene(seed, &scene);
        snprintf(name, sizeof name, "random scene %d", seed);
        compared += compare(name, &scene);
        scene_free(&scene);
    }
    print_message("    %d scenes compared\n", compared);
    assert_true(compared >= 10);
}

/* A wide beam over 20 m takes many terms, and at 1e-9 several pieces. */
static void deep_and_wide(void **state)
{
    (void)state;
    struct scene scene;
    support_write(
        "deep.cfg",
        "sonar = { fc = 150e3; bandwidth = 30e3; fs = 40e3; };\n"
        "pulse = { kind = \"lfm\"; duration = 1e-3; };\n"
        "array = { tx_length = 0.03; rx_length = 0.03; receivers = 2; first_offset = 0.01; pitch = 0.01; };\n"
        "track = { speed = 0.0; pri = 0.1; spacing = 0.01; pings = 700; x_first = -3.5; };\n"
        "record = { first_sample = 520; samples = 1400; };\n"
        "beam = { kind = \"txrx\"; truncation = \"sine\"; limit = 0.28; };\n"
        "targets = { points = ( { x = 0.0; r = 12.0; }, { x = 0.1; r = 21.0; }, { x = -0.2; r = 30.0; } ); };\n"
        "image = { x = { first = -0.3; step = 0.025; count = 24; }; r = { first = 11.0; step = 0.05; count = "
        "401; }; };\n");
    support_scene(path_of("deep.cfg"), &scene);
    assert_true(compare("deep and wide", &scene));
    scene_free(&scene);
}

/* More rows than bins: the chirp is read to its last value. */
static void fine_rows(void **state)
{
    (void)state;
    struct scene scene;
    support_write("fine.cfg", "base = {\n@include \"study/quick.cfg\"\n};\n"
                              "image = { x = { first = -0.1; step = 0.05; count = 5; };\n"
                              "          r = { first = 19.85; step = 5e-4; count = 600; }; };\n");
    support_scene(path_of("fine.cfg"), &scene);
    assert_true(compare("fine rows", &scene));
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(random_scenes), cmocka_unit_test(deep_and_wide),
                                       cmocka_unit_test(fine_rows)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
