/* Choices against a sweep: what `auto` takes, beside every candidate and every setting of `sweep` on the same scene.

   Without arguments a test of two scenes, which asserts no time. With arguments, scenes or ranges of seeds, a
   measurement: `test_choice 3001-3020 study/quick` times each choice beside the fastest settings that are within the
   budget. Seconds are of one thread, without those in which it waited for a processor; the least of several runs. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "imaging/imaging.h"
#include "metrics/metrics.h"
#include "measure/session.h"
#include "measure/timing.h"
#include "choice/candidates.h"
#include "choice/process.h"
#include "advise/machine_rates.h"
#include "sweep/sweep_settings.h"
#include "tests/support.h"

static const double budgets[] = {1e-1, 1e-2, 1e-3, 1e-4};
enum { BUDGETS = sizeof budgets / sizeof *budgets, SETTINGS_MOST = 400, RUNS = 3, ROUNDS = 3 };
static const double LAW_MOST = 15; /* times the measured error are predicted at most (docs/planning.md) */
static const double SLOW = 2;      /* times the fastest in a first run: not timed again */
static const double LONG = 0.2;    /* s: so long runs count at once, and once a plan */

/* Whatever may be the fastest: all that `sweep` runs, in float, and what its parameters' defaults leave out. */
static const char *const families[] = {"bp_nearest",
                                       "bp_linear",
                                       "bp_linear:preemphasis=on",
                                       "bp_sinc",
                                       "bp_sinc:window=kaiser_band",
                                       "bp_zeropad",
                                       "bp_farrow",
                                       "bp_farrow:factor=2",
                                       "bp_fitted",
                                       "bp_nearest:engine=general",
                                       "bp_linear:engine=general",
                                       "bp_zeropad:engine=general",
                                       "bp_farrow:engine=general",
                                       "bp_fitted:engine=general",
                                       "bp_factorised",
                                       "rma_lbf",
                                       "rma_pca",
                                       "rma_wu",
                                       "rma_numeric",
                                       "rma_delay",
                                       "wk_classic",
                                       "wk_squint"};

struct setting {
    struct spec spec;
    char name[300];
    double said;            /* s: predicted; NAN of those that are no candidates */
    double error;           /* measured, after one best complex gain; INFINITY where refused */
    double bytes;           /* of its plan */
    double seconds;         /* of the fastest run */
    double compress, focus; /* of the least */
    bool contends;
};

struct sweep {
    struct setting *list; /* [count] */
    int count;
};

/* How choices compare with the fastest of the sweep, over all scenes. */
struct tally {
    double ratio[4000], front[4000]; /* over the fastest within the budget, and within the choice's own error */
    int count;
    int none, wrong; /* choices that found nothing; of these, and of those over the budget, those that are wrong */
    /* Of budgets nearly beyond reach, those that nothing was found for, and those of them that a setting is within. */
    int refused, near;
};

static void setting_name(const struct spec *spec, char *text, size_t size)
{
    snprintf(text, size, "%s%s%s", spec->algorithm->name, *spec->text ? ":" : "", spec->text);
}

/* Takes the spec over, and returns its place. */
static struct setting *sweep_add(struct sweep *sweep, struct spec *spec)
{
    for (int k = 0; k < sweep->count; k++)
        if (spec_equal(&sweep->list[k].spec, spec)) {
            spec_free(spec);
            return &sweep->list[k];
        }
    assert_true(sweep->count < SETTINGS_MOST);
    struct setting *setting = &sweep->list[sweep->count++];
    *setting = (struct setting){.spec = *spec, .error = INFINITY, .said = NAN, .seconds = INFINITY};
    setting_name(spec, setting->name, sizeof setting->name);
    return setting;
}

static void spec_make(const char *name, const char *settings, struct spec *spec)
{
    char text[200];
    const bool has = strchr(name, ':') || *settings;
    snprintf(text, sizeof text, "%s%s%s%cprecision=float", name, *settings ? ":" : "", settings, has ? ',' : ':');
    if (spec_parse(text, spec) != STATUS_OK)
        fail_msg("%s", status_message());
}

static void sweep_make(const struct scene *scene, struct sweep *sweep)
{
    static struct candidate candidates[CANDIDATES_MAX];
    *sweep = (struct sweep){.list = calloc(SETTINGS_MOST, sizeof *sweep->list)};
    assert_non_null(sweep->list);
    const int count = candidates_fill(&scene->acquisition, candidates);
    for (int k = 0; k < count; k++) {
        struct spec spec;
        spec_make(candidates[k].algorithm->name, candidates[k].settings, &spec);
        sweep_add(sweep, &spec);
    }
    for (size_t k = 0; k < sizeof families / sizeof *families; k++) {
        struct sweep_settings settings = {.count = 0};
        struct spec start;
        spec_make(families[k], "", &start);
        assert_int_equal(settings_add(&settings, &start), STATUS_OK);
        for (int n = 0; n < settings.count; n++) {
            sweep_add(sweep, &settings.specs[n]);
            settings.specs[n] = (struct spec){.algorithm = NULL};
        }
        settings_free(&settings);
        spec_free(&start);
    }
}

static void sweep_free(struct sweep *sweep)
{
    for (int k = 0; k < sweep->count; k++)
        spec_free(&sweep->list[k].spec);
    free(sweep->list);
}

static double stage_seconds(const struct stages *stages, const char *name)
{
    for (int k = 0; k < stages->count; k++)
        if (strcmp(stages->stage[k].name, name) == 0)
            return stages->stage[k].seconds;
    return 0;
}

/* One plan, `runs` runs, the first of several not counted unless it is long; with `measure` the error of the image. */
static void setting_run(const struct session *session, struct setting *setting, int runs, bool measure)
{
    const struct problem problem = session_problem(session->scene, setting->spec.algorithm, PRECISION_FLOAT);
    const struct echoes *echoes = &session->echoes[PRECISION_FLOAT];
    if (!setting->spec.algorithm->plan)
        return;
    struct imaging imaging;
    struct image image;
    enum status status = imaging_open(&setting->spec, &problem, &imaging);
    if (status == STATUS_UNSUPPORTED)
        return;
    if (measure)
        setting->bytes = imaging.algorithm->work(imaging.plan).bytes;
    for (int k = 0; k < runs && status == STATUS_OK; k++) {
        struct stages stages;
        stages_begin(&stages);
        const double begin = stages.mark;
        status = imaging_execute(&imaging, echoes, &stages);
        const double seconds = seconds_now() - begin;
        if (seconds >= LONG)
            runs = k; /* the last */
        if ((k > 0 || seconds >= LONG) && seconds < setting->seconds) {
            setting->seconds = seconds;
            setting->compress = stage_seconds(&stages, "compress");
            setting->focus = stage_seconds(&stages, "focus");
        }
    }
    if (status == STATUS_OK && measure) {
        status = imaging_finish(&imaging, echoes, &image);
        setting->error = metrics_error(&image, &session->reference).error_gain;
        image_free(&image);
    }
    imaging_close(&imaging);
    if (status != STATUS_OK)
        fail_msg("%s: %s", setting->name, status_message());
}

/* The fastest whose error is at most `error`; NULL without one. */
static struct setting *sweep_fastest(const struct sweep *sweep, double error)
{
    struct setting *best = NULL;
    for (int k = 0; k < sweep->count; k++)
        if (sweep->list[k].error <= error && (!best || sweep->list[k].seconds < best->seconds))
            best = &sweep->list[k];
    return best;
}

static struct setting *sweep_find(struct sweep *sweep, const struct candidate *candidate)
{
    struct spec spec;
    spec_make(candidate->algorithm->name, candidate->settings, &spec);
    return sweep_add(sweep, &spec);
}

/* What is near the fastest of a budget, or of an error that is measured, is timed again with the choices. */
static void contenders_mark(const struct sweep *sweep, double error)
{
    const struct setting *best = sweep_fastest(sweep, error);
    for (int k = 0; k < sweep->count && best; k++)
        sweep->list[k].contends |= sweep->list[k].error <= error && sweep->list[k].seconds <= SLOW * best->seconds;
}

struct comparison {
    struct choice choice;
    struct setting *chosen; /* NULL: none */
};

static void comparison_print(const char *scene, double budget, const struct comparison *c, const struct sweep *sweep,
                             struct tally *tally)
{
    const struct setting *best = sweep_fastest(sweep, budget);
    if (!c->chosen) {
        print_message("%s, %g: no candidate, least predicted %.2e; fastest %s\n", scene, budget, c->choice.least,
                      best ? best->name : "none");
        tally->none++;
        tally->wrong += best != NULL;
        return;
    }
    const struct setting *front = sweep_fastest(sweep, c->chosen->error);
    const double ratio = best ? c->chosen->seconds / best->seconds : INFINITY;
    print_message("%s, %g: %s %.2e, %.3g ms (%.3g said); %.2f times %s %.2e; %.2f times the front's %s\n", scene,
                  budget, c->chosen->name, c->chosen->error, 1e3 * c->chosen->seconds, 1e3 * c->choice.list[0].seconds,
                  ratio, best ? best->name : "none", best ? best->error : NAN, c->chosen->seconds / front->seconds,
                  front->name);
    tally->wrong += !(c->chosen->error <= budget);
    tally->front[tally->count] = c->chosen->seconds / front->seconds;
    tally->ratio[tally->count++] = ratio;
}

/* The least memory of the settings within an error; that of some setting where none is. */
static double least_bytes(const struct sweep *sweep, double error)
{
    double least = INFINITY, any = INFINITY;
    for (int k = 0; k < sweep->count; k++)
        if (sweep->list[k].error < INFINITY) {
            any = fmin(any, sweep->list[k].bytes);
            least = sweep->list[k].error <= error ? fmin(least, sweep->list[k].bytes) : least;
        }
    return least < INFINITY ? least : any;
}

/* The setting of the least error that memory leaves; NULL without one. */
static const struct setting *sweep_finest(const struct sweep *sweep, double bytes)
{
    const struct setting *finest = NULL;
    for (int k = 0; k < sweep->count; k++)
        if (sweep->list[k].bytes <= bytes && sweep->list[k].error < (finest ? finest->error : INFINITY))
            finest = &sweep->list[k];
    return finest;
}

/* Errors and memory that nothing reaches, or little: where nothing is found, no setting of the sweep is within both.
   Predicted errors are upper bounds: near the budget a setting may be within it that is predicted not to be. */
static void refusals_compare(const struct session *session, const char *name, const struct sweep *sweep,
                             struct tally *tally)
{
    static const double errors[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8}, shares[] = {0.5, 0.999, 2, 1e6};
    enum { ERRORS = sizeof errors / sizeof *errors, SHARES = sizeof shares / sizeof *shares };
    const struct problem problem = scene_problem(session->scene, PRECISION_FLOAT);
    for (int k = 0; k < ERRORS * SHARES; k++) {
        const double error = errors[k / SHARES];
        const double plan_bytes = shares[k % SHARES] * least_bytes(sweep, error);
        const struct budget budget = {
            .error = error, .bytes = process_bytes(&problem, plan_bytes), .seconds = INFINITY};
        const struct setting *finest = sweep_finest(sweep, plan_bytes);
        struct choice choice;
        assert_int_equal(choice_make(&problem, session->echoes, &budget, &choice), STATUS_OK);
        if (choice.found)
            assert_true(choice.list[0].bytes <= budget.bytes && choice.list[0].error <= error);
        tally->refused += !choice.found;
        if (!choice.found && finest && finest->error <= error) {
            print_message("%s, %g in %.4g MB: nothing is found, least predicted %.2e; %s has %.2e\n", name, error,
                          budget.bytes / 1e6, choice.least, finest->name, finest->error);
            tally->near++;
            tally->wrong += finest->error <= error / LAW_MOST;
        }
        choice_free(&choice);
    }
}

/* Image a scene by all settings and compare the choices. */
static void scene_compare(const struct scene *scene, const char *name, bool timed, struct tally *tally)
{
    struct session session;
    struct sweep sweep;
    struct comparison comparisons[BUDGETS];
    sweep_make(scene, &sweep);
    assert_int_equal(session_open(scene, &session), STATUS_OK);
    if (support_peak(&session.reference) == 0) { /* no record meets an echo: errors are not defined */
        print_message("%s: all pixels are zero\n", name);
        session_close(&session);
        sweep_free(&sweep);
        return;
    }
    for (int k = 0; k < BUDGETS; k++) {
        const struct problem problem = scene_problem(scene, PRECISION_FLOAT);
        const struct budget budget = {.error = budgets[k],
                                      .bytes = 4e9,
                                      .seconds = INFINITY,
                                      .region = {scene->reference_count, scene->reference_patches}};
        assert_int_equal(choice_make(&problem, session.echoes, &budget, &comparisons[k].choice), STATUS_OK);
        comparisons[k].chosen = comparisons[k].choice.found ? sweep_find(&sweep, &comparisons[k].choice.list[0]) : NULL;
    }
    for (int k = 0; k < sweep.count; k++)
        setting_run(&session, &sweep.list[k], 2, true);
    for (int k = 0; k < BUDGETS; k++) {
        for (int n = 0; n < comparisons[k].choice.count; n++) {
            const struct candidate *c = &comparisons[k].choice.list[n];
            if (c->forecast.sums_pairs && c->verdict != CANDIDATE_REFUSED)
                sweep_find(&sweep, c)->said = c->seconds;
        }
        contenders_mark(&sweep, budgets[k]);
        if (comparisons[k].chosen) {
            comparisons[k].chosen->contends = true;
            contenders_mark(&sweep, comparisons[k].chosen->error);
        }
    }
    for (int n = 0; n < ROUNDS && timed; n++)
        for (int k = 0; k < sweep.count; k++)
            if (sweep.list[k].contends)
                setting_run(&session, &sweep.list[k], 1 + RUNS, false);
    for (int k = 0; k < sweep.count && timed; k++) {
        const struct setting *s = &sweep.list[k];
        if (s->error < INFINITY)
            print_message("setting %s %s %.3e, %.4g ms (%.4g said), of which compressing %.4g, summing %.4g\n", name,
                          s->name, s->error, 1e3 * s->seconds, 1e3 * s->said, 1e3 * s->compress, 1e3 * s->focus);
    }
    for (int k = 0; k < BUDGETS; k++) {
        comparison_print(name, budgets[k], &comparisons[k], &sweep, tally);
        choice_free(&comparisons[k].choice);
    }
    refusals_compare(&session, name, &sweep, tally);
    session_close(&session);
    sweep_free(&sweep);
}

static void seed_compare(int seed, bool timed, struct tally *tally)
{
    struct scene scene;
    char name[32];
    snprintf(name, sizeof name, "seed %d", seed);
    support_random_scene(seed, &scene);
    scene_compare(&scene, name, timed, tally);
    scene_free(&scene);
}

static int given;
static char **names;

/* Choices are within their budgets, and where there is none, no setting of the sweep is. */
static void choices_compare(void **state)
{
    (void)state;
    static struct tally tally;
    if (given == 0) {
        seed_compare(3001, false, &tally);
        seed_compare(3002, false, &tally);
    } else
        assert_int_equal(machine_rates_need(), STATUS_OK);
    for (int k = 0; k < given; k++) {
        int first, last;
        const int read = sscanf(names[k], "%d-%d", &first, &last);
        for (int seed = first; read > 0 && seed <= (read > 1 ? last : first); seed++)
            seed_compare(seed, true, &tally);
        if (read <= 0) {
            struct scene scene;
            support_scene(names[k], &scene);
            scene_compare(&scene, names[k], true, &tally);
            scene_free(&scene);
        }
    }
    print_message("nothing was found for %d budgets nearly beyond reach, of which a setting is within %d\n",
                  tally.refused, tally.near);
    assert_true(tally.refused > 0);
    assert_int_equal(tally.wrong, 0);
    assert_true(tally.count > 0);
    if (given == 0)
        return;
    int slow = 0, beside = 0;
    for (int k = 0; k < tally.count; k++) {
        slow += tally.ratio[k] > 1.5;
        beside += tally.front[k] > 1.3;
    }
    const double middle = median(tally.ratio, tally.count); /* sorts them */
    print_message("%d choices, %d found nothing; times the fastest within the budget: median %.2f, nine of ten %.2f, "
                  "worst %.2f; %d above 1.5; %d beyond 1.3 times the front\n",
                  tally.count, tally.none, middle, quantile(tally.ratio, tally.count, 0.9),
                  tally.ratio[tally.count - 1], slow, beside);
    assert_true(slow <= tally.count / 10);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test_setup_teardown(choices_compare, folder_make, folder_remove)};
    given = argc - 1;
    names = argv + 1;
    if (given > 0) {
        omp_set_num_threads(1);
        seconds_skip_waiting();
    }
    return cmocka_run_group_tests_name("choice", tests, NULL, NULL);
}
