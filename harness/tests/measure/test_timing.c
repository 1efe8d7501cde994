/* Every figure made of times, on a clock that goes as it is told (fake_clock.h): what timing makes of known runs, how
   often it repeats them, and what of it comes to the row, the table and the report. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/clock.h"
#include "contract/delay.h"
#include "measure/outcome.h"
#include "results/results.h"
#include "report/report.h"
#include "show/table.h"
#include "run/batch.h"
#include "tests/measure/fake_clock.h"
#include "tests/support.h"

static const struct spec spec = {.algorithm = &telling};

static struct scene scene;
static struct session session;

static int session_begin(void **state)
{
    (void)state;
    support_scene("study/quick", &scene);
    return session_open(&scene, &session) == STATUS_OK ? 0 : -1;
}

static int session_end(void **state)
{
    (void)state;
    session_close(&session);
    scene_free(&scene);
    return 0;
}

/* From now on runs and the control take this. */
static void tell(const struct told *how, const double *control)
{
    told = *how;
    runs_done = 0;
    fake_clock_begin();
    fake.control = control;
    session.control.measured = -INFINITY;
}

static struct timing timed(enum effort effort, struct timing_samples *samples)
{
    struct image image;
    struct timing timing;
    const struct problem problem = session_problem(&scene, &telling, PRECISION_FLOAT);
    const enum status status = timing_measure(&spec, &problem, &session.echoes[PRECISION_FLOAT], &session.control,
                                              effort, samples, &image, &timing);
    fake.on = false;
    if (status != STATUS_OK)
        fail_msg("%s", status_message());
    image_free(&image);
    return timing;
}

static const double slack_s = 1e-11; /* what is lost of a second of a clock at 1000 s */
static const double steady[] = {0.008, 0.008, 0.008, 0.008};
static const double pairs_timed = FAKE_PAIRS;
#define QUICK_PAIRS 114192 /* of study/quick */
#define CONTROL_S   (QUICK_PAIRS * 0.01 / FAKE_PAIRS)

/* --- What timing makes of runs -------------------------------------------------------------------------------- */

static void quartiles_between_two(void **state)
{
    (void)state;
    double sorted[] = {1, 2, 4, 8, 16};
    assert_close(quantile(sorted, 5, 0.25), 2, 0);
    assert_close(quantile(sorted, 5, 0.75), 8, 0);
    assert_close(quantile(sorted, 4, 0.25), 1.75, 1e-12);
    assert_close(quantile(sorted, 5, 1), 16, 0);
    assert_close(quantile(sorted, 1, 0.75), 1, 0);
    assert_true(isnan(quantile(sorted, 0, 0.5)));
    assert_close(timing_spread(&(struct timing){.run_s = 2, .run_q1_s = 1.9, .run_q3_s = 2.3}), 0.2, 1e-12);
}

/* Median, minimum, quartiles; how often is repeated; whether the first run counts. */
static void runs_are_summed_up(void **state)
{
    (void)state;
    static const struct {
        enum effort effort;
        struct told told;
        int runs, begun; /* timed, and with the first one */
        double run_s, min_s, q1_s, q3_s, spent_s;
    } cases[] = {
        /* Five and half a second; the first warms up, though it is the fastest. */
        {EFFORT_WHOLE, {{0.05, 0.11, 0.19, 0.10, 0.12, 0.13}}, 5, 6, 0.12, 0.10, 0.11, 0.13, 0.70},
        {EFFORT_WHOLE, {{1, 0.01}}, 50, 51, 0.01, 0.01, 0.01, 0.01, 1.5},
        {EFFORT_WHOLE, {{9, 1.6, 1.0, 1.3}}, 3, 4, 1.3, 1.0, NAN, NAN, 12.9},         /* less than four: no quartiles */
        {EFFORT_WHOLE, {{9, 0.8, 0.9, 1.2, 1.6}}, 4, 5, 1.05, 0.8, 0.875, 1.3, 13.5}, /* of four: between two */
        {EFFORT_WHOLE, {{10, 3}}, 1, 1, 10, 10, NAN, NAN, 10},
        {EFFORT_WHOLE, {{10, 3}, .clearing_s = 2.6}, 3, 4, 3, 3, NAN, NAN, 19},
        {EFFORT_WHOLE, {{10, 3}, .clearing_s = 2.4}, 1, 1, 10, 10, NAN, NAN, 10},
        {EFFORT_BRIEF, {{0.039, 0.01, 0.02}}, 5, 6, 0.02, 0.01, 0.02, 0.02, 0.129},
        {EFFORT_BRIEF, {{0.03, 0.005}}, 8, 9, 0.005, 0.005, 0.005, 0.005, 0.07},
        {EFFORT_BRIEF, {{0.06, 0.05, 0.07}}, 3, 3, 0.06, 0.05, NAN, NAN, 0.18},
        {EFFORT_BRIEF, {{0.29, 0.2}}, 2, 2, 0.245, 0.2, NAN, NAN, 0.49},
        {EFFORT_BRIEF, {{0.3, 0.2}}, 1, 1, 0.3, 0.3, NAN, NAN, 0.3},
        {EFFORT_BRIEF, {{0.3, 0.2}, .clearing_s = 0.1}, 2, 3, 0.2, 0.2, NAN, NAN, 0.7},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        tell(&cases[k].told, steady);
        const struct timing timing = timed(cases[k].effort, NULL);
        print_message("case %zu: %d runs, median %.9g s\n", k + 1, timing.runs, timing.run_s);
        assert_int_equal(timing.runs, cases[k].runs);
        assert_int_equal(runs_done, cases[k].begun);
        assert_close(timing.run_s, cases[k].run_s, slack_s);
        assert_close(timing.run_min_s, cases[k].min_s, slack_s);
        assert_close(timing.spent_s, cases[k].spent_s, 10 * slack_s);
        assert_close(timing.plan_s, 0.004, slack_s);
        if (timing.runs < 4)
            assert_true(isnan(timing.run_q1_s) && isnan(timing.run_q3_s));
        if (timing.runs >= 4) {
            assert_close(timing.run_q1_s, cases[k].q1_s, slack_s);
            assert_close(timing.run_q3_s, cases[k].q3_s, slack_s);
        }
    }
}

/* Those of the run nearest the median, which they sum up to; a name that comes twice is one stage. */
static void stages_are_of_the_median_run(void **state)
{
    (void)state;
    tell(&(struct told){{9, 0.3, 0.1, 0.2}}, steady);
    const struct timing timing = timed(EFFORT_WHOLE, NULL);
    assert_close(timing.run_s, 0.2, slack_s);
    assert_int_equal(timing.stages.count, 2);
    assert_string_equal(timing.stages.stage[0].name, "compress");
    assert_string_equal(timing.stages.stage[1].name, "focus");
    assert_close(timing.stages.stage[0].seconds, 0.05, slack_s);
    assert_close(timing.stages.stage[1].seconds, 0.15, slack_s);
}

/* Counted one by one: whose delay lies in the record, within the aperture. */
static double pairs_of_quick(void)
{
    const struct acquisition *a = &scene.acquisition;
    const struct grid *grid = &scene.patches[0];
    double count = 0;
    assert_int_equal(scene.patch_count, 1);
    for (int n = 0; n < a->pings * a->receivers; n++)
        for (int k = 0; k < grid->x_count * grid->r_count; k++) {
            const int ping = n / a->receivers;
            const struct vector pixel = grid_point(grid, k / grid->x_count, k % grid->x_count);
            const double tau = delay_exact(a->tx[ping], a->rx[n], a->velocity[ping], pixel, a->sound_speed);
            const double at = (tau - a->t0[ping]) * a->fs;
            count += at >= -0.5 && at < a->samples - 0.5;
        }
    return count;
}

/* The median of the loop's runs before and after, for all pairs: those that the algorithm sums, or without any those of
   the problem. Its drift goes by the faster one of each two. */
static void control_is_for_all_pairs(void **state)
{
    (void)state;
    static const double control[] = {0.016, 0.008, 0.009, 0.012};
    const double pairs = QUICK_PAIRS;
    assert_close(pairs_of_quick(), pairs, 0);
    tell(&(struct told){{0.2}, .pairs = pairs}, control);
    struct timing timing = timed(EFFORT_WHOLE, NULL);
    assert_int_equal(fake.controls, 4);
    assert_close(timing.control_s, 0.0105 / pairs_timed * pairs, pairs * slack_s / pairs_timed);
    assert_close(timing.drift, 9. / 8 - 1, 1e-8);
    assert_close(timing.spent_s, 1.2, 10 * slack_s); /* is not of the runs */
    tell(&(struct told){{0.2}}, control);
    timing = timed(EFFORT_WHOLE, NULL);
    assert_close(timing.control_s, 0.0105 / pairs_timed * pairs, pairs * slack_s / pairs_timed);
}

/* Where hundreds are measured, what was timed within a second is taken again. */
static void control_is_recent(void **state)
{
    (void)state;
    static const double control[] = {0.01, 0.02, 0.04, 0.05, 0.06, 0.07};
    tell(&(struct told){{0.1}, .pairs = QUICK_PAIRS}, control);
    struct timing timing = timed(EFFORT_BRIEF, NULL);
    assert_int_equal(fake.controls, 2);
    assert_close(timing.control_s, 1.5 * CONTROL_S, 1e-7 * CONTROL_S);
    assert_close(timing.drift, 0, 0);
    fake.on = true;
    timing = timed(EFFORT_BRIEF, NULL); /* 0.2 s later, and as long */
    assert_int_equal(fake.controls, 2);
    fake.on = true;
    fake_clock_pass(0.9);
    timing = timed(EFFORT_BRIEF, NULL);
    assert_int_equal(fake.controls, 4);
    assert_close(timing.control_s, 4.5 * CONTROL_S, 1e-7 * CONTROL_S);
    tell(&(struct told){{1.1}, .pairs = QUICK_PAIRS}, control); /* a run of more than that second */
    timing = timed(EFFORT_BRIEF, NULL);
    assert_int_equal(fake.controls, 4);
    assert_close(timing.control_s, 3 * CONTROL_S, 1e-7 * CONTROL_S);
    assert_close(timing.drift, 3, 1e-8);
}

/* Threads without a processor: those of the runs that count, and not of the control. */
static void waiting_is_of_the_runs(void **state)
{
    (void)state;
    tell(&(struct told){{5, 0.2}, .waited = 0.3}, steady);
    assert_close(timed(EFFORT_WHOLE, NULL).waited, 0.3, 1e-8);
    tell(&(struct told){{10}, .waited = 0.7}, steady);
    assert_close(timed(EFFORT_WHOLE, NULL).waited, 0.7, 1e-8);
}

/* Times of three rounds are one setting's: each warms up anew, and has a third of the time; a long first run counts. */
static void rounds_are_one_measurement(void **state)
{
    (void)state;
    static struct timing_samples samples, longer;
    static const double slowness[TIMING_ROUNDS] = {1, 3, 2};
    static const double control[] = {0.01, 0.01, 0.01, 0.01, 0.02, 0.02, 0.02, 0.02, 0.03, 0.03, 0.03, 0.03};
    struct timing timing;
    for (int round = 0; round < TIMING_ROUNDS; round++) {
        const struct told slow = {{0.4, 0.02 * slowness[round]}, .waited = 0.5 * (round == 1), .pairs = QUICK_PAIRS};
        tell(&slow, control + 4 * round);
        timing = timed(EFFORT_WHOLE, &samples);
    }
    assert_int_equal(timing.runs, 9 + 3 + 5); /* in 0.5/3 s each */
    assert_true(fabs(timing.run_s - 0.02) < slack_s && fabs(timing.run_min_s - 0.02) < slack_s);
    assert_close(timing.run_q3_s, 0.04, slack_s);
    assert_close(timing.control_s, 2 * CONTROL_S, 1e-7 * CONTROL_S);
    assert_close(timing.waited, 0.5 * 0.18 / (0.18 + 0.18 + 0.2), 1e-8);
    for (int round = 0; round < TIMING_ROUNDS; round++) {
        tell(&(struct told){{1 * slowness[round], 99}, .pairs = QUICK_PAIRS}, control + 4 * round);
        timing = timed(EFFORT_WHOLE, &longer);
    }
    assert_true(timing.runs == TIMING_ROUNDS && fabs(timing.run_s - 2) < slack_s);
}

/* Of a busy machine: the time in which other work had the processor is left out. */
static void waiting_is_left_out(void **state)
{
    (void)state;
    fake_clock_begin();
    seconds_skip_waiting();
    const double begin = seconds_now();
    fake_clock_pass(0.5);
    fake.waited += 300000000;
    assert_close(seconds_now() - begin, 0.2, slack_s);
    fake_clock_pass(0.25);
    assert_close(seconds_now() - begin, 0.45, slack_s);
    clock_set(clock_monotonic);
    fake.on = false;
}

/* --- What comes to the row, the table and the report ----------------------------------------------------------- */

/* Time, speed-up and rate, as the row's line of the table has them. */
static void check_table(const struct measurement *row, const char *time, const char *speed_up, const char *rate)
{
    static char text[8192];
    char line[120];
    FILE *stream = fmemopen(text, sizeof text, "w");
    assert_non_null(stream);
    unsetenv("COLUMNS");
    table_begin(stream, false);
    table_row(stream, row);
    assert_int_equal(fclose(stream), 0);
    snprintf(line, sizeof line, "  %-34s %8s %8s %9s ", "telling", time, speed_up, rate);
    if (!strstr(text, line))
        fail_msg("'%s' is not in%s", line, strstr(text, row->scene));
}

/* Each mark of a noisy time by itself, at its limit of a tenth, and all together: ~ and the words. */
static void noise_is_told(void **state)
{
    (void)state;
    static const double faster[] = {0.01, 0.01, 0.0091, 0.0091}, slower[] = {0.01, 0.01, 0.0112, 0.012},
                        dropped[] = {0.01, 0.01, 0.0089, 0.0089};
    static const char spread[] = "the middle half of 5 runs spans 11 % of the median",
                      waited[] = "other work had the processors for 12 % of the time",
                      slow[] = "the scalar reference loop's time changed by +12 % meanwhile",
                      fast[] = "the scalar reference loop's time changed by -11 % meanwhile";
    static const struct {
        double first, last, waited; /* quartiles beside a median of .2 s; of each thread */
        const double *control;
        const char *reasons[3];
    } cases[] = {
        {0.191, 0.21, 0.09, faster, {NULL}},
        {0.19, 0.212, 0, steady, {spread}},
        {0.2, 0.2, 0.12, steady, {waited}},
        {0.2, 0.2, 0, slower, {slow}},
        {0.2, 0.2, 0, dropped, {fast}},
        {0.19, 0.212, 0, slower, {spread, slow}},
        {0.19, 0.212, 0.12, slower, {spread, waited, slow}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct outcome outcome;
        char wanted[400] = "";
        const double low = cases[k].first, high = cases[k].last;
        for (int n = 0; n < 3 && cases[k].reasons[n]; n++)
            snprintf(wanted + strlen(wanted), sizeof wanted - strlen(wanted), "%s%s",
                     n == 0 ? "warning: times scatter: " : "; ", cases[k].reasons[n]);
        tell(&(struct told){{5, high, low, 0.2, low, high}, .waited = cases[k].waited * omp_get_max_threads()},
             cases[k].control);
        outcome_measure(&session, &spec, EFFORT_WHOLE, NULL, &outcome);
        fake.on = false;
        const char *found = strstr(outcome.row.reason, "warning: times");
        assert_string_equal(found ? found : "", wanted);
        check_table(&outcome.row, *wanted ? "200 ms~" : "200 ms",
                    cell_significant(outcome.row.control_s / 0.2, "x").text, "0.32 GF/s");
        outcome_free(&outcome);
    }
}

/* Pairs are Gp/s, without pairs 6.46e7 operations in 0.02 s are 3.23 GF/s; the control's time is for the problem's
   pairs. */
static void speed_up_and_rate(void **state)
{
    (void)state;
    static const double control[] = {0.01, 0.01, 0.01, 0.01};
    for (int k = 0; k < 2; k++) {
        struct outcome outcome;
        const double s = k == 0 ? QUICK_PAIRS / 0.512e9 : 0.02;
        tell(&(struct told){{5, 0.95 * s, 1.05 * s, s}, .pairs = k == 0 ? QUICK_PAIRS : 0}, control);
        outcome_measure(&session, &spec, EFFORT_WHOLE, NULL, &outcome);
        fake.on = false;
        assert_close(outcome.row.control_s, CONTROL_S, 1e-9 * CONTROL_S);
        assert_close(outcome.row.flops, 6.46e7, 0);
        check_table(&outcome.row, k == 0 ? "223 us" : "20 ms", cell_significant(CONTROL_S / s, "x").text,
                    k == 0 ? "0.51 Gp/s" : "3.23 GF/s");
        outcome_free(&outcome);
    }
}

/* A clock that stands still, or is set back, an image that is kept from the run before, and more processors than
   threads make no result; the echoes are as they were. */
static void false_times_are_no_result(void **state)
{
    (void)state;
    static const struct {
        struct told told;
        const char *reason; /* NULL: it is a result */
    } cases[] = {
        {{{0}, .pairs = QUICK_PAIRS}, "a run of telling takes 0 s, "},
        {{{-0.2}, .pairs = QUICK_PAIRS}, "a run of telling takes -0.2 s, "},
        {{{0.2}}, "of the scalar reference loop 0 s: the system's clock stands still"},
        {{{0.2}, .pairs = QUICK_PAIRS, .processors = 2}, NULL},
        {{{0.2}, .pairs = QUICK_PAIRS, .keeps = true},
         "the image of the negated echoes is not the negated image (run 2)"},
        {{{0.2}, .pairs = QUICK_PAIRS, .processors = 2.5}, "telling kept 2.5 processors busy with --threads 2"}};
    const double first = *(const float *)session.echoes[PRECISION_FLOAT].samples;
    omp_set_num_threads(2);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct outcome outcome;
        tell(&cases[k].told, cases[k].told.pairs > 0 ? steady : (const double[4]){0});
        outcome_measure(&session, &spec, EFFORT_WHOLE, NULL, &outcome);
        fake.on = false;
        assert_string_equal(outcome.row.status, cases[k].reason ? "failed" : "ok");
        assert_true(!cases[k].reason || strstr(outcome.row.reason, cases[k].reason));
        assert_true(isnan(outcome.row.run_s) == !!cases[k].reason);
        assert_true((outcome.image.patch_count == 0) == !!cases[k].reason);
        assert_true(*(const float *)session.echoes[PRECISION_FLOAT].samples == first);
        outcome_free(&outcome);
    }
}

/* Measured as `run` does it, or `sweep` (in turn): the row, read back. */
static struct measurement run_row(bool in_turn, struct results *results)
{
    struct batch batch;
    assert_int_equal(batch_open(folder, 1, false, &batch), STATUS_OK);
    batch.in_turn = in_turn;
    assert_int_equal(batch_close(&batch, batch_scene(&batch, &scene, 1, &spec)), STATUS_OK);
    fake.on = false;
    assert_int_equal(results_read(path_of("measurements.csv"), results), STATUS_OK);
    assert_int_equal(results->csv.row_count, 1);
    return results->measurements[0];
}

/* An algorithm that looks at the clock until 0.2 s are over, 0.18 and 0.23 now and then, from `run` to the report. */
static void figures_reach_the_report(void **state)
{
    (void)state;
    static const double control[] = {0.008, 0.01, 0.012, 0.01};
    const double readings_s = 20e-6, threads = omp_get_max_threads();
    struct results results;
    tell(&(struct told){{3, 0.23, 0.2, 0.18, 0.2, 0.23}, .pairs = QUICK_PAIRS, .busy = true}, control);
    fake.tick = 1000;
    const struct measurement row = run_row(false, &results);
    assert_string_equal(row.status, "ok");
    assert_string_equal(row.precision, "float");
    assert_close(row.threads, threads, 0);
    assert_int_equal(row.runs, 5);
    assert_close(row.plan_s, 0.004, readings_s);
    assert_close(row.run_s, 0.2, readings_s);
    assert_close(row.run_min_s, 0.18, readings_s);
    assert_close(row.run_q1_s, 0.2, readings_s);
    assert_close(row.run_q3_s, 0.23, readings_s);
    double low, high;
    measurement_interval(&row, &low, &high);
    assert_true(low == row.run_q1_s && high == row.run_q3_s);
    assert_close(row.control_s, CONTROL_S, 1e-6 * CONTROL_S);
    assert_close(row.pairs, QUICK_PAIRS, 0);
    assert_close(row.flops, 6.46e7, 0);
    assert_string_equal(row.stages, "compress=0.05;focus=0.15");
    assert_non_null(strstr(row.reason, "times scatter: the middle half of 5 runs spans 15 % of the median"));
    assert_int_equal(report_write(folder), STATUS_OK);
    char *page = support_read_cells("report.html");
    assert_non_null(page);
    char line[100];
    snprintf(line, sizeof line, "\n|telling|200 ms~ (-0.0, +15.0 %%)|%s|4 ms|0.0646|",
             cell_significant(CONTROL_S / 0.2, "x").text);
    assert_non_null(strstr(page, line));
    free(page);
    results_free(&results);
}

/* The same by the system's own clock, of which only the least is certain. */
static void busy_waiting_takes_its_time(void **state)
{
    (void)state;
    const double least = 0.003, begin = seconds_now();
    struct results results;
    told = (struct told){{least}, .pairs = QUICK_PAIRS, .busy = true};
    const struct measurement row = run_row(true, &results);
    assert_true(row.runs >= 5 * TIMING_ROUNDS / 3 && row.run_min_s >= least && row.run_s >= row.run_min_s);
    assert_true(row.run_min_s * row.runs <= seconds_now() - begin);
    assert_true(row.control_s > 0 && row.plan_s > 0);
    results_free(&results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quartiles_between_two),
        cmocka_unit_test(runs_are_summed_up),
        cmocka_unit_test(stages_are_of_the_median_run),
        cmocka_unit_test(control_is_for_all_pairs),
        cmocka_unit_test(control_is_recent),
        cmocka_unit_test(waiting_is_of_the_runs),
        cmocka_unit_test(rounds_are_one_measurement),
        cmocka_unit_test(waiting_is_left_out),
        cmocka_unit_test(noise_is_told),
        cmocka_unit_test(speed_up_and_rate),
        cmocka_unit_test(false_times_are_no_result),
        cmocka_unit_test_setup_teardown(figures_reach_the_report, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(busy_waiting_takes_its_time, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, session_begin, session_end);
}
