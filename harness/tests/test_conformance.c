/* Every registered algorithm through every promise of algorithm.h, on ordinary and extreme scenes. An algorithm may refuse
   a scene as unsupported, with a reason; what it accepts must hold. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../metrics.h"
#include "../simulate.h"
#include "support.h"

/* ---- allocations by our own objects: the linker sends their calls here (-Wl,--wrap) ---- */
static bool counting;
static int allocations;

#define WRAPPED(type, name, parameters, arguments) \
    type __real_##name parameters; \
    type __wrap_##name parameters; \
    type __wrap_##name parameters \
    { \
        if (counting) \
            allocations++; \
        return __real_##name arguments; \
    }
WRAPPED(void *, malloc, (size_t size), (size))
WRAPPED(void *, calloc, (size_t count, size_t size), (count, size))
WRAPPED(void *, realloc, (void *block, size_t size), (block, size))
WRAPPED(void *, aligned_alloc, (size_t alignment, size_t size), (alignment, size))
WRAPPED(int, posix_memalign, (void **block, size_t alignment, size_t size), (block, alignment, size))
WRAPPED(char *, strdup, (const char *text), (text))
WRAPPED(void *, fftw_malloc, (size_t size), (size))
WRAPPED(void *, fftwf_malloc, (size_t size), (size))

/* ---- scenes ---- */
struct setting {
    const char *name;
    int pings, receivers;
    double first_offset, speed, fs, r, r_first;     /* target and first image row, m */
    bool raw, empty;
    double bound;       /* of the relative error: nearest neighbour's; at fs = B every short kernel loses much of the band */
};

static const struct setting settings[] = {
    {"ordinary", 8, 6, 0.04, 2.5, 30e3, 30, 29.75, false, false, 0.15},
    {"raw", 8, 6, 0.04, 2.5, 30e3, 30, 29.75, true, false, 0.15},
    {"empty", 8, 6, 0.04, 2.5, 30e3, 30, 29.75, true, true, 0},
    {"one ping", 1, 6, 0.04, 2.5, 30e3, 30, 29.75, true, false, 0.15},
    {"one receiver", 24, 1, 0.04, 2.5, 30e3, 30, 29.75, true, false, 0.15},
    {"one pair", 1, 1, 0, 2.5, 30e3, 30, 29.75, false, false, 0.15},
    {"negative offsets", 8, 6, -0.24, 2.5, 30e3, 30, 29.75, true, false, 0.15},
    {"v/c = 0.05", 8, 6, 0.04, 75, 30e3, 30, 29.75, true, false, 0.15},
    {"stop and hop", 8, 6, 0.04, 0, 30e3, 30, 29.75, true, false, 0.15},
    {"pixels on the track", 8, 6, 0.04, 2.5, 30e3, 0.5, 0, false, false, 0.3},
    {"fs = B", 8, 6, 0.04, 2.5, 15e3, 30, 29.75, false, false, 0.7},
};
enum { SETTINGS = sizeof settings / sizeof *settings };

static void make_scene(const struct setting *setting, struct scene *scene, struct grid *grid)
{
    double spacing = 0.02 * (setting->receivers > 1 ? setting->receivers : 2), duration = 2e-3;
    int samples = setting->fs > 20e3 ? 1024 : 512;
    double first = floor(fmax(0, 2 * setting->r / 1500 * setting->fs - samples / 4));
    *scene = (struct scene){
        .pulse_kind = setting->raw ? PULSE_LFM : PULSE_FLAT, .pulse_duration = duration,
        .beam = {setting->r < 1 ? BEAM_RECT : BEAM_TXRX, TRUNCATION_NONE, 0, false}, .patch_count = 1, .patches = grid};
    struct acquisition *a = &scene->acquisition;
    *a = (struct acquisition){
        .sound_speed = 1500, .fc = 150e3, .fs = setting->fs, .bandwidth = 15e3, .samples = samples,
        .receivers = setting->receivers, .pings = setting->pings, .tx_length = 0.08, .rx_length = 0.04,
        .aperture_limit = INFINITY, .compressed = !setting->raw,
        .pulse_length = setting->raw ? pulse_length_lfm(duration, setting->fs) : 0};
    assert_int_equal(acquisition_allocate(a), STATUS_OK);
    for (int p = 0; p < a->pings; p++) {
        a->t0[p] = first / a->fs;
        a->tx[p].x = (p - (a->pings - 1) / 2.0) * spacing;
        a->velocity[p].x = setting->speed;
        for (int m = 0; m < a->receivers; m++)
            a->rx[p * a->receivers + m].x = a->tx[p].x + setting->first_offset + 0.04 * m;
    }
    if (setting->raw)
        pulse_lfm(a->bandwidth, duration, a->fs, a->pulse_length, a->pulse);
    *grid = (struct grid){-0.24, 0.02, 25, setting->r_first, 0.025, 21};
    scene->target_count = scene->point_count = !setting->empty;
    scene->targets = calloc(1, sizeof *scene->targets);
    scene->targets[0] = (struct target){0.011, setting->r, 1};
    assert_int_equal(acquisition_check(a, setting->name), STATUS_OK);
}

static void free_scene(struct scene *scene)
{
    free(scene->targets);
    acquisition_free(&scene->acquisition);
}

static const struct algorithm *current;     /* what the tests run through */

static struct problem problem_of(const struct scene *scene)
{
    return (struct problem){&scene->acquisition, 1, scene->patches, PRECISION_DOUBLE};
}

/* The current algorithm with its defaults; false when it refuses the scene. */
static bool form(const char *precision, const struct problem *problem, const struct echoes *echoes, struct image *image)
{
    char spec[80];
    snprintf(spec, sizeof spec, "%s:precision=%s", current->name, precision);
    enum status status = support_image(spec, *problem, echoes, image);
    if (status == STATUS_OK)
        return true;
    assert_int_equal(status, STATUS_UNSUPPORTED);
    assert_true(strlen(status_message()) > 10);
    return false;
}

static bool same_bits(const struct image *a, const struct image *b)
{
    size_t pixels = (size_t)a->patches[0].x_count * (size_t)a->patches[0].r_count;
    return memcmp(a->pixels[0], b->pixels[0], pixels * precision_size(a->precision)) == 0;
}

/* On every setting: finite, near the exact image, the same bits for 1 and 2 threads, float near double. */
static void all_settings(void **state)
{
    (void)state;
    int accepted = 0;
    for (int k = 0; k < SETTINGS; k++) {
        struct scene scene;
        struct grid grid;
        struct echoes echoes;
        struct image exact, image, single, again;
        make_scene(&settings[k], &scene, &grid);
        assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
        struct problem problem = problem_of(&scene);
        assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
        omp_set_num_threads(2);
        if (form("double", &problem, &echoes, &image)) {
            accepted++;
            omp_set_num_threads(1);
            assert_true(form("double", &problem, &echoes, &again));
            assert_true(form("float", &problem, &echoes, &single));
            assert_true(same_bits(&image, &again));
            image_free(&again);
            omp_set_num_threads(2);
            assert_true(form("float", &problem, &echoes, &again));
            assert_true(same_bits(&single, &again));
            double error = support_difference(&image, &exact), rounding = support_difference(&single, &image);
            if (settings[k].empty) {
                assert_true(support_peak(&image) == 0 && support_peak(&single) == 0);
                struct target target = {0, settings[k].r, 1};
                struct slice_metrics m = metrics_slice(&image, &scene.acquisition, &target, AXIS_AZIMUTH);
                assert_true(isnan(m.pslr_db[DEFINITION_NULL]) && isnan(m.width_m) && *m.reason);
            } else {
                double bound = current->traits & TRAIT_EXACT ? 1e-12 : settings[k].bound;
                print_message("%s, %s: error %.2e, float against double %.1e\n", current->name, settings[k].name, error,
                              rounding);
                assert_true(support_peak(&exact) > 0.5);     /* there is something to compare */
                assert_true(error <= bound);
                assert_true(rounding < 2e-6);
            }
            image_free(&again);
            image_free(&single);
            image_free(&image);
        }
        image_free(&exact);
        echoes_free(&echoes);
        free_scene(&scene);
    }
    assert_true(accepted > 0);
}

/* Image(2j a - 0.5 b) = 2j Image(a) - 0.5 Image(b). */
static void linearity(void **state)
{
    (void)state;
    struct scene scene;
    struct grid grid;
    struct echoes echoes[3];
    struct image image[3];
    make_scene(&settings[1], &scene, &grid);
    for (int k = 0; k < 3; k++) {
        scene.targets[0] = (struct target){0.1 * k - 0.08, 29.9 + 0.07 * k, 1};
        assert_int_equal(scene_simulate(&scene, &echoes[k]), STATUS_OK);
    }
    size_t count = (size_t)scene.acquisition.samples * (size_t)scene.acquisition.receivers * (size_t)scene.acquisition.pings;
    double complex *s[3];
    for (int k = 0; k < 3; k++)
        s[k] = (double complex *)echoes[k].samples;
    for (size_t n = 0; n < count; n++)
        s[2][n] = 2 * I * s[0][n] - 0.5 * s[1][n];
    struct problem problem = problem_of(&scene);
    bool accepted = true;
    for (int k = 0; k < 3; k++)
        accepted = form("double", &problem, &echoes[k], &image[k]) && accepted;
    assert_true(accepted);
    double worst = 0;
    for (int i = 0; i < grid.r_count; i++)
        for (int j = 0; j < grid.x_count; j++)
            worst = worse_of(worst, cabs(2 * I * image_pixel(&image[0], 0, i, j) - 0.5 * image_pixel(&image[1], 0, i, j)
                                     - image_pixel(&image[2], 0, i, j)));
    assert_true(worst < 1e-12 * support_peak(&image[2]));
    for (int k = 0; k < 3; k++) {
        image_free(&image[k]);
        echoes_free(&echoes[k]);
    }
    free_scene(&scene);
}

/* Echoes two pings later show the same image two ping spacings further on. */
static void translation(void **state)
{
    (void)state;
    enum { SHIFT = 2 };
    struct scene scene;
    struct grid grid, moved;
    struct echoes echoes;
    struct image image, after;
    make_scene(&settings[1], &scene, &grid);
    const struct acquisition *a = &scene.acquisition;
    assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
    size_t ping = (size_t)a->samples * (size_t)a->receivers;
    double complex *s = (double complex *)echoes.samples;
    memset(s + (size_t)(a->pings - SHIFT) * ping, 0, SHIFT * ping * sizeof *s);
    struct problem problem = problem_of(&scene);
    assert_true(form("double", &problem, &echoes, &image));
    memmove(s + SHIFT * ping, s, (size_t)(a->pings - SHIFT) * ping * sizeof *s);
    memset(s, 0, SHIFT * ping * sizeof *s);
    moved = grid;
    moved.x_first += SHIFT * (a->tx[1].x - a->tx[0].x);
    problem.patches = &moved;
    assert_true(form("double", &problem, &echoes, &after));
    assert_true(support_difference(&after, &image) < 1e-9);
    image_free(&image);
    image_free(&after);
    echoes_free(&echoes);
    free_scene(&scene);
}

/* A plan runs any number of times with the same bits and allocates nothing of ours; it writes every pixel. */
static void repeated_execution(void **state)
{
    (void)state;
    for (int p = 0; p < 2; p++) {
        enum precision precision = p ? PRECISION_DOUBLE : PRECISION_FLOAT;
        struct scene scene;
        struct grid grid;
        struct echoes echoes, converted;
        struct image first, second;
        struct spec spec;
        struct stages stages;
        void *plan;
        make_scene(&settings[1], &scene, &grid);
        assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
        assert_int_equal(echoes_convert(&echoes, precision, &converted), STATUS_OK);
        assert_int_equal(image_allocate(1, &grid, precision, &first), STATUS_OK);
        assert_int_equal(image_allocate(1, &grid, precision, &second), STATUS_OK);
        memset(second.pixels[0], 0x5a, (size_t)grid.x_count * (size_t)grid.r_count * precision_size(precision));
        assert_int_equal(spec_parse(current->name, &spec), STATUS_OK);
        struct problem problem = problem_of(&scene);
        problem.precision = precision;
        assert_int_equal(current->plan(&problem, spec.options, &plan), STATUS_OK);
        struct work work = current->work(plan);
        assert_true(work.flops > 0 && work.bytes > 0 && isfinite(work.flops) && *work.engine);
        stages_begin(&stages);
        counting = true;
        allocations = 0;
        assert_int_equal(current->execute(plan, &converted, &first, &stages), STATUS_OK);
        stages_begin(&stages);
        assert_int_equal(current->execute(plan, &converted, &second, &stages), STATUS_OK);
        counting = false;
        assert_int_equal(allocations, 0);
        assert_true(stages.count > 0);
        assert_true(same_bits(&first, &second));
        current->destroy(plan);
        current->destroy(NULL);
        spec_free(&spec);
        image_free(&first);
        image_free(&second);
        echoes_free(&converted);
        echoes_free(&echoes);
        free_scene(&scene);
    }
}

/* The counter above does see an allocation. */
static void counter_counts(void **state)
{
    (void)state;
    counting = true;
    allocations = 0;
    free(malloc(1));
    struct image image;
    struct grid grid = {0, 1, 1, 1, 1, 1};
    assert_int_equal(image_allocate(1, &grid, PRECISION_FLOAT, &image), STATUS_OK);
    counting = false;
    image_free(&image);
    assert_true(allocations >= 2);
}

/* Tables say of themselves what is true. */
static void description(void **state)
{
    (void)state;
    assert_ptr_equal(algorithm_find(current->name), current);
    assert_true(strlen(current->summary) > 5 && strlen(current->reference) > 3);
    for (const struct param *p = current->params; p && p->name; p++) {
        assert_true(p->initial >= p->min && p->initial <= p->max && *p->summary);
        assert_true(p->offset < current->options_size);
        char sweep[128], *rest = sweep;
        snprintf(sweep, sizeof sweep, "%s", p->sweep ? p->sweep : "");
        for (char *value; (value = strtok_r(rest, " ", &rest));) {
            char text[256];
            struct spec spec;
            snprintf(text, sizeof text, "%s:%s=%s", current->name, p->name, value);
            assert_int_equal(spec_parse(text, &spec), STATUS_OK);
            spec_free(&spec);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(description),   cmocka_unit_test(all_settings),       cmocka_unit_test(linearity),
        cmocka_unit_test(translation),   cmocka_unit_test(repeated_execution), cmocka_unit_test(counter_counts),
    };
    int failed = 0;
    for (int k = 0; algorithms[k]; k++) {
        current = algorithms[k];
        print_message("--- %s\n", current->name);
        failed += cmocka_run_group_tests_name(current->name, tests, NULL, NULL);
    }
    return failed;
}
