/* What is written into results, foreign files, places that cannot be written, and the terminal's table. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "show/table.h"
#include "tests/results/results_fixture.h"

static void check_refused(const char *place)
{
    struct provenance provenance = provenance_of("c1", 2);
    struct results_folder *results = (struct results_folder *)&provenance;
    static char before[65536];
    snprintf(before, sizeof before, "%s", file_text(measurements_path));
    assert_int_equal(results_folder_open(results_directory, &provenance, &results), STATUS_INVALID);
    assert_null(results);
    assert_non_null(strstr(status_message(), place));
    assert_string_equal(file_text(measurements_path), before);
}

static void test_foreign_files(void **state)
{
    (void)state;
    file_write(measurements_path, "w", "my,own\ndata,1\n");
    check_refused("measurements.csv:1: the first line is not '# sasbench");
    file_write(measurements_path, "w", "");
    check_refused("measurements.csv:1: the first line is not '# sasbench");
    file_write(measurements_path, "w", "# sasbench measurements 2\na\n");
    check_refused("measurements.csv:1: the first line is not '# sasbench");
    file_write(measurements_path, "w", "# sasbench measurements 1\na,b\n1\n");
    check_refused("measurements.csv:3: 1 fields");
    file_write(measurements_path, "w",
               "# sasbench measurements 1\n" PROVENANCE MEASUREMENT_HEADER
               "s,a,,float,2,,ok,,,1,1,1,x,,,,,,,,,,,,,,,,,,,,\n");
    file_write(targets_path, "w", "# sasbench targets 1\n" PROVENANCE TARGET_HEADER);
    check_refused("measurements.csv:9: runs is 'x'");
    file_write(measurements_path, "w", "# sasbench measurements 1\n" PROVENANCE "scene,algorithm\n");
    check_refused("measurements.csv: column 3 is missing; 'options' is needed");
    struct results read;
    file_write(measurements_path, "w", "# sasbench measurements 1\n" PROVENANCE);
    assert_int_equal(results_read(measurements_path, &read), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "no line names the columns; 33 names from 'scene' on are needed"));
    file_write(measurements_path, "w", "# sasbench measurements 1\n" PROVENANCE MEASUREMENT_COLUMNS ",more\n");
    assert_int_equal(results_read(measurements_path, &read), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "column 34 is 'more'; 33 columns are needed"));
    remove(measurements_path);
    results_folder_close(open_ok("c1", 2));
    file_write(targets_path, "w", "notes\n");
    check_refused("targets.csv:1: the first line is not '# sasbench");
}

static void test_unwritable(void **state)
{
    (void)state;
    struct provenance provenance = provenance_of("c1", 2);
    struct results_folder *results;
    char below[320];
    file_write(measurements_path, "w", "a file\n");
    snprintf(below, sizeof below, "%s/folder", measurements_path);
    assert_int_equal(results_folder_open(below, &provenance, &results), STATUS_INVALID);
    assert_non_null(strstr(status_message(), below));
    assert_int_equal(results_folder_open(measurements_path, &provenance, &results), STATUS_INVALID);
    assert_int_equal(results_folder_open("/proc/sasbench", &provenance, &results), STATUS_INVALID);
    assert_int_equal(results_folder_open("/proc", &provenance, &results), STATUS_INVALID);
    assert_null(results);
}

static void test_folder_made(void **state)
{
    (void)state;
    struct provenance provenance = provenance_of("c1", 2);
    struct results_folder *results;
    char outer[300], inner[320], path[360];
    snprintf(outer, sizeof outer, "%s/outer", results_directory);
    snprintf(inner, sizeof inner, "%s/inner", outer);
    snprintf(path, sizeof path, "%s//", inner);
    assert_int_equal(results_folder_open(path, &provenance, &results), STATUS_OK);
    results_folder_close(results);
    snprintf(path, sizeof path, "%s/measurements.csv", inner);
    assert_int_equal(remove(path), 0);
    snprintf(path, sizeof path, "%s/targets.csv", inner);
    assert_int_equal(remove(path), 0);
    assert_int_equal(rmdir(inner), 0);
    assert_int_equal(rmdir(outer), 0);
}

static void check_rights(const char *path, mode_t mask)
{
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    if ((info.st_mode & 0777) != (0666 & ~mask))
        fail_msg("%s has the rights %03o under umask %03o", path, (unsigned)info.st_mode & 0777, (unsigned)mask);
}

/* New files are readable as any program's, by the user's umask, whether made in place or beside it. */
static void test_rights_follow_umask(void **state)
{
    (void)state;
    static const mode_t masks[] = {022, 027, 077, 0};
    char beside[320];
    snprintf(beside, sizeof beside, "%s/beside.csv", results_directory);
    for (size_t k = 0; k < sizeof masks / sizeof *masks; k++) {
        const mode_t before = umask(masks[k]);
        struct results_folder *results = open_ok("c1", 2);
        assert_int_equal(results_folder_scene(results, "s", 1), STATUS_OK);
        results_folder_close(results);
        assert_int_equal(measurements_write(beside, "a note", NULL, 0, NULL, 0), STATUS_OK);
        check_rights(measurements_path, masks[k]);
        check_rights(targets_path, masks[k]);
        check_rights(beside, masks[k]);
        assert_true(remove(measurements_path) == 0 && remove(targets_path) == 0 && remove(beside) == 0);
        assert_int_equal(umask(before), masks[k]);
    }
}

/* A time that is none makes no figure. */
static void test_times_are_positive(void **state)
{
    (void)state;
    static const struct {
        const char *times, *fault; /* plan_s to control_s */
    } cases[] = {{"1,0,0,3,1,", "measurements.csv:9: run_s is '0'; a number > 0 or nothing is needed"},
                 {"1,-0.5,1,3,1,", ":9: run_s is '-0.5'"},
                 {"1,1,-0,3,1,", ":9: run_min_s is '-0'"},
                 {"1,1,1,3,-2,", ":9: control_s is '-2'"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct results read;
        char text[2000];
        snprintf(text, sizeof text,
                 "# sasbench measurements 1\n" PROVENANCE MEASUREMENT_HEADER
                 "s,a,,float,2,,ok,,,%s,,,,,,,,,,,,,,,,,,\n",
                 cases[k].times);
        file_write(measurements_path, "w", text);
        assert_int_equal(results_read(measurements_path, &read), STATUS_INVALID);
        if (!strstr(status_message(), cases[k].fault))
            fail_msg("'%s' is not '%s'", status_message(), cases[k].fault);
    }
    assert_string_equal(cell_time(0).text, "-");
    assert_string_equal(cell_time(-1e-3).text, "-");
    assert_string_equal(cell_time(2e-3).text, "2 ms");
}

/* A full disk, acted by a limit of the file size: said at once, and the next run finds whole rows only. */
static void test_full_disk(void **state)
{
    (void)state;
    struct results_folder *results = open_ok("c1", 2);
    assert_int_equal(results_folder_scene(results, "s", 1), STATUS_OK);
    add_ok(results, "s", "first");
    struct stat info;
    struct rlimit before, limit;
    assert_int_equal(stat(measurements_path, &info), 0);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    limit = before;
    limit.rlim_cur = (rlim_t)info.st_size + 20;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    struct measurement row = measurement_of("s", "second");
    enum status status = results_folder_add(results, &row);
    limit.rlim_cur = 100;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    enum status scene_status = results_folder_scene(results, "t", 2);
    enum status add_status = results_folder_add(results, &row);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    signal(SIGXFSZ, SIG_DFL);
    assert_int_equal(status, STATUS_FAILED);
    assert_int_not_equal(scene_status, STATUS_OK);
    assert_int_equal(add_status, STATUS_FAILED);
    results_folder_close(results);
    results = open_ok("c1", 2);
    assert_non_null(find(results, "s", "first"));
    assert_null(find(results, "s", "second"));
    results_folder_close(results);
    assert_int_equal(rows_of(measurements_path), 1);
}

static void test_provenance(void **state)
{
    (void)state;
    struct provenance a, b;
    provenance_fill(&a, 7);
    provenance_fill(&b, 7);
    assert_int_equal(a.threads, 7);
    assert_int_equal(strlen(a.program), 16);
    assert_string_equal(a.program, b.program);
    assert_non_null(strstr(a.machine, " GiB"));
    assert_non_null(strstr(a.libraries, "fftw-3."));
    assert_non_null(strstr(a.libraries, "matio-1."));
    assert_non_null(strstr(a.libraries, "libconfig-1."));
    assert_true(*a.compiler && *a.flags && *a.commit);
    assert_int_equal(strlen(a.date), strlen("2000-01-01T00:00:00Z"));
}

/* Every field of a row is a column, in the same order, so that none is left as it was. */
static void check_columns(const struct column *columns, size_t size)
{
    const struct column *column = columns;
    assert_int_equal(column->offset, 0);
    for (; column[1].name; column++)
        if (column[1].offset - column->offset != 8)
            fail_msg("a field between %s and %s is no column", column->name, column[1].name);
    assert_int_equal(column->offset + 8, size);
}

static void test_columns(void **state)
{
    (void)state;
    check_columns(measurement_columns, sizeof(struct measurement));
    check_columns(target_columns, sizeof(struct target_row));
    const struct measurement row = measurement_empty("s", "a", "", PRECISION_FLOAT), full = measurement_of("s", "a");
    int count = 0;
    for (const struct column *column = measurement_columns; column->name; column++) {
        const char *field = (const char *)&row + column->offset;
        if (column->type == COLUMN_REAL)
            assert_true(isnan(*(const double *)field));
        if (column->type == COLUMN_INTEGER)
            assert_int_equal(*(const int *)field, -1);
    }
    for (const struct column *metric = metric_first(measurement_columns); metric; metric = metric_first(metric + 1)) {
        count++;
        assert_true(metric->type == COLUMN_REAL
                    && metric->absolute_slack[PRECISION_FLOAT] >= metric->absolute_slack[PRECISION_DOUBLE]
                    && metric->absolute_slack[PRECISION_DOUBLE] >= 0 && metric->relative_slack >= 0);
        double value = *(const double *)((const char *)&full + metric->offset);
        if (strcmp(metric->name, "pslr_db") == 0)
            assert_close(value, -13.3, 0);
        if (strcmp(metric->name, "run_s") == 0)
            assert_close(value, 1.0 / 3, 0);
    }
    assert_int_equal(count, 15);
}

static void test_table(void **state)
{
    (void)state;
    static char text[8192];
    FILE *stream = fmemopen(text, sizeof text, "w");
    assert_non_null(stream);
    struct measurement row = measurement_of("bp22/table3", "bp_sinc");
    table_begin(stream, false);
    table_row(stream, &row);
    row.algorithm = "bp_linear";
    row.options = "beta=8";
    row.precision = "double";
    row.run_s = 2.5e-5;
    row.pairs = 0;
    row.flops = 1e6;
    row.phase_rms_rad = NAN;
    table_row(stream, &row);
    row.options = "";
    row.run_s = NAN;
    row.pairs = NAN;
    table_row(stream, &row);
    row.algorithm = "rma_lbf";
    row.options = "variant=corrected,blocks=8,spacing=inverse,blend=linear,stolt=8";
    row.run_s = 1234.4;
    table_row(stream, &row);
    row.scene = "study/point";
    row.status = "unsupported";
    row.reason = "the track is not uniform and straight, which range migration needs: ping 17 lies 0.0123 m away "
                 "from its place in the line through all the others, 0.00001 m are accepted";
    table_row(stream, &row);
    table_scene_end(stream);
    table_columns(stream);
    fclose(stream);
    int headings = 0;
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
        if (strlen(line) > 110)
            fail_msg("%zu columns: %s", strlen(line), line);
        headings += strcmp(line, "bp22/table3") == 0 || strcmp(line, "study/point") == 0;
        if (strncmp(line, "  bp_sinc ", 10) == 0) { /* without its defaults */
            assert_non_null(strstr(line, " 333 ms "));
            assert_non_null(strstr(line, " 6x "));
            assert_non_null(strstr(line, " 37 Gp/s "));
            assert_non_null(strstr(line, " 1.0e-07       - 1.0e-03  38.40 -13.30 -10.40"));
        }
        if (strncmp(line, "  bp_linear:precision=double ", 29) == 0)
            headings +=
                (strstr(line, " 25 us ") && strstr(line, " 40 GF/s ")) || strstr(line, "  -        -         - ");
        headings += 10 * (strstr(line, " 1234 s ") != NULL) + 100 * (strstr(line, "0.00001 m are accepted") != NULL);
    }
    assert_int_equal(headings, 114);
}

/* At 80 columns; what is refused for one reason is told once; sharpness where there are no lobes. */
static void test_narrow_table(void **state)
{
    (void)state;
    static char text[8192];
    FILE *stream = fmemopen(text, sizeof text, "w");
    assert_non_null(stream);
    struct measurement row = measurement_of("tank", "bp_sinc");
    setenv("COLUMNS", "80", 1);
    table_begin(stream, false);
    row.pslr_db = row.islr_db = row.width_m = NAN;
    row.peak_over_median = 241.4;
    row.reason =
        "no point targets to measure lobes of; warning: condition ghost: spacing is 2, limit 1; warning: times "
        "scatter: the middle half of 5 runs spans 30 % of the median";
    table_row(stream, &row);
    row.reason = "warning: condition ghost: spacing is 2, limit 1; warning: condition doppler: beam is 3, limit 1";
    table_row(stream, &row);
    row.options = "";
    row.status = "unsupported";
    static const char *const refused[] = {"wk_classic", "wk_squint", "wk_polar"};
    char reason[200];
    for (int k = 0; k < 3; k++) {
        row.algorithm = refused[k];
        snprintf(reason, sizeof reason, "%s: condition one_receiver: the number of receivers is 8; at most 1 is needed",
                 refused[k]);
        row.reason = reason;
        table_row(stream, &row);
    }
    row.scene = "another";
    table_row(stream, &row);
    table_scene_end(stream);
    table_works_header(stream);
    table_work(
        stream, "bp_sinc:taps=8,window=none",
        &(struct work){.flops = 1e9, .published = {{"BP22 Eq. (11) + sinc load", 1e9}, {"LBF21 Eq. (23)", 1e9}}});
    unsetenv("COLUMNS");
    fclose(stream);
    int said = 0, referred = 0, warned = 0;
    assert_non_null(strstr(text, " 333 ms~ "));
    assert_non_null(strstr(text, "    warning: condition ghost: spacing is 2, limit 1\n"));
    assert_null(strstr(text, "times scatter"));
    assert_non_null(strstr(text, " entro. contr.   peak\n"));
    assert_non_null(strstr(text, "   4.50      2    241\n"));
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
        if (strlen(line) > 80)
            fail_msg("%zu columns: %s", strlen(line), line);
        said += strstr(line, "condition one_receiver: ") != NULL;
        warned += strstr(line, "warning: condition ghost: ") != NULL;
        warned += 10 * (strstr(line, "warning: condition doppler: ") != NULL);
        referred += strstr(line, "  refused: wk_classic, wk_squint, wk_polar: condition one_receiver: ") != NULL;
    }
    assert_int_equal(said, 2); /* once a scene, of all in a line */
    assert_int_equal(warned, 11);
    assert_int_equal(referred, 1);
}

/* Of many rows a line for each scene: how many images, what was refused and warned of, and what failed and why. */
static void test_brief_table(void **state)
{
    (void)state;
    static char text[2048];
    FILE *stream = fmemopen(text, sizeof text, "w");
    assert_non_null(stream);
    setenv("COLUMNS", "80", 1);
    table_begin(stream, true);
    struct measurement row = measurement_of("one", "bp_sinc");
    table_scene(stream, "one", "9 pixels");
    table_warning(stream, "warning: condition motion: rms is 2, limit 0.1");
    row.reason = "warning: condition ghost: spacing is 2, limit 1; warning: times scatter: much; "
                 "warning: target 5: no patch holds it; warning: 4 more targets likewise";
    table_row(stream, &row);
    table_row(stream, &row);
    row.status = "unsupported";
    table_row(stream, &row);
    row.scene = "two";
    row.status = "failed";
    row.reason = "no memory";
    table_row(stream, &row);
    table_scene_end(stream);
    table_scene_end(stream);
    unsetenv("COLUMNS");
    fclose(stream);
    assert_string_equal(text, "one                       2 images, 1 refused, warned: motion, ghost, target 5\n"
                              "not measured\n"
                              "  two: bp_sinc\n    failed: no memory\n"
                              "two                       0 images, 1 failed\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_foreign_files, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_unwritable, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_folder_made, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_rights_follow_umask, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_times_are_positive, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_full_disk, results_make, results_remove),
        cmocka_unit_test(test_provenance),
        cmocka_unit_test(test_columns),
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_narrow_table),
        cmocka_unit_test(test_brief_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
