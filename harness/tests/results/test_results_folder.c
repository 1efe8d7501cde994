/* The results folder through cuts and changes. */
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/results/results_fixture.h"

static void test_round_trip(void **state)
{
    (void)state;
    char host[HOST_NAME_MAX + 1] = "", wanted[200];
    struct results_folder *results = open_ok("c1", 2);
    assert_int_equal(gethostname(host, sizeof host - 1), 0);
    assert_int_equal(results_folder_scene(results, "folder/a,\"b\"", 0xabcdef), STATUS_OK);
    add_ok(results, "folder/a,\"b\"", "bp_sinc");
    const char *text = file_text(measurements_path);
    assert_int_equal(
        strncmp(text, "# sasbench measurements 1\n# machine: a machine\n# isa: v3\n# compiler: gcc?12\n", 72), 0);
    assert_non_null(strstr(text, "\n# commit: c1\n"));
    assert_non_null(strstr(text, "\n# threads: 2\n"));
    assert_non_null(strstr(text, "\n# scene folder/a,\"b\": 0000000000abcdef\n"));
    assert_non_null(strstr(
        text, "\n" MEASUREMENT_HEADER "\"folder/a,\"\"b\"\"\",bp_sinc,\"taps=8,window=none\",float,2,general,ok,,"
              "\"half \"\"of\"\" it,?and more\",0.25,0.333333333,0.3,5,2,compress=0.1;focus=0.9,,1e+12,"
              "1.23456789e+10,4096,1e-07,,0.001,0.0384,-13.3,-10.4,0.32,0.34,4.5,2,,"));
    snprintf(wanted, sizeof wanted, ",4.5,2,,%s,", host); /* and the load */
    assert_true(strtod(strstr(text, wanted) + strlen(wanted), NULL) >= 0);
    text = file_text(targets_path);
    assert_int_equal(strncmp(text, "# sasbench targets 1\n", 21), 0);
    assert_non_null(strstr(text, "\n" TARGET_HEADER "\"folder/a,\"\"b\"\"\",bp_sinc,\"taps=8,window=none\",float,3,"
                                 "azimuth,null,3,1e-05,,0.0384,-13.3,-10.4\n"));
    results_folder_close(results);

    results = open_ok("c1", 2);
    assert_int_equal(results_folder_scene(results, "folder/a,\"b\"", 0xabcdef), STATUS_OK);
    const struct measurement *row = find(results, "folder/a,\"b\"", "bp_sinc");
    assert_non_null(row);
    assert_string_equal(row->skipped, "half \"of\" it,?and more");
    assert_string_equal(row->reason, "");
    assert_int_equal(row->runs, 5);
    assert_close(row->run_s, 1.0 / 3, 1e-9);
    assert_close(row->islr_db, -10.4, 0);
    assert_true(isnan(row->flops_published) && isnan(row->error_gain));
    assert_null(find(results, "folder/a,\"b\"", "bp_linear"));
    assert_null(results_folder_find(results, "folder/a,\"b\"", "bp_sinc", "taps=8,window=none", "double"));
    assert_null(results_folder_find(results, "folder/a,\"b\"", "bp_sinc", "taps=4,window=none", "float"));
    add_ok(results, "folder/a,\"b\"", "bp_linear");
    results_folder_close(results);
    assert_int_equal(rows_of(measurements_path), 2);
    assert_int_equal(rows_of(targets_path), 2);
}

/* A row without the columns that later versions added is continued, and has them empty. */
static void test_earlier_columns(void **state)
{
    (void)state;
    static const char earlier[] = "scene,algorithm,options,precision,threads,engine,status,reason,skipped,plan_s,run_s,"
                                  "run_min_s,runs,control_s,stages,flops_published,flops,pairs,bytes,error,error_gain,"
                                  "phase_rms_rad,width_m,pslr_db,islr_db,run_q1_s,run_q3_s,entropy,contrast,"
                                  "peak_over_median\n",
                      row[] = "s,a,,float,2,,ok,,,1,1,1,5,,,,,,,,,,,,,,,,,7";
    char text[2000];
    snprintf(text, sizeof text, "# sasbench measurements 1\n" PROVENANCE "%s%s\n", earlier, row);
    file_write(measurements_path, "w", text);
    file_write(targets_path, "w", "# sasbench targets 1\n" PROVENANCE TARGET_HEADER);
    struct results_folder *results = open_ok("c1", 2);
    assert_non_null(results_folder_find(results, "s", "a", "", "float"));
    results_folder_close(results);
    snprintf(text, sizeof text, "\n%s%s,,,\n", MEASUREMENT_HEADER, row);
    assert_non_null(strstr(file_text(measurements_path), text));
}

static void test_undefined_fields(void **state)
{
    (void)state;
    struct results_folder *results = open_ok("c1", 2);
    struct measurement row = measurement_of("s", "rma_wu");
    row.status = "unsupported";
    row.reason = "the track is curved";
    row.runs = -1;
    row.run_s = row.plan_s = NAN;
    row.stages = NULL;
    assert_int_equal(results_folder_scene(results, "s", 1), STATUS_OK);
    assert_int_equal(results_folder_add(results, &row), STATUS_OK);
    results_folder_close(results);
    assert_non_null(strstr(file_text(measurements_path), "and more\",,,0.3,,2,,,1e+12"));
    results = open_ok("c1", 2);
    const struct measurement *found = find(results, "s", "rma_wu");
    assert_non_null(found);
    assert_string_equal(found->status, "unsupported");
    assert_string_equal(found->stages, "");
    assert_int_equal(found->runs, -1);
    assert_true(isnan(found->run_s));
    results_folder_close(results);
}

/* What `open` prints on standard error while it takes up the folder. */
static const char *opening_tells(const struct provenance *provenance, struct results_folder **results)
{
    static char text[2048];
    FILE *caught = tmpfile();
    int before = dup(STDERR_FILENO);
    assert_non_null(caught);
    assert_true(before >= 0 && dup2(fileno(caught), STDERR_FILENO) >= 0);
    enum status status = results_folder_open(results_directory, provenance, results);
    assert_true(dup2(before, STDERR_FILENO) >= 0);
    close(before);
    assert_int_equal(status, STATUS_OK);
    rewind(caught);
    text[fread(text, 1, sizeof text - 1, caught)] = '\0';
    fclose(caught);
    return text;
}

/* Rows of another machine, instruction set, library, commit, program or number of threads do not count, nor those whose
   targets are missing: the files are begun anew, the old ones are kept, and it is said. */
static void test_other_run(void **state)
{
    (void)state;
    static const char *const told[] = {
        "measured with commit 'c1', now with 'c2'",
        "measured with threads '2', now with '3'",
        "measured with program '0123', now with '4567'",
        "measured with machine 'a machine', now with 'another'",
        "measured with isa 'v3', now with 'baseline'",
        "measured with libraries 'some', now with 'others'",
        "targets.csv is missing",
    };
    char kept_measurements[300], kept_targets[300];
    snprintf(kept_measurements, sizeof kept_measurements, "%s/measurements.1.csv", results_directory);
    snprintf(kept_targets, sizeof kept_targets, "%s/targets.1.csv", results_directory);
    for (int change = 0; change < 7; change++) {
        struct provenance other = provenance_of(change == 0 ? "c2" : "c1", change == 1 ? 3 : 2);
        struct results_folder *results = open_ok("c1", 2);
        assert_int_equal(results_folder_scene(results, "s", 1), STATUS_OK);
        add_ok(results, "s", "bp_sinc");
        results_folder_close(results);
        if (change == 2)
            strcpy(other.program, "4567");
        if (change == 3)
            strcpy(other.machine, "another");
        if (change == 4)
            strcpy(other.isa, "baseline");
        if (change == 5)
            strcpy(other.libraries, "others");
        if (change == 6)
            assert_int_equal(remove(targets_path), 0);
        const char *text = opening_tells(&other, &results);
        assert_non_null(strstr(text, told[change]));
        assert_non_null(strstr(text, change == 6 ? "kept in measurements.1.csv\n"
                                                 : "kept in measurements.1.csv and targets.1.csv\n"));
        assert_null(find(results, "s", "bp_sinc"));
        results_folder_close(results);
        assert_int_equal(rows_of(measurements_path), 0);
        assert_int_equal(rows_of(targets_path), 0);
        assert_null(strstr(file_text(measurements_path), "# scene"));
        assert_int_equal(rows_of(kept_measurements), 1);
        assert_non_null(strstr(file_text(kept_measurements), "# scene s: "));
        assert_int_equal(remove(kept_measurements), 0);
        assert_int_equal(remove(kept_targets), change == 6 ? -1 : 0);
        /* Files without rows give way without a word. */
        assert_string_equal(opening_tells(&(struct provenance){.commit = "c3"}, &results), "");
        results_folder_close(results);
    }
}

/* What is kept a second time does not replace what was kept before. */
static void test_kept_twice(void **state)
{
    (void)state;
    for (int k = 1; k <= 3; k++) {
        struct results_folder *results = open_ok(k == 1 ? "c1" : k == 2 ? "c2" : "c3", 2);
        assert_int_equal(results_folder_scene(results, "s", 1), STATUS_OK);
        add_ok(results, "s", k == 1 ? "first" : k == 2 ? "second" : "third");
        results_folder_close(results);
    }
    static const char *const names[] = {"measurements.1.csv", "measurements.2.csv", "measurements.csv"};
    static const char *const algorithms_kept[] = {"s,first", "s,second", "s,third"};
    for (int k = 0; k < 3; k++) {
        char path[300];
        snprintf(path, sizeof path, "%s/%s", results_directory, names[k]);
        assert_int_equal(rows_of(path), 1);
        assert_non_null(strstr(file_text(path), algorithms_kept[k]));
    }
}

/* A row that failed is measured again, and gives way to what comes of it, and only to that. */
static void test_failed_again(void **state)
{
    (void)state;
    struct measurement row = measurement_of("s", "bp_sinc");
    struct results_folder *results = open_ok("c1", 2);
    row.status = "failed";
    row.reason = "no memory";
    assert_int_equal(results_folder_scene(results, "s", 1), STATUS_OK);
    assert_int_equal(results_folder_add(results, &row), STATUS_OK);
    add_ok(results, "s", "bp_linear");
    results_folder_close(results);
    for (int attempt = 0; attempt < 2; attempt++) {
        results = open_ok("c1", 2);
        assert_int_equal(results_folder_scene(results, "s", 1), STATUS_OK);
        assert_null(find(results, "s", "bp_sinc"));
        assert_non_null(find(results, "s", "bp_linear"));
        assert_int_equal(rows_of(measurements_path), 2);
        if (attempt == 0)
            assert_int_equal(results_folder_add(results, &row), STATUS_OK);
        else
            add_ok(results, "s", "bp_sinc");
        results_folder_close(results);
        assert_int_equal(rows_of(measurements_path), 2);
        assert_int_equal(rows_of(targets_path), 1 + attempt);
    }
    results = open_ok("c1", 2);
    assert_non_null(find(results, "s", "bp_sinc"));
    results_folder_close(results);
    assert_null(strstr(file_text(measurements_path), "failed"));
}

/* A folder belongs to one program at a time, in this process or another. The lock goes with the process. */
static void test_folder_is_locked(void **state)
{
    (void)state;
    struct provenance provenance = provenance_of("c1", 2);
    struct results_folder *first = open_ok("c1", 2), *second;
    assert_int_equal(results_folder_open(results_directory, &provenance, &second), STATUS_INVALID);
    assert_null(second);
    assert_non_null(strstr(status_message(), results_directory));
    assert_non_null(strstr(status_message(), "another sasbench is at work"));
    results_folder_close(first);
    int told[2];
    char byte;
    assert_int_equal(pipe(told), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        bool good =
            results_folder_open(results_directory, &provenance, &first) == STATUS_OK && write(told[1], "x", 1) == 1;
        if (good)
            pause();
        _exit(1);
    }
    assert_int_equal(read(told[0], &byte, 1), 1);
    assert_int_equal(results_folder_open(results_directory, &provenance, &second), STATUS_INVALID);
    kill(child, SIGKILL);
    assert_int_equal(waitpid(child, NULL, 0), child);
    results_folder_close(open_ok("c1", 2));
    close(told[0]);
    close(told[1]);
}

static void test_changed_scene(void **state)
{
    (void)state;
    struct results_folder *results = open_ok("c1", 2);
    assert_int_equal(results_folder_scene(results, "s", 1), STATUS_OK);
    add_ok(results, "s", "bp_sinc");
    assert_int_equal(results_folder_scene(results, "s: 2", 2), STATUS_OK);
    add_ok(results, "s: 2", "bp_sinc");
    results_folder_close(results);
    results = open_ok("c1", 2);
    assert_int_equal(results_folder_scene(results, "s: 2", 2), STATUS_OK);
    assert_int_equal(results_folder_scene(results, "s", 3), STATUS_OK);
    assert_null(find(results, "s", "bp_sinc"));
    char kept[300]; /* with the row that went */
    snprintf(kept, sizeof kept, "%s/measurements.1.csv", results_directory);
    assert_int_equal(rows_of(kept), 2);
    assert_non_null(find(results, "s: 2", "bp_sinc"));
    assert_int_equal(rows_of(measurements_path), 1);
    assert_int_equal(rows_of(targets_path), 1);
    assert_null(strstr(file_text(measurements_path), "# scene s: 0000000000000001"));
    assert_non_null(strstr(file_text(measurements_path), "# scene s: 0000000000000003"));
    add_ok(results, "s", "bp_sinc");
    results_folder_close(results);
    results = open_ok("c1", 2);
    assert_int_equal(results_folder_scene(results, "s", 3), STATUS_OK);
    assert_non_null(find(results, "s", "bp_sinc"));
    results_folder_close(results);
}

/* The measurements cut at every byte of their last row: whole rows are kept, and targets without one go. */
static void test_cut_row(void **state)
{
    (void)state;
    struct results_folder *results = open_ok("c1", 2);
    assert_int_equal(results_folder_scene(results, "s", 1), STATUS_OK);
    add_ok(results, "s", "first");
    struct stat before, after;
    assert_int_equal(stat(measurements_path, &before), 0);
    add_ok(results, "s", "second");
    results_folder_close(results);
    assert_int_equal(stat(measurements_path, &after), 0);
    for (off_t size = after.st_size - 1; size >= before.st_size; size--) {
        assert_int_equal(truncate(measurements_path, size), 0);
        results = open_ok("c1", 2);
        assert_int_equal(results_folder_scene(results, "s", 1), STATUS_OK);
        assert_non_null(find(results, "s", "first"));
        assert_null(find(results, "s", "second"));
        assert_int_equal(rows_of(targets_path), 1);
        add_ok(results, "s", "second");
        results_folder_close(results);
        assert_int_equal(rows_of(measurements_path), 2);
        assert_int_equal(rows_of(targets_path), 2);
    }
    /* Targets whose measurement was never finished. */
    file_write(targets_path, "a", "s,third,\"taps=8,window=none\",float,0,azimuth,null,,,,,,\ns,third,\"ta");
    results_folder_close(open_ok("c1", 2));
    assert_int_equal(rows_of(targets_path), 2);
    assert_null(strstr(file_text(targets_path), "third"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_round_trip, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_earlier_columns, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_undefined_fields, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_other_run, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_kept_twice, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_failed_again, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_folder_is_locked, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_changed_scene, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_cut_row, results_make, results_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
