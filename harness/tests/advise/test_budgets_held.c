/* What `auto` chooses stays within its budgets on scenes drawn from seeds: a few by the built-in rates; with arguments,
   ranges of seeds as 2001-2060, by those of this machine, where `plan` has measured them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "metrics/metrics.h"
#include "measure/session.h"
#include "measure/timing.h"
#include "choice/choice.h"
#include "advise/machine_rates.h"
#include "tests/support.h"

enum { SEEDS_MOST = 1000, BUDGETS = 4 };

/* What choices made of their budgets. */
struct tally {
    double used[SEEDS_MOST * BUDGETS]; /* measured error over the budget */
    int count, refused;
    int zero; /* choices on images of zeros, which have no error and must be zero as well */
};

/* Measure what `auto` chooses for one scene and budget. */
static void choice_measure(struct session *session, const char *name, double budget, struct tally *tally)
{
    char text[64];
    struct spec spec;
    struct image image;
    snprintf(text, sizeof text, "auto:error=%g", budget);
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    enum status status = session_image(session, &spec, &image);
    if (status == STATUS_OK) {
        if (support_peak(&session->reference) > 0) {
            const double error = metrics_error(&image, &session->reference).error_gain;
            print_message("%s, %s: %.2e, %.2f of the budget\n", name, text, error, error / budget);
            tally->used[tally->count++] = error / budget;
        } else {
            assert_true(support_peak(&image) == 0);
            tally->zero++;
        }
        image_free(&image);
    } else {
        if (status != STATUS_UNSUPPORTED || !strstr(status_message(), "condition budget"))
            fail_msg("%s, %s: %s", name, text, status_message());
        print_message("%s: %s\n", name, status_message());
        tally->refused++;
    }
    spec_free(&spec);
}

static void seed_measure(int seed, double noise_std, struct tally *tally)
{
    static const double budgets[BUDGETS] = {1e-1, 1e-2, 1e-3, 1e-4};
    struct scene scene;
    struct session session;
    char name[32];
    snprintf(name, sizeof name, "seed %d", seed);
    support_noisy_scene(seed, noise_std, &scene);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    for (int k = 0; k < BUDGETS; k++)
        choice_measure(&session, name, budgets[k], tally);
    session_close(&session);
    scene_free(&scene);
}

static int given;
static char **ranges;

/* Measured errors within the budget, of other seeds than the planner was made with. */
static void within_budget(void **state)
{
    (void)state;
    static char few[] = "2001-2006", *usual[] = {few};
    static struct tally tally;
    int over = 0, seeds = 0;
    if (given > 0)
        assert_int_equal(machine_rates_need(), STATUS_OK);
    for (int k = 0; k < (given > 0 ? given : 1); k++) {
        int first, last;
        const char *range = (given > 0 ? ranges : usual)[k];
        const int read = sscanf(range, "%d-%d", &first, &last);
        if (read <= 0)
            fail_msg("%s is no range of seeds: accepted is 2001-2060, or one seed", range);
        last = read > 1 ? last : first;
        for (int seed = first; seed <= last && seeds < SEEDS_MOST; seed++, seeds++)
            seed_measure(seed, 0, &tally);
    }
    assert_true(tally.count > 0);
    const double middle = median(tally.used, tally.count); /* sorts them */
    for (int k = 0; k < tally.count; k++)
        over += tally.used[k] > 1;
    print_message("%d choices on %d scenes, %d refused, %d on images of zeros: %d over the budget, at most %.2f of it, "
                  "median %.2f\n",
                  tally.count, seeds, tally.refused, tally.zero, over, tally.used[tally.count - 1], middle);
    if (over > tally.count / 100 || tally.used[tally.count - 1] > 1.5)
        fail_msg("%d of %d choices are over the budget, the worst %g times", over, tally.count,
                 tally.used[tally.count - 1]);
    assert_true(tally.refused <= seeds / 10);
}

/* Nor does noise, which has all frequencies that a compressed record can hold: of raw and of compressed echoes, faint
   and far above them. */
static void noisy_within_budget(void **state)
{
    (void)state;
    static const double levels[] = {0.05, 1, 10};
    static const int seeds[] = {7001, 7002, 7009, 7014}; /* two of either */
    static struct tally tally;
    for (int k = 0; k < 12; k++)
        seed_measure(seeds[k / 3], levels[k % 3], &tally);
    assert_int_equal(tally.count, 12 * BUDGETS);
    const double middle = median(tally.used, tally.count); /* sorts them */
    print_message("noisy: at most %.2f of the budget, median %.2f\n", tally.used[tally.count - 1], middle);
    assert_true(tally.used[tally.count - 1] <= 1 && middle > 0.1);
}

/* On a curved track of many pings images of subapertures are chosen, with the error that the budget leaves them. */
static void subapertures_within_budget(void **state)
{
    (void)state;
    static const double budgets[] = {3e-2, 1e-2, 1e-3};
    struct scene scene;
    struct session session;
    static struct tally tally;
    support_scene("study/rail_sway", &scene);
    scene.acquisition.pings = 512;
    const struct problem problem = scene_problem(&scene, PRECISION_FLOAT);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    for (size_t k = 0; k < sizeof budgets / sizeof *budgets; k++) {
        const struct budget budget = {.error = budgets[k], .bytes = 4e9, .seconds = INFINITY};
        struct choice choice;
        assert_int_equal(choice_make(&problem, session.echoes, &budget, &choice), STATUS_OK);
        assert_true(choice.found);
        assert_string_equal(choice.list[0].algorithm->name, "bp_factorised");
        choice_free(&choice);
        choice_measure(&session, "512 pings of study/rail_sway", budgets[k], &tally);
        assert_true(tally.used[k] <= 1 && tally.used[k] > 0.1);
    }
    session_close(&session);
    scene_free(&scene);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(within_budget, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(noisy_within_budget, folder_make, folder_remove),
        cmocka_unit_test(subapertures_within_budget),
    };
    given = argc - 1;
    ranges = argv + 1;
    return cmocka_run_group_tests_name("budgets_held", tests, NULL, NULL);
}
