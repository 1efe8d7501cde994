/* A run in shards: merged, they are the run; what does not belong together is refused. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>

#include "files/csv.h"
#include "scene/random.h"
#include "tests/command/program.h"
#include "tests/command/same_rows.h"

enum { SHARDS = 8 };
static char folders[SHARDS][20], parts[SHARDS][20];

/* `kills`: end it by SIGKILL that often, at random moments, before it runs to its end. */
static void shard_run(const char *const *arguments, int kills, struct random *random)
{
    for (int k = 0; k < kills; k++) {
        int status;
        FILE *sink = tmpfile();
        const pid_t child = program_start(arguments, sink, sink);
        nanosleep(&(struct timespec){.tv_nsec = (long)(9e8 * random_uniform(random))}, NULL);
        kill(child, SIGKILL);
        assert_int_equal(waitpid(child, &status, 0), child);
        fclose(sink);
    }
    program_good(arguments);
}

/* The rows of eight shards, every other one of which is killed, resumed and has its options in another order, are
   the run's; a second merge changes nothing. */
static void merged_shards_are_the_run(void **state)
{
    (void)state;
    struct random random = random_seed(11, 0);
    program_good((const char *const[ARGUMENTS_MAX]){"sweep", "scene.cfg", "study/quick", "-a", "bp_linear:beta=4", "-a",
                                                    "bp_nearest", "-o", "whole"});
    for (int k = 0; k < SHARDS; k++) {
        snprintf(folders[k], sizeof folders[k], "shard-%d", k + 1);
        snprintf(parts[k], sizeof parts[k], "%d/%d", k + 1, SHARDS);
        const char *const in_order[ARGUMENTS_MAX] = {
            "sweep", "scene.cfg", "study/quick", "-a",    "bp_linear:beta=4", "-a", "bp_nearest",
            "-o",    folders[k],  "--shard",     parts[k]};
        const char *const turned[ARGUMENTS_MAX] = {"sweep", "--shard",          parts[k],   "study/quick",
                                                   "-o",    folders[k],         "-a",       "bp_nearest",
                                                   "-a",    "bp_linear:beta=4", "scene.cfg"};
        shard_run(k % 2 ? turned : in_order, k % 2, &random);
    }
    const char *arguments[ARGUMENTS_MAX] = {"merge", "-o", "merged"};
    for (int k = 0; k < SHARDS; k++)
        arguments[3 + k] = folders[k];
    size_t sizes[2];
    char *bytes[2];
    for (int again = 0; again < 2; again++) {
        char *told = program_output(arguments);
        assert_non_null(strstr(told, "merged: 10 cells of 8 folders, measured on "));
        free(told);
        assert_same_results("whole", "merged");
        bytes[again] = bytes_read("merged/measurements.csv", &sizes[again]);
    }
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(bytes[0], bytes[1], sizes[0]);
    free(bytes[0]);
    free(bytes[1]);
    program_good((const char *const[ARGUMENTS_MAX]){"report", "merged"});
}

/* Verdicts of scenes, one of which is refused. */
static void stability_in_shards(void **state)
{
    (void)state;
    program_good((const char *const[ARGUMENTS_MAX]){"stability", "--quick", "extreme/base", "extreme/amp_denormal",
                                                    "extreme/v_gt_c", "-a", "bp_nearest", "-o", "verdicts"});
    for (int k = 0; k < 2; k++)
        program_good((const char *const[ARGUMENTS_MAX]){"stability", "--quick", "extreme/base", "extreme/amp_denormal",
                                                        "extreme/v_gt_c", "-a", "bp_nearest", "-o", k ? "v2" : "v1",
                                                        "--shard", k ? "2/2" : "1/2"});
    program_good((const char *const[ARGUMENTS_MAX]){"merge", "v1", "v2", "-o", "v"});
    assert_same_rows("verdicts/stability.csv", "v/stability.csv");
    assert_same_rows("verdicts/expected.csv", "v/expected.csv");
}

/* ---- what is refused ---- */

static const char head[] =
    "# sasbench measurements 1\n# machine: %s\n# isa: v3\n# libraries: some\n# commit: c\n"
    "# program: %s\n# threads: 1\n# scene a: %s\n"
    "scene,algorithm,options,precision,threads,engine,status,reason,skipped,plan_s,run_s,run_min_s,"
    "runs,control_s,stages,flops_published,flops,pairs,bytes,error,error_gain,phase_rms_rad,width_m,"
    "pslr_db,islr_db,run_q1_s,run_q3_s,entropy,contrast,peak_over_median,host,load,error_flown\n";
static const char row[] = "a,%s,,float,1,general,%s,,,1,%s,1,5,1,,,1,1,1,1,1,1,,,,1,1,1,1,1,node,0.5,\n";

/* A folder with one row. */
static void results_make(const char *name, const char *const from[3], const char *algorithm, const char *status,
                         const char *seconds)
{
    char text[3000], path[100];
    int length = snprintf(text, sizeof text, head, from[0], from[1], from[2]);
    snprintf(text + length, sizeof text - (size_t)length, row, algorithm, status, seconds);
    mkdir(path_in(name), 0777);
    snprintf(path, sizeof path, "%.60s/measurements.csv", name);
    text_write(path, text);
}

static void mixtures_are_refused(void **state)
{
    (void)state;
    results_make("first", (const char *const[]){"m", "p", "01"}, "one", "ok", "1");
    results_make("program", (const char *const[]){"m", "q", "01"}, "two", "ok", "1");
    results_make("scene", (const char *const[]){"m", "p", "02"}, "two", "ok", "1");
    results_make("again", (const char *const[]){"m", "p", "01"}, "one", "ok", "2");
    results_make("other", (const char *const[]){"n", "p", "01"}, "one", "ok", "2");
    mkdir(path_in("mixed"), 0777);
    results_make("mixed/1", (const char *const[]){"o", "p", "01"}, "one", "ok", "2");
    static const struct refusal refusals[] = {
        {{"merge", "first", "program", "-o", "x"}, {"program/measurements.csv", "'# program: q'", "'# program: p'"}},
        {{"merge", "first", "scene", "-o", "x"}, {"scene/measurements.csv", "'# scene a: 02'", "'# scene a: 01'"}},
        {{"merge", "first", "again", "-o", "x"},
         {"again/measurements.csv:10", "a with one", "first/measurements.csv:10"}},
        {{"merge", "first", "foreign", "-o", "x"}, {"foreign/measurements.csv"}},
        {{"merge", "first", "nowhere", "-o", "x"}, {"nowhere"}},
        {{"merge", "first", "first", "-o", "x"}, {"first"}},
        {{"merge", "first", "other", "-o", "mixed"}, {"mixed/1", "'o'", "'m'"}},
        {{"merge", "first"}, {"-o DIR"}},
        {{"run", "--shard", "0/8"}, {"'0/8'", "from 1/8 to 8/8"}},
        {{"run", "--shard", "9/8"}, {"'9/8'"}},
        {{"sweep", "--shard", "1/8 "}, {"'1/8 '"}},
        {{"stability", "--shard", "1"}, {"'1'"}},
        {{"reproduce", "sensitivity", "--shard", "1/8"}, {"sensitivity", "1/8"}},
    };
    assert_all_refused(refusals, COUNT_OF(refusals));
}

/* Each kind of machine has its folder; a finished row replaces a failed one, whatever the order. */
static void kinds_of_machines_stay_apart(void **state)
{
    (void)state;
    struct csv csv;
    results_make("m1", (const char *const[]){"m", "p", "01"}, "one", "failed", "1");
    results_make("n1", (const char *const[]){"n, with more", "p", "01"}, "one", "ok", "3");
    results_make("m2", (const char *const[]){"m", "p", "01"}, "one", "ok", "2");
    results_make("m3", (const char *const[]){"m", "p", "01"}, "one", "failed", "4");
    char *told = program_output((const char *const[ARGUMENTS_MAX]){"merge", "m1", "n1", "m2", "m3", "-o", "apart"});
    assert_non_null(strstr(told, "apart/1: 1 cells of 3 folders, measured on m, v3\n"));
    assert_non_null(strstr(told, "apart/2: 1 cells of 1 folders, measured on n, with more, v3\n"));
    assert_non_null(strstr(told, "times of different ones are not compared"));
    free(told);
    for (int k = 0; k < 2; k++) {
        assert_int_equal(
            csv_read(path_in(k ? "apart/2/measurements.csv" : "apart/1/measurements.csv"), CSV_TAIL_KEEP, &csv),
            STATUS_OK);
        assert_int_equal(csv.row_count, 1);
        assert_string_equal(csv_cell(&csv, 0, csv_column(&csv, "run_s")), k ? "3" : "2");
        assert_string_equal(csv_cell(&csv, 0, csv_column(&csv, "host")), "node");
        assert_string_equal(csv_cell(&csv, 0, csv_column(&csv, "load")), "0.5");
        csv_free(&csv);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(merged_shards_are_the_run),
        cmocka_unit_test(stability_in_shards),
        cmocka_unit_test(mixtures_are_refused),
        cmocka_unit_test(kinds_of_machines_stay_apart),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
