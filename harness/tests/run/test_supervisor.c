/* A run outlives what its algorithms do: planted ones that crash, in a process as the program makes it. */
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "run/supervisor.h"
#include "run/batch.h"
#include "tests/support.h"

enum crash { CRASH_NONE, CRASH_NULL, CRASH_ABORT, CRASH_FPE, CRASH_KILL, CRASH_EXIT, CRASH_PLAN };
static enum crash wanted;

/* Unchecked, for it is the signal that is wanted and not a sanitizer's report. */
__attribute__((no_sanitize("undefined", "address"))) static void write_nowhere(void)
{
    static int *volatile nowhere;
    *nowhere = 1;
}

static enum status planted_plan(const struct problem *problem, const void *method, const void *options, void **plan)
{
    (void)problem, (void)method, (void)options;
    *plan = NULL;
    if (wanted == CRASH_PLAN)
        write_nowhere();
    return STATUS_OK;
}

static enum status planted_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    (void)plan, (void)echoes;
    for (int k = 0; k < image->patch_count; k++)
        memset(image->pixels[k], 0, grid_pixels(&image->patches[k]) * precision_size(image->precision));
    if (wanted == CRASH_NULL)
        write_nowhere();
    if (wanted == CRASH_ABORT)
        abort();
    if (wanted == CRASH_FPE)
        raise(SIGFPE);
    if (wanted == CRASH_KILL)
        raise(SIGKILL);
    if (wanted == CRASH_EXIT)
        exit(3);
    stages_end(stages, "focus");
    return STATUS_OK;
}

static struct work planted_work(const void *plan)
{
    (void)plan;
    return (struct work){.flops = 1e5, .bytes = 1, .engine = "planted"};
}

static void planted_destroy(void *plan)
{
    (void)plan;
}

static const struct algorithm planted = {.name = "planted",
                                         .plan = planted_plan,
                                         .execute = planted_execute,
                                         .work = planted_work,
                                         .destroy = planted_destroy};

/* As a program begins: no core files, and none of cmocka's handlers. */
static void process_reset(void)
{
    const struct rlimit no_core = {0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    for (int number = 1; number < 32; number++)
        signal(number, SIG_DFL);
}

/* What `run` does; the exit status of the program. */
static int run(const char *directory)
{
    struct scene scene;
    struct batch batch;
    struct spec specs[3] = {0};
    process_reset();
    supervisor_begin();
    support_scene("study/quick", &scene);
    enum status status = spec_parse("bp_nearest", &specs[0]);
    specs[1] = (struct spec){.algorithm = &planted, .precision = PRECISION_FLOAT};
    if (status == STATUS_OK)
        status = spec_parse("bp_linear", &specs[2]);
    if (status == STATUS_OK)
        status = batch_open(directory, 3, false, &batch);
    if (status == STATUS_OK)
        status = batch_close(&batch, batch_scene(&batch, &scene, 3, specs));
    return (int)status;
}

/* In a process of its own, for the test itself must not be the one that begins anew. */
static int run_apart(void)
{
    int state = -1;
    pid_t process = fork();
    if (process == 0) {
        if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr))
            _exit(99);
        _exit(run(folder));
    }
    assert_true(process > 0);
    assert_int_equal(waitpid(process, &state, 0), process);
    return state;
}

static void check_rows(const char *status, const char *reason)
{
    struct results results;
    assert_int_equal(results_read(path_of("measurements.csv"), &results), STATUS_OK);
    assert_int_equal(results.csv.row_count, 3);
    for (int k = 0; k < 3; k++) {
        const struct measurement *row = &results.measurements[k];
        bool is_planted = strcmp(row->algorithm, "planted") == 0;
        assert_string_equal(row->status, is_planted ? status : "ok");
        if (is_planted)
            assert_non_null(strstr(row->reason, reason));
        else
            assert_true(row->run_s > 0 && row->error > 0);
    }
    results_free(&results);
}

/* Whatever ends the process, the other rows are measured, and the reason is reported. The next run tries again. */
static void crashes_are_rows(void **state)
{
    (void)state;
    const struct {
        enum crash crash;
        const char *reason;
    } cases[] = {
        {CRASH_NULL, "ended by signal 11 (Segmentation fault)"},     {CRASH_ABORT, "ended by signal 6 (Aborted)"},
        {CRASH_FPE, "ended by signal 8 (Floating point exception)"}, {CRASH_KILL, "ended by signal 9 (Killed)"},
        {CRASH_EXIT, "ended the program with exit status 3"},        {CRASH_PLAN, "ended by signal 11"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        wanted = cases[k].crash;
        int ended = run_apart();
        assert_true(WIFEXITED(ended));
        assert_int_equal(WEXITSTATUS(ended), STATUS_FAILED);
        check_rows("failed", cases[k].reason);
    }
    wanted = CRASH_NONE;
    assert_int_equal(run_apart(), 0);
    check_rows("ok", "");
}

/* A signal that somebody sent, and a crash that is no algorithm's, end the run as before. */
static void other_ends_pass_through(void **state)
{
    (void)state;
    const int signals[] = {SIGTERM, SIGINT, SIGSEGV, SIGKILL};
    for (size_t k = 0; k < sizeof signals / sizeof *signals; k++) {
        int ended;
        pid_t process = fork();
        if (process == 0) {
            process_reset();
            supervisor_begin();
            if (signals[k] == SIGTERM)
                supervisor_enter("amid a task");
            raise(signals[k]);
            _exit(0);
        }
        assert_int_equal(waitpid(process, &ended, 0), process);
        assert_true(WIFSIGNALED(ended));
        assert_int_equal(WTERMSIG(ended), signals[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(crashes_are_rows, folder_make, folder_remove),
        cmocka_unit_test(other_ends_pass_through),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
