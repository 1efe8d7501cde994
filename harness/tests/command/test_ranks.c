/* Ranks of mpirun share a run: whatever their number, and whichever of their processes is killed and when, the rows are
   those of one process. Skipped without MPI. */
#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "echoes/matfile.h"
#include "scene/random.h"
#include "tests/command/program.h"
#include "tests/command/same_rows.h"

enum { RANKS_MOST = 4, SKIPPED = 77 };
/* Looks, 50 ms apart, at an mpirun without ranks: where one is killed in its first moment, Open MPI 4.1's sometimes
   never ends. */
enum { ALONE_MOST = 200 };

static const char *mpirun; /* its path */

/* Begin the program as `count` ranks, in the test's folder. */
static pid_t ranks_start(int count, const char *const *arguments, FILE *sink)
{
    char number[12];
    const char *words[ARGUMENTS_MAX + 8] = {mpirun, "--oversubscribe",         "--bind-to", "none", "-n",
                                            number, getenv("SASBENCH_PROGRAM")};
    snprintf(number, sizeof number, "%d", count);
    for (int k = 0; k < ARGUMENTS_MAX && arguments[k]; k++)
        words[7 + k] = arguments[k];
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
        setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
        if (chdir(path_in(".")) == 0 && dup2(fileno(sink), STDOUT_FILENO) >= 0
            && dup2(fileno(sink), STDERR_FILENO) >= 0)
            execv(mpirun, (char *const *)words);
        _exit(127);
    }
    assert_true(child > 0);
    return child;
}

/* The n-th child of a process, by its number; 0: none. */
static pid_t child_of(pid_t parent, int n)
{
    pid_t found[64] = {0};
    int count = 0;
    DIR *open = opendir("/proc");
    assert_non_null(open);
    for (struct dirent *entry; (entry = readdir(open)) && count < 64;) {
        char path[300], state;
        int process, above;
        snprintf(path, sizeof path, "/proc/%s/stat", entry->d_name);
        FILE *file = *entry->d_name >= '1' && *entry->d_name <= '9' ? fopen(path, "r") : NULL;
        if (!file)
            continue;
        if (fscanf(file, "%d (%*[^)]) %c %d", &process, &state, &above) == 3 && above == parent && state != 'Z')
            found[count++] = process;
        fclose(file);
    }
    closedir(open);
    for (int a = 0; a < count; a++)
        for (int b = 0; b < a; b++)
            if (found[a] < found[b]) {
                const pid_t other = found[a];
                found[a] = found[b];
                found[b] = other;
            }
    return n < count ? found[n] : 0;
}

/* Its exit status, -1 after a signal; what it printed goes to `text`. */
static int ranks_end(pid_t child, FILE *sink, char *text, size_t size)
{
    int status, alone = 0;
    for (pid_t ended = 0; ended == 0; ended = waitpid(child, &status, WNOHANG)) {
        nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
        alone = child_of(child, 0) > 0 ? 0 : alone + 1;
        if (alone == ALONE_MOST) {
            print_message("mpirun waits for ranks that have ended: killed\n");
            kill(child, SIGKILL);
        }
    }
    rewind(sink);
    text[fread(text, 1, size - 1, sink)] = '\0';
    fclose(sink);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void ranks_good(int count, const char *const *arguments)
{
    static char text[200000];
    FILE *sink = tmpfile();
    const int status = ranks_end(ranks_start(count, arguments, sink), sink, text, sizeof text);
    if (status != 0)
        fail_msg("%d ranks end with %d: %s", count, status, text);
}

static char *pixels_read(const char *name, size_t *size)
{
    struct grid grid;
    double complex *pixels;
    assert_int_equal(image_file_read(path_of(name), &grid, &pixels), STATUS_OK);
    *size = grid_pixels(&grid) * sizeof *pixels;
    return (char *)pixels;
}

#define SWEEP(place)                                                                                                   \
    (const char *const[ARGUMENTS_MAX])                                                                                 \
    {                                                                                                                  \
        "sweep", "scene.cfg", "study/quick", "-a", "bp_linear:beta=4", "-a", "bp_nearest", "-o", place                 \
    }

static void any_number_of_ranks_has_the_rows(void **state)
{
    (void)state;
    char place[20];
    program_good(SWEEP("whole"));
    for (int count = 2; count <= RANKS_MOST; count++) {
        snprintf(place, sizeof place, "ranks-%d", count);
        ranks_good(count, SWEEP(place));
        assert_same_results("whole", place);
    }
    ranks_good(
        2, (const char *const[ARGUMENTS_MAX]){"run", "scene.cfg", "-a", "bp_nearest", "-a", "rma_lbf", "-o", "run-2"});
    program_good(
        (const char *const[ARGUMENTS_MAX]){"run", "scene.cfg", "-a", "bp_nearest", "-a", "rma_lbf", "-o", "run-1"});
    assert_same_results("run-1", "run-2");
}

/* An image's bits for any number of ranks, also where ranks are killed. */
static void ranks_form_one_image(void **state)
{
    (void)state;
    static char text[200000];
    size_t sizes[2];
    struct random random = random_seed(24, 0);
    static const char *const alone[ARGUMENTS_MAX] = {"image", "-s",      "study/quick", "-a", "reference",
                                                     "-o",    "one.mat", "--tile",      "8x2"};
    static const char *const arguments[ARGUMENTS_MAX] = {"image", "-s",    "study/quick", "-a", "reference",
                                                         "-o",    "i.mat", "--tile",      "8x2"};
    program_good(alone);
    char *whole = pixels_read("one.mat", &sizes[0]);
    for (int count = 2; count <= RANKS_MOST; count++)
        for (int kills = 0; kills < 2; kills++) {
            if (kills) {
                FILE *sink = tmpfile();
                const pid_t child = ranks_start(count, arguments, sink);
                for (int k = 0; k < 500 && !support_exists("i.mat.tiles"); k++)
                    nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
                nanosleep(&(struct timespec){.tv_nsec = (long)(1e8 * random_uniform(&random))}, NULL);
                const pid_t rank = child_of(child, count % 2);
                if (rank > 0)
                    kill(rank, SIGKILL);
                ranks_end(child, sink, text, sizeof text);
            }
            ranks_good(count, arguments);
            char *pixels = pixels_read("i.mat", &sizes[1]);
            assert_int_equal(sizes[0], sizes[1]);
            assert_memory_equal(whole, pixels, sizes[0]);
            assert_false(support_exists("i.mat.tiles") || support_exists("i.mat.tiles.1"));
            free(pixels);
        }
    program_good((const char *const[ARGUMENTS_MAX]){"simulate", "study/quick", "-o", "e.mat"});
    ranks_good(2, (const char *const[ARGUMENTS_MAX]){"image", "-e", "e.mat", "-a", "reference", "-o", "m.mat",
                                                     "--memory", "1G"});
    char *pixels = pixels_read("m.mat", &sizes[1]);
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(whole, pixels, sizes[0]);
    free(pixels);
    free(whole);
}

/* SIGKILL to rank 0, to another, or to a process that works for one of them, four times; then the rest. What mpirun
   still prints of ranks that it ends is up to it: more rounds until it has been seen. */
static void killed_ranks_resume(void **state)
{
    (void)state;
    enum { KILLS = 4, ROUNDS_MOST = 5 };
    static char text[200000];
    struct random random = random_seed(23, 0);
    const char *given = getenv("SASBENCH_KILLS");
    const int rounds = given ? (atoi(given) + KILLS - 1) / KILLS : 1;
    char place[20], begun[40];
    int ended = 0, told = 0;
    for (int round = 0; round < rounds || (round < ROUNDS_MOST && !(ended > 0 && told > 0)); round++) {
        snprintf(place, sizeof place, "killed-%d", round);
        snprintf(begun, sizeof begun, "%s/rank-1", place);
        for (int k = 0; k < KILLS; k++) {
            const int count = 2 + (KILLS * round + k) % 3;
            const int rank = k % 2 ? 0 : 1 + (int)(random_uniform(&random) * (count - 1));
            FILE *sink = tmpfile();
            const pid_t child = ranks_start(count, SWEEP(place), sink);
            for (int n = 0; n < 1000 && !(support_exists(begun) && child_of(child, rank) > 0); n++)
                nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
            nanosleep(&(struct timespec){.tv_nsec = (long)(9.9e8 * random_uniform(&random))}, NULL);
            pid_t process = child_of(child, rank);
            if (process > 0 && k == 2) /* its child, a crash: the rank goes on */
                process = child_of(process, 0);
            if (process > 0)
                kill(process, SIGKILL);
            const int status = ranks_end(child, sink, text, sizeof text);
            ended += status != 0 && process > 0;
            told += strstr(text, "on signal 9 (Killed)") && strstr(text, "holds what was measured");
        }
        ranks_good(2 + round % 2, SWEEP(place));
        assert_same_results("whole", place);
        assert_false(support_exists(begun));
    }
    print_message("%d runs were ended, %d with the places of their rows\n", ended, told);
    assert_true(ended > 0 && told > 0);
}

/* One process alone takes up what ended ranks have left. */
static void left_rows_are_taken_up(void **state)
{
    (void)state;
    FILE *sink = tmpfile();
    static char text[200000];
    const pid_t child = ranks_start(2, SWEEP("left"), sink);
    for (int k = 0; k < 1000 && !support_exists("left/rank-1/measurements.csv"); k++)
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    nanosleep(&(struct timespec){.tv_nsec = 700000000}, NULL);
    kill(child_of(child, 0), SIGKILL);
    assert_int_not_equal(ranks_end(child, sink, text, sizeof text), 0);
    assert_true(support_exists("left/rank-1"));
    program_good(SWEEP("left"));
    assert_same_results("whole", "left");
    assert_false(support_exists("left/rank-1"));
}

/* Refusals come once, from rank 0; what ranks do not share is refused. */
static void ranks_refuse_once(void **state)
{
    (void)state;
    static char text[200000];
    static const struct {
        const char *arguments[ARGUMENTS_MAX], *says;
    } refusals[] = {
        {{"list"}, "sasbench: list: one of 3 ranks"},
        {{"sweep", "-a", "bp_nowhere"}, "SPEC 'bp_nowhere'"},
        {{"image", "--scene", "scene.cfg", "-a", "bp_nearest", "-o", "x.mat"}, "sasbench: image: one of 3 ranks"},
    };
    for (size_t k = 0; k < COUNT_OF(refusals); k++) {
        FILE *sink = tmpfile();
        const int status = ranks_end(ranks_start(3, refusals[k].arguments, sink), sink, text, sizeof text);
        const char *first = strstr(text, refusals[k].says);
        assert_int_equal(status, 2);
        if (!first || strstr(first + 1, refusals[k].says))
            fail_msg("'%s' not once in: %s", refusals[k].says, text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_ranks_has_the_rows),
        cmocka_unit_test(ranks_form_one_image),
        cmocka_unit_test(killed_ranks_resume),
        cmocka_unit_test(left_rows_are_taken_up),
        cmocka_unit_test(ranks_refuse_once),
    };
    setenv("OMP_NUM_THREADS", "1", 1);
    mpirun = getenv("SASBENCH_MPIRUN");
    if (!mpirun || !*mpirun) {
        puts("no MPI: skipped");
        return SKIPPED;
    }
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
