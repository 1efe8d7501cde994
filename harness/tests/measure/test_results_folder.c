/* CSV files, the results folder through cuts and changes, and the terminal's table. */
#include <locale.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "data/csv.h"
#include "measure/results_folder.h"
#include "show/table.h"
#include "tests/assertions.h"

#define MEASUREMENT_HEADER                                                                                             \
    "scene,algorithm,options,precision,threads,engine,status,reason,skipped,plan_s,run_s,run_min_s,runs,control_s,"    \
    "stages,flops_published,flops,pairs,bytes,error,error_gain,phase_rms_rad,width_m,pslr_db,islr_db\n"
#define PROVENANCE "# machine: a machine\n# isa: v3\n# libraries: some\n# commit: c1\n# program: 0123\n# threads: 2\n"
#define TARGET_HEADER                                                                                                  \
    "scene,algorithm,options,precision,target,axis,definition,extent_m,position_error_m,phase_error_rad,width_m,"      \
    "pslr_db,islr_db\n"

/* --- A folder of its own for every test ---------------------------------------------------------------------- */

static char folder[256], measurements_path[300], targets_path[300];

static int folder_make(void **state)
{
    (void)state;
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/sasbench-XXXXXX", base ? base : "/tmp");
    if (!mkdtemp(folder))
        return -1;
    snprintf(measurements_path, sizeof measurements_path, "%s/measurements.csv", folder);
    snprintf(targets_path, sizeof targets_path, "%s/targets.csv", folder);
    return 0;
}

static int folder_remove(void **state)
{
    (void)state;
    static const char *const kept[] = {"measurements.1.csv", "measurements.2.csv", "targets.1.csv", "targets.2.csv"};
    remove(measurements_path);
    remove(targets_path);
    for (size_t k = 0; k < sizeof kept / sizeof *kept; k++) {
        char path[300];
        snprintf(path, sizeof path, "%s/%s", folder, kept[k]);
        remove(path);
    }
    return rmdir(folder); /* fails when a temporary file was left behind */
}

static void file_write(const char *path, const char *mode, const char *text)
{
    FILE *file = fopen(path, mode);
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static char *file_text(const char *path)
{
    static char text[1 << 16];
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    size_t size = fread(text, 1, sizeof text - 1, file);
    text[size] = '\0';
    fclose(file);
    return text;
}

/* --- CSV ----------------------------------------------------------------------------------------------------- */

static void test_csv_read(void **state)
{
    (void)state;
    struct csv csv;
    file_write(measurements_path, "w",
               "# key: first\r\n# other: x: y\na,\"b,c\",\r\n1,\"say \"\"hi\"\", there\",\n\n#between: rows\n"
               "\"# no comment\",,3\n,\"\",\"last\"");
    assert_int_equal(csv_read(measurements_path, CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_int_equal(csv.column_count, 3);
    assert_int_equal(csv_column(&csv, "b,c"), 1);
    assert_int_equal(csv_column(&csv, "none"), -1);
    assert_int_equal(csv.row_count, 3);
    assert_string_equal(csv_cell(&csv, 0, 1), "say \"hi\", there");
    assert_string_equal(csv_cell(&csv, 0, 2), "");
    assert_string_equal(csv_cell(&csv, 1, 0), "# no comment");
    assert_string_equal(csv_cell(&csv, 1, 2), "3");
    assert_string_equal(csv_cell(&csv, 2, 2), "last");
    assert_int_equal(csv.lines[0], 4);
    assert_int_equal(csv.lines[1], 7);
    assert_int_equal(csv.comment_count, 3);
    assert_string_equal(csv_comment(&csv, "key"), "first");
    assert_string_equal(csv_comment(&csv, "other"), "x: y");
    assert_string_equal(csv_comment(&csv, "between"), "rows");
    assert_null(csv_comment(&csv, "ke"));
    csv_free(&csv);
    assert_int_equal(csv_read(measurements_path, CSV_TAIL_DROP, &csv), STATUS_OK);
    assert_int_equal(csv.row_count, 2);
    csv_free(&csv);
    file_write(measurements_path, "w", "\xef\xbb\xbf# key: first\na\n1\n"); /* a byte order mark */
    assert_int_equal(csv_read(measurements_path, CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_string_equal(csv_comment(&csv, "key"), "first");
    assert_int_equal(csv_column(&csv, "a"), 0);
    csv_free(&csv);
    file_write(measurements_path, "w", "");
    assert_int_equal(csv_read(measurements_path, CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_int_equal(csv.column_count + csv.row_count, 0);
    csv_free(&csv);
}

static void test_csv_faults(void **state)
{
    (void)state;
    static const struct {
        const char *text, *place;
    } faults[] = {
        {"a,b\n1,2\n3\n", ":3: 1 fields"},
        {"a,b\n1,2,3\n", ":2: 3 fields"},
        {"a\n\"x\"z\n", ":2: stray"},
        {"a\n1\n\"x\n2\n", ":3: a quoted field never ends"},
        {"a\nx\"y\n", ":2: stray"},
        {"a\nx\ry\n", ":2:2: control character 0x0d"},
        {"a\nb\n\x1b[31mc\n", ":3:1: control character 0x1b"},
        {"a\n\"b\tc\"\n", ":2:3: control character 0x09"},
        {"# k: v\x07\na\n", ":1:7: control character 0x07"},
        {"a\nb\x7f\n", ":2:2: control character 0x7f"},
    };
    struct csv csv;
    for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
        file_write(measurements_path, "w", faults[k].text);
        assert_int_equal(csv_read(measurements_path, CSV_TAIL_KEEP, &csv), STATUS_INVALID);
        assert_non_null(strstr(status_message(), measurements_path));
        assert_non_null(strstr(status_message(), faults[k].place));
        assert_null(csv.text);
    }
    FILE *file = fopen(measurements_path, "w");
    assert_non_null(file);
    fwrite("a\n1\0\n", 1, 5, file);
    fclose(file);
    assert_int_equal(csv_read(measurements_path, CSV_TAIL_KEEP, &csv), STATUS_INVALID);
    assert_int_equal(csv_read(folder, CSV_TAIL_KEEP, &csv), STATUS_INVALID);
    assert_int_equal(csv_read(targets_path, CSV_TAIL_KEEP, &csv), STATUS_INVALID);
    assert_int_equal(csv_read("/dev/zero", CSV_TAIL_KEEP, &csv), STATUS_INVALID);
    assert_int_equal(mkfifo(targets_path, 0600), 0);
    assert_int_equal(csv_read(targets_path, CSV_TAIL_KEEP, &csv), STATUS_INVALID); /* without a wait for a writer */
    remove(targets_path);
}

/* A text cut at every byte: what is left are its whole lines. */
static void test_csv_cut(void **state)
{
    (void)state;
    static const char head[] = "# c \" d\na,b\n", row_1[] = "1,\"x\"\"y,\"\n", comment[] = "#\"\n";
    static const char row_2[] = "\"\",2\n";
    char text[128];
    snprintf(text, sizeof text, "%s%s%s%s", head, row_1, comment, row_2);
    int whole = (int)strlen(text), first = (int)(strlen(head) + strlen(row_1));
    struct csv csv;
    for (int length = 0; length <= whole; length++) {
        char cut[sizeof text];
        snprintf(cut, sizeof cut, "%.*s", length, text);
        file_write(measurements_path, "w", cut);
        assert_int_equal(csv_read(measurements_path, CSV_TAIL_DROP, &csv), STATUS_OK);
        assert_int_equal(csv.row_count, (length >= first) + (length >= whole));
        csv_free(&csv);
    }
}

static void test_csv_numbers(void **state)
{
    (void)state;
    double value;
    assert_true(csv_number("", &value) && isnan(value));
    assert_true(csv_number("-1.5e-3", &value) && value == -1.5e-3);
    assert_true(csv_number("inf", &value) && isinf(value));
    assert_false(csv_number("1,5", &value));
    assert_false(csv_number(" 1", &value));
    assert_false(csv_number("1 ", &value));
    assert_false(csv_number("x", &value));
    /* A decimal comma of the caller's locale changes nothing (where such a locale is installed). */
    setlocale(LC_ALL, "de_DE.UTF-8");
    char text[64] = "";
    FILE *file = fmemopen(text, sizeof text, "w");
    assert_non_null(file);
    csv_write_number(file, 0.1234567891234);
    csv_write_text(file, ",");
    csv_write_number(file, NAN);
    csv_write_text(file, NULL);
    fclose(file);
    assert_string_equal(text, "0.123456789\",\"");
    assert_true(csv_number("0.5", &value) && value == 0.5);
    setlocale(LC_ALL, "C");
}

/* --- The results folder -------------------------------------------------------------------------------------- */

static struct provenance provenance_of(const char *commit, int threads)
{
    struct provenance provenance = {.machine = "a machine",
                                    .isa = "v3",
                                    .libraries = "some",
                                    .compiler = "gcc\n12",
                                    .program = "0123",
                                    .date = "today",
                                    .threads = threads};
    snprintf(provenance.commit, sizeof provenance.commit, "%s", commit);
    return provenance;
}

static struct measurement measurement_of(const char *scene, const char *algorithm)
{
    return (struct measurement){.scene = scene,
                                .algorithm = algorithm,
                                .options = "taps=8,window=none",
                                .precision = "float",
                                .threads = 2,
                                .engine = "general",
                                .status = "ok",
                                .reason = "",
                                .skipped = "half \"of\" it,\nand more",
                                .plan_s = 0.25,
                                .run_s = 1.0 / 3,
                                .run_min_s = 0.3,
                                .runs = 5,
                                .control_s = 2,
                                .stages = "compress=0.1;focus=0.9",
                                .flops_published = NAN,
                                .flops = 1e12,
                                .pairs = 12345678901.0,
                                .bytes = 4096,
                                .error = 1e-7,
                                .error_gain = NAN,
                                .phase_rms_rad = 0.001,
                                .width_m = 0.0384,
                                .pslr_db = -13.3,
                                .islr_db = -10.4};
}

static struct target_row target_of(const char *scene, const char *algorithm)
{
    return (struct target_row){
        scene, algorithm, "taps=8,window=none", "float", 3, "azimuth", "null", 3, 1e-5, NAN, 0.0384, -13.3, -10.4};
}

static struct results_folder *open_ok(const char *commit, int threads)
{
    struct provenance provenance = provenance_of(commit, threads);
    struct results_folder *results = NULL;
    assert_int_equal(results_folder_open(folder, &provenance, &results), STATUS_OK);
    assert_non_null(results);
    return results;
}

static void add_ok(struct results_folder *results, const char *scene, const char *algorithm)
{
    struct target_row target = target_of(scene, algorithm);
    struct measurement row = measurement_of(scene, algorithm);
    assert_int_equal(results_folder_targets(results, &target, 1), STATUS_OK);
    assert_int_equal(results_folder_add(results, &row), STATUS_OK);
}

static const struct measurement *find(const struct results_folder *results, const char *scene, const char *algorithm)
{
    return results_folder_find(results, scene, algorithm, "taps=8,window=none", "float");
}

static int rows_of(const char *path)
{
    struct csv csv;
    assert_int_equal(csv_read(path, CSV_TAIL_KEEP, &csv), STATUS_OK);
    int rows = csv.row_count;
    csv_free(&csv);
    return rows;
}

static void test_round_trip(void **state)
{
    (void)state;
    struct results_folder *results = open_ok("c1", 2);
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
              "1.23456789e+10,4096,1e-07,,0.001,0.0384,-13.3,-10.4\n"));
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
    enum status status = results_folder_open(folder, provenance, results);
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
    snprintf(kept_measurements, sizeof kept_measurements, "%s/measurements.1.csv", folder);
    snprintf(kept_targets, sizeof kept_targets, "%s/targets.1.csv", folder);
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
        snprintf(path, sizeof path, "%s/%s", folder, names[k]);
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
    assert_int_equal(results_folder_open(folder, &provenance, &second), STATUS_INVALID);
    assert_null(second);
    assert_non_null(strstr(status_message(), folder));
    assert_non_null(strstr(status_message(), "another sasbench is at work"));
    results_folder_close(first);
    int told[2];
    char byte;
    assert_int_equal(pipe(told), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        bool good = results_folder_open(folder, &provenance, &first) == STATUS_OK && write(told[1], "x", 1) == 1;
        if (good)
            pause();
        _exit(1);
    }
    assert_int_equal(read(told[0], &byte, 1), 1);
    assert_int_equal(results_folder_open(folder, &provenance, &second), STATUS_INVALID);
    kill(child, SIGKILL);
    assert_int_equal(waitpid(child, NULL, 0), child);
    results_folder_close(open_ok("c1", 2));
    close(told[0]);
    close(told[1]);
}

/* What a killed run left on its way to its place goes with the next; other files stay. */
static void test_swept(void **state)
{
    (void)state;
    static const char *const names[] = {".sasbench-A1b2C3", ".sasbench-folder", ".sasbench-folder/run.gp", "mine.tmp"};
    char paths[4][300];
    for (int k = 0; k < 4; k++) {
        snprintf(paths[k], sizeof paths[k], "%s/%s", folder, names[k]);
        if (k == 1)
            assert_int_equal(mkdir(paths[k], 0700), 0);
        else
            file_write(paths[k], "w", "half");
    }
    results_folder_close(open_ok("c1", 2));
    for (int k = 0; k < 4; k++)
        assert_int_equal(access(paths[k], F_OK), k == 3 ? 0 : -1);
    assert_int_equal(remove(paths[3]), 0);
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
    snprintf(kept, sizeof kept, "%s/measurements.1.csv", folder);
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

static void check_refused(const char *place)
{
    struct provenance provenance = provenance_of("c1", 2);
    struct results_folder *results = (struct results_folder *)&provenance;
    static char before[65536];
    snprintf(before, sizeof before, "%s", file_text(measurements_path));
    assert_int_equal(results_folder_open(folder, &provenance, &results), STATUS_INVALID);
    assert_null(results);
    assert_non_null(strstr(status_message(), place));
    assert_string_equal(file_text(measurements_path), before);
}

static void test_foreign_files(void **state)
{
    (void)state;
    file_write(measurements_path, "w", "my,own\ndata,1\n");
    check_refused("measurements.csv:1: not a file of ours");
    file_write(measurements_path, "w", "");
    check_refused("measurements.csv:1: not a file of ours");
    file_write(measurements_path, "w", "# sasbench measurements 2\na\n");
    check_refused("measurements.csv:1: not a file of ours");
    file_write(measurements_path, "w", "# sasbench measurements 1\na,b\n1\n");
    check_refused("measurements.csv:3: 1 fields");
    file_write(measurements_path, "w",
               "# sasbench measurements 1\n" PROVENANCE MEASUREMENT_HEADER "s,a,,float,2,,ok,,,1,1,1,x,,,,,,,,,,,,\n");
    file_write(targets_path, "w", "# sasbench targets 1\n" PROVENANCE TARGET_HEADER);
    check_refused("measurements.csv:9: runs is 'x'");
    file_write(measurements_path, "w", "# sasbench measurements 1\n" PROVENANCE "scene,algorithm\n");
    check_refused("measurements.csv: the header line");
    remove(measurements_path);
    results_folder_close(open_ok("c1", 2));
    file_write(targets_path, "w", "notes\n");
    check_refused("targets.csv:1: not a file of ours");
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
    snprintf(outer, sizeof outer, "%s/outer", folder);
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

/* --- What is written into the files -------------------------------------------------------------------------- */

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

/* The metric table names columns of the CSV and points to their values. */
static void test_metric_table(void **state)
{
    (void)state;
    struct measurement row = measurement_of("s", "a");
    int count = 0;
    for (const struct metric *metric = metrics; metric->name; metric++, count++) {
        char column[64];
        snprintf(column, sizeof column, ",%s", metric->name);
        assert_non_null(strstr(MEASUREMENT_HEADER, column));
        assert_true(metric->unit && metric->title
                    && metric->absolute_slack[PRECISION_FLOAT] >= metric->absolute_slack[PRECISION_DOUBLE]
                    && metric->absolute_slack[PRECISION_DOUBLE] >= 0 && metric->relative_slack >= 0);
        double value = *(const double *)((const char *)&row + metric->offset);
        if (strcmp(metric->name, "pslr_db") == 0)
            assert_close(value, -13.3, 0);
        if (strcmp(metric->name, "run_s") == 0)
            assert_close(value, 1.0 / 3, 0);
    }
    assert_int_equal(count, 11);
}

static void test_table(void **state)
{
    (void)state;
    static char text[8192];
    FILE *stream = fmemopen(text, sizeof text, "w");
    assert_non_null(stream);
    struct measurement row = measurement_of("bp22/table3", "bp_sinc");
    table_header(stream);
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
    fclose(stream);
    int headings = 0;
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
        if (strlen(line) > 110)
            fail_msg("%zu columns: %s", strlen(line), line);
        headings += strcmp(line, "bp22/table3") == 0 || strcmp(line, "study/point") == 0;
        if (strncmp(line, "  bp_sinc:taps=8,window=none ", 29) == 0) {
            assert_non_null(strstr(line, " 333 ms "));
            assert_non_null(strstr(line, " 6x "));
            assert_non_null(strstr(line, " 37 Gp/s "));
            assert_non_null(strstr(line, " 38.40 -13.30 -10.40"));
        }
        if (strncmp(line, "  bp_linear:beta=8,precision=double ", 36) == 0)
            assert_true(strstr(line, " 25 us ") && strstr(line, " 40 GF/s "));
        if (strncmp(line, "  bp_linear:precision=double ", 29) == 0)
            assert_non_null(strstr(line, "  -        -         - "));
        headings += 10 * (strstr(line, " 1234 s ") != NULL) + 100 * (strstr(line, "0.00001 m are accepted") != NULL);
    }
    assert_int_equal(headings, 112);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_csv_read, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_csv_faults, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_csv_cut, folder_make, folder_remove),
        cmocka_unit_test(test_csv_numbers),
        cmocka_unit_test_setup_teardown(test_round_trip, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_undefined_fields, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_other_run, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_kept_twice, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_failed_again, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_folder_is_locked, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_swept, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_changed_scene, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_cut_row, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_foreign_files, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_unwritable, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_folder_made, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_full_disk, folder_make, folder_remove),
        cmocka_unit_test(test_provenance),
        cmocka_unit_test(test_metric_table),
        cmocka_unit_test(test_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
