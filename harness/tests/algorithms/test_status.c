/* What an algorithm says of itself: errors, whichever thread meets them, and more stages than there is room for. */
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "contract/algorithm.h"
#include "common/clock.h"
#include "tests/support.h"

enum { THREADS = 4, LOOPS = 200 };

static enum status parts_run(int failing)
{
    enum status status = STATUS_OK;
#pragma omp parallel for schedule(static, 1) num_threads(THREADS)
    for (int k = 0; k < THREADS; k++)
        if (k == failing)
            status = status_set(STATUS_FAILED, "part %d: no memory", k);
    return status;
}

static void errors_of_workers_reach_the_caller(void **state)
{
    (void)state;
    for (int failing = 0; failing < THREADS; failing++) {
        char expected[40];
        snprintf(expected, sizeof expected, "part %d: no memory", failing);
        status_set(STATUS_OK, "%s", "older");
        assert_int_equal(parts_run(-1), STATUS_OK);
        assert_string_equal(status_message(), "older");
        assert_int_equal(parts_run(failing), STATUS_FAILED);
        assert_string_equal(status_message(), expected);
        assert_string_equal(status_message(), expected);
        status_set(STATUS_FAILED, "scene: %s", status_message());
        snprintf(expected, sizeof expected, "scene: part %d: no memory", failing);
        assert_string_equal(status_message(), expected);
        parts_run(failing);
        status_set(STATUS_FAILED, "newer");
        assert_string_equal(status_message(), "newer");
    }
}

/* Each thread reads its own, and where all fail the caller has one of them, whole. */
static void errors_of_many_threads_stay_whole(void **state)
{
    (void)state;
    int others = 0;
    for (int loop = 0; loop < LOOPS; loop++) {
#pragma omp parallel num_threads(THREADS) reduction(+ : others)
        {
            char expected[600];
            memset(expected, 'a' + omp_get_thread_num(), sizeof expected - 1);
            expected[sizeof expected - 1] = '\0';
            status_set(STATUS_FAILED, "%s", expected);
            others += strcmp(status_message(), expected) != 0;
        }
        const char *message = status_message();
        assert_in_range(*message, 'a', 'a' + THREADS - 1);
        assert_int_equal(strspn(message, (const char[]){*message, '\0'}), 599);
    }
    assert_int_equal(others, 0);
}

static double now_s;

static double clock_told(void)
{
    return now_s;
}

/* Those beyond are added to the last one: nothing is lost, and nothing is written behind the array. */
static void stages_beyond_the_twelfth_go_to_it(void **state)
{
    (void)state;
    enum { STAGES = 15, ROOM = sizeof((struct stages *)NULL)->stage / sizeof((struct stages *)NULL)->stage[0] };
    static const char *const names[STAGES] = {"a", "b", "c", "d", "e", "f", "g", "h",
                                              "i", "j", "k", "l", "m", "n", "o"};
    struct stages stages;
    double sum = 0;
    clock_set(clock_told);
    stages_begin(&stages);
    for (int k = 0; k < 2 * STAGES; k++) {
        now_s += 1 + k % STAGES;
        stages_end(&stages, names[k % STAGES]);
    }
    clock_set(clock_monotonic);
    assert_int_equal(stages.count, ROOM);
    for (int k = 0; k < ROOM; k++) {
        assert_string_equal(stages.stage[k].name, names[k]);
        assert_close(stages.stage[k].seconds, k < ROOM - 1 ? 2 * (k + 1) : 2 * (12 + 13 + 14 + 15), 1e-9);
        sum += stages.stage[k].seconds;
    }
    assert_close(sum, now_s, 1e-9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_of_workers_reach_the_caller),
        cmocka_unit_test(errors_of_many_threads_stay_whole),
        cmocka_unit_test(stages_beyond_the_twelfth_go_to_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
