/* compare --ab: what the statistics conclude from made-up times, and what becomes of programs that are slower, refuse,
   crash, hang or answer something else. The programs are shell scripts; the real one is run once. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "gate/ab.h"
#include "gate/ab_interval.h"
#include "scene/random.h"
#include "tests/support.h"

/* --- Statistics ----------------------------------------------------------------------------------------------- */

enum { ROUNDS = 16, TRIALS = 200 };

/* Ratios of times around `ratio`; the noises are standard deviations of a round and of a block. Every tenth block is
   disturbed by up to 50 %, to either side. */
static struct ab_interval draw_interval(struct random *random, double ratio, double noise_round, double noise_block,
                                        double miss)
{
    double ratios[ROUNDS][AB_BLOCKS];
    for (int k = 0, round = 0; round < ROUNDS; round++) {
        double shift = noise_round * M_SQRT2 * creal(random_normal(random));
        for (int block = 0; block < AB_BLOCKS; block++, k++) {
            double hit = k % 10 == 0 ? 0.5 * (2 * random_uniform(random) - 1) : 0;
            ratios[round][block] = ratio * exp(shift + hit + noise_block * M_SQRT2 * creal(random_normal(random)));
        }
    }
    const struct ab_interval interval = ab_interval_find(ratios, ROUNDS, miss);
    assert_true(interval.low <= interval.middle && interval.middle <= interval.high);
    return interval;
}

static void verdicts_of_made_up_times(void **state)
{
    (void)state;
    static const struct {
        double ratio, noise_round, noise_block;
        enum verdict verdict;
        int least; /* of the trials that must come to it; the others are too noisy to tell */
    } cases[] = {
        {1.00, 0.01, 0.02, VERDICT_SAME, TRIALS - 10}, {1.00, 0.02, 0.06, VERDICT_SAME, TRIALS / 10},
        {1.00, 0.00, 0.50, VERDICT_NOISY, TRIALS},     {1.10, 0.01, 0.02, VERDICT_WORSE, TRIALS - 10},
        {1.30, 0.02, 0.06, VERDICT_WORSE, TRIALS - 2}, {0.80, 0.01, 0.02, VERDICT_BETTER, TRIALS - 2},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        struct random random = random_seed(7, n);
        int counts[VERDICTS] = {0};
        for (int trial = 0; trial < TRIALS; trial++) {
            struct ab_interval interval =
                draw_interval(&random, cases[n].ratio, cases[n].noise_round, cases[n].noise_block, 1e-4);
            counts[ab_interval_verdict(&interval)]++;
        }
        enum verdict verdict = cases[n].verdict;
        /* A slowdown of 10 % may also be but warned of, never denied. */
        int others = TRIALS - counts[verdict] - (verdict == VERDICT_NOISY ? 0 : counts[VERDICT_NOISY])
                     - (verdict == VERDICT_WORSE ? counts[VERDICT_WARNING] : 0);
        if (counts[verdict] < cases[n].least || others > 0)
            fail_msg("case %zu: %d %s; %d worse, %d warnings, %d better, %d same, %d noisy", n, counts[verdict],
                     verdict_names[verdict], counts[VERDICT_WORSE], counts[VERDICT_WARNING], counts[VERDICT_BETTER],
                     counts[VERDICT_SAME], counts[VERDICT_NOISY]);
    }
}

static void intervals_hold_as_often_as_they_say(void **state)
{
    (void)state;
    struct random random = random_seed(8, 0);
    int outside = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        struct ab_interval interval = draw_interval(&random, 1.07, 0.02, 0.02, 0.025);
        outside += interval.low > 1.07 || interval.high < 1.07;
    }
    assert_in_range(outside, TRIALS / 100, TRIALS / 8); /* 5 %, and what few rounds add */
}

static void verdicts_at_the_stated_effects(void **state)
{
    (void)state;
    static const struct {
        struct ab_interval interval;
        enum verdict verdict;
    } cases[] = {
        {{1.051, 1.06, 1.07}, VERDICT_WORSE},
        {{1.049, 1.06, 1.07}, VERDICT_WARNING},
        {{1.031, 1.04, 1.045}, VERDICT_WARNING},
        {{1.029, 1.04, 1.045}, VERDICT_SAME},
        {{0.9, 1, 1.049}, VERDICT_SAME},
        {{0.9, 1, 1.051}, VERDICT_NOISY},
        {{0.9, 0.95, 0.97}, VERDICT_BETTER},
        {{0.9, 0.95, 0.98}, VERDICT_SAME},
        {{0.2, 1, 4}, VERDICT_NOISY},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        assert_int_equal(ab_interval_verdict(&cases[k].interval), cases[k].verdict);
}

/* --- Programs ------------------------------------------------------------------------------------------------- */

static struct ab_effort quick = {4, 2, 8, 20, 30};

static int folder_remove_known(void **state)
{
    (void)state;
    static const char *const names[] = {"old", "new", "pid"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        remove(path_of(names[k]));
    return rmdir(folder);
}

static void script_write(const char *name, const char *text)
{
    FILE *file = fopen(path_of(name), "w");
    assert_non_null(file);
    fprintf(file, "#!/bin/sh\n%s", text);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod(path_of(name), 0755), 0);
}

/* A program that plans and runs: what it answers to either. */
#define HELLO              "echo sasbench measure 1\n"
#define PROGRAM(plan, run) HELLO "while read what rest; do case $what in plan) " plan ";; run) " run ";; esac; done\n"
#define PLANNED            "echo planned 0 a1"
#define TOOK(text)         "echo 'took " text "'"
#define GOOD               PROGRAM(PLANNED, TOOK("0.010 clear=0.0001;compress=0.0039;focus=0.006"))

static enum status compare_scripts(const char *old, const char *new, struct diff *diff)
{
    static const char *const scenes[] = {"gate/points"};
    struct spec spec;
    script_write("old", old);
    script_write("new", new);
    assert_int_equal(spec_parse("bp_linear", &spec), STATUS_OK);
    char paths[2][400];
    snprintf(paths[0], sizeof paths[0], "%s", path_of("old"));
    snprintf(paths[1], sizeof paths[1], "%s", path_of("new"));
    enum status status = ab_run(paths[0], paths[1], scenes, 1, &spec, 1, &quick, diff);
    spec_free(&spec);
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1); /* no child is left */
    assert_int_equal(errno, ECHILD);
    return status;
}

static void slower_stages_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *new;
        enum verdict total, compress, focus;
        enum status status;
    } cases[] = {
        {GOOD, VERDICT_SAME, VERDICT_SAME, VERDICT_SAME, STATUS_OK},
        {PROGRAM(PLANNED, TOOK("0.0106 clear=0.0001;compress=0.0039;focus=0.0066")), VERDICT_WORSE, VERDICT_SAME,
         VERDICT_WORSE, STATUS_FAILED},
        {PROGRAM(PLANNED, TOOK("0.0104 clear=0.0001;compress=0.0043;focus=0.006")), VERDICT_WARNING, VERDICT_WORSE,
         VERDICT_SAME, STATUS_FAILED},
        {PROGRAM(PLANNED, TOOK("0.0102 clear=0.0003;compress=0.0039;focus=0.006")), VERDICT_SAME, VERDICT_SAME,
         VERDICT_SAME, STATUS_OK},
        {PROGRAM(PLANNED, TOOK("0.0104 clear=0.0003;compress=0.0041;focus=0.006")), VERDICT_WARNING, VERDICT_WORSE,
         VERDICT_SAME, STATUS_FAILED},
        {PROGRAM(PLANNED, TOOK("0.007 clear=0.0001;compress=0.0039;focus=0.003")), VERDICT_BETTER, VERDICT_SAME,
         VERDICT_BETTER, STATUS_OK},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        struct diff diff;
        if (compare_scripts(GOOD, cases[n].new, &diff) != STATUS_OK)
            fail_msg("case %zu: %s", n, status_message());
        const enum verdict verdicts[] = {cases[n].total, cases[n].compress, cases[n].focus};
        static const char *const parts[] = {"total", "compress", "focus"};
        assert_int_equal(diff.finding_count, 3); /* clear is too small to be compared alone */
        for (int k = 0; k < 3; k++) {
            const struct finding *f = &diff.findings[k];
            assert_string_equal(f->detail, parts[k]);
            if (f->verdict != verdicts[k])
                fail_msg("case %zu: %s is %s", n, parts[k], verdict_names[f->verdict]);
        }
        assert_true(fabs(diff.findings[0].before - 0.010) < 1e-9);
        assert_int_equal(diff_status(&diff), cases[n].status);
        diff_free(&diff);
    }
}

static void what_one_program_refuses_is_gone_or_new(void **state)
{
    (void)state;
    static const char refusing[] = PROGRAM("echo refused no such thing", "echo failed");
    struct diff diff;
    assert_int_equal(compare_scripts(GOOD, refusing, &diff), STATUS_OK);
    assert_int_equal(diff.counts[CLASS_TIME][VERDICT_GONE], 1);
    assert_int_equal(diff_status(&diff), STATUS_FAILED);
    diff_free(&diff);
    assert_int_equal(compare_scripts(refusing, GOOD, &diff), STATUS_OK);
    assert_int_equal(diff.counts[CLASS_TIME][VERDICT_NEW], 1);
    assert_int_equal(diff_status(&diff), STATUS_OK);
    diff_free(&diff);
    assert_int_equal(compare_scripts(refusing, refusing, &diff), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "no such thing"));
    diff_free(&diff);
}

static void faulty_programs_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *program, *says[3];
    } cases[] = {
        {"exit 3\n", {"ended with status 3", "sasbench measure 1"}},
        {"kill -SEGV $$\n", {"signal 11", "sasbench measure 1"}},
        {"echo hello\n", {"sends 'hello'", "another version"}},
        {"echo sasbench measure 2\n", {"sasbench measure 2", "another version"}},
        {"exec sleep 100\n", {"sends nothing for 1 s"}},
        {"yes | tr -d '\\n'\n", {"longer than 8192"}},
        {HELLO "exit 0\n", {"ended with status 0", "'plan bp_linear:beta=8"}},
        {HELLO "exec 0<&- 1>&-; sleep 100\n", {"closed its output", "'plan "}},
        {HELLO "sleep 100\n", {"sends nothing", "after 'plan "}},
        {PROGRAM("echo what", "exit"), {"answers 'what' to 'plan", "'planned JOB HASH' is needed"}},
        {PROGRAM("echo planned 0 a2", "exit"), {"gate/points", "read it differently"}},
        {PROGRAM(PLANNED, "exit 1"), {"ended with status 1 after 'run 0 1'"}},
        {PROGRAM(PLANNED, "sleep 100"), {"sends nothing", "after 'run 0 1'"}},
        {PROGRAM(PLANNED, "echo failed out of luck"), {"answers 'failed out of luck' to 'run 0 1'"}},
        {PROGRAM(PLANNED, TOOK("nan focus=1")), {"'took nan focus=1'", "is needed"}},
        {PROGRAM(PLANNED, TOOK("-1 focus=1")), {"'took -1 focus=1'"}},
        {PROGRAM(PLANNED, TOOK("1 focus=x")), {"'took 1 focus=x'"}},
        {PROGRAM(PLANNED, TOOK("1 focus=1;")), {"'took 1 focus=1;'"}},
        {PROGRAM(PLANNED, TOOK("1 a=1 b")), {"'took 1 a=1 b'"}},
        {PROGRAM(PLANNED, TOOK("1 a=1;b=1;c=1;d=1;e=1;f=1;g=1;h=1;i=1;j=1;k=1;l=1;m=1")), {"'took 1 a=1;b=1"}},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        for (int side = 0; side < (strstr(cases[n].says[0], "nothing") ? 1 : 2); side++) {
            struct diff diff;
            quick.patience_s = strstr(cases[n].says[0], "nothing") ? 1 : 30;
            const char *good = GOOD, *bad = cases[n].program;
            enum status status = compare_scripts(side ? good : bad, side ? bad : good, &diff);
            bool said = strstr(status_message(), cases[n].says[0])
                        && (strstr(cases[n].says[0], "gate") || strstr(status_message(), side ? "NEW " : "OLD "));
            for (int k = 1; k < 3 && cases[n].says[k]; k++)
                said = said && strstr(status_message(), cases[n].says[k]);
            if (status != STATUS_INVALID || !said)
                fail_msg("case %zu, side %d: status %d, '%s'", n, side, status, status_message());
            diff_free(&diff);
        }
}

static void what_is_no_program_is_told(void **state)
{
    (void)state;
    static const char *const scenes[] = {"gate/points"}, *const no_scenes[] = {"gate/nothing"};
    struct diff diff;
    script_write("old", GOOD);
    chmod(path_of("old"), 0644);
    const char *const paths[] = {folder, path_of("old"), path_of("none")};
    for (int k = 0; k < 3; k++) {
        assert_int_equal(ab_run(paths[k], "/bin/sh", scenes, 1, NULL, 0, &quick, &diff), STATUS_INVALID);
        assert_non_null(strstr(status_message(), "no program that can be run"));
        assert_non_null(strstr(status_message(), paths[k]));
        diff_free(&diff);
    }
    assert_int_equal(ab_run(paths[1], paths[1], no_scenes, 1, NULL, 0, &quick, &diff), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "gate/nothing"));
    diff_free(&diff);
}

/* What a hanging program had started is ended with it. */
static void nothing_is_left_behind(void **state)
{
    (void)state;
    struct diff diff;
    char text[500];
    quick.patience_s = 1;
    snprintf(text, sizeof text, "sleep 300 &\necho $! > %s\nwait\n", path_of("pid"));
    assert_int_equal(compare_scripts(GOOD, text, &diff), STATUS_INVALID);
    diff_free(&diff);
    int process = 0;
    FILE *file = fopen(path_of("pid"), "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%d", &process), 1);
    fclose(file);
    for (int k = 0; k < 500 && kill(process, 0) == 0; k++) /* until its new parent has seen its end */
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    assert_int_equal(kill(process, 0), -1);
}

/* The real one beside itself: no verdict is expected of so few rounds. */
static void the_real_program_answers(void **state)
{
    (void)state;
    static const char *const scenes[] = {"gate/points"};
    const struct ab_effort effort = {2, 1, 2, 20, 60};
    const char *program = getenv("SASBENCH_PROGRAM");
    struct diff diff;
    struct spec specs[2];
    assert_non_null(program);
    assert_int_equal(spec_parse("bp_linear:beta=2,precision=double", &specs[0]), STATUS_OK);
    assert_int_equal(spec_parse("rma_pca", &specs[1]), STATUS_OK);
    if (ab_run(program, program, scenes, 1, specs, 2, &effort, &diff) != STATUS_OK)
        fail_msg("%s", status_message());
    assert_true(diff.finding_count >= 4);
    assert_string_equal(diff.findings[0].detail, "total");
    assert_non_null(strstr(diff.findings[0].spec, "bp_linear:beta=2"));
    for (int k = 0; k < diff.finding_count; k++) {
        const struct finding *f = &diff.findings[k];
        assert_true(f->before > 0 && f->after > 0 && f->change_low <= f->change && f->change <= f->change_high);
    }
    diff_free(&diff);
    spec_free(&specs[0]);
    spec_free(&specs[1]);
}

int main(void)
{
#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, folder_make, folder_remove_known)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(verdicts_of_made_up_times),
        cmocka_unit_test(intervals_hold_as_often_as_they_say),
        cmocka_unit_test(verdicts_at_the_stated_effects),
        IN_FOLDER(slower_stages_are_told),
        IN_FOLDER(what_one_program_refuses_is_gone_or_new),
        IN_FOLDER(faulty_programs_are_told),
        IN_FOLDER(what_is_no_program_is_told),
        IN_FOLDER(nothing_is_left_behind),
        IN_FOLDER(the_real_program_answers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
