/* The whole program as a user meets it: help, images from scenes and files, runs and how they resume. */
#include <fts.h>
#include <math.h>
#include <omp.h>
#include <pty.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "files/csv.h"
#include "echoes/matfile.h"
#include "tests/command/program.h"

/* Whether text goes on with part, where long lines are wrapped: runs of blanks and line breaks are alike. */
static bool continues_with(const char *text, const char *part)
{
    static const char blanks[] = " \n";
    while (*part) {
        size_t of_part = strspn(part, blanks), of_text = strspn(text, blanks);
        if (!of_part != !of_text || (!of_part && *part != *text))
            return false;
        part += of_part ? of_part : 1;
        text += of_text ? of_text : 1;
    }
    return true;
}

static void assert_holds(const char *text, const char *part)
{
    const char *at = text;
    while (*at && !continues_with(at, part))
        at++;
    if (!*at)
        fail_msg("no '%s' in: %s", part, text);
}

static void help_list_and_info_tell_everything(void **state)
{
    (void)state;
    static const char *const helps[][ARGUMENTS_MAX] = {{"--help"}, {"-h"}, {"help"}};
    static const char *const commands[] = {"\n  list ", "\n  info ", "\n  simulate ", "\n  image ",
                                           "\n  run ",  "\n  test ", "help COMMAND"};
    for (size_t k = 0; k < COUNT_OF(helps); k++) {
        char *text = program_output(helps[k]);
        for (size_t n = 0; n < COUNT_OF(commands); n++)
            assert_holds(text, commands[n]);
        assert_null(strstr(text, "\n  measure\n")); /* which compare --ab starts */
        free(text);
    }
    static const char *const of_run[][ARGUMENTS_MAX] = {{"run", "--help"}, {"help", "run"}, {"run", "x", "-h"}};
    for (size_t k = 0; k < COUNT_OF(of_run); k++) {
        char *text = program_output(of_run[k]);
        assert_holds(text, "Usage: sasbench run ([SCENE ...] | --echoes FILE.mat [--grid GRID])");
        assert_holds(text, "--algorithm SPEC");
        assert_holds(text, "Exit status: 0 done");
        assert_null(strstr(text, "--quick"));
        assert_null(strstr(text, "simulate"));
        free(text);
    }
    static const char *const facts[] = {("sasbench " SASBENCH_VERSION), "commit ", "compiler: ", "libraries: fftw",
                                        "instruction set: "};
    char *version = program_output((const char *const[ARGUMENTS_MAX]){"--version"});
    for (size_t n = 0; n < COUNT_OF(facts); n++)
        assert_holds(version, facts[n]);
    free(version);
    char *list = program_output((const char *const[ARGUMENTS_MAX]){"list"});
    for (int k = 0; algorithms[k]; k++) {
        assert_holds(list, algorithms[k]->name);
        assert_holds(list, algorithms[k]->summary);
        assert_holds(list, algorithms[k]->reference);
        char *info = program_output((const char *const[ARGUMENTS_MAX]){"info", algorithms[k]->name});
        assert_holds(info, algorithms[k]->name);
        assert_holds(info, "precision");
        for (const struct param *param = algorithms[k]->params; param && param->name; param++) {
            if (param->hidden) { /* tests' and plain engines' */
                assert_null(strstr(info, param->summary));
                continue;
            }
            assert_holds(info, param->name);
            assert_holds(info, param->summary);
            if (param->sweep)
                assert_holds(info, param->sweep);
        }
        free(info);
    }
    free(list);
}

/* Without a terminal, and COLUMNS unset: as wide as a wide one. */
static void assert_lines_fit(const char *text)
{
    for (; *text; text += strcspn(text, "\n") + (text[strcspn(text, "\n")] == '\n'))
        if (strcspn(text, "\n") > 110)
            fail_msg("%zu columns: %.*s", strcspn(text, "\n"), (int)strcspn(text, "\n"), text);
}

static void file_and_scene_give_the_same_image(void **state)
{
    (void)state;
    static const char *const simulate[ARGUMENTS_MAX] = {"simulate", "study/quick", "-o", "echoes.mat"};
    static const char *const from_scene[ARGUMENTS_MAX] = {
        "image", "--scene", "study/quick", "--algorithm", "bp_sinc:precision=double", "-o", "scene.mat"};
    static const char *const from_file[ARGUMENTS_MAX] = {"image",
                                                         "--echoes",
                                                         "echoes.mat",
                                                         "--grid",
                                                         "-0.6:0.02:61,19.85:0.025:13",
                                                         "--algorithm",
                                                         "bp_sinc:precision=double",
                                                         "-o",
                                                         "file.mat",
                                                         "--threads",
                                                         "1"};
    struct grid grid[2];
    double complex *pixels[2];
    program_good(simulate);
    program_good(from_scene);
    program_good(from_file);
    const char *const files[] = {"scene.mat", "file.mat"};
    for (int k = 0; k < 2; k++) {
        if (image_file_read(path_in(files[k]), &grid[k], &pixels[k]) != STATUS_OK)
            fail_msg("%s", status_message());
        assert_int_equal(grid[k].x_count, 61);
        assert_int_equal(grid[k].r_count, 13);
        assert_true(fabs(grid[k].x_first + 0.6) < 1e-9 && fabs(grid[k].x_step - 0.02) < 1e-9);
        assert_true(fabs(grid[k].r_first - 19.85) < 1e-9 && fabs(grid[k].r_step - 0.025) < 1e-9);
    }
    double peak = 0, difference = 0;
    int brightest = 0;
    for (int i = 0; i < 61 * 13; i++) {
        if (cabs(pixels[0][i]) > peak) {
            peak = cabs(pixels[0][i]);
            brightest = i;
        }
        difference = worse_of(difference, cabs(pixels[0][i] - pixels[1][i]));
    }
    assert_int_equal(brightest, 6 * 61 + 30); /* the target at (0, 20) m */
    if (!(difference <= 1e-9 * peak))
        fail_msg("largest difference %g of a peak of %g", difference, peak);
    free(pixels[0]);
    free(pixels[1]);
}

static void csv_load(const char *name, struct csv *csv)
{
    if (csv_read(path_in(name), CSV_TAIL_DROP, csv) != STATUS_OK)
        fail_msg("%s", status_message());
}

/* The first row that is no comment. */
static void assert_header(const char *name, const char *header)
{
    size_t size;
    char *text = bytes_read(name, &size), *line = text;
    while (*line == '#')
        line += strcspn(line, "\n") + 1;
    line[strcspn(line, "\n")] = '\0';
    assert_true(line > text); /* a comment block tells where the rows come from */
    assert_string_equal(line, header);
    free(text);
}

static void assert_rows_kept(const struct csv *before, const struct csv *after)
{
    assert_true(after->row_count >= before->row_count);
    for (int row = 0; row < before->row_count; row++)
        for (int k = 0; k < before->column_count; k++)
            assert_string_equal(csv_cell(after, row, k), csv_cell(before, row, k));
}

/* Pictures in a folder below ours, each of them a PNG from signature to end. */
static int pictures_count(const char *name)
{
    static const char begin[] = "\x89PNG\r\n\x1a\n", end[] = "IEND\xae\x42\x60\x82";
    char path[600], *roots[] = {path, NULL};
    int count = 0;
    snprintf(path, sizeof path, "%s", path_in(name));
    FTS *tree = fts_open(roots, FTS_PHYSICAL | FTS_NOCHDIR, NULL);
    assert_non_null(tree);
    for (FTSENT *entry; (entry = fts_read(tree));) {
        const char *extension = strrchr(entry->fts_name, '.');
        if (entry->fts_info != FTS_F || !extension || strcmp(extension, ".png") != 0)
            continue;
        size_t size;
        char *bytes = bytes_read(entry->fts_path + strlen(folder) + 1, &size);
        assert_true(size > 1000);
        assert_memory_equal(bytes, begin, sizeof begin - 1);
        assert_memory_equal(bytes + size - (sizeof end - 1), end, sizeof end - 1);
        free(bytes);
        count++;
    }
    fts_close(tree);
    return count;
}

static int rows_with_status(const struct csv *csv, const char *status)
{
    int count = 0;
    for (int row = 0; row < csv->row_count; row++)
        count += strcmp(csv_cell(csv, row, csv_column(csv, "status")), status) == 0;
    return count;
}

static void run_leaves_its_results_and_keeps_them(void **state)
{
    (void)state;
    static const char *const run[ARGUMENTS_MAX] = {"run", "study/quick", "-o", "results/quick"};
    struct csv first, second;
    char *table = program_output(run);
    assert_holds(table, "study/quick");
    assert_lines_fit(table);
    int count = 0;
    for (; algorithms[count]; count++)
        assert_holds(table, algorithms[count]->name);
    free(table);
    assert_header("results/quick/measurements.csv",
                  "scene,algorithm,options,precision,threads,engine,status,reason,skipped,plan_s,run_s,run_min_s,"
                  "runs,control_s,stages,flops_published,flops,pairs,bytes,error,error_gain,phase_rms_rad,width_m,"
                  "pslr_db,islr_db,run_q1_s,run_q3_s,entropy,contrast,peak_over_median,host,load,error_flown");
    assert_header("results/quick/targets.csv", "scene,algorithm,options,precision,target,axis,definition,extent_m,"
                                               "position_error_m,phase_error_rad,width_m,pslr_db,islr_db");
    csv_load("results/quick/measurements.csv", &first);
    assert_int_equal(first.row_count, count);
    int good = rows_with_status(&first, "ok");
    assert_true(good >= 5); /* reference and the back projections image everything */
    assert_int_equal(rows_with_status(&first, "failed"), 0);
    assert_int_equal(pictures_count("results/quick"), good + 2); /* slices, and error against time */
    assert_int_equal(access(path_in("results/quick/study_quick-slices.svg"), F_OK), 0);
    for (int row = 0; row < first.row_count; row++) {
        double run_s, error;
        if (strcmp(csv_cell(&first, row, csv_column(&first, "status")), "ok") != 0)
            continue;
        assert_string_equal(csv_cell(&first, row, csv_column(&first, "scene")), "study/quick");
        assert_true(csv_number(csv_cell(&first, row, csv_column(&first, "run_s")), &run_s) && run_s > 0);
        assert_true(csv_number(csv_cell(&first, row, csv_column(&first, "error")), &error) && error < 0.5);
    }

    char *again = program_output(run);
    assert_holds(again, "\nno row was measured anew: all are of an earlier run");
    free(again);
    csv_load("results/quick/measurements.csv", &second);
    assert_int_equal(second.row_count, first.row_count);
    assert_rows_kept(&first, &second);
    csv_free(&first);
    csv_free(&second);
}

static void unsupported_is_a_row_with_a_reason(void **state)
{
    (void)state;
    static const char *const run[ARGUMENTS_MAX] = {"run", "scene.cfg", "-a", "bp_sinc:taps=7", "-o", "results/odd"};
    struct csv csv;
    program_good(run);
    csv_load("results/odd/measurements.csv", &csv);
    assert_int_equal(csv.row_count, 1);
    assert_string_equal(csv_cell(&csv, 0, csv_column(&csv, "status")), "unsupported");
    assert_holds(csv_cell(&csv, 0, csv_column(&csv, "reason")), "taps is 7");
    assert_string_equal(csv_cell(&csv, 0, csv_column(&csv, "run_s")), "");
    assert_int_equal(pictures_count("results/odd"), 0);
    csv_free(&csv);
}

/* Rows that are whole by now; 0 while there is no file. */
static int rows_now(const char *name)
{
    struct csv csv;
    if (csv_read(path_in(name), CSV_TAIL_DROP, &csv) != STATUS_OK)
        return 0;
    int count = csv.row_count;
    csv_free(&csv);
    return count;
}

static void interrupted_run_resumes(void **state)
{
    (void)state;
    static const char *const run[ARGUMENTS_MAX] = {"run",        "scene.cfg", "study/quick", "-a",
                                                   "bp_nearest", "-o",        "results/cut"};
    static const char measurements[] = "results/cut/measurements.csv", targets[] = "results/cut/targets.csv";
    struct csv before, after;
    int status;
    FILE *sink = tmpfile();
    assert_non_null(sink);
    pid_t child = program_start(run, sink, sink);
    while (rows_now(measurements) == 0 && waitpid(child, &status, WNOHANG) == 0)
        nanosleep(&(struct timespec){0, 2000000}, NULL);
    kill(-child, SIGKILL); /* with the gnuplot that it may have started */
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status));
    fclose(sink);
    csv_load(measurements, &before);
    assert_int_equal(before.row_count, 1);

    program_good(run);
    csv_load(measurements, &after);
    assert_rows_kept(&before, &after);
    assert_int_equal(after.row_count, 2);
    assert_int_equal(rows_with_status(&after, "ok"), 2);
    assert_string_equal(csv_cell(&after, 1, csv_column(&after, "scene")), "study/quick");
    assert_int_equal(rows_now(targets), 2 * 5); /* one target: three definitions along x, two along r */
    /* Each scene's image, the slices of the scene that the second call measured, error against time, the overview. */
    assert_in_range(pictures_count("results/cut"), 5, 6);
    csv_free(&before);
    csv_free(&after);
}

/* On a terminal a message is broken at blanks; elsewhere it is one line. */
static void messages_fit_the_terminal(void **state)
{
    (void)state;
    static const char *const wrong[ARGUMENTS_MAX] = {"info", "no_such_algorithm"};
    const struct winsize size = {.ws_col = 60, .ws_row = 24};
    char text[4096] = "";
    size_t length = 0;
    int master, slave, status;
    assert_int_equal(openpty(&master, &slave, NULL, NULL, &size), 0);
    FILE *err = fdopen(slave, "w");
    pid_t child = program_start(wrong, err, err);
    assert_int_equal(waitpid(child, &status, 0), child);
    fclose(err);
    for (ssize_t got; (got = read(master, text + length, sizeof text - 1 - length)) > 0;)
        length += (size_t)got;
    close(master);
    struct outcome outcome = program_run(wrong);
    int lines = 0;
    for (char *line = strtok(text, "\r\n"); line; line = strtok(NULL, "\r\n"), lines++)
        if (strlen(line) > 60 || !strstr(outcome.err, line))
            fail_msg("%zu columns, or another text: %s", strlen(line), line);
    assert_in_range(lines, 3, 20);
    assert_ptr_equal(strchr(outcome.err, '\n') + 1, outcome.err + strlen(outcome.err));
    outcome_free(&outcome);
}

static void plans_fit_a_line(void **state)
{
    (void)state;
    struct outcome outcome =
        program_run((const char *const[ARGUMENTS_MAX]){"plan", "study/quick", "--error", "1e-3", "--all"});
    assert_int_equal(outcome.status, 0); /* may note that rates are measured */
    assert_holds(outcome.out, "candidate");
    assert_lines_fit(outcome.out);
    outcome_free(&outcome);
}

/* The choice and the command that runs it first, then no more than the next of each family. */
static void plans_answer_first(void **state)
{
    (void)state;
    char *plan = program_output((const char *const[ARGUMENTS_MAX]){"plan", "study/quick", "--error", "1e-3"});
    char spec[100], command[300];
    int lines = 0;
    assert_int_equal(sscanf(plan, "bp_%99[^ ]", spec), 1);
    spec[strlen(spec) - 1] = '\0';
    assert_holds(plan, ": predicted error ");
    snprintf(command, sizeof command, " of memory\n  ./sasbench image --scene study/quick -a bp_%s -o image.mat\n",
             spec);
    assert_holds(plan, command);
    assert_holds(plan, "\n  bp_factorised: ");
    assert_holds(plan, "\n  rma_");
    assert_holds(plan, "\n  wk_");
    for (const char *at = plan; (at = strchr(at, '\n')); at++)
        lines++;
    assert_in_range(lines, 7, 9);
    assert_lines_fit(plan);
    free(plan);
}

static void threads_beyond_the_processors_are_told(void **state)
{
    (void)state;
    char threads[12], said[60];
    snprintf(threads, sizeof threads, "%d", omp_get_num_procs() + 1);
    snprintf(said, sizeof said, "sasbench: warning: %s threads share %d processor", threads, omp_get_num_procs());
    struct outcome outcome = program_run(
        (const char *const[ARGUMENTS_MAX]){"run", "scene.cfg", "-a", "bp_nearest", "-o", "shared", "-t", threads});
    assert_int_equal(outcome.status, 0);
    assert_holds(outcome.err, said);
    outcome_free(&outcome);
}

/* Each condition is said once, with whom it concerns unless these are all. Standard error does not cut into it. */
static void check_says_each_condition_once(void **state)
{
    (void)state;
    struct outcome outcome = program_run((const char *const[ARGUMENTS_MAX]){"check", path_in("scene.cfg"), "--all"});
    assert_int_equal(outcome.status, 1); /* omega-k takes one receiver */
    const char *first = strstr(outcome.out, "met      phase_digits");
    assert_non_null(first);
    assert_null(strstr(first + 1, "met      phase_digits"));
    const char *refused = strstr(outcome.out, "REFUSED  one_receiver");
    assert_non_null(refused);
    assert_null(strstr(refused + 1, "REFUSED  one_receiver"));
    assert_holds(outcome.out, "\nSensitivities of the image's middle");
    outcome_free(&outcome);
}

/* The verdict first, then what does not hold, with its cure and whom it concerns; what holds only with --all. */
static void check_answers_first(void **state)
{
    (void)state;
    struct outcome outcome = program_run((const char *const[ARGUMENTS_MAX]){"check", path_in("scene.cfg")});
    assert_int_equal(outcome.status, 1);
    const char *verdict =
        strstr(outcome.out, "scene: 15 of 18 algorithms take this scene; 0 warnings\n  REFUSED  one_re");
    assert_non_null(verdict);
    assert_holds(outcome.out, "cure: back projection, range migration (rma_*)");
    assert_holds(outcome.out, "           wk_classic, wk_squint, wk_polar\n");
    assert_null(strstr(outcome.out, "  met "));
    outcome_free(&outcome);
    char *alone = program_output((const char *const[ARGUMENTS_MAX]){"check", path_in("scene.cfg"), "-a", "bp_linear"});
    assert_holds(
        alone,
        "scene: 1 of 1 algorithm takes this scene; 0 warnings\n  near     unambiguous           0.838 (at most 1)");
    free(alone);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(help_list_and_info_tell_everything),
        cmocka_unit_test(check_says_each_condition_once),
        cmocka_unit_test(check_answers_first),
        cmocka_unit_test(file_and_scene_give_the_same_image),
        cmocka_unit_test(run_leaves_its_results_and_keeps_them),
        cmocka_unit_test(unsupported_is_a_row_with_a_reason),
        cmocka_unit_test(interrupted_run_resumes),
        cmocka_unit_test(messages_fit_the_terminal),
        cmocka_unit_test(plans_fit_a_line),
        cmocka_unit_test(plans_answer_first),
        cmocka_unit_test(threads_beyond_the_processors_are_told),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
