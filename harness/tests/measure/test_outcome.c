/* The row of an image that is known, the exact one times one gain; a row's figures in the report. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "metrics/metrics.h"
#include "measure/outcome.h"
#include "results/results_folder.h"
#include "report/report.h"
#include "tests/support.h"

static struct scene scene;
static struct session session;
static const double complex gain = 0.9 * (0.955336489125606 + 0.29552020666134 * I); /* of phase .3 rad */

static enum status copy_plan(const struct problem *problem, const void *method, const void *options, void **plan)
{
    (void)problem, (void)method, (void)options;
    *plan = &session;
    return STATUS_OK;
}

static enum status copy_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    (void)plan, (void)echoes;
    for (int k = 0; k < image->patch_count; k++)
        for (int i = 0; i < image->patches[k].r_count; i++)
            for (int j = 0; j < image->patches[k].x_count; j++)
                support_pixel_set(image, k, i, j, gain * image_pixel(&session.reference, k, i, j));
    stages_end(stages, "copy");
    return STATUS_OK;
}

static struct work copy_work(const void *plan)
{
    (void)plan;
    return (struct work){.flops = 1, .pairs = 2, .bytes = 3, .published = {{"a paper", 4}}, .engine = "copy"};
}

static void copy_destroy(void *plan)
{
    (void)plan;
}

static void check_target(const struct target_row *row, const struct slice_metrics *slice)
{
    static const char *const definitions[] = {"null", "3db", "pixel"};
    int d = 0;
    while (d < 2 && strcmp(row->definition, definitions[d]) != 0)
        d++;
    assert_close(row->extent_m, slice->extent_m, 0);
    assert_close(row->position_error_m, slice->position_error_m, 1e-12);
    assert_close(row->phase_error_rad, 0.3, 1e-9);
    assert_close(row->width_m, slice->width_m, 1e-12);
    if (!isnan(slice->pslr_db[d]))
        assert_close(row->pslr_db, slice->pslr_db[d], 1e-9);
    assert_close(row->islr_db, slice->islr_db[d], 1e-9);
}

static double promised; /* NAN: nothing */

static double copy_promise(const void *options)
{
    (void)options;
    return promised;
}

/* The row of such an image whose settings promise something. */
static void check_promise(double promise, enum precision precision, const char *warning)
{
    const struct algorithm copy = {.name = "copy",
                                   .promise = copy_promise,
                                   .plan = copy_plan,
                                   .execute = copy_execute,
                                   .work = copy_work,
                                   .destroy = copy_destroy};
    const struct spec spec = {.algorithm = &copy, .precision = precision};
    struct outcome outcome;
    promised = promise;
    outcome_measure(&session, &spec, EFFORT_NONE, NULL, &outcome);
    assert_string_equal(outcome.row.status, "ok");
    const char *said = strstr(outcome.reason, OUTCOME_WARNING "condition promise");
    if (!said != !warning || (warning && !strstr(said, warning)))
        fail_msg("promise %g: %s", promise, outcome.reason);
    outcome_free(&outcome);
}

/* An error over what the settings promise is told with both figures; rounding and nothing promised are not. */
static void promises(void **state)
{
    (void)state;
    support_scene("gate/points", &scene);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    const double error = cabs(gain - 1); /* 0.301 */
    check_promise(0.25, PRECISION_DOUBLE, "is 0.301, limit 0.25 (");
    check_promise(error - 1e-9, PRECISION_DOUBLE, "is 0.301, limit 0.30");
    check_promise(error + 1e-9, PRECISION_DOUBLE, NULL);
    check_promise(error - 1e-7, PRECISION_FLOAT, NULL);
    check_promise(error - 1e-5, PRECISION_FLOAT, "is 0.301, limit 0.30");
    check_promise(NAN, PRECISION_DOUBLE, NULL);
    session_close(&session);
    scene_free(&scene);
}

/* Errors of the gain; lobes and sharpness, which no gain changes, as of the exact image: medians of two targets are
   their means. */
static void row_of_a_gain(void **state)
{
    (void)state;
    const struct algorithm copy = {
        .name = "copy", .plan = copy_plan, .execute = copy_execute, .work = copy_work, .destroy = copy_destroy};
    const struct spec spec = {.algorithm = &copy, .precision = PRECISION_DOUBLE};
    struct outcome outcome;
    struct slice_metrics azimuth[2], range[2];
    support_scene("gate/points", &scene);
    assert_int_equal(scene.point_count, 2);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    outcome_measure(&session, &spec, EFFORT_NONE, NULL, &outcome);
    const struct measurement *row = &outcome.row;
    assert_string_equal(row->status, "ok");
    assert_string_equal(row->precision, "double");
    assert_string_equal(row->engine, "copy");
    assert_close(row->flops, 1, 0);
    assert_close(row->pairs, 2, 0);
    assert_close(row->bytes, 3, 0);
    assert_close(row->flops_published, 4, 0);
    assert_close(row->error, cabs(gain - 1), 1e-9);
    assert_true(row->error_gain < 1e-9);
    assert_close(row->phase_rms_rad, 0.3, 1e-9);
    assert_true(isnan(row->run_s) && isnan(row->control_s) && row->runs < 0);
    for (int t = 0; t < 2; t++) {
        azimuth[t] = metrics_slice(&session.reference, &scene.acquisition, &scene.targets[t], AXIS_AZIMUTH);
        range[t] = metrics_slice(&session.reference, &scene.acquisition, &scene.targets[t], AXIS_RANGE);
    }
    assert_close(row->width_m, (azimuth[0].width_m + azimuth[1].width_m) / 2, 1e-12);
    assert_close(row->pslr_db, (azimuth[0].pslr_db[0] + azimuth[1].pslr_db[0]) / 2, 1e-9);
    assert_close(row->islr_db, (azimuth[0].islr_db[0] + azimuth[1].islr_db[0]) / 2, 1e-9);
    assert_int_equal(outcome.target_count, 2 * 5); /* three definitions along azimuth, two along range */
    for (int k = 0; k < outcome.target_count; k++) {
        const struct target_row *target = &outcome.targets[k];
        assert_int_equal(target->target, k / 5);
        check_target(target, strcmp(target->axis, "azimuth") == 0 ? &azimuth[k / 5] : &range[k / 5]);
    }
    const struct sharpness sharpness = metrics_sharpness(&session.reference);
    assert_close(row->entropy, sharpness.entropy, 1e-9);
    assert_close(row->contrast, sharpness.contrast, 1e-9);
    assert_close(row->peak_over_median, sharpness.peak_over_median, 1e-9);
    outcome_free(&outcome);
    session_close(&session);
    scene_free(&scene);
}

/* Each figure of a row in its column of the report, in its unit. */
static void columns_of_the_report(void **state)
{
    (void)state;
    const struct provenance provenance = {.machine = "m", .commit = "abc", .program = "def", .date = "now"};
    struct results_folder *results;
    struct measurement row = measurement_empty("a", "bp_nearest", "", PRECISION_FLOAT);
    row.plan_s = 0.01;
    row.run_s = 0.25;
    row.run_q1_s = 0.2;
    row.run_q3_s = 0.275;
    row.control_s = 3;
    row.flops = 0.75e9;
    row.bytes = 12.5e6;
    row.error = 0.125;
    row.error_gain = 0.0625;
    row.phase_rms_rad = 0.5;
    row.width_m = 0.04;
    row.pslr_db = -13.25;
    row.islr_db = -10.5;
    assert_int_equal(results_folder_open(folder, &provenance, &results), STATUS_OK);
    assert_int_equal(results_folder_scene(results, row.scene, 1), STATUS_OK);
    assert_int_equal(results_folder_add(results, &row), STATUS_OK);
    results_folder_close(results);
    assert_int_equal(report_write(folder), STATUS_OK);
    char *page = support_read_cells("report.html");
    assert_non_null(page);
    assert_non_null(strstr(page, "|bp_nearest|250 ms (-20.0, +10.0 %)|12x|10 ms|0.75|12.5|1.2e-01|6.2e-02|5.0e-01|"
                                 "40.00|-13.25|-10.50|"));
    free(page);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(row_of_a_gain),
        cmocka_unit_test(promises),
        cmocka_unit_test_setup_teardown(columns_of_the_report, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
