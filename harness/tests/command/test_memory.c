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
#include "scene/simulate.h"
#include "tests/command/program.h"

/* Measured over said: 0.86 to 1.08. */
static const double LEAST = 0.8, MOST = 1.2;

/* The most that lay in memory of a process, whose words go to the file "said"; what this one takes is a part of it. */
static double child_bytes(const char *const *arguments)
{
    int status;
    struct rusage usage;
    FILE *said = fopen(path_in("said"), "w");
    assert_non_null(said);
    const pid_t child = program_start(arguments, said, said);
    assert_int_equal(wait4(child, &status, 0, &usage), child);
    fclose(said);
    if (status != 0)
        fail_msg("%s", support_read("said"));
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
        measured[k / SPECS][k % SPECS] = child_bytes((const char *const[ARGUMENTS_MAX]){
            "image", "--scene", scenes[k / SPECS], "-a", specs[k % SPECS], "-o", "x.mat", "-t", "1"});
    for (int k = 0; k < SCENES; k++) {
        struct scene scene;
        if (scene_load(strchr(scenes[k], '.') ? path_in(scenes[k]) : scenes[k], data_path(DATA_SCENES), &scene)
            != STATUS_OK)
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
    assert_int_equal(scene_load("study/swath", data_path(DATA_SCENES), &scene), STATUS_OK);
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

static enum status pings_make(void *simulation, int first, int count, double complex *samples)
{
    return simulation_pings(simulation, first, count, samples);
}

/* long.mat, of version 7.3, whose samples take 86 MB in float. */
static void long_write(void)
{
    struct scene scene;
    struct simulation *simulation;
    text_write("long.cfg", "sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\npulse = { kind = \"flat\"; };\n"
                           "array = { tx_length = 0.08; rx_length = 0.04; receivers = 4; first_offset = 0.04; "
                           "pitch = 0.04; };\n"
                           "track = { speed = 1.25; pri = 0.064; pings = 3000; x_first = -120.0; };\n"
                           "record = { first_sample = 720; samples = 900; };\n"
                           "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.443; };\n"
                           "aperture_limit = 0.1;\ntargets = { points = ( { x = 0.1; r = 30.0; } ); };\n"
                           "image = { x = { first = -100.0; step = 0.04; count = 5000; };\n"
                           "          r = { first = 20.0; step = 0.04; count = 400; }; };\n");
    assert_int_equal(scene_load(path_in("long.cfg"), data_path(DATA_SCENES), &scene), STATUS_OK);
    const struct echo_notes notes = scene_notes(&scene);
    assert_int_equal(simulation_open(&scene, 1, &simulation), STATUS_OK);
    const struct sample_source source = {simulation_exponent(simulation), pings_make, simulation};
    assert_int_equal(echo_file_blocks(path_in("long.mat"), &scene.acquisition, &source, 100, &notes), STATUS_OK);
    simulation_close(simulation);
    scene_free(&scene);
}

/* Tiles for a memory: the process keeps to it, in several tiles, and leaves little of it unused. */
static void tiles_keep_to_a_memory(void **state)
{
    (void)state;
    static const char *const specs[] = {"bp_nearest", "bp_farrow", "bp_sinc:taps=4,engine=general", "bp_factorised",
                                        "rma_delay"};
    static const double limit = 120e6;
    long_write();
    for (size_t k = 0; k < COUNT_OF(specs); k++) {
        int columns, rows, tiles;
        const double bytes = child_bytes((const char *const[ARGUMENTS_MAX]){
            "image", "-e", "long.mat", "-a", specs[k], "-o", "x.mat", "-t", "1", "--memory", "120M"});
        char *said = support_read("said"), *at = strstr(said, "--tile ");
        assert_non_null(at);
        assert_int_equal(sscanf(at, "--tile %dx%d, %d in all", &columns, &rows, &tiles), 3);
        print_message("%s: %d tiles of %dx%d, %.1f MB\n", specs[k], tiles, columns, rows,
                      1e-6 * bytes); /* 100 to 115 */
        assert_true(tiles > 1 && bytes <= limit && bytes >= 0.7 * limit);
        free(said);
    }
    program_good((const char *const[ARGUMENTS_MAX]){"simulate", "long.cfg", "-o", "five.mat"});
    static const struct refusal refusals[] = {
        {{"image", "-e", "five.mat", "-a", "bp_nearest", "-o", "no.mat", "--memory", "120M"},
         {"version 5", "191.3 MB", "7.3"}},
        {{"image", "-e", "long.mat", "-a", "rma_delay", "-o", "no.mat", "--memory", "18M"}, {"--memory", "18 MB"}},
        {{"image", "-e", "long.mat", "-a", "rma_delay", "-o", "no.mat", "--memory", "18x"}, {"--memory", "'18x'"}},
        {{"image", "-e", "long.mat", "-a", "rma_delay", "-o", "no.png", "--memory", "60M"}, {"--memory", "FILE.mat"}},
        {{"image", "-e", "long.mat", "-a", "rma_delay", "-o", "no.mat", "--memory", "60M", "--tile", "9x9"},
         {"--memory 60M", "--tile 9x9"}},
        {{"image", "-s", "study/quick", "-a", "rma_delay", "-o", "no.mat", "--memory", "60M"}, {"--echoes"}},
    };
    assert_all_refused(refusals, COUNT_OF(refusals));
}

/* Some pings of samples that stay in their file are those of the whole. */
static void samples_in_a_file_are_the_same(void **state)
{
    (void)state;
    struct scene whole, part;
    struct echoes echoes;
    long_write();
    assert_int_equal(scene_from_echoes(path_in("long.mat"), NULL, "grid", true, &whole), STATUS_OK);
    assert_int_equal(scene_from_echoes(path_in("long.mat"), NULL, "grid", false, &part), STATUS_OK);
    const struct acquisition all = part.acquisition;
    const size_t each = (size_t)all.receivers * (size_t)all.samples;
    part.recording.first = 1400;
    part.acquisition = acquisition_part(&all, 1400, 250);
    assert_int_equal(scene_echoes(&part, &echoes), STATUS_OK);
    assert_memory_equal(echoes.samples, (const double complex *)whole.recorded + 1400 * each,
                        250 * each * sizeof(double complex));
    echoes_free(&echoes);
    part.acquisition = all;
    scene_free(&whole);
    scene_free(&part);
}

/* The image that `plan` answers with is in as many tiles as it says, and as small. */
static void plans_are_of_tiles(void **state)
{
    (void)state;
    char spec[200], tile[64], shown[64];
    int tiles = 0, columns = 0, rows = 0, node = 0, each = 0, lines = 0;
    long_write();
    struct outcome outcome = program_run((const char *const[ARGUMENTS_MAX]){"plan", "-e", "long.mat", "--error", "1e-2",
                                                                            "--memory", "120M", "--nodes", "6"});
    const char *plan = outcome.out;
    assert_int_equal(outcome.status, 0);
    const char *command = strstr(plan, "image --echoes long.mat --memory 120M -a "), *words = strstr(plan, "In ");
    assert_non_null(command);
    assert_non_null(words);
    assert_int_equal(sscanf(strstr(command, " -a "), " -a %199s", spec), 1);
    assert_int_equal(sscanf(words, "In %d tiles of %d x %d pixels", &tiles, &columns, &rows), 3);
    assert_true(tiles > 1);
    snprintf(tile, sizeof tile, "--tile %dx%d, %d in all", columns, rows, tiles);
    child_bytes((const char *const[ARGUMENTS_MAX]){"image", "-e", "long.mat", "-a", spec, "-o", "plan.mat", "--memory",
                                                   "120M"});
    char *said = support_read("said");
    assert_non_null(strstr(said, tile));
    free(said);
    const char *line = strstr(plan, " rate\n");
    assert_non_null(line);
    snprintf(tile, sizeof tile, "%dx%d", columns, rows);
    for (line += strlen(" rate"); sscanf(line, "\n %d %63s %d", &node, shown, &each) == 3;
         line = strchr(line + 1, '\n')) {
        assert_int_equal(node, lines < 3 ? 1 << lines : 6);
        assert_true(lines > 0 || (each == tiles && strcmp(shown, tile) == 0));
        lines++;
    }
    assert_int_equal(lines, 4);
    outcome_free(&outcome);
    assert_shell("ln long.mat \"it's.mat\"", 0);
    outcome = program_run((const char *const[ARGUMENTS_MAX]){"plan", "-e", "it's.mat", "--memory", "120M"});
    assert_non_null(strstr(outcome.out, " image --echoes 'it'\\''s.mat' --memory 120M -a "));
    outcome_free(&outcome);
    outcome = program_run((const char *const[ARGUMENTS_MAX]){"plan", "-e", "long.mat", "--memory", "18M"});
    assert_int_equal(outcome.status, 1);
    assert_non_null(strstr(outcome.err, "sasbench: plan: --memory: no tile fits into 18 MB"));
    outcome_free(&outcome);
    static const struct refusal refusals[] = {
        {{"plan", "-e", "long.mat", "--nodes", "0"}, {"--nodes", "'0'", "1 to 100000"}},
        {{"plan", "study/quick", "--nodes", "2.5"}, {"--nodes", "'2.5'", "whole number"}},
    };
    assert_all_refused(refusals, COUNT_OF(refusals));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(processes_take_what_plans_say),
                                       cmocka_unit_test(budgets_are_of_the_process),
                                       cmocka_unit_test(tiles_keep_to_a_memory), cmocka_unit_test(plans_are_of_tiles),
                                       cmocka_unit_test(samples_in_a_file_are_the_same)};
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
