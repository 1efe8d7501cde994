/* What a process takes at most, as the system counts it, is what a plan says of it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "files/paths.h"
#include "imaging/imaging.h"
#include "choice/choice.h"
#include "choice/process.h"
#include "scene/scene.h"
#include "tests/command/program.h"

/* Measured over said: 0.86 to 1.08. */
static const double LEAST = 0.8, MOST = 1.2;

/* The most that lay in memory of a process that images a scene with one thread; what this one takes is a part of it. */
static double child_bytes(const char *scene, const char *spec)
{
    const char *const arguments[ARGUMENTS_MAX] = {"image", "--scene", scene, "-a", spec, "-o", "x.mat", "-t", "1"};
    int status;
    struct rusage usage;
    FILE *nothing = fopen("/dev/null", "w");
    assert_non_null(nothing);
    const pid_t child = program_start(arguments, nothing, nothing);
    assert_int_equal(wait4(child, &status, 0, &usage), child);
    fclose(nothing);
    assert_int_equal(status, 0);
    return 1024.0 * (double)usage.ru_maxrss;
}

static double plan_bytes(const char *text, const struct scene *scene)
{
    struct spec spec;
    struct imaging imaging;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    const struct problem problem = scene_problem(scene, spec.precision);
    assert_int_equal(imaging_open(&spec, &problem, &imaging), STATUS_OK);
    const double bytes = process_bytes(&problem, imaging.algorithm->work(imaging.plan).bytes);
    imaging_close(&imaging);
    spec_free(&spec);
    return bytes;
}

/* Echoes that are most of it, tables, an image that is most of it, and next to nothing. */
static void processes_take_what_plans_say(void **state)
{
    (void)state;
    static const char *const scenes[] = {"study/swath", "pf05/nine", "study/quick", "wide.cfg"};
    static const char *const specs[] = {"bp_nearest",
                                        "bp_farrow",
                                        "bp_sinc:engine=general",
                                        "bp_factorised",
                                        "rma_delay",
                                        "bp_fitted:precision=double",
                                        "rma_lbf:precision=double"};
    enum { SCENES = sizeof scenes / sizeof *scenes, SPECS = sizeof specs / sizeof *specs };
    double measured[SCENES][SPECS], low = INFINITY, high = 0;
    text_write("wide.cfg", "base = {\n@include \"study/quick.cfg\"\n};\n"
                           "image = { x = { first = -0.5; step = 1e-3; count = 1500; };\n"
                           "          r = { first = 19.5; step = 1e-3; count = 1500; }; };\n");
    for (int k = 0; k < SCENES * SPECS; k++) /* before this process grows, of which the children begin as copies */
        measured[k / SPECS][k % SPECS] = child_bytes(scenes[k / SPECS], specs[k % SPECS]);
    for (int k = 0; k < SCENES; k++) {
        struct scene scene;
        if (scene_load(strchr(scenes[k], '.') ? path_in(scenes[k]) : scenes[k], SCENE_DIRECTORY, &scene) != STATUS_OK)
            fail_msg("%s", status_message());
        for (int n = 0; n < SPECS; n++) {
            const double said = plan_bytes(specs[n], &scene), ratio = measured[k][n] / said;
            low = fmin(low, ratio);
            high = fmax(high, ratio);
            if (!(ratio >= LEAST && ratio <= MOST))
                print_message("%s, %s: %.4g MB, of which %.4g MB are planned\n", scenes[k], specs[n],
                              measured[k][n] / 1e6, said / 1e6);
        }
        scene_free(&scene);
    }
    print_message("processes take %.3f to %.3f times what is planned\n", low, high);
    assert_true(low >= LEAST && high <= MOST);
}

/* The choice keeps to a budget of the whole process: with a byte less than it says, it is another, or none. */
static void budgets_are_of_the_process(void **state)
{
    (void)state;
    struct scene scene;
    struct choice choice, less;
    assert_int_equal(scene_load("study/swath", SCENE_DIRECTORY, &scene), STATUS_OK);
    const struct problem problem = scene_problem(&scene, PRECISION_FLOAT);
    assert_int_equal(choice_make(&problem, NULL, &(struct budget){.error = 1e-2, .bytes = 1e12}, &choice), STATUS_OK);
    assert_true(choice.found && choice.list[0].bytes > process_bytes(&problem, 0));
    assert_int_equal(
        choice_make(&problem, NULL, &(struct budget){.error = 1e-2, .bytes = choice.list[0].bytes - 1}, &less),
        STATUS_OK);
    assert_true(!less.found || less.list[0].bytes < choice.list[0].bytes);
    choice_free(&less);
    assert_int_equal(
        choice_make(&problem, NULL, &(struct budget){.error = 1e-2, .bytes = process_bytes(&problem, 0)}, &less),
        STATUS_OK);
    assert_true(!less.found);
    choice_free(&less);
    choice_free(&choice);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(processes_take_what_plans_say),
                                       cmocka_unit_test(budgets_are_of_the_process)};
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
