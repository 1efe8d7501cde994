/* The regression gate: the shipped baseline holds on every instruction set, and injected faults are caught by name. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/paths.h"
#include "backprojection/bp.h"
#include "contract/delay.h"
#include "gate/baseline.h"
#include "gate/diff.h"
#include "tests/support.h"

static int folder_remove_known(void **state)
{
    (void)state;
    remove(path_of("old.csv"));
    remove(path_of("new.csv"));
    return rmdir(folder); /* fails when a file was left behind */
}

/* --- The baseline --------------------------------------------------------------------------------------------- */

static void check_baseline(const char *isa)
{
    struct diff diff;
    setenv("SASBENCH_ISA", isa, 1);
    assert_int_equal(baseline_write(path_of("new.csv")), STATUS_OK);
    unsetenv("SASBENCH_ISA");
    assert_int_equal(diff_results(data_path(DATA_BASELINE), path_of("new.csv"), &diff), STATUS_OK);
    if (diff_status(&diff) != STATUS_OK || diff.finding_count < 500) {
        diff_print(&diff, stdout);
        fail_msg("%s code differs from results/baseline.csv (./sasbench baseline writes a new one, to be reviewed)",
                 isa);
    }
    diff_free(&diff);
}

static void baseline_holds(void **state)
{
    (void)state;
    check_baseline("v4"); /* the best that there is */
}

static void baseline_holds_without_vector_extensions(void **state)
{
    (void)state;
    check_baseline("baseline");
}

/* An image of something else, a failure, and an algorithm that images no scene of the gate are no baseline. */
static void unfit_rows_are_refused(void **state)
{
    (void)state;
    static const struct algorithm mine = {.name = "mine"}, area = {.name = "mine", .traits = TRAIT_AREA};
    struct measurement rows[3] = {measurement_empty("gate/points", "mine", "taps=8", PRECISION_FLOAT),
                                  measurement_empty("gate/field", "mine", "taps=8", PRECISION_FLOAT),
                                  measurement_empty("gate/field", "other", "", PRECISION_FLOAT)};
    rows[0].status = rows[2].status = "ok";
    rows[0].error = 0.4;
    rows[2].error = 2;
    rows[1].status = "unsupported";
    rows[1].reason = "the track bends";
    assert_int_equal(baseline_accept(&mine, rows, 3), STATUS_OK);
    rows[0].error = 0.6;
    assert_int_equal(baseline_accept(&mine, rows, 3), STATUS_FAILED);
    assert_non_null(strstr(status_message(), "mine:taps=8 in float has an error of 0.6 on gate/points, must be at "));
    assert_int_equal(baseline_accept(&area, rows, 3), STATUS_OK);
    rows[0].error = NAN;
    assert_int_equal(baseline_accept(&mine, rows, 3), STATUS_FAILED);
    assert_int_equal(baseline_accept(&mine, rows + 1, 2), STATUS_FAILED);
    assert_non_null(strstr(status_message(), "mine images no scene of scenes/gate (gate/field: the track bends)"));
    rows[1].status = "failed";
    assert_int_equal(baseline_accept(&mine, rows, 3), STATUS_FAILED);
}

/* --- Injected faults ------------------------------------------------------------------------------------------ */

enum fault {
    FAULT_NONE,
    FAULT_WEIGHTS,
    FAULT_HALF_SAMPLE,
    FAULT_SIGN,
    FAULT_RECEIVER,
    FAULT_FLOAT_DELAY,
    FAULT_FLOAT_PHASE,
    FAULT_STOP_AND_HOP,
    FAULT_BLOCK,
    FAULTS
};
static const char *const fault_names[FAULTS] = {"none",
                                                "a swapped interpolation weight",
                                                "a half-sample shift",
                                                "a phase sign",
                                                "a dropped receiver",
                                                "the delay in float",
                                                "the phase in float",
                                                "stop-and-hop",
                                                "a lost sub-block"};
static enum fault injected;

/* bp_sinc:taps=16,window=kaiser written plainly once more, with one fault at a time. Double, compressed echoes. */
enum { TAPS = 16, FRACTIONS = 1024 };

static void read_weights(double fraction, double w[TAPS])
{
    static double table[FRACTIONS + 1][TAPS];
    if (table[0][TAPS / 2 - 1] == 0)
        for (int k = 0; k <= FRACTIONS; k++)
            sinc_weights(TAPS, 5, (double)k / FRACTIONS, table[k]);
    int at = (int)(fraction * FRACTIONS);
    double u = fraction * FRACTIONS - at;
    for (int k = 0; k < TAPS; k++)
        w[k] = (1 - u) * table[at][k] + u * table[at + 1][k];
    if (injected == FAULT_WEIGHTS) {
        double left = w[TAPS / 2 - 1];
        w[TAPS / 2 - 1] = w[TAPS / 2];
        w[TAPS / 2] = left;
    }
}

static enum status plain_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    const struct acquisition *a = echoes->acquisition;
    const struct grid *grid = &image->patches[0];
    double complex *pixels = image->pixels[0];
    (void)plan, (void)stages;
    memset(pixels, 0, grid_pixels(grid) * sizeof *pixels);
    for (int pair = 0; pair < a->pings * a->receivers; pair++) {
        int ping = pair / a->receivers, receiver = pair % a->receivers;
        const double complex *s = (const double complex *)echoes->samples + (size_t)pair * (size_t)a->samples;
        struct vector velocity = injected == FAULT_STOP_AND_HOP ? (struct vector){0, 0, 0} : a->velocity[ping];
        for (int k = 0; k < grid->r_count * grid->x_count; k++) {
            struct vector p = {grid->x_first + k % grid->x_count * grid->x_step,
                               grid->r_first + k / grid->x_count * grid->r_step, 0};
            double tau = delay_exact(a->tx[ping], a->rx[pair], velocity, p, a->sound_speed), w[TAPS];
            if (injected == FAULT_FLOAT_DELAY)
                tau = (float)tau;
            double q = (tau - a->t0[ping]) * a->fs + (injected == FAULT_HALF_SAMPLE ? 0.5 : 0), cycles = a->fc * tau;
            if (!(q >= 0 && q <= a->samples - 1) || (injected == FAULT_RECEIVER && receiver == a->receivers - 1))
                continue;
            double complex value = 0;
            int at = (int)q + 1 - TAPS / 2;
            read_weights(q - floor(q), w);
            for (int t = 0; t < TAPS; t++)
                value += at + t >= 0 && at + t < a->samples ? w[t] * s[at + t] : 0;
            double phase = 2 * 3.14159265358979323846 * (cycles - floor(cycles));
            if (injected == FAULT_FLOAT_PHASE)
                phase = fmodf((float)(2 * 3.14159265358979323846 * cycles), 6.28318530717958648F);
            pixels[k] += value * cexp((injected == FAULT_SIGN ? -I : I) * phase);
        }
    }
    return STATUS_OK;
}

/* Range migration in sixteen blocks, one of which never arrives. */
static enum status lossy_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    enum status status = algorithm_find("rma_lbf")->execute(plan, echoes, image, stages);
    size_t rows = (size_t)image->patches[0].r_count, columns = (size_t)image->patches[0].x_count;
    if (injected == FAULT_BLOCK)
        memset((float complex *)image->pixels[0] + rows / 2 * columns, 0, rows / 16 * columns * sizeof(float complex));
    return status;
}

/* Does the gate pass the row? Otherwise *metric tells by which metric it is worse first. */
static bool gate_passes(struct session *session, const char *spec_text, bool plain, const char **metric)
{
    struct spec spec;
    struct measurement healthy, row;
    struct diff diff;
    char reason[512];
    assert_int_equal(spec_parse(spec_text, &spec), STATUS_OK);
    baseline_row(session, &spec, reason, sizeof reason, &healthy);
    struct algorithm faulty = *spec.algorithm;
    faulty.execute = plain ? plain_execute : lossy_execute;
    spec.algorithm = &faulty;
    baseline_row(session, &spec, reason, sizeof reason, &row);
    assert_int_equal(measurements_write(path_of("old.csv"), "healthy", NULL, 0, &healthy, 1), STATUS_OK);
    assert_int_equal(measurements_write(path_of("new.csv"), "faulty", NULL, 0, &row, 1), STATUS_OK);
    assert_int_equal(diff_results(path_of("old.csv"), path_of("new.csv"), &diff), STATUS_OK);
    bool passes = diff_status(&diff) == STATUS_OK;
    *metric = "";
    for (int k = diff.finding_count - 1; k >= 0; k--)
        if (diff.findings[k].verdict == VERDICT_WORSE)
            for (const struct column *m = metric_first(measurement_columns); m; m = metric_first(m + 1))
                if (strcmp(m->name, diff.findings[k].metric) == 0)
                    *metric = m->name;
    diff_free(&diff);
    spec_free(&spec);
    return passes;
}

static void faults_are_caught_by_name(void **state)
{
    (void)state;
    struct scene scene;
    struct session session;
    support_scene("gate/blocks", &scene);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    for (injected = FAULT_NONE; injected < FAULTS; injected++) {
        bool block = injected == FAULT_BLOCK;
        const char *metric;
        bool passes = gate_passes(
            &session, block ? "rma_lbf:blocks=16" : "bp_sinc:taps=16,window=kaiser,precision=double", !block, &metric);
        if (passes != (injected == FAULT_NONE) || strcmp(metric, passes ? "" : "error") != 0)
            fail_msg("%s: %s, metric '%s'", fault_names[injected], passes ? "passed" : "caught", metric);
    }
    session_close(&session);
    scene_free(&scene);
}

int main(void)
{
    omp_set_num_threads(1); /* the same bits, and quick beside other tests */
#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, folder_make, folder_remove_known)
    const struct CMUnitTest tests[] = {
        IN_FOLDER(baseline_holds),
        IN_FOLDER(baseline_holds_without_vector_extensions),
        cmocka_unit_test(unfit_rows_are_refused),
        IN_FOLDER(faults_are_caught_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
