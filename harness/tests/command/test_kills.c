/* A command that is killed again and again, at moments that differ each time, and then resumed: the rows are those of
   an undisturbed one, and nothing else is left. */
#include <dirent.h>
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

/* SASBENCH_KILLS in the environment: more of them, for a long run by hand. */
static int kills_wanted(void)
{
    const char *given = getenv("SASBENCH_KILLS");
    return given ? atoi(given) : 3;
}

static double seconds_of(const char *const *arguments)
{
    double begin = seconds_now();
    program_good(arguments);
    return seconds_now() - begin;
}

/* True: the signal came before the end. */
static bool kill_after(const char *const *arguments, double seconds, int number)
{
    int status;
    FILE *sink = tmpfile();
    assert_non_null(sink);
    pid_t child = program_start(arguments, sink, sink);
    nanosleep(&(struct timespec){(time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds))}, NULL);
    kill(child, number);
    assert_int_equal(waitpid(child, &status, 0), child);
    fclose(sink);
    return WIFSIGNALED(status) && WTERMSIG(status) == number;
}

static int name_order(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* The names in a folder, sorted, one a line: what both runs leave is the same. */
static char *names_of(const char *directory)
{
    static const char *names[1000];
    size_t count = 0, size;
    char *text = NULL;
    DIR *open = opendir(path_of(directory));
    FILE *stream = open_memstream(&text, &size);
    assert_non_null(open);
    assert_non_null(stream);
    for (struct dirent *entry; (entry = readdir(open)) && count < COUNT_OF(names);)
        names[count++] = strdup(entry->d_name);
    closedir(open);
    qsort(names, count, sizeof *names, name_order);
    for (size_t k = 0; k < count; k++) {
        fprintf(stream, "%s\n", names[k]);
        free((char *)names[k]);
    }
    fclose(stream);
    return text;
}

/* The same command into two folders, the second of which is NAME-killed. */
static void check_resumed(const char *name, const char *const *whole, const char *const *killed)
{
    static const int numbers[] = {SIGKILL, SIGINT, SIGTERM};
    struct random random = random_seed(7, 0);
    double duration = seconds_of(whole);
    int count = kills_wanted(), hits = 0;
    for (int k = 0; k < count; k++)
        hits += kill_after(killed, duration * (k + random_uniform(&random)) / (count + 1), numbers[k % 3]);
    assert_true(hits > 0);
    program_good(killed);
    char folders[2][40];
    for (int k = 0; k < 2; k++)
        snprintf(folders[k], sizeof folders[k], "%s%s", name, k ? "-killed" : "");
    assert_same_results(folders[0], folders[1]);
    char *wanted = names_of(folders[0]), *names = names_of(folders[1]);
    assert_string_equal(names, wanted);
    free(wanted);
    free(names);
}

#define RUN(place)                                                                                                     \
    (const char *const[ARGUMENTS_MAX])                                                                                 \
    {                                                                                                                  \
        "run", "study/quick", "scene.cfg", "-a", "bp_nearest", "-a", "bp_sinc", "-a", "rma_lbf", "-o", place           \
    }
#define SWEEP(place)                                                                                                   \
    (const char *const[ARGUMENTS_MAX])                                                                                 \
    {                                                                                                                  \
        "sweep", "scene.cfg", "-a", "bp_zeropad:factor=4", "-a", "bp_nearest", "-o", place                             \
    }
#define REPRODUCE(place)                                                                                               \
    (const char *const[ARGUMENTS_MAX])                                                                                 \
    {                                                                                                                  \
        "reproduce", "zp15_f3", "-o", place                                                                            \
    }

static void killed_run_resumes(void **state)
{
    (void)state;
    check_resumed("run", RUN("run"), RUN("run-killed"));
}

static void killed_sweep_resumes(void **state)
{
    (void)state;
    check_resumed("sweep", SWEEP("sweep"), SWEEP("sweep-killed"));
}

/* Where to go on is said, once. */
static void check_interruption_told(FILE *sink, const char *kept)
{
    static char text[100000];
    rewind(sink);
    text[fread(text, 1, sizeof text - 1, sink)] = '\0';
    fclose(sink);
    const char *at = strstr(text, "sasbench: interrupted; "), *end = at ? strchr(at, '\n') : NULL;
    if (!end || strstr(end, "interrupted;"))
        fail_msg("interruption not said once: %s", at ? at : text);
    const char *folder_named = strstr(at, kept);
    assert_true(folder_named && folder_named < end);
}

/* An interrupted run ends by the signal at once, and says where its rows are: here in the midst of the exact image. */
static void interrupted_run_is_told(void **state)
{
    (void)state;
    static const char *const arguments[ARGUMENTS_MAX] = {"run", "study/template", "-a", "bp_nearest", "-o", "stopped"};
    int status;
    FILE *sink = tmpfile();
    assert_non_null(sink);
    const pid_t child = program_start(arguments, sink, sink);
    for (int k = 0; k < 6000 && !support_exists("stopped/measurements.csv"); k++)
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    nanosleep(&(struct timespec){.tv_nsec = 200000000}, NULL);
    assert_int_equal(kill(-child, SIGINT), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT);
    check_interruption_told(sink, "stopped");
}

/* An interrupted sweep ends by the signal, which a terminal sends to all of its processes; `report` writes what its
   rows say. */
static void interrupted_sweep_is_reported(void **state)
{
    (void)state;
    static const char *const arguments[ARGUMENTS_MAX] = {"sweep",       "scene.cfg", "-a", "bp_zeropad",
                                                         "--precision", "float",     "-o", "interrupted"};
    int status;
    FILE *sink = tmpfile();
    assert_non_null(sink);
    const pid_t child = program_start(arguments, sink, sink);
    int rows = 0;
    for (int k = 0; k < 6000 && rows < 3; k++) {
        struct csv csv;
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
        if (support_exists("interrupted/measurements.csv")
            && csv_read(path_of("interrupted/measurements.csv"), CSV_TAIL_DROP, &csv) == STATUS_OK) {
            rows = csv.row_count;
            csv_free(&csv);
        }
    }
    assert_int_equal(kill(-child, SIGINT), 0); /* its group */
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT);
    check_interruption_told(sink, "interrupted");
    assert_in_range(rows, 3, 7);
    static const char *const files[] = {"cheapest.csv", "fronts.csv", "slopes.csv"};
    program_good((const char *const[ARGUMENTS_MAX]){"report", "interrupted"});
    for (size_t k = 0; k < COUNT_OF(files); k++) {
        char name[60];
        snprintf(name, sizeof name, "interrupted/%s", files[k]);
        if (!support_exists(name))
            fail_msg("%s is not there", name);
    }
}

static void killed_reproduction_resumes(void **state)
{
    (void)state;
    check_resumed("reproduce", REPRODUCE("reproduce"), REPRODUCE("reproduce-killed"));
}

/* Pictures by their end, MATLAB files as the program reads them. */
static bool is_whole(const char *file, const char *bytes, size_t size)
{
    static const char end[] = "IEND\xae\x42\x60\x82";
    if (strstr(file, ".png"))
        return size > sizeof end && memcmp(bytes + size - (sizeof end - 1), end, sizeof end - 1) == 0;
    struct outcome outcome = program_run((const char *const[ARGUMENTS_MAX]){"info", file});
    const bool good = outcome.status == 0;
    outcome_free(&outcome);
    return good;
}

/* A file that the user named is the old one or a new one that is whole, whenever the command is killed; what it had
   begun goes with the next. */
static void killed_files_are_whole(void **state)
{
    (void)state;
    static const struct {
        const char *arguments[ARGUMENTS_MAX], *file;
    } commands[] = {
        {{"simulate", "study/quick", "-o", "files/echoes.mat"}, "files/echoes.mat"},
        {{"image", "--scene", "study/quick", "-a", "bp_sinc", "-o", "files/image.mat"}, "files/image.mat"},
        {{"image", "--scene", "study/quick", "-a", "bp_sinc", "-o", "files/image.png"}, "files/image.png"},
    };
    struct random random = random_seed(9, 0);
    assert_int_equal(mkdir(path_of("files"), 0777), 0);
    for (size_t c = 0; c < COUNT_OF(commands); c++) {
        size_t size;
        const double duration = seconds_of(commands[c].arguments);
        for (int k = 0, count = 5 * kills_wanted(); k < count; k++) {
            text_write(commands[c].file, "old\n");
            kill_after(commands[c].arguments, duration * random_uniform(&random), SIGKILL);
            char *bytes = bytes_read(commands[c].file, &size);
            if (strcmp(bytes, "old\n") != 0 && !is_whole(commands[c].file, bytes, size))
                fail_msg("%s has %zu bytes and is neither the old one nor whole", commands[c].file, size);
            free(bytes);
        }
        program_good(commands[c].arguments);
    }
    char *names = names_of("files");
    assert_string_equal(names, ".\n..\nechoes.mat\nimage.mat\nimage.png\n");
    free(names);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(killed_run_resumes),      cmocka_unit_test(killed_sweep_resumes),
        cmocka_unit_test(interrupted_run_is_told), cmocka_unit_test(interrupted_sweep_is_reported),
        cmocka_unit_test(killed_files_are_whole),  cmocka_unit_test(killed_reproduction_resumes),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
