/* The conformance checks catch what they are there for: nearest-neighbour back projection with one fault at a time must
   fail them, by name. Each faulty algorithm runs in a program of its own, this one with the fault's name as
   argument. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/algorithms/conformance_counted.h"
#include "tests/algorithms/conformance_planted.h"

extern const struct algorithm reference;

static const struct fault *injected;

/* ---- works ---- */

static struct work work_few_flops(const void *plan)
{
    struct work work = bp_work(plan);
    work.flops /= 1000;
    return work;
}

static struct work work_many_flops(const void *plan)
{
    struct work work = bp_work(plan);
    work.flops *= 1000;
    return work;
}

static struct work work_without_pairs(const void *plan)
{
    struct work work = bp_work(plan);
    work.pairs = 0;
    return work;
}

static struct work work_one_flop(const void *plan)
{
    struct work work = bp_work(plan);
    work.pairs = 0;
    work.flops = 1;
    return work;
}

static struct work work_three_pairs(const void *plan)
{
    struct work work = bp_work(plan);
    work.pairs = 3;
    return work;
}

static struct work work_one_byte(const void *plan)
{
    struct work work = bp_work(plan);
    work.bytes = 1;
    return work;
}

static void destroy_nothing(void *plan)
{
    (void)plan;
}

/* ---- the table ---- */

static const struct fault {
    const char *name, *says;  /* a part of the message */
    struct algorithm differs; /* what is not as in a good one */
} faults[] = {
    {"none", NULL, {0}},
    {"double declared integer", "setting scale: a field of 0 bytes", {.params = by_hand}},
    {"setting that nothing reads", "setting scale: off its default it changes", {.params = unread}},
    {"leak", "raw, float: destroy leaves 1 blocks of 1 bytes", {.plan = plan_leaks}},
#ifndef SANITIZED
    {"mmap leak", "raw, float: the pages that plan and destroy leave mapped each time is 4,", {.plan = plan_maps}},
    {"mmap in execute", "raw, float: the pages that a repeated execute touches anew is 16,", {.execute = execute_maps}},
#endif
    {"plan kept", "raw, float: destroy leaves", {.destroy = destroy_nothing}},
    {"fftw_alloc in execute", "raw, float: execute allocates 2 and frees 2 blocks", {.execute = execute_allocates}},
    {"fftw_plan in execute", "raw, float: execute makes 2 FFT plans", {.execute = execute_plans}},
    {"flops off by 1000", "ordinary: work.flops is", {.work = work_few_flops}},
    {"flops 1000 times too many", "work.flops is", {.work = work_many_flops}},
    {"one flop for no pairs", "ordinary: work.flops is 1, must be from", {.work = work_one_flop}},
    {"3 pairs", "ordinary: work.pairs is 3,", {.work = work_three_pairs}},
    {"1 byte", "raw, float: work.bytes is 1,", {.work = work_one_byte}},
    {"aperture limit ignored",
     "aperture limit: the error against reference is",
     {.plan = plan_unlimited, .work = work_without_pairs}},
    {"y ignored", "curved track in space: the error against reference is", {.plan = plan_without_y}},
    {"z ignored", "curved track in space: the error against reference is", {.plan = plan_without_z}},
    {"velocity along x only", "curved track in space: the error against reference is", {.plan = plan_along_x}},
    {"t0 of the first ping", "curved track in space: the error against reference is", {.plan = plan_one_t0}},
    {"straight tracks only",
     "curved track in space: refused, \"the track is not straight\"",
     {.plan = plan_straight_only}},
    {"wrong sign on backward tracks", "towards -x: the error against reference is", {.plan = plan_forward}},
    {"angle ignored", "turned grid: the error against reference is", {.plan = plan_unturned}},
    {"first patch only", "two patches: the error against reference is", {.execute = execute_first_patch}},
    {"gain", "raw: the gain's distance from 1 is 0.1", {.execute = execute_gain}},
    {"false forecast", "ordinary: the error after one gain is", {.cost = forecast_perfect}},
    {"false condition",
     "ordinary: its conditions accept what its plan accepts: the image: condition receivers",
     {.conditions = conditions_false}},
    {"no reason", "one ping: plan returns status 3, \"no\"", {.plan = plan_without_reason}},
    {"half a plan", "raw: without the memory of allocation 0 plan leaves 1 blocks", {.plan = plan_half_made}},
    {"static plan",
     "two live plans: 20 of 40 images have other bits",
     {.plan = plan_static, .execute = execute_static}},
    {"static scratch", "two executes at once: ", {.execute = execute_shared}},
    {"memoised image", "other echoes in the same array: the difference", {.execute = execute_memoised}},
    {"known targets", "ordinary: the error against reference is", {.execute = execute_known}},
    {"omp_set_num_threads in execute", "raw, float: OpenMP's settings differ", {.execute = execute_threads}},
    {"reads past the record", "ordinary, double: images ended", {.execute = execute_past_end}},
    {"reads ahead of the record", "ordinary, double: images ended", {.execute = execute_ahead}},
    {"races", "other bits", {.execute = execute_races}},
    {"last pixel not written", "the error against reference is", {.execute = execute_last_pixel}},
    {"NaN", "ordinary: the error against reference is nan, at most 0.15", {.execute = execute_nan}},
    {"exit", "ordinary, double: images ended the program with exit status", {.execute = execute_exits}},
    {"not linear", "sum of two echoes: the difference", {.execute = execute_adds}},
    {"not exact", "ordinary: the error against reference is 0.0", {.traits = TRAIT_EXACT}},
    {"without a baseline", "0 rows of it; `./sasbench baseline` adds them", {.name = "no_such_algorithm"}},
};
enum { FAULTS = sizeof faults / sizeof *faults };

/* Takes the name of a shipped one, whose rows are in the baseline. */
static struct algorithm faulty = {
    .name = "bp_nearest",
    .summary = "nearest-neighbour back projection with a fault",
    .reference = "none",
    .traits = TRAIT_ANY_TRACK | TRAIT_APERTURE_LIMIT,
    .options_size = sizeof(struct options),
    .plan = plan_good,
    .execute = bp_execute,
    .work = bp_work,
    .destroy = bp_destroy,
};
const struct algorithm *const algorithms[] = {&reference, &faulty, NULL};
const struct algorithm *const algorithm_filters[] = {NULL};

const struct algorithm *algorithm_find(const char *name)
{
    for (int k = 0; algorithms[k]; k++)
        if (strcmp(algorithms[k]->name, name) == 0)
            return algorithms[k];
    return NULL;
}

static int run_with(const char *name)
{
    for (int k = 0; k < FAULTS && !injected; k++)
        if (strcmp(faults[k].name, name) == 0)
            injected = &faults[k];
    assert_non_null(injected);
    const struct algorithm *d = &injected->differs;
    faulty.name = d->name ? d->name : faulty.name;
    faulty.params = d->params;
    faulty.traits |= d->traits;
    faulty.plan = d->plan ? d->plan : faulty.plan;
    faulty.execute = d->execute ? d->execute : faulty.execute;
    faulty.cost = d->cost;
    faulty.conditions = d->conditions;
    faulty.work = d->work ? d->work : faulty.work;
    faulty.destroy = d->destroy ? d->destroy : faulty.destroy;
    return conformance_counted(faulty.name) > 0;
}

static const char *program;

/* Everything that the program with this fault prints; its exit status. */
static int output_of(const char *fault, char *text, size_t size)
{
    setenv("FAULTY", program, 1);
    setenv("FAULT", fault, 1);
    FILE *pipe = popen("\"$FAULTY\" \"$FAULT\" 2>&1", "r");
    assert_non_null(pipe);
    size_t length = fread(text, 1, size - 1, pipe);
    text[length] = '\0';
    return pclose(pipe);
}

/* In a line of a broken promise. */
static const char *broken_find(const char *text, const char *says)
{
    for (const char *line = text; (line = strstr(line, "  BROKEN ")); line++) {
        const char *found = strstr(line, says), *end = strchr(line, '\n');
        if (found && found < end)
            return line;
    }
    return NULL;
}

static void each_fault_is_caught(void **state)
{
    (void)state;
    static char text[1 << 16];
    int missed = 0;
    for (int k = 0; k < FAULTS; k++) {
        int status = output_of(faults[k].name, text, sizeof text);
        const char *says = faults[k].says ? broken_find(text, faults[k].says) : NULL;
        bool right = faults[k].says ? WIFEXITED(status) && WEXITSTATUS(status) > 0 && says : status == 0;
        print_message("%s: %.*s\n", faults[k].name, says ? (int)strcspn(says, "\n") : 0, says ? says : "");
        if (!right)
            print_error("%s: status %d, must %s\n%s\n", faults[k].name, status,
                        faults[k].says ? "fail and say" : "pass", faults[k].says ? faults[k].says : text);
        missed += !right;
    }
    assert_int_equal(missed, 0);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_fault_is_caught),
    };
    program = argv[0];
    return argc > 1 ? run_with(argv[1]) : cmocka_run_group_tests_name("conformance faults", tests, NULL, NULL);
}
