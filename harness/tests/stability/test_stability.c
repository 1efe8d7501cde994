/* The trial sees what it is there for: nearest-neighbour back projection with one fault at a time, and the files of
 * verdicts. */
#include <fenv.h>
#include <math.h>
#include <omp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/paths.h"
#include "contract/delay.h"
#include "stability/stability.h"
#include "stability/stability_table.h"
#include "tests/support.h"

enum fault {
    FAULT_NONE,
    FAULT_FLOAT_DELAY,
    FAULT_UNREDUCED_PHASE,
    FAULT_FLOAT_COORDINATES,
    FAULT_SOUND_SPEED,
    FAULT_RINT,
    FAULT_NO_SCALING,
    FAULT_WORKER_MODE,
    FAULT_NAN,
    FAULT_CRASH,
    FAULT_INVALID
};
static enum fault injected;

/* ---- a plain back projection, named as the method that it is ---- */

static enum status planted_plan(const struct problem *problem, const void *method, const void *options, void **plan)
{
    struct problem *copy = malloc(sizeof *copy);
    (void)method, (void)options;
    if (copy)
        *copy = *problem;
    *plan = copy;
    return copy ? STATUS_OK : status_set(STATUS_FAILED, "no memory for the plan");
}

static struct vector rounded(struct vector v)
{
    return injected == FAULT_FLOAT_COORDINATES ? (struct vector){(float)v.x, (float)v.y, (float)v.z} : v;
}

static double complex sample_of(const struct echoes *echoes, size_t index)
{
    if (echoes->precision == PRECISION_DOUBLE)
        return ((const double complex *)echoes->samples)[index];
    float complex value = ((const float complex *)echoes->samples)[index];
    if (injected == FAULT_NO_SCALING) { /* as recorded, which may be a number with few bits */
        volatile float re = ldexpf(crealf(value), echoes->exponent), im = ldexpf(cimagf(value), echoes->exponent);
        value = ldexpf(re, -echoes->exponent) + I * ldexpf(im, -echoes->exponent);
    }
    return value;
}

static double complex phase_factor(double fc, double tau)
{
    if (injected == FAULT_UNREDUCED_PHASE) {
        const float angle = (float)(2 * M_PI * fc * tau);
        return cosf(angle) + I * sinf(angle);
    }
    const double cycles = fc * (injected == FAULT_FLOAT_DELAY ? (double)(float)tau : tau);
    const double angle = 2 * M_PI * (cycles - floor(cycles + 0.5));
    return cos(angle) + I * sin(angle);
}

static double complex pixel_sum(const struct problem *problem, const struct echoes *echoes, struct vector p)
{
    const struct acquisition *a = problem->acquisition;
    const double c = a->sound_speed * (injected == FAULT_SOUND_SPEED ? 1 + 1e-12 : 1);
    double complex sum = 0;
    for (int ping = 0; ping < a->pings; ping++)
        for (int m = 0; m < a->receivers; m++) {
            const size_t record = (size_t)ping * (size_t)a->receivers + (size_t)m;
            const double tau =
                delay_exact(rounded(a->tx[ping]), rounded(a->rx[record]), a->velocity[ping], rounded(p), c);
            const double q = (tau - a->t0[ping]) * a->fs, n = injected == FAULT_RINT ? rint(q) : floor(q + 0.5);
            if (q >= 0 && q <= a->samples - 1)
                sum += sample_of(echoes, record * (size_t)a->samples + (size_t)n) * phase_factor(a->fc, tau);
        }
    return sum;
}

/* What the thread does wrong beside the sum. */
static void thread_spoil(void)
{
    if (injected == FAULT_WORKER_MODE)
        fesetround(omp_get_thread_num() == 1 ? FE_UPWARD : fegetround());
    if (injected == FAULT_INVALID)
        feraiseexcept(FE_INVALID);
    if (injected == FAULT_CRASH)
        raise(SIGSEGV);
}

static enum status planted_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    const struct problem *problem = plan;
    (void)stages;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
#pragma omp parallel for schedule(static)
        for (int j = 0; j < g->x_count; j++) {
            thread_spoil();
            double complex sum = pixel_sum(problem, echoes, (struct vector){g->x_first + j * g->x_step, g->r_first, 0});
            if (injected == FAULT_NAN && j == 3)
                sum = NAN;
            if (image->precision == PRECISION_DOUBLE)
                ((double complex *)image->pixels[k])[j] = sum;
            else
                ((float complex *)image->pixels[k])[j] = (float complex)sum;
        }
    }
    return STATUS_OK;
}

static struct work planted_work(const void *plan)
{
    (void)plan;
    return (struct work){.engine = "planted"};
}

static const struct algorithm planted = {.name = "bp_nearest",
                                         .summary = "nearest neighbour with one fault",
                                         .reference = "",
                                         .reading = READING_NEAREST,
                                         .extreme_error = 0.15,
                                         .plan = planted_plan,
                                         .execute = planted_execute,
                                         .work = planted_work,
                                         .destroy = free};

static struct stability_verdict verdict_with(enum fault fault, const char *name, enum precision precision)
{
    const struct spec spec = {.algorithm = &planted, .precision = precision};
    struct scene scene;
    struct trial trial;
    injected = fault;
    support_scene(name, &scene);
    assert_int_equal(trial_run(&scene, &spec, 1, TRIAL_MODES, &trial), STATUS_OK);
    struct stability_verdict verdict = trial_verdict(&trial, 0);
    trial_close(&trial);
    scene_free(&scene);
    print_message("fault %2d, %-20s %s: D %.1f, error %.2g, spread %.2g %s\n", fault, name,
                  precision == PRECISION_DOUBLE ? "double" : "float", verdict.digits, verdict.error, verdict.spread,
                  verdict.why);
    return verdict;
}

static void assert_fails(struct stability_verdict verdict, const char *why)
{
    assert_int_equal(verdict.kind, VERDICT_FAILS);
    assert_string_equal(verdict.why, why);
}

/* Without a fault the plain sum loses nothing on any of the scenes below. */
static void careful_code_loses_nothing(void **state)
{
    (void)state;
    static const char *const scenes[] = {"extreme/base", "extreme/utm", "extreme/amp_denormal", "extreme/tie_exact"};
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++)
        for (int precision = 0; precision < 2; precision++) {
            struct stability_verdict verdict = verdict_with(FAULT_NONE, scenes[k], (enum precision)precision);
            assert_int_equal(verdict.kind, VERDICT_WORKS);
            assert_true(verdict.digits < 1 && verdict.same_bits && verdict.finite && verdict.exceptions == 0);
        }
}

static void lost_digits_are_seen(void **state)
{
    (void)state;
    static const struct {
        enum fault fault;
        const char *scene;
        enum precision precision;
        double digits; /* at least */
    } cases[] = {
        {FAULT_FLOAT_DELAY, "extreme/base", PRECISION_FLOAT, 2.8},
        {FAULT_FLOAT_DELAY, "extreme/base", PRECISION_DOUBLE, 7},
        {FAULT_UNREDUCED_PHASE, "extreme/base", PRECISION_FLOAT, 2.8},
        {FAULT_FLOAT_COORDINATES, "extreme/utm", PRECISION_FLOAT, 5},
        {FAULT_SOUND_SPEED, "extreme/base", PRECISION_DOUBLE, 3},
        {FAULT_RINT, "extreme/base", PRECISION_DOUBLE, 7},
        {FAULT_RINT, "extreme/base", PRECISION_FLOAT, 3.5},
        {FAULT_NO_SCALING, "extreme/amp_denormal", PRECISION_FLOAT, 2.2},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct stability_verdict verdict = verdict_with(cases[k].fault, cases[k].scene, cases[k].precision);
        assert_fails(verdict, "digits");
        assert_true(verdict.digits >= cases[k].digits);
    }
}

static void flaws_are_seen(void **state)
{
    (void)state;
    assert_fails(verdict_with(FAULT_WORKER_MODE, "extreme/base", PRECISION_FLOAT), "bits differ between threads");
    assert_fails(verdict_with(FAULT_WORKER_MODE, "extreme/base", PRECISION_DOUBLE), "bits differ between threads");
    assert_fails(verdict_with(FAULT_INVALID, "extreme/base", PRECISION_DOUBLE), "raised invalid");
    struct stability_verdict verdict = verdict_with(FAULT_NAN, "extreme/base", PRECISION_DOUBLE);
    assert_fails(verdict, "not finite, mode nearest");
    assert_false(verdict.finite);
    verdict = verdict_with(FAULT_CRASH, "extreme/base", PRECISION_DOUBLE);
    assert_fails(verdict, "signal, mode nearest");
    assert_non_null(strstr(verdict.message, "ended by signal 11"));
}

/* ---- the files ---- */

static struct stability_row row_of(const struct spec *spec, enum verdict_kind kind, const char *why, double error,
                                   double digits)
{
    struct stability_row row = {
        "extreme/base", spec, {.kind = kind, .error = error, .digits = digits, .same_bits = true}};
    row.verdict.error_most = 0.15;
    snprintf(row.verdict.why, sizeof row.verdict.why, "%s", why);
    return row;
}

static int differences(const struct stability_row *row, int *unknown)
{
    int differ;
    assert_int_equal(stability_compare(path_of("expected.csv"), 1, row, &differ, unknown), STATUS_OK);
    return differ;
}

static void rows_are_held_to_what_is_expected(void **state)
{
    (void)state;
    const struct spec spec = {.algorithm = &planted, .text = "beta=8,window=none"};
    const struct spec other = {.algorithm = &planted, .text = "beta=9"};
    struct stability_row works = row_of(&spec, VERDICT_WORKS, "", 0.1, 0.5);
    int unknown;
    assert_int_equal(stability_expected_write(path_of("expected.csv"), 1, &works), STATUS_OK);
    assert_int_equal(stability_write(path_of("stability.csv"), TRIAL_MODES, 1, &works), STATUS_OK);
    const struct {
        struct stability_row row;
        int differ, unknown;
    } cases[] = {
        {works, 0, 0},
        {row_of(&spec, VERDICT_WORKS, "", 0.2, 0.5), 1, 0}, /* beyond the bound of the error */
        {row_of(&spec, VERDICT_WORKS, "", 0.1, 2.1), 1, 0}, /* of the digits */
        {row_of(&spec, VERDICT_DEGRADES, "", 0.1, 0.5), 1, 0},
        {row_of(&spec, CANDIDATE_REFUSED, "lbf_law", NAN, NAN), 1, 0},
        {row_of(&other, VERDICT_WORKS, "", 0.2, 0.5), 0, 1}, /* nothing is expected */
        {row_of(&other, VERDICT_FAILS, "digits", 0.2, 3), 1, 0},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        assert_int_equal(differences(&cases[k].row, &unknown), cases[k].differ);
        assert_int_equal(unknown, cases[k].unknown);
    }
    struct stability_row refused = row_of(&spec, CANDIDATE_REFUSED, "lbf_law", NAN, NAN);
    assert_int_equal(stability_expected_write(path_of("expected.csv"), 1, &refused), STATUS_OK);
    assert_int_equal(differences(&refused, &unknown), 0);
    assert_int_equal(differences(&works, &unknown), 1);
    snprintf(refused.verdict.why, sizeof refused.verdict.why, "doppler"); /* another condition is another verdict */
    assert_int_equal(differences(&refused, &unknown), 1);
    support_write("expected.csv", "scene,algorithm\n");
    int differ;
    assert_int_equal(stability_compare(path_of("expected.csv"), 1, &works, &differ, &unknown), STATUS_INVALID);
}

static void conditions_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *message, *name;
    } cases[] = {
        {"rma_lbf: condition lbf_law: the formula's phase error is 2; at most 0.1 is needed", "lbf_law"},
        {"/a/b.cfg:7: key 'track.speed' is 1500.0, must be below", "track.speed"},
        {"engine=invariant: condition invariance: how far columns drift is 2; at most 1e-07 is needed", "invariance"},
        {"rma_lbf: a single ping has no azimuth spectrum", "pings"},
        {"a.cfg: delays of up to 9 s at fc = 1 Hz (ping 1) leave a phase error of 3 rad", "phase_digits"},
        {"rma_lbf: something else (why)", "something else "},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        assert_string_equal(refusal_verdict(cases[k].message).why, cases[k].name);
}

static void mistakes_are_refused(void **state)
{
    (void)state;
    const char *const names[] = {"extreme/nosuch"};
    struct stability_request request = {.scene_count = 1, .scenes = names, .directory = path_of("out"), .quick = true};
    assert_int_equal(stability_run(&request, data_path(DATA_STABILITY)), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "extreme/nosuch.cfg: no scene can be read there"));
    assert_false(support_exists("out"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(careful_code_loses_nothing),
        cmocka_unit_test(lost_digits_are_seen),
        cmocka_unit_test(flaws_are_seen),
        cmocka_unit_test_setup_teardown(rows_are_held_to_what_is_expected, folder_make, folder_remove),
        cmocka_unit_test(conditions_are_named),
        cmocka_unit_test_setup_teardown(mistakes_are_refused, folder_make, folder_remove),
    };
    return cmocka_run_group_tests_name("stability", tests, NULL, NULL);
}
