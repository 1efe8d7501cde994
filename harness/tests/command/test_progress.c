/* What those who wait see: a line on a terminal, with the seconds and the share that is done, and no trace of it
   behind; every algorithm says how far it is. */
#include <math.h>
#include <pty.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/progress.h"
#include "files/paths.h"
#include "run/progress_line.h"
#include "measure/session.h"
#include "tests/command/program.h"

/* What a child does on a terminal of its own, COLUMNS wide. */
static void on_terminal(void (*work)(const void *of), const void *of, char *said, size_t size)
{
    enum { COLUMNS = 40 };
    const struct winsize window = {.ws_row = 24, .ws_col = COLUMNS};
    int terminal, status;
    size_t used = 0;
    const pid_t child = forkpty(&terminal, NULL, NULL, &window);
    assert_true(child >= 0);
    if (child == 0) {
        work(of);
        _exit(0);
    }
    for (ssize_t got; used < size - 1 && (got = read(terminal, said + used, size - 1 - used)) > 0;)
        used += (size_t)got;
    said[used] = '\0';
    close(terminal);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
}

static void work_half(const void *of)
{
    progress_line(false, "%s", (const char *)of);
    progress_part(0.25, 0.75, 4);
    progress_step();
    progress_step();
    sleep(3);
    progress_line_clear();
    puts("done");
    fflush(stdout);
}

static void a_terminal_is_told(void **state)
{
    (void)state;
    char said[2000];
    on_terminal(work_half, "work", said, sizeof said);
    assert_non_null(strstr(said, "\r\033[Kwork\r"));
    assert_true(strstr(said, "\r\033[Kwork, 1 s, 50 %\r") || strstr(said, "\r\033[Kwork, 2 s, 50 %\r"));
    assert_non_null(strstr(said, "\r\033[Kdone\r\n"));
    /* One that is wider is cut. */
    on_terminal(work_half, "work on a scene whose name is longer than the terminal is wide", said, sizeof said);
    assert_true(strstr(said, "\r\033[Kwork on a scene whose name i, 1 s, 50 %\r")
                || strstr(said, "\r\033[Kwork on a scene whose name i, 2 s, 50 %\r"));
}

static void program_execute(const void *of)
{
    execv(getenv("SASBENCH_PROGRAM"), (char *const *)of);
    _exit(127);
}

static void commands_tell_a_terminal(void **state)
{
    (void)state;
    static const char *const image[] = {"sasbench",  "image", "--scene",  "study/quick", "-a",
                                        "bp_linear", "-o",    "told.mat", NULL};
    static const char *const run[] = {"sasbench", "run", "study/quick", "-a", "bp_linear", "-o", "told", NULL};
    char said[16000];
    assert_int_equal(chdir(path_in("")), 0);
    on_terminal(program_execute, image, said, sizeof said);
    assert_non_null(strstr(said, "study/quick: echoes"));
    assert_non_null(strstr(said, "study/quick: image by bp_linear"));
    assert_non_null(strstr(said, "\r\033[Ktold.mat: bp_linear of study/quick"));
    on_terminal(program_execute, run, said, sizeof said);
    assert_non_null(strstr(said, "[1/1] study/quick echoes and exact"));
    assert_non_null(strstr(said, "[1/1] study/quick bp_linear"));
}

/* All of a scene is done when it is done, and nothing at the beginning. */
static void each_algorithm_says_how_far_it_is(void **state)
{
    (void)state;
    struct scene scene;
    struct session session;
    assert_int_equal(scene_load("study/quick", data_path(DATA_SCENES), &scene), STATUS_OK);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    int imaged = 0;
    for (int k = 0; algorithms[k]; k++) {
        struct spec spec;
        struct image image;
        assert_int_equal(spec_parse(algorithms[k]->name, &spec), STATUS_OK);
        progress_part(0, 0, 0);
        assert_true(progress_share() == 0);
        if (session_image(&session, &spec, &image) == STATUS_OK) {
            if (!(fabs(progress_share() - 1) < 1e-12))
                fail_msg("%s ends at %g", algorithms[k]->name, progress_share());
            image_free(&image);
            imaged++;
        }
        spec_free(&spec);
    }
    assert_true(imaged >= 10);
    session_close(&session);
    scene_free(&scene);
}

static int folder_leave_last(void **state)
{
    assert_int_equal(chdir("/"), 0);
    return folder_remove(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_terminal_is_told), cmocka_unit_test(commands_tell_a_terminal),
                                       cmocka_unit_test(each_algorithm_says_how_far_it_is)};
    return cmocka_run_group_tests(tests, inputs_make, folder_leave_last);
}
