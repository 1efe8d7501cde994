#include "tests/algorithms/conformance.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/pairs/pairs.h"
#include "gate/baseline.h"
#include "files/csv.h"
#include "metrics/metrics.h"
#include "scene/simulate.h"
#include "tests/algorithms/conformance_params.h"
#include "tests/algorithms/conformance_scenes.h"
#include "tests/allocations.h"

static struct problem problem_of(const struct scene *scene, enum precision precision)
{
    return problem_make(&scene->acquisition, 1, scene->patches, precision);
}

/* ---- the algorithm ---- */
static const struct algorithm *current; /* what the tests run through */
static const struct setting
    *usual; /* a scene that it must image: raw echoes, of a monostatic sonar where it needs one */

#define REFUSE(setting, format, ...) fail_msg("%s, %s: " format, current->name, setting, __VA_ARGS__)

static void at_most(const char *setting, const char *what, double value, double bound)
{
    if (!(value <= bound))
        REFUSE(setting, "%s is %.3g, must be at most %.3g", what, value, bound);
}

/* Its defaults. */
static void make_spec(enum precision precision, struct spec *spec)
{
    char text[80];
    snprintf(text, sizeof text, "%s:precision=%s", current->name, precision_name(precision));
    if (spec_parse(text, spec) != STATUS_OK)
        fail_msg("%s: %s", current->name, status_message());
}

/* A plan by the current algorithm's defaults; false when it refuses the scene. */
static bool make_plan(const struct setting *setting, const struct problem *problem, void **plan)
{
    struct spec spec;
    int unset;
    make_spec(problem->precision, &spec);
    *plan = &unset;
    enum status status = algorithm_plan(current, problem, spec.options, plan);
    spec_free(&spec);
    if (status == STATUS_OK)
        return true;
    if (status != STATUS_UNSUPPORTED || strlen(status_message()) <= 10)
        REFUSE(setting->name, "plan returns status %d, \"%s\", must be 0, or %d with a reason", status,
               status_message(), STATUS_UNSUPPORTED);
    if (*plan)
        REFUSE(setting->name, "%s", "plan refuses and leaves *plan set, must be NULL");
    if (setting->promise & current->traits)
        REFUSE(setting->name, "refused, \"%s\", in spite of its trait", status_message());
    return false;
}

/* Work that a plan may claim. */
static void check_work(const char *setting, const struct problem *problem, const void *plan)
{
    struct work work = current->work(plan);
    double pairs = pairs_count(problem);
    if (work.pairs != 0 && work.pairs != pairs)
        REFUSE(setting, "work.pairs is %.9g, must be 0 or what pairs_count counts, %.9g", work.pairs, pairs);
    if (!(work.flops > 0) || !isfinite(work.flops) || !(work.flops >= 8 * work.pairs))
        REFUSE(setting, "work.flops is %.3g, must be above 0 and at least 8 a pair, %.3g", work.flops, 8 * work.pairs);
    /* Not twice the work of summing every sample for each pair and transforming each record: ours claim .001 to .8 of
       that. */
    const struct acquisition *a = problem->acquisition;
    const double samples = a->samples + a->pulse_length, records = (double)a->pings * a->receivers;
    const double most = 2 * (pairs * 8 * samples + records * 5 * samples * log2(samples));
    if (!(work.flops <= most))
        REFUSE(setting, "work.flops is %.3g, must be at most %.3g", work.flops, most);
    if (!*work.engine)
        REFUSE(setting, "%s", "work.engine is empty, must name the way that was chosen");
}

static void run_plan(const char *setting, void *plan, const struct echoes *echoes, struct image *image)
{
    struct stages stages;
    stages_begin(&stages);
    enum status status = current->execute(plan, echoes, image, &stages);
    if (status != STATUS_OK)
        REFUSE(setting, "execute returns status %d, \"%s\"", status, status_message());
    if (stages.count == 0)
        REFUSE(setting, "%s", "execute names no stage, must call stages_end");
}

static void allocate_image(const struct problem *problem, struct image *image)
{
    assert_int_equal(image_allocate(1, problem->patches, problem->precision, image), STATUS_OK);
    size_t pixels = (size_t)problem->patches->x_count * (size_t)problem->patches->r_count;
    memset(image->pixels[0], 0x5a, pixels * precision_size(problem->precision)); /* every pixel must be written */
}

/* The image by the current algorithm's defaults; false when it refuses the scene. Echoes are in double. */
static bool form(const struct setting *setting, struct problem problem, enum precision precision, int threads,
                 const struct echoes *echoes, struct image *image)
{
    struct echoes converted;
    void *plan;
    problem.precision = precision;
    omp_set_num_threads(threads);
    if (!make_plan(setting, &problem, &plan))
        return false;
    check_work(setting->name, &problem, plan);
    assert_int_equal(echoes_convert(echoes, precision, &converted), STATUS_OK);
    allocate_image(&problem, image);
    run_plan(setting->name, plan, &converted, image);
    current->destroy(plan);
    echoes_free(&converted);
    return true;
}

static bool same_bits(const struct image *a, const struct image *b)
{
    size_t pixels = (size_t)a->patches[0].x_count * (size_t)a->patches[0].r_count;
    return memcmp(a->pixels[0], b->pixels[0], pixels * precision_size(a->precision)) == 0;
}

/* ---- checks ---- */

static void check_images(const struct setting *setting, const struct scene *scene, const struct image *exact,
                         const struct image *image, const struct image *single)
{
    if (!setting->empty) {
        double error = support_difference(image, exact), rounding = support_difference(single, image);
        print_message("%s, %s: error %.2e, float against double %.1e\n", current->name, setting->name, error, rounding);
        assert_true(support_peak(exact) > 0.5); /* there is something to compare */
        at_most(setting->name, "the error against reference", error,
                current->traits & TRAIT_EXACT ? 1e-8 : setting->bound);
        at_most(setting->name, "the difference of float from double", rounding, 2e-6);
        return;
    }
    at_most(setting->name, "the peak of the image of zeros", worse_of(support_peak(image), support_peak(single)), 0);
    struct target target = {0, setting->r, 1};
    struct slice_metrics m = metrics_slice(image, &scene->acquisition, &target, AXIS_AZIMUTH);
    assert_true(isnan(m.pslr_db[DEFINITION_NULL]) && isnan(m.width_m) && *m.reason);
}

/* On every setting: near the exact image, float near double, the same bits for 1 and 2 threads, work as it is. */
static void all_settings(void **state)
{
    (void)state;
    int accepted = 0;
    for (int k = 0; k < SETTINGS; k++) {
        const struct setting *setting = &settings[k];
        struct scene scene;
        struct grid grid;
        struct echoes echoes;
        struct image exact, images[2], again;
        make_scene(setting, &scene, &grid);
        assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
        struct problem problem = problem_of(&scene, PRECISION_DOUBLE);
        assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
        if (form(setting, problem, PRECISION_DOUBLE, 2, &echoes, &images[PRECISION_DOUBLE])) {
            accepted++;
            if (!form(setting, problem, PRECISION_FLOAT, 2, &echoes, &images[PRECISION_FLOAT]))
                REFUSE(setting->name, "refused in float, \"%s\", not in double", status_message());
            for (int precision = 0; precision < 2; precision++) {
                assert_true(form(setting, problem, (enum precision)precision, 1, &echoes, &again));
                if (!same_bits(&again, &images[precision]))
                    REFUSE(setting->name, "other bits on 1 thread than on 2, in %s",
                           precision_name((enum precision)precision));
                image_free(&again);
            }
            check_images(setting, &scene, &exact, &images[PRECISION_DOUBLE], &images[PRECISION_FLOAT]);
            image_free(&images[0]);
            image_free(&images[1]);
        }
        image_free(&exact);
        echoes_free(&echoes);
        free_scene(&scene);
    }
    if (accepted == 0)
        fail_msg("%s: refuses every scene", current->name);
}

/* Image(2j a - 0.5 b) = 2j Image(a) - 0.5 Image(b). */
static void linearity(void **state)
{
    (void)state;
    struct scene scene;
    struct grid grid;
    struct echoes echoes[3];
    struct image image[3];
    make_scene(usual, &scene, &grid);
    for (int k = 0; k < 3; k++) {
        scene.targets[0] = (struct target){0.1 * k - 0.08, 29.9 + 0.07 * k, 1};
        assert_int_equal(scene_simulate(&scene, &echoes[k]), STATUS_OK);
    }
    size_t count =
        (size_t)scene.acquisition.samples * (size_t)scene.acquisition.receivers * (size_t)scene.acquisition.pings;
    double complex *s[3];
    for (int k = 0; k < 3; k++)
        s[k] = (double complex *)echoes[k].samples;
    for (size_t n = 0; n < count; n++)
        s[2][n] = 2 * I * s[0][n] - 0.5 * s[1][n];
    struct problem problem = problem_of(&scene, PRECISION_DOUBLE);
    for (int k = 0; k < 3; k++)
        if (!form(usual, problem, PRECISION_DOUBLE, 2, &echoes[k], &image[k]))
            fail_msg("%s: refuses an ordinary scene, \"%s\"", current->name, status_message());
    double worst = 0;
    for (int i = 0; i < grid.r_count; i++)
        for (int j = 0; j < grid.x_count; j++)
            worst = worse_of(worst, cabs(2 * I * image_pixel(&image[0], 0, i, j) - 0.5 * image_pixel(&image[1], 0, i, j)
                                         - image_pixel(&image[2], 0, i, j)));
    at_most("sum of two echoes", "the difference from the sum of two images over the peak",
            worst / support_peak(&image[2]), 1e-12);
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
    make_scene(usual, &scene, &grid);
    const struct acquisition *a = &scene.acquisition;
    assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
    size_t ping = (size_t)a->samples * (size_t)a->receivers;
    double complex *s = (double complex *)echoes.samples;
    memset(s + (size_t)(a->pings - SHIFT) * ping, 0, SHIFT * ping * sizeof *s);
    struct problem problem = problem_of(&scene, PRECISION_DOUBLE);
    assert_true(form(usual, problem, PRECISION_DOUBLE, 2, &echoes, &image));
    memmove(s + SHIFT * ping, s, (size_t)(a->pings - SHIFT) * ping * sizeof *s);
    memset(s, 0, SHIFT * ping * sizeof *s);
    moved = grid;
    moved.x_first += SHIFT * (a->tx[1].x - a->tx[0].x);
    problem.patches = &moved;
    assert_true(form(usual, problem, PRECISION_DOUBLE, 2, &echoes, &after));
    at_most("echoes two pings later", "the difference of the shifted image", support_difference(&after, &image), 1e-9);
    image_free(&image);
    image_free(&after);
    echoes_free(&echoes);
    free_scene(&scene);
}

/* What a plan holds, in one precision: as many bytes as work.bytes says (with one thread), nothing taken or planned by
   execute, nothing left by destroy. */
static void check_memory(const struct scene *scene, const struct echoes *echoes, enum precision precision)
{
    const char *setting = precision == PRECISION_DOUBLE ? "raw, double" : "raw, float";
    struct problem problem = problem_of(scene, precision);
    struct echoes converted;
    struct image first, second;
    void *plan;
    assert_int_equal(echoes_convert(echoes, precision, &converted), STATUS_OK);
    allocate_image(&problem, &first);
    allocate_image(&problem, &second);
    omp_set_num_threads(1);
    allocations_begin(-1);
    assert_true(make_plan(usual, &problem, &plan));
    struct allocations planned = allocations_now();
    double bytes = current->work(plan).bytes;
    run_plan(setting, plan, &converted, &first);
    run_plan(setting, plan, &converted, &second);
    struct allocations executed = allocations_now();
    current->destroy(plan);
    current->destroy(NULL);
    struct allocations left = allocations_end();
    if (!(fabs(bytes / planned.bytes - 1) <= 0.01))
        REFUSE(setting, "work.bytes is %.0f, must be what the plan holds on one thread, %.0f, to 1 %%", bytes,
               planned.bytes);
    if (executed.taken != planned.taken || executed.freed != planned.freed)
        REFUSE(setting, "execute allocates %d and frees %d blocks, must be none", executed.taken - planned.taken,
               executed.freed - planned.freed);
    if (executed.plans != planned.plans)
        REFUSE(setting, "execute makes %d FFT plans, must be none", executed.plans - planned.plans);
    if (left.blocks != 0 || left.plans != left.plans_destroyed)
        REFUSE(setting, "destroy leaves %d blocks of %.0f bytes and %d FFT plans, must be none", left.blocks,
               left.bytes, left.plans - left.plans_destroyed);
    if (!same_bits(&first, &second))
        REFUSE(setting, "%s", "other bits by the second execute of a plan");
    image_free(&first);
    image_free(&second);
    echoes_free(&converted);
}

/* Whichever allocation fails: plan says so and leaves nothing, or does without. Of many allocations some 50 are tried,
   evenly, half of them in each precision. */
static void check_refused_memory(const struct scene *scene, enum precision precision)
{
    enum { TRIED = 25 };
    struct problem problem = problem_of(scene, precision);
    struct spec spec;
    make_spec(precision, &spec);
    omp_set_num_threads(1);
    void *whole = NULL;
    allocations_begin(-1);
    if (algorithm_plan(current, &problem, spec.options, &whole) == STATUS_OK)
        current->destroy(whole);
    const int count = allocations_end().taken;
    const int step = 1 + count / TRIED;
    for (int call = precision == PRECISION_DOUBLE ? step / 2 : 0; call < count; call += step) {
        void *plan = NULL;
        allocations_begin(call);
        enum status status = algorithm_plan(current, &problem, spec.options, &plan);
        if (status == STATUS_OK)
            current->destroy(plan);
        struct allocations left = allocations_end();
        const bool refused = left.refused > 0;
        if (status != STATUS_OK && (!refused || status != STATUS_FAILED || plan || strlen(status_message()) <= 10))
            REFUSE("raw",
                   "without the memory of allocation %d plan returns status %d, \"%s\", must be %d with a reason", call,
                   status, status_message(), STATUS_FAILED);
        if (status == STATUS_OK && refused)
            REFUSE("raw", "plan goes on without the memory of allocation %d, must say so", call);
        if (left.blocks != 0 || left.plans != left.plans_destroyed)
            REFUSE("raw", "without the memory of allocation %d plan leaves %d blocks and %d FFT plans, must be none",
                   call, left.blocks, left.plans - left.plans_destroyed);
    }
    spec_free(&spec);
}

static void memory(void **state)
{
    (void)state;
    struct scene scene;
    struct grid grid;
    struct echoes echoes;
    make_scene(usual, &scene, &grid);
    assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
    for (int precision = 0; precision < 2; precision++) {
        check_memory(&scene, &echoes, (enum precision)precision);
        check_refused_memory(&scene, (enum precision)precision);
    }
    echoes_free(&echoes);
    free_scene(&scene);
}

/* The same bits for any number of threads, also fewer than planned for, however often a plan is executed and however
   loops are scheduled. */
static void schedules(void **state)
{
    (void)state;
    static const int threads[] = {1, 2, 3, 5};
    static const omp_sched_t kinds[] = {omp_sched_static, omp_sched_dynamic, omp_sched_guided};
    enum { COUNTS = sizeof threads / sizeof *threads, REPEATS = 12 };
    struct scene scene;
    struct grid grid;
    struct echoes echoes;
    make_scene(usual, &scene, &grid);
    assert_int_equal(scene_simulate(&scene, &echoes), STATUS_OK);
    for (int precision = 0; precision < 2; precision++) {
        struct problem problem = problem_of(&scene, (enum precision)precision);
        struct echoes converted;
        struct image first, again;
        assert_int_equal(echoes_convert(&echoes, problem.precision, &converted), STATUS_OK);
        for (int k = 0; k < COUNTS; k++) {
            void *plan;
            omp_set_num_threads(threads[k]);
            assert_true(make_plan(usual, &problem, &plan));
            for (int n = 0; n < REPEATS; n++) {
                allocate_image(&problem, &again);
                omp_set_num_threads(n < REPEATS - 1 || k == 0 ? threads[k] : threads[k - 1]);
                omp_set_schedule(kinds[n % 3], 1);
                run_plan(usual->name, plan, &converted, &again);
                if (k + n == 0)
                    first = again;
                else if (!same_bits(&first, &again))
                    REFUSE(usual->name, "other bits by execute number %d on %d threads than on one, in %s", n + 1,
                           omp_get_max_threads(), precision_name(problem.precision));
                if (k + n > 0)
                    image_free(&again);
            }
            current->destroy(plan);
        }
        image_free(&first);
        echoes_free(&converted);
    }
    omp_set_schedule(omp_sched_static, 0);
    echoes_free(&echoes);
    free_scene(&scene);
}

static void description(void **state)
{
    (void)state;
    if (algorithm_find(current->name) != current)
        fail_msg("%s: this name does not find it", current->name);
    if (strlen(current->summary) <= 5 || strlen(current->reference) <= 3)
        fail_msg("%s: summary and reference are \"%s\" and \"%s\", must say something", current->name, current->summary,
                 current->reference);
    for (const struct param *p = current->params; p && p->name; p++)
        conformance_check_param(current, p);
}

/* Its quality and work are on record, so that the gate can tell when they get worse. */
static void baseline_rows(void **state)
{
    (void)state;
    struct csv csv;
    int rows = 0;
    if (csv_read(BASELINE_PATH, CSV_TAIL_KEEP, &csv) != STATUS_OK)
        fail_msg("%s", status_message());
    for (int row = 0; row < csv.row_count; row++)
        rows += strcmp(csv_cell(&csv, row, csv_column(&csv, "algorithm")), current->name) == 0;
    csv_free(&csv);
    if (rows == 0)
        fail_msg("%s: results/baseline.csv has no row of it; `./sasbench baseline` adds them: review and commit "
                 "them with the algorithm",
                 current->name);
}

/* Raw echoes of several receivers, unless that is refused. */
static const struct setting *setting_usual(void)
{
    struct scene scene;
    struct grid grid;
    void *plan;
    make_scene(&settings[RAW], &scene, &grid);
    struct problem problem = problem_of(&scene, PRECISION_DOUBLE);
    bool accepted = make_plan(&settings[RAW], &problem, &plan);
    if (accepted)
        current->destroy(plan);
    free_scene(&scene);
    return &settings[accepted ? RAW : MONOSTATIC];
}

int conformance_run(const struct algorithm *algorithm)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(description), cmocka_unit_test(baseline_rows), cmocka_unit_test(all_settings),
        cmocka_unit_test(linearity),   cmocka_unit_test(translation),   cmocka_unit_test(memory),
        cmocka_unit_test(schedules),
    };
    current = algorithm;
    usual = setting_usual();
    print_message("--- %s\n", current->name);
    return cmocka_run_group_tests_name(current->name, tests, NULL, NULL);
}
