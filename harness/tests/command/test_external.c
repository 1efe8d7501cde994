/* Any program as an algorithm: it loses its own row, whatever it does, and leaves no process and no file behind. */
#define _GNU_SOURCE /* asprintf */
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "files/csv.h"
#include "tests/command/external_program.h"
#include "tests/command/program.h"

/* The lines of a shell that measures with these SPECs. */
static void specs_run(const char *options, const char *specs, const char *output)
{
    char *line = NULL;
    assert_true(
        asprintf(&line, "\"$SASBENCH_PROGRAM\" run study/quick %s %s -o %s >out.txt 2>err.txt", options, specs, output)
        > 0);
    support_shell(line);
    free(line);
}

/* The cell of the row of an algorithm, "" without such a row. */
static const char *cell_of(const struct csv *csv, const char *algorithm, const char *column)
{
    for (int row = 0; row < csv->row_count; row++)
        if (strcmp(csv_cell(csv, row, csv_column(csv, "algorithm")), algorithm) == 0)
            return csv_cell(csv, row, csv_column(csv, column));
    return "";
}

/* Neither a process of the tests' programs is left, nor a folder of theirs. */
static void assert_nothing_left(void)
{
    assert_shell(
        "for k in $(seq 100); do ! ps -eo args | grep -q '^[^ ]*python3 bad.py\\|^sleep 31557.25' && "
        "! ls -d sasbench-* && exit 0; sleep .1; done; ps -eo pid,args | grep '[ /]python3 bad.py\\|sleep 31557' "
        ">&2; exit 1",
        0);
}

static void faults_lose_their_row(void **state)
{
    (void)state;
    char specs[COUNT_OF(lost) * 40 + 200] = "-a bp_nearest -a external:./absent";
    struct csv csv;
    for (size_t k = 0; k < COUNT_OF(lost); k++)
        snprintf(specs + strlen(specs), sizeof specs - strlen(specs), " -a 'external:python3 bad.py %s'", lost[k].kind);
    specs_run("--timeout 5", specs, "faults");
    assert_int_equal(csv_read(path_in("faults/measurements.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_string_equal(cell_of(&csv, "bp_nearest", "status"), "ok");
    assert_string_equal(cell_of(&csv, "external:./absent", "status"), "failed");
    assert_non_null(strstr(cell_of(&csv, "external:./absent", "reason"), "absent: cannot be run: No such file"));
    int wrong = 0;
    for (size_t k = 0; k < COUNT_OF(lost); k++) {
        char name[60];
        snprintf(name, sizeof name, "external:python3 bad.py %s", lost[k].kind);
        const char *status = cell_of(&csv, name, "status"), *reason = cell_of(&csv, name, "reason");
        if (strcmp(status, lost[k].status) != 0 || !strstr(reason, lost[k].reason)) {
            print_error("%s: %s, %s; must be %s, %s\n", name, status, reason, lost[k].status, lost[k].reason);
            wrong++;
        }
    }
    assert_int_equal(wrong, 0);
    assert_string_equal(cell_of(&csv, "external:python3 bad.py noisy", "flops"), "");
    assert_string_equal(cell_of(&csv, "external:python3 bad.py noisy", "pairs"), "");
    assert_non_null(strstr(cell_of(&csv, "external:python3 bad.py noisy", "stages"), "program="));
    csv_free(&csv);
    assert_shell("test $(wc -c <faults/external.log) -lt 400000 && grep -q '^== external:python3 bad.py noisy$' "
                 "faults/external.log && grep -q '^ValueError' faults/external.log",
                 0);
    assert_nothing_left();
}

/* More processors than threads, if it gets them for every image: others may have them, and one image within the
   threads is enough for the rule. */
static void threads_are_counted(void **state)
{
    (void)state;
    for (int attempt = 0; attempt < 4 && sysconf(_SC_NPROCESSORS_ONLN) > 1; attempt++) {
        struct csv csv;
        assert_shell("rm -rf crowd processors", 0);
        specs_run("--threads 1", "-a 'external:python3 bad.py threads'", "crowd");
        char *processors = support_read("processors");
        assert_non_null(processors);
        double least = INFINITY;
        char *rest = processors;
        for (const char *word = strsep(&rest, " "); word && *word; word = strsep(&rest, " "))
            least = fmin(least, atof(word));
        free(processors);
        assert_int_equal(csv_read(path_in("crowd/measurements.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
        const bool failed = strcmp(csv_cell(&csv, 0, csv_column(&csv, "status")), "failed") == 0;
        if (failed)
            assert_non_null(strstr(csv_cell(&csv, 0, csv_column(&csv, "reason")), "processors busy with --threads 1"));
        csv_free(&csv);
        assert_true(failed || least < 1.5);
        if (failed)
            return;
    }
    print_message("[  SKIPPED ] the program never had more than 1.5 processors\n");
    skip();
}

/* However ours ends. */
static void ends_with_us(void **state)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGKILL};
    (void)state;
    for (size_t k = 0; k < COUNT_OF(signals); k++) {
        int status;
        FILE *sink = tmpfile();
        const pid_t child =
            program_start((const char *const[ARGUMENTS_MAX]){"run", "study/quick", "-a", "external:python3 bad.py hang",
                                                             "-a", "external:python3 bad.py bomb", "-o", "x"},
                          sink, sink);
        assert_shell("for k in $(seq 200); do ps -eo args | grep -q '^[^ ]*python3 bad.py hang' && exit 0; sleep .1; "
                     "done; exit 1",
                     0);
        kill(signals[k] == SIGINT ? -child : child, signals[k]); /* Ctrl-C reaches the group */
        assert_int_equal(waitpid(child, &status, 0), child);
        fclose(sink);
        assert_nothing_left();
    }
}

/* Quotes keep what would end a word or the command; two commands are two algorithms; an edited script is measured
   anew. */
static void commands_are_read(void **state)
{
    struct csv csv;
    (void)state;
    static const struct refusal refusals[] = {
        {{"run", "study/quick", "-a", "external:", "-o", "x"}, {"external:: the command is missing"}},
        {{"run", "study/quick", "-a", "external:a 'b", "-o", "x"}, {"a quote is not closed", "external:COMMAND"}},
        {{"run", "study/quick", "-a", "external:a | b", "-o", "x"}, {"one of |&;<>(){} needs quotes"}},
        {{"run", "study/quick", "-a", "external:a $(b)", "-o", "x"}, {"commands are not substituted"}},
        {{"run", "study/quick", "-a", "external:a\nb", "-o", "x"}, {"it has a control character"}},
        {{"run", "study/quick", "-a", "external:a:b", "-o", "x"}, {"'b' is not a setting"}},
        {{"run", "study/quick", "-a", "external:a", "--timeout", "0", "-o", "x"}, {"--timeout is '0'", "above 0"}},
        {{"run", "study/quick", "-a", "external:a", "--timeout", "nan", "-o", "x"}, {"--timeout is 'nan'"}},
    };
    assert_all_refused(refusals, COUNT_OF(refusals));
    assert_shell("mkdir 'a b' && cp bad.py 'a b/c:d,e.py'", 0);
    const char *specs =
        "-a \"external:python3 'a b/c:d,e.py' good:precision=double\" -a 'external:python3 bad.py good'";
    for (int run = 0; run < 2; run++) {
        specs_run("", specs, "named");
        assert_int_equal(csv_read(path_in("named/measurements.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
        assert_string_equal(cell_of(&csv, "external:python3 'a b/c:d,e.py' good", "status"), "ok");
        assert_string_equal(cell_of(&csv, "external:python3 'a b/c:d,e.py' good", "precision"), "double");
        assert_string_equal(cell_of(&csv, "external:python3 bad.py good", "status"), "ok");
        const char *origin = csv_comment(&csv, "algorithm external:python3 bad.py good");
        assert_non_null(origin);
        assert_non_null(strstr(origin, " by Python 3"));
        csv_free(&csv);
        assert_shell(run == 0 ? "echo '# edited' >>bad.py" : "grep -q 'bad.py good has changed' err.txt", 0);
    }
    assert_shell("! grep -q 'e.py. good has changed' err.txt", 0);
    assert_nothing_left();
}

/* An interpreter's adapter, where it is: its image is that of our own truncated sinc. The test of docs/plugins.md holds
   its promises. */
static void assert_adapter(const char *check, const char *command)
{
    struct csv csv;
    char specs[300], *table;
    if (system(check) != 0) {
        print_message("[  SKIPPED ] %s: not there\n", check);
        skip();
    }
    assert_shell("cp \"$ROOT\"/docs/plugin/* .", 0);
    snprintf(specs, sizeof specs, "-a '%s' -a bp_sinc", command);
    specs_run("", specs, "adapter");
    specs_run("--shard 2/2", specs, "shard");
    assert_int_equal(csv_read(path_in("adapter/measurements.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_string_equal(cell_of(&csv, command, "status"), "ok");
    const double error = atof(cell_of(&csv, command, "error")), ours = atof(cell_of(&csv, "bp_sinc", "error"));
    assert_true(error > .999 * ours && error < 1.001 * ours);
    csv_free(&csv);
    table = program_output((const char *const[ARGUMENTS_MAX]){"sweep", "study/quick", "-a", command, "-o", "swept"});
    free(table);
    char *points = support_read("swept/measurements.csv");
    assert_non_null(strstr(points, command));
    free(points);
    assert_shell("rm -r adapter swept shard", 0);
    assert_nothing_left();
}

static void numpy_is_measured(void **state)
{
    (void)state;
    assert_adapter("/usr/bin/python3 -c 'import numpy, scipy.io' 2>/dev/null", "external:/usr/bin/python3 my_bp.py");
}

static void octave_is_measured(void **state)
{
    (void)state;
    assert_adapter("octave-cli --version >/dev/null 2>&1", "external:octave-cli -qf my_bp.m");
}

static int program_make(void **state)
{
    const int made = inputs_make(state);
    text_write("bad.py", bad_py);
    return made;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(faults_lose_their_row), cmocka_unit_test(threads_are_counted),
        cmocka_unit_test(ends_with_us),          cmocka_unit_test(commands_are_read),
        cmocka_unit_test(numpy_is_measured),     cmocka_unit_test(octave_is_measured),
    };
    return cmocka_run_group_tests_name("external", tests, program_make, folder_remove);
}
