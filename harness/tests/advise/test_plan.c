/* Planning: the fastest choice, refusals with the best that there is, and what the command prints and writes. */
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "command/task.h"
#include "files/csv.h"
#include "results/provenance.h"
#include "choice/choice.h"
#include "echoes/echo_data.h"
#include "scene/simulate.h"
#include "choice/rates.h"
#include "advise/machine_rates.h"
#include "advise/planned.h"
#include "tests/support.h"

/* Every seed is a scene, and always the same one. */
static void scenes_are_whole(void **state)
{
    (void)state;
    for (int seed = 0; seed < 200; seed++) {
        struct scene scene;
        support_random_scene(seed, &scene);
        const struct acquisition *a = &scene.acquisition;
        assert_true(a->pings <= 90 && a->samples <= 1500 && a->receivers >= 1 && a->receivers <= 80);
        assert_true(a->fs >= 1.05 * a->bandwidth * 0.999 && a->fs <= 4.001 * a->bandwidth);
        const uint64_t hash = scene.hash;
        scene_free(&scene);
        support_random_scene(seed, &scene);
        assert_true(scene.hash == hash);
        scene_free(&scene);
    }
}

/* A choice on a scene's echoes. */
static void choose_on(const char *name, const struct budget *budget, enum precision precision, struct choice *choice)
{
    struct scene scene;
    struct echoes echoes[2];
    support_scene(name, &scene);
    const struct problem problem = scene_problem(&scene, precision);
    assert_int_equal(scene_echoes(&scene, &echoes[PRECISION_DOUBLE]), STATUS_OK);
    assert_int_equal(echoes_convert(&echoes[PRECISION_DOUBLE], PRECISION_FLOAT, &echoes[PRECISION_FLOAT]), STATUS_OK);
    assert_int_equal(choice_make(&problem, echoes, budget, choice), STATUS_OK);
    image_free(&choice->image); /* its patches are the scene's */
    echoes_free(&echoes[PRECISION_FLOAT]);
    echoes_free(&echoes[PRECISION_DOUBLE]);
    scene_free(&scene);
}

static void choose(double error, double bytes, enum precision precision, struct choice *choice)
{
    const struct budget budget = {.error = error, .bytes = bytes, .seconds = INFINITY};
    choose_on("study/quick", &budget, precision, choice);
}

/* Laws alone choose by what they say, and measure nothing. */
static void laws_choose(void **state)
{
    (void)state;
    struct scene scene;
    struct choice choice;
    support_scene("study/quick", &scene);
    const struct problem problem = scene_problem(&scene, PRECISION_FLOAT);
    const struct budget budget = {.error = 1e-2, .bytes = 4e9};
    assert_int_equal(choice_make(&problem, NULL, &budget, &choice), STATUS_OK);
    assert_true(choice.found && choice.image.patch_count == 0 && choice.list[0].error <= 1e-2);
    for (int k = 0; k < choice.count; k++)
        assert_int_equal(choice.list[k].measured.pixels, 0);
    choice_free(&choice);
    scene_free(&scene);
}

/* The chosen one is within the budget, and no other is that and faster; a larger budget takes no more time. */
static void fastest_within(void **state)
{
    (void)state;
    double before = INFINITY;
    for (double error = 1e-5; error < 0.2; error *= 10) {
        struct choice choice;
        choose(error, 4e9, PRECISION_FLOAT, &choice);
        assert_true(choice.found);
        const struct candidate *best = &choice.list[0];
        assert_true(best->verdict == CANDIDATE_CHOSEN && best->error <= error && best->bytes > 0 && !*best->reason);
        assert_true(best->seconds <= before);
        before = best->seconds;
        for (int k = 1; k < choice.count; k++) {
            const struct candidate *c = &choice.list[k];
            char name[CANDIDATE_NAME];
            candidate_name(c, name);
            assert_int_equal(strlen(name), /* whole */
                             strlen(c->algorithm->name) + (*c->settings ? 1 : 0) + strlen(c->settings));
            assert_true(*c->reason != '\0');
            if (c->error <= error && c->verdict == CANDIDATE_SLOWER)
                assert_true(c->seconds >= best->seconds);
            if (c->verdict == CANDIDATE_ERROR)
                assert_true(sqrt(c->error * fmax(c->measured.high, c->error)) > error || !c->forecast.sums_pairs);
        }
        choice_free(&choice);
    }
}

static void nothing_fits(void **state)
{
    (void)state;
    struct choice choice;
    choose(1e-9, 4e9, PRECISION_FLOAT, &choice);
    assert_false(choice.found);
    assert_true(choice.least > 1e-9 && choice.least < 1e-5);
    choice_free(&choice);
    choose(1e-3, 100, PRECISION_FLOAT, &choice);
    assert_false(choice.found);
    assert_int_equal(choice.list[0].verdict, CANDIDATE_MEMORY);
    choice_free(&choice);

    const struct budget budget = {.error = 1e-9, .bytes = 4e9, .seconds = INFINITY};
    struct spec spec;
    choose(1e-9, 4e9, PRECISION_FLOAT, &choice);
    assert_int_equal(choice_spec(&choice, &budget, PRECISION_FLOAT, &spec), STATUS_UNSUPPORTED);
    assert_non_null(strstr(status_message(), "condition budget"));
    assert_non_null(strstr(status_message(), ", of bp_"));
    choice_free(&choice);
}

/* The kept file with the first of one text in it replaced: are its rates taken? */
static bool rates_taken(const char *kept, const char *old, const char *new)
{
    const char *at = strstr(kept, old);
    char text[8192];
    bool found;
    assert_non_null(at);
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - kept), kept, new, at + strlen(old));
    support_write("cache/sasbench/rates.csv", text);
    machine_rates_use(&found);
    return found;
}

/* Rates go to the cache and come from there; those of another machine, instruction set or program are not taken, nor
   is a file that lacks one or holds what no machine can have. */
static void rates_are_kept(void **state)
{
    (void)state;
    const struct rates before = *rates_get();
    struct rates made = before;
    struct provenance provenance;
    bool found;
    setenv("XDG_CACHE_HOME", path_of("cache"), 1);
    machine_rates_use(&found);
    assert_false(found);
    made.migrate[MIGRATION_FOCUS] = 1.25e-9;
    assert_int_equal(machine_rates_keep(&made), STATUS_OK);
    rates_set(&before);
    machine_rates_use(&found);
    assert_true(found);
    assert_close(rates_get()->migrate[MIGRATION_FOCUS], 1.25e-9, 1e-15);
    rates_set(&before);
    provenance_fill(&provenance, 1);
    char *kept = support_read("cache/sasbench/rates.csv");
    assert_non_null(kept);
    static const char *const faults[][2] = {
        {"\n1.25e-09", "\n0"},        {"\n1.25e-09", "\n-1e-9"}, {"\n1.25e-09", "\nnan"}, {"\n1.25e-09", "\ninf"},
        {"\n1.25e-09", "\n1e-2"},     {"\n1.25e-09", "\n"},      {"\n1.25e-09", ""},      {"\n1.9\n", "\n0\n"},
        {"rate\n2.4e-10", "rate\n0"}, {"\n6.4e-08", "\n-6e-8"},
    };
    assert_false(rates_taken(kept, provenance.machine, "another"));
    char isa[32];
    snprintf(isa, sizeof isa, ", %s, program ", provenance.isa);
    assert_false(rates_taken(kept, isa, ", v0, program "));
    assert_false(rates_taken(kept, provenance.program, "0123456789abcdef"));
    for (size_t k = 0; k < sizeof faults / sizeof *faults; k++)
        if (rates_taken(kept, faults[k][0], faults[k][1]))
            fail_msg("taken in spite of '%s'", faults[k][1]);
    assert_memory_equal(rates_get(), &before, sizeof before);
    assert_true(rates_taken(kept, "\n6.4e-08", "\n0")); /* what noise may make */
    free(kept);
    const struct rates none = {.doubled = 1};
    assert_int_equal(machine_rates_keep(&none), STATUS_FAILED);
    assert_true(rates_get()->migrate[MIGRATION_FOCUS] > 0);
    setenv("XDG_CACHE_HOME", path_of("cache/sasbench/rates.csv"), 1); /* no folder */
    assert_int_not_equal(machine_rates_keep(&made), STATUS_OK);
    rates_set(&before);
}

/* What `plan` prints of a scene, for the caller to free. */
static char *plan_printed(const char *scene, const char *error)
{
    const char *names[] = {scene};
    struct task task = {.names = names, .name_count = 1, .error = error, .all = true};
    fflush(stdout);
    const int kept = dup(STDOUT_FILENO), file = open(path_of("printed"), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    assert_true(kept >= 0 && file >= 0 && dup2(file, STDOUT_FILENO) >= 0);
    const enum status status = command_plan(&task);
    fflush(stdout);
    assert_true(dup2(kept, STDOUT_FILENO) >= 0 && close(kept) == 0 && close(file) == 0);
    assert_int_equal(status, STATUS_OK);
    char *text = support_read("printed");
    assert_non_null(text);
    return text;
}

/* What is wrong with a scene is told ahead of the candidates; of one that is right, whether the image keeps up with the
   platform: it passes 4.975 m at 1.8 m/s. A reason of several algorithms is told once. */
static void scene_is_judged(void)
{
    support_write("wrong.cfg", "base = {\n@include \"study/quick.cfg\"\n};\n"
                               "track = { speed = -2.5; pri = 0.128; pings = 18; x_first = -5.0; };\n"
                               "targets = { points = ( { x = 1.74; r = 19.92; } ); };\n"
                               "image = { angle = 5; x = { first = -0.5; step = 0.02; count = 51; };\n"
                               "r = { first = 19.5; step = 0.025; count = 41; }; };\n");
    char *text = plan_printed(path_of("wrong.cfg"), "1e-2");
    const char *chosen = strstr(text, "candidate"), *ghost = strstr(text, "condition ghost"),
               *unseen = strstr(text, "condition pixels_seen");
    assert_true(chosen && ghost && unseen && ghost < chosen && unseen < chosen);
    assert_null(strstr(text, "rma_lbf: condition"));
    assert_non_null(strstr(text, "rma_lbf:limit=0.785: condition axes"));
    assert_non_null(strstr(text, ": as rma_lbf\n"));
    free(text);
    text = plan_printed("study/template", "1e-3");
    assert_null(strstr(text, "warning"));
    assert_non_null(strstr(text, "The platform passes the 4.98 m of the image along its track in 2.76 s, "));
    free(text);
}

/* Turned axes: what is planned with is counted as back projection counts it. */
static void turned_axes(void **state)
{
    (void)state;
    struct choice choice;
    const struct budget budget = {.error = 1e-3, .bytes = 4e9, .seconds = INFINITY};
    choose_on("gate/squint", &budget, PRECISION_FLOAT, &choice);
    assert_true(choice.found && choice.list[0].forecast.record_values > 0);
    assert_true(choice.work.pairs > 0 && choice.list[0].pairs == choice.work.pairs);
    assert_close(choice.list[0].flops, choice.work.flops, 1e-3 * choice.work.flops);
    choice_free(&choice);
}

/* What the command chooses in float: its error, and s. Returns in how many precisions it chooses. */
static int chosen_read(struct task task, double *error, double *seconds)
{
    struct csv csv;
    int chosen = 0;
    task.output = path_of("plan.csv");
    assert_int_equal(command_plan(&task), STATUS_OK);
    assert_int_equal(csv_read(task.output, CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_true(csv.row_count > 60);
    for (int row = csv.row_count - 1; row >= 0; row--)
        if (strcmp(csv_cell(&csv, row, csv_column(&csv, "verdict")), "chosen") == 0) {
            *error = atof(csv_cell(&csv, row, csv_column(&csv, "error")));
            *seconds = atof(csv_cell(&csv, row, csv_column(&csv, "seconds")));
            chosen++; /* float is the first */
        }
    csv_free(&csv);
    return chosen;
}

static void command_writes(void **state)
{
    (void)state;
    const char *names[] = {"study/quick"};
    double error, seconds;
    setenv("XDG_CACHE_HOME", path_of("cache"), 1);
    struct task task = {.names = names, .name_count = 1, .error = "1e-2"};
    assert_int_equal(chosen_read(task, &error, &seconds), 2);
    assert_true(error <= 1e-2 && seconds > 0);
    task.output = path_of("plan.csv");
    scene_is_judged();
    task.error = "-1";
    assert_int_equal(command_plan(&task), STATUS_INVALID);
    task.error = NULL;
    static const char *const wrong[] = {"4X", "4 GB", "4GBB", "4iB", "4Bi", "-1G", "0", "MiB", "1e400", "4gb", "nan"};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        task.memory = wrong[k];
        assert_int_equal(command_plan(&task), STATUS_INVALID);
        assert_non_null(
            strstr(status_message(), "must be bytes above 0: 4e9, or with k, M, G, T, Ki, Mi, Gi or Ti and B"));
    }
    /* The least that the process takes decides; each says as much, or a byte less. */
    task.error = "1e-2";
    static const char *const enough[] = {"1T", "1TB", "1Ti", "4000000000", "4000000000B", "0.5GiB", "512MiB", "99e6kB"};
    for (size_t k = 0; k < sizeof enough / sizeof *enough; k++) {
        task.memory = enough[k];
        if (command_plan(&task) != STATUS_OK)
            fail_msg("%s: %s", enough[k], status_message());
    }
    static const char *const little[] = {"1M", "16MB", "15MiB", "16000k", "15000KiB", "1.6e7B"};
    for (size_t k = 0; k < sizeof little / sizeof *little; k++) {
        task.memory = little[k];
        assert_int_equal(command_plan(&task), STATUS_FAILED);
    }
}

/* --time: the most exact within it; more time, less error; too little is refused. */
static void time_is_kept(void **state)
{
    (void)state;
    const char *names[] = {"study/quick"};
    double least, errors[3];
    chosen_read((struct task){.names = names, .name_count = 1, .error = "0.1"}, &errors[0], &least);
    for (int k = 0; k < 3; k++) {
        const double most = (double[]){1.5, 10, 1e4}[k] * least;
        char time[32];
        double seconds;
        snprintf(time, sizeof time, "%.6g", most);
        chosen_read((struct task){.names = names, .name_count = 1, .time = time}, &errors[k], &seconds);
        assert_true(seconds <= 1.00001 * most && (k == 0 || errors[k] <= errors[k - 1]));
    }
    assert_true(errors[2] < errors[0] / 3);
    static const char *const wrong[] = {"0", "-1", "nan", "1s", ""};
    for (int k = 0; k < 5; k++)
        assert_int_equal(command_plan(&(struct task){.names = names, .name_count = 1, .time = wrong[k]}),
                         STATUS_INVALID);
    assert_int_equal(command_plan(&(struct task){.names = names, .name_count = 1, .time = "1e-9"}), STATUS_FAILED);
    const struct task both = {.names = names, .name_count = 1, .time = "1", .error = "1e-3"};
    assert_int_equal(command_plan(&both), STATUS_INVALID);
}

/* What range migration takes is counted without a plan: the plan's FLOPs, and a time of which the terms over the
   receivers are a small part, as is measured. */
static void migration_is_counted(void **state)
{
    (void)state;
    const char *const specs[] = {"rma_delay:terms=1", "rma_delay:terms=3", "rma_lbf", "rma_numeric:limit=0.01"};
    enum { SPECS = sizeof specs / sizeof *specs };
    double seconds[SPECS];
    struct scene scene;
    support_scene("study/far", &scene);
    const struct problem problem = scene_problem(&scene, PRECISION_FLOAT);
    for (int k = 0; k < SPECS; k++) {
        struct spec spec;
        struct forecast forecast;
        void *plan;
        assert_int_equal(spec_parse(specs[k], &spec), STATUS_OK);
        assert_int_equal(algorithm_cost(spec.algorithm, &problem, spec.options, &forecast), STATUS_OK);
        assert_int_equal(algorithm_plan(spec.algorithm, &problem, spec.options, &plan), STATUS_OK);
        assert_true(forecast.migration_flops == spec.algorithm->work(plan).flops);
        assert_true((forecast.migration[MIGRATION_TERMS] > 0) == (k < 2));
        assert_true((forecast.migration[MIGRATION_BLOCKS] > 0) == (k >= 2));
        seconds[k] = rates_migration(rates_get(), &forecast, PRECISION_FLOAT);
        spec.algorithm->destroy(plan);
        spec_free(&spec);
    }
    scene_free(&scene);
    assert_true(seconds[1] > seconds[0] && seconds[1] < 1.2 * seconds[0]); /* 1.04 to 1.08 times are measured */
    assert_true(seconds[2] > 2 * seconds[0]);                              /* 3.2 times */
}

/* Range migration is chosen where it is the fastest; its error, which costs its conditions, is forecast where it would
   be, and not where another is faster. */
static void migration_is_chosen(void **state)
{
    (void)state;
    static const struct {
        const char *scene;
        bool chosen;
    } cases[] = {{"bp22/table3", true}, {"study/quick", false}};
    for (int n = 0; n < 2; n++) {
        struct choice choice;
        const struct budget budget = {.error = 1e-2, .bytes = 4e9, .seconds = INFINITY, .all = true};
        int slower = 0;
        choose_on(cases[n].scene, &budget, PRECISION_FLOAT, &choice);
        assert_true(choice.found && (strcmp(choice.list[0].algorithm->name, "rma_delay") == 0) == cases[n].chosen);
        for (int k = 1; k < choice.count; k++) {
            const struct candidate *c = &choice.list[k];
            if (c->algorithm->traits & TRAIT_APERTURE_LIMIT || c->verdict != CANDIDATE_SLOWER)
                continue;
            slower++;
            assert_true(c->error == INFINITY && c->seconds >= choice.list[0].seconds && c->flops > 0);
            assert_non_null(strstr(c->reason, "times the chosen one's time, whatever its error"));
        }
        assert_true(slower > 5);
        choice_free(&choice);
    }
}

/* Of one column of pixels, `share` of a sample apart along range, in the general engine. */
static struct forecast column_forecast(const char *text, double share)
{
    struct scene scene;
    struct spec spec;
    struct forecast forecast;
    support_scene("study/sway", &scene);
    const struct acquisition *a = &scene.acquisition;
    struct grid *grid = &scene.patches[0];
    grid->x_count = 1;
    grid->r_step = share * a->sound_speed / (2 * a->fs);
    const struct problem problem = problem_make(a, 1, grid, PRECISION_FLOAT);
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    assert_int_equal(algorithm_forecast(spec.algorithm, &problem, spec.options, &forecast), STATUS_OK);
    spec_free(&spec);
    scene_free(&scene);
    assert_false(forecast.tables);
    return forecast;
}

/* Pixels whose neighbours lie further apart than half a sample, of branches a sample, load their own, which takes time
   by the rates for it; blocks of pixels are as many. Branches that stand for a kernel are such, too, but need no
   transforms of their own. */
static void steep_slopes_cost(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double near, far; /* samples */
    } cases[] = {{"bp_nearest:engine=general", 0.45, 0.55},
                 {"bp_farrow:degree=2,engine=general", 0.9, 1.1},
                 {"bp_farrow:degree=4,engine=general", 0.9, 1.1},
                 {"bp_fitted:taps=8,engine=general", 0.9, 1.1}};
    const double pairs = 1e9;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const struct forecast near = column_forecast(cases[k].text, cases[k].near),
                              far = column_forecast(cases[k].text, cases[k].far);
        struct forecast alike = far;
        alike.apart = 0;
        assert_true(near.apart == 0 && far.apart == 1 && near.units == far.units);
        const double more = rates_sums(rates_get(), &far, PRECISION_FLOAT, pairs)
                            - rates_sums(rates_get(), &alike, PRECISION_FLOAT, pairs);
        const double own = rates_get()->apart[far.kind] + rates_get()->apart_value[far.kind] * far.values;
        assert_close(more / pairs / own, 1, 1e-6);
    }
    const struct forecast kernel = column_forecast("bp_fitted:taps=8,engine=general", 1.1),
                          one = column_forecast("bp_nearest:engine=general", 1.1);
    assert_true(kernel.kind == READ_BRANCHES && kernel.values > 3 && kernel.record_flops == one.record_flops);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(scenes_are_whole, folder_make, folder_remove),
        cmocka_unit_test(fastest_within),
        cmocka_unit_test(laws_choose),
        cmocka_unit_test(nothing_fits),
        cmocka_unit_test(turned_axes),
        cmocka_unit_test(migration_is_counted),
        cmocka_unit_test(migration_is_chosen),
        cmocka_unit_test(steep_slopes_cost),
        cmocka_unit_test_setup_teardown(rates_are_kept, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(command_writes, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(time_is_kept, folder_make, folder_remove),
    };
    return cmocka_run_group_tests_name("plan", tests, NULL, NULL);
}
