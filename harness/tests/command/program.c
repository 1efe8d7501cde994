/* The program as a process (program.h). */
#include "tests/command/program.h"

#include <fts.h>
#include <limits.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "echoes/matfile.h"

static char program[PATH_MAX];
char long_name[5000];
const char scene_text[] =
    "sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\n"
    "pulse = { kind = \"lfm\"; duration = 2e-3; };\n"
    "array = { tx_length = 0.08; rx_length = 0.04; receivers = 4; first_offset = 0.04; pitch = 0.04; };\n"
    "track = { speed = 2.5; pri = 0.032; pings = 12; x_first = -0.5; };\n"
    "record = { first_sample = 720; samples = 256; };\n"
    "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.443; };\n"
    "targets = { points = ( { x = 0.0; r = 20.0; } ); };\n"
    "noise = { std = 0.0; seed = 3; };\n"
    "image = { around_targets = { half_x = 0.3; half_r = 0.1; x_step = 0.02; r_step = 0.025; }; };\n";

/* --- Files ----------------------------------------------------------------------------------------------------- */

const char *path_in(const char *name)
{
    static char path[600];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

void bytes_write(const char *name, const void *bytes, size_t size)
{
    FILE *file = fopen(path_in(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

void text_write(const char *name, const char *text)
{
    bytes_write(name, text, strlen(text));
}

/* With a zero byte behind. */
static char *stream_read(FILE *file, size_t *size)
{
    char *text = NULL;
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    text = calloc(1, *size + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, *size, file), *size);
    return text;
}

char *bytes_read(const char *name, size_t *size)
{
    FILE *file = fopen(path_in(name), "rb");
    assert_non_null(file);
    char *bytes = stream_read(file, size);
    fclose(file);
    return bytes;
}

static int name_order(const FTSENT **a, const FTSENT **b)
{
    return strcmp((*a)->fts_name, (*b)->fts_name);
}

/* Every file below the folder with its size and time: two equal texts mean that nothing was written. */
static char *folder_state(void)
{
    char *text = NULL, *roots[] = {folder, NULL};
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    FTS *tree = fts_open(roots, FTS_PHYSICAL | FTS_NOCHDIR, name_order);
    assert_non_null(stream);
    assert_non_null(tree);
    for (FTSENT *entry; (entry = fts_read(tree));) {
        const struct stat *about = entry->fts_statp;
        if (entry->fts_info == FTS_F)
            fprintf(stream, "%s %lld %lld.%09ld\n", entry->fts_path, (long long)about->st_size,
                    (long long)about->st_mtim.tv_sec, about->st_mtim.tv_nsec);
        else if (entry->fts_info == FTS_D)
            fprintf(stream, "%s\n", entry->fts_path);
    }
    fts_close(tree);
    fclose(stream);
    return text;
}

/* --- Processes ------------------------------------------------------------------------------------------------- */

pid_t program_start(const char *const *arguments, FILE *out, FILE *err)
{
    char *words[ARGUMENTS_MAX + 2] = {program};
    for (int k = 0; k < ARGUMENTS_MAX && arguments[k]; k++)
        words[k + 1] = (char *)arguments[k];
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        setpgid(0, 0);
        alarm(600); /* it hangs, also on a machine that has other work */
        if (chdir(folder) == 0 && dup2(fileno(out), STDOUT_FILENO) >= 0 && dup2(fileno(err), STDERR_FILENO) >= 0)
            execv(program, words);
        _exit(127);
    }
    return child;
}

struct outcome program_run(const char *const *arguments)
{
    FILE *out = tmpfile(), *err = tmpfile();
    assert_non_null(out);
    assert_non_null(err);
    int status;
    size_t size;
    pid_t child = program_start(arguments, out, err);
    assert_int_equal(waitpid(child, &status, 0), child);
    struct outcome outcome = {WIFEXITED(status) ? WEXITSTATUS(status) : -1, stream_read(out, &size),
                              stream_read(err, &size)};
    fclose(out);
    fclose(err);
    return outcome;
}

void outcome_free(struct outcome *outcome)
{
    free(outcome->out);
    free(outcome->err);
}

/* Runs to a good end without a word on standard error; returns what it printed. */
char *program_output(const char *const *arguments)
{
    struct outcome outcome = program_run(arguments);
    if (outcome.status != 0 || *outcome.err)
        fail_msg("sasbench %s ... exits with %d: %s", arguments[0], outcome.status, outcome.err);
    free(outcome.err);
    return outcome.out;
}

void program_good(const char *const *arguments)
{
    free(program_output(arguments));
}

/* One line "sasbench: ..." that holds every text of `says`. */
static bool line_says(const char *line, const char *const *says)
{
    const char *end = strchr(line, '\n');
    bool good = strncmp(line, "sasbench: ", strlen("sasbench: ")) == 0 && end && !end[1];
    for (int k = 0; k < SAYS_MAX && says[k]; k++)
        good &= strstr(line, says[k]) != NULL;
    return good;
}

/* Exit status 2, one line of error, nothing else printed, nothing written. Tells and returns false otherwise. */
bool is_refused(const char *const *arguments, const char *const *says)
{
    char *before = folder_state();
    struct outcome outcome = program_run(arguments);
    char *after = folder_state();
    bool said = line_says(outcome.err, says), untouched = strcmp(before, after) == 0;
    bool good = outcome.status == 2 && said && !*outcome.out && untouched;
    if (!good) {
        print_message("sasbench");
        for (int k = 0; k < ARGUMENTS_MAX && arguments[k]; k++)
            print_message(" '%.100s'", arguments[k]);
        print_message("\n  exits with %d, %s%s, says: %s", outcome.status, *outcome.out ? "prints" : "prints nothing",
                      untouched ? "" : ", WRITES", outcome.err);
        for (int k = 0; k < SAYS_MAX && says[k]; k++)
            print_message("  to be said: %s\n", says[k]);
    }
    free(before);
    free(after);
    outcome_free(&outcome);
    return good;
}

void assert_all_refused(const struct refusal *refusals, size_t count)
{
    int failures = 0;
    for (size_t k = 0; k < count; k++)
        failures += !is_refused(refusals[k].arguments, refusals[k].says);
    assert_int_equal(failures, 0);
}

/* --- The folder ------------------------------------------------------------------------------------------------ */

/* The echo file that the others are cut and damaged from. */
static void echo_files_write(void)
{
    struct scene scene;
    struct echoes echoes;
    size_t size;
    support_scene("study/quick", &scene);
    support_echoes(&scene, &echoes);
    if (echo_file_write(path_in("good.mat"), &echoes, NULL) != STATUS_OK)
        fail_msg("%s", status_message());
    echoes_free(&echoes);
    scene_free(&scene);
    char *bytes = bytes_read("good.mat", &size);
    bytes_write("begun.mat", bytes, 100); /* inside the head of 128 bytes */
    bytes_write("head.mat", bytes, 128);
    bytes_write("half.mat", bytes, size / 2);
    bytes_write("short.mat", bytes, size - 1);
    bytes_write("long.mat", bytes, size + 1); /* bytes_read adds one */
    memset(bytes + size / 2, 0xff, 1000);     /* amid the packed samples */
    bytes_write("damaged.mat", bytes, size);
    free(bytes);
}

/* The folder is where the program runs: all paths are relative to it. */
int inputs_make(void **state)
{
    const char *path = getenv("SASBENCH_PROGRAM");
    if (!path || !realpath(path, program)) {
        print_error("SASBENCH_PROGRAM must be the path of the program to test\n");
        exit(1); /* cmocka would go on, in the folder that we are in */
    }
    /* The program's own temporary files are to be seen, too. */
    if (folder_make(state) != 0 || setenv("TMPDIR", folder, 1) != 0)
        return -1;
    /* Where two threads share a processor the program says so, and good ends are quiet ones. */
    if (omp_get_num_procs() < 2)
        setenv("OMP_NUM_THREADS", "1", 1);
    memset(long_name, 'x', sizeof long_name - 1);
    if (mkdir(path_in("folder.cfg"), 0777) != 0 || mkdir(path_in("foreign"), 0777) != 0
        || mkdir(path_in("crowded"), 0777) != 0 || mkdir(path_in("crowded/targets.csv"), 0777) != 0)
        return -1;
    text_write("scene.cfg", scene_text);
    text_write("plain.txt", "plain text\n");
    text_write("foreign/measurements.csv", "volt,ampere\n1,2\n");
    text_write("empty.cfg", "");
    text_write("empty.mat", "");
    bytes_write("binary.cfg",
                "\x7f"
                "ELF\x02\x01\x00\x03\xff\xfe",
                10);
    echo_files_write();
    return 0;
}
