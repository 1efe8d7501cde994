/* Sharpness of images, differences of slices, spread of times. */
#include <math.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>

#include "measure/metrics.h"
#include "measure/outcome.h"
#include "measure/timing.h"
#include "tests/support.h"

/* A tenth more of the exact image is -20 dB of its peak away everywhere that the slice has it. */
static void test_slice_difference(void **state)
{
    (void)state;
    const struct grid grid = {-1, 0.02, 101, 9.9, 0.025, 9, 0};
    const struct acquisition acquisition = {.sound_speed = 1500, .fc = 150e3, .bandwidth = 20e3};
    const struct target target = {0, 10, 1};
    const struct grid shorter = {-1, 0.02, 100, 9.9, 0.025, 9, 0};
    struct image image, exact, other;
    double *position, *decibels;
    int count;
    support_image_make(&grid, 1, PRECISION_DOUBLE, &image);
    support_image_make(&grid, 1, PRECISION_DOUBLE, &exact);
    for (int j = 0; j < 101; j++) {
        const double value = exp(-pow((j - 50) / 8.0, 2));
        support_pixel_set(&exact, 0, 4, j, value);
        support_pixel_set(&image, 0, 4, j, (1 + 0.1 * I) * value);
    }
    metrics_slice_samples(&image, &acquisition, &target, AXIS_AZIMUTH, &position, &decibels, &count);
    assert_true(count > 100);
    double *difference = metrics_slice_difference(&image, &exact, &acquisition, &target, AXIS_AZIMUTH, count);
    assert_non_null(difference);
    assert_close(difference[count / 2], -20, 1e-6);
    const int quarter = count / 2 + count / 20;
    assert_close(difference[quarter] - difference[count / 2], decibels[quarter] - decibels[count / 2], 1e-6);
    free(difference);
    assert_null(metrics_slice_difference(&image, &exact, &acquisition, &target, AXIS_AZIMUTH, count - 2));
    support_image_make(&shorter, 1, PRECISION_DOUBLE, &other);
    assert_null(metrics_slice_difference(&image, &other, &acquisition, &target, AXIS_AZIMUTH, count));
    free(position);
    free(decibels);
    image_free(&image);
    image_free(&exact);
    image_free(&other);
}

static void check_sharpness(const struct image *image, double entropy, double contrast, double ratio)
{
    struct sharpness s = metrics_sharpness(image);
    assert_close(s.entropy, entropy, 1e-9);
    assert_close(s.contrast, contrast, 1e-7); /* the root of a difference */
    if (isnan(ratio))
        assert_true(isnan(s.peak_over_median));
    else
        assert_close(s.peak_over_median, ratio, 1e-6 * ratio);
}

/* Even pixels, one bright pixel, powers 1 to n, whatever the scale. */
static void test_sharpness(void **state)
{
    (void)state;
    enum { ROWS = 4, COLUMNS = 5, COUNT = 2 * ROWS * COLUMNS };
    const struct grid grids[2] = {{0, 1, COLUMNS, 10, 1, ROWS, 0}, {9, 1, COLUMNS, 10, 1, ROWS, 0}};
    const double scales[] = {1, 1e-160, 1e150};
    struct image image;
    support_image_make(grids, 2, PRECISION_DOUBLE, &image);
    assert_true(isnan(metrics_sharpness(&image).entropy) && isnan(metrics_sharpness(&image).contrast));
    support_pixel_set(&image, 1, 2, 3, 7 * I);
    check_sharpness(&image, 0, sqrt(COUNT - 1.0), NAN);
    for (size_t scale = 0; scale < sizeof scales / sizeof *scales; scale++) {
        double entropy = 0, sum = COUNT * (COUNT + 1) / 2.0, squares = 0;
        for (int k = 0; k < COUNT; k++)
            support_pixel_set(&image, k / 20, k % 20 / COLUMNS, k % COLUMNS, scales[scale] * cexp(k * I));
        check_sharpness(&image, log(COUNT), 0, 1);
        for (int k = 0; k < COUNT; k++) { /* a permutation of 1 .. COUNT */
            int level = 7 * k % COUNT + 1;
            support_pixel_set(&image, k / 20, k % 20 / COLUMNS, k % COLUMNS, scales[scale] * sqrt(level));
            entropy -= level / sum * log(level / sum);
            squares += (double)level * level;
        }
        double mean = sum / COUNT;
        check_sharpness(&image, entropy, sqrt(squares / COUNT - mean * mean) / mean,
                        sqrt((double)COUNT / (COUNT / 2 + 1)));
    }
    support_pixel_set(&image, 0, 0, 0, NAN);
    assert_true(isnan(metrics_sharpness(&image).peak_over_median));
    image_free(&image);
}

static void test_quartiles(void **state)
{
    (void)state;
    const double sorted[] = {1, 2, 4, 8, 16};
    assert_close(quantile(sorted, 5, 0.25), 2, 0);
    assert_close(quantile(sorted, 5, 0.75), 8, 0);
    assert_close(quantile(sorted, 4, 0.25), 1.75, 1e-12);
    assert_close(quantile(sorted, 5, 1), 16, 0);
    assert_close(quantile(sorted, 1, 0.75), 1, 0);
    assert_true(isnan(quantile(sorted, 0, 0.5)));
    assert_close(timing_spread(&(struct timing){.run_s = 2, .run_q1_s = 1.9, .run_q3_s = 2.3}), 0.2, 1e-12);
}

/* Rounds of a setting are put together; one alone is timed at least three times. */
static void test_rounds_add_up(void **state)
{
    (void)state;
    static struct timing_samples samples;
    struct scene scene;
    struct session session;
    struct spec spec;
    struct outcome outcome;
    support_scene("study/quick", &scene);
    assert_int_equal(spec_parse("bp_nearest", &spec), STATUS_OK);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    int before = 0;
    for (int round = 1; round < TIMING_ROUNDS; round++) {
        outcome_round(&session, &spec, &samples);
        assert_true(samples.runs > before && samples.elapsed > 0 && samples.controls == 4 * round);
        before = samples.runs;
    }
    outcome_measure(&session, &spec, EFFORT_WHOLE, &samples, &outcome);
    assert_string_equal(outcome.row.status, "ok");
    assert_true(samples.runs > before && outcome.row.runs == samples.runs && samples.controls == 4 * TIMING_ROUNDS);
    double sorted[TIMING_RUNS];
    for (int k = 0; k < samples.runs; k++)
        sorted[k] = samples.seconds[k];
    assert_close(outcome.row.run_s, median(sorted, samples.runs), 0);
    assert_close(outcome.row.run_min_s, sorted[0], 0);
    double low, high;
    measurement_interval(&outcome.row, &low, &high);
    assert_true(low <= outcome.row.run_s && high >= outcome.row.run_s);
    outcome_free(&outcome);
    spec_free(&spec);
    session_close(&session);
    scene_free(&scene);
}

/* A method that takes as long as is asked for, and at first has the system clear memory for `clearing_s`. */
static double pause_s, clearing_s;
static int plan_made;

static enum status pause_plan(const struct problem *problem, const void *options, void **plan)
{
    (void)problem, (void)options;
    *plan = &plan_made;
    return STATUS_OK;
}

static enum status pause_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    (void)plan, (void)echoes, (void)image;
    for (const double begin = seconds_now(); seconds_now() - begin < clearing_s;) {
        const size_t bytes = 16 << 20;
        char *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        assert_true(memory != MAP_FAILED);
        for (size_t k = 0; k < bytes; k += 4096)
            memory[k] = 1;
        munmap(memory, bytes);
    }
    clearing_s = 0;
    nanosleep(&(struct timespec){.tv_nsec = (long)(1e9 * pause_s)}, NULL);
    stages_end(stages, "focus");
    return STATUS_OK;
}

static struct work pause_work(const void *plan)
{
    (void)plan;
    return (struct work){.pairs = 1};
}

static void pause_destroy(void *plan)
{
    (void)plan;
}

/* Where hundreds are measured, a long run is not repeated, a short one as often as quartiles need, and the scalar
   reference loop is timed once a second. A first run in which the system clears memory is not counted. */
static void test_effort_follows_the_run(void **state)
{
    (void)state;
    static const struct {
        double pause_s, clearing_s;
        enum effort effort;
        int least, most;
    } cases[] = {{0.31, 0, EFFORT_BRIEF, 1, 1},   {0.06, 0, EFFORT_BRIEF, 2, 3},
                 {0.06, 0.3, EFFORT_BRIEF, 2, 3}, {0, 0, EFFORT_BRIEF, 5, TIMING_RUNS},
                 {0.11, 0, EFFORT_WHOLE, 3, 5},   {0, 0, EFFORT_WHOLE, 5, TIMING_RUNS}};
    const struct algorithm pause = {
        .name = "pause", .plan = pause_plan, .execute = pause_execute, .work = pause_work, .destroy = pause_destroy};
    const struct spec spec = {.algorithm = &pause};
    struct scene scene;
    struct session session;
    support_scene("study/quick", &scene);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    const struct problem problem = session_problem(&scene, &pause, PRECISION_FLOAT);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct image image;
        struct timing timing;
        const double measured = session.control.measured;
        pause_s = cases[k].pause_s;
        clearing_s = cases[k].clearing_s;
        assert_int_equal(timing_measure(&spec, &problem, &session.echoes[PRECISION_FLOAT], &session.control,
                                        cases[k].effort, NULL, &image, &timing),
                         STATUS_OK);
        assert_in_range(timing.runs, cases[k].least, cases[k].most);
        assert_true(timing.run_s >= pause_s && timing.spent_s >= timing.runs * pause_s && timing.control_s > 0);
        assert_true(isfinite(timing.run_q1_s) == (timing.runs >= 4));
        if (cases[k].clearing_s > 0)
            assert_true(timing.run_s < cases[k].clearing_s);
        if (cases[k].effort == EFFORT_BRIEF)
            assert_true(session.control.measured == measured || session.control.measured - measured > 1);
        else
            assert_true(session.control.measured > measured);
        image_free(&image);
    }
    session_close(&session);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slice_difference),
        cmocka_unit_test(test_sharpness),
        cmocka_unit_test(test_quartiles),
        cmocka_unit_test(test_rounds_add_up),
        cmocka_unit_test(test_effort_follows_the_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
