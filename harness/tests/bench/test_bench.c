/* What `bench` says of goals: the ratios of lines that were measured in one run, and which goals they hold. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "files/paths.h"
#include "files/csv.h"
#include "bench/bench.h"
#include "tests/support.h"

#define LINES                                                                                                          \
    "line,scene,algorithm,threads,isa,pair_flops\nnearest,gate/points,bp_nearest,1,,8\n"                               \
    "everywhere,gate/points,bp_nearest,all,,8\nsinc,gate/points,\"bp_sinc:taps=8,precision=double\",1,baseline,40\n"   \
    "never,gate/points,bp_nearest,1,v9,8\ndelay,gate/blocks,rma_delay,1,,\n"
#define GOALS "line,value,over,sense,goal\n"

static enum status measure(const char *lines, const char *goals)
{
    char where[400], to[400];
    support_write("lines.csv", lines);
    support_write("goals.csv", goals);
    snprintf(where, sizeof where, "%s", path_of("."));
    snprintf(to, sizeof to, "%s", path_of("out"));
    return bench_goals(where, to);
}

/* The value beside a goal; `held` is what its row is to say. */
static double goal_value(const struct csv *csv, const char *what, const char *held)
{
    double value = NAN;
    int found = 0;
    for (int row = 0; row < csv->row_count; row++)
        if (strcmp(csv_cell(csv, row, csv_column(csv, "what")), what) == 0) {
            assert_string_equal(csv_cell(csv, row, csv_column(csv, "held")), held);
            assert_true(csv_number(csv_cell(csv, row, csv_column(csv, "value")), &value));
            found++;
        }
    assert_int_equal(found, 1);
    return value;
}

static void goals_are_held_or_not(void **state)
{
    (void)state;
    struct csv csv;
    if (measure(LINES, GOALS "nearest,run_s,nearest,at most,1\nnearest,run_s,sinc,at least,1e9\n"
                             "sinc,error,,at most,1e-2\nsinc,error,,at most,1e-9\nnever,rate,peak,at least,0.1\n"
                             "nearest,rate,peak,at least,1e-9\ndelay,run_s,fft,at least,1e-9\n"
                             "delay,focused_s,delay,at most,1\n")
        != STATUS_OK)
        fail_msg("%s", status_message());
    assert_int_equal(csv_read(path_of("out/goals.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_int_equal(csv.row_count, 8);
    assert_string_equal(csv_cell(&csv, 0, 0), "nearest, run_s over sinc"); /* the worst first */
    assert_true(goal_value(&csv, "nearest, run_s over nearest", "yes") == 1);
    assert_true(goal_value(&csv, "nearest, run_s over sinc", "no") > 0);
    assert_true(isnan(goal_value(&csv, "never, rate over peak", "not measured")));
    assert_in_range(1e12 * goal_value(&csv, "nearest, rate over peak", "yes"), 1, 1e12); /* a fraction of it */
    assert_true(goal_value(&csv, "delay, run_s over fft", "yes") > 0);
    csv_free(&csv);
    assert_int_equal(csv_read(path_of("out/bench.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_int_equal(csv.row_count, 4); /* all but the one for no instruction set of ours */
    csv_free(&csv);
    assert_true(support_exists("out/bench.png"));
}

static void cells_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *lines, *goals, *says;
    } wrong[] = {
        {"line,scene\na,b\n", GOALS, "column 3 must be 'algorithm'"},
        {"line,scene,algorithm,threads,isa,pair_flops\na,gate/points,bp_nearest,2,,8\n", GOALS, "accepted: 1, all"},
        {"line,scene,algorithm,threads,isa,pair_flops\na,gate/points,bp_nearest,1,,many\n", GOALS, "a number"},
        {LINES, GOALS "none,run_s,,at most,1\n", "column line is 'none'"},
        {LINES, GOALS "nearest,hours,,at most,1\n", "column value is 'hours'"},
        {LINES, GOALS "nearest,rate,moon,at most,1\n", "column over is 'moon'"},
        {LINES, GOALS "nearest,rate,peak,at best,1\n", "column sense is 'at best'"},
        {LINES, GOALS "nearest,rate,peak,at most,-1\n", "column goal is '-1'"},
    };
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        assert_int_equal(measure(wrong[k].lines, wrong[k].goals), STATUS_INVALID);
        if (!strstr(status_message(), wrong[k].says))
            fail_msg("'%s' is not in '%s'", wrong[k].says, status_message());
    }
    /* Those that we ship are right: what is refused is the folder, behind them. */
    support_write("file", "");
    assert_int_equal(bench_goals(data_path(DATA_BENCH), path_of("file/in")), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "file"));
    assert_null(strstr(status_message(), "goals.csv"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(goals_are_held_or_not, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(cells_are_refused, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
