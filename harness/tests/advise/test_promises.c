/* Every algorithm's promise on scenes drawn from seeds, in float and in double: an image is within the error that its
   settings promise, or its row warns of a cause, or it is refused with a reason. Whatever is over its promise has the
   warning `promise` at least, by measurement. A third of the scenes are near (ranges below the aperture), a third have
   an image that is dark beside bright echoes.

   Without arguments a test of a few seeds; with arguments a measurement of ranges of seeds: `test_promises 1-2000`. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "measure/outcome.h"
#include "scene/random_scene.h"
#include "tests/support.h"

enum { KINDS = 3, TEXT = 4000 };

static const double OVER = 1.1;
static const char PROMISE[] = OUTCOME_WARNING "condition promise: ";

static const char *const specs[] = {"bp_farrow", "bp_farrow:error=1e-2", "bp_factorised", "bp_factorised:error=1e-3",
                                    "rma_lbf", "rma_pca", "rma_wu", "rma_numeric", "rma_delay", "rma_chirp",
                                    "wk_classic", "wk_squint", "auto:error=1e-2", "auto:error=1e-3",
                                    /* These promise nothing of an error; their images must be numbers. */
                                    "bp_nearest", "bp_linear", "bp_sinc", "bp_zeropad", "bp_fitted", "wk_polar"};

struct tally {
    int ok, refused, warned, broken;
};

/* A target or a field of them, and an image, in place of the random scene's. */
static void dark_targets(const char *text, int seed, FILE *stream)
{
    struct random random = random_seed((uint64_t)seed, 2);
    double x[2], r[2];
    const char *targets = strstr(text, "targets ="), *behind = strchr(targets, '\n');
    assert_int_equal(
        sscanf(targets, "targets = { fields = ( { x = [%lf, %lf]; r = [%lf, %lf]", &x[0], &x[1], &r[0], &r[1]), 4);
    const double width = x[1] - x[0], depth = r[1] - r[0], loud = pow(10, 0.5 + 2 * random_uniform(&random));
    fprintf(stream, "%.*s", (int)(targets - text), text);
    if (random_uniform(&random) < 0.5) /* an acoustic shadow: the image lies in a gap between scatterers */
        fprintf(stream,
                "targets = { fields = ( { x = [%.9f, %.9f]; r = [%.9f, %.9f]; count = 200; seed = %d; }, "
                "{ x = [%.9f, %.9f]; r = [%.9f, %.9f]; count = 200; seed = %d; } ); };\n",
                x[0] - 2 * width, x[0] - 0.1 * width, r[0], r[1], seed, x[1] + 0.1 * width, x[1] + 2 * width, r[0],
                r[1], seed + 1);
    else { /* a target, and a loud one beside it, along the track or in range */
        const bool aside = random_uniform(&random) < 0.5;
        fprintf(stream,
                "targets = { points = ( { x = %.9f; r = %.9f; amplitude = 1.0; }, { x = %.9f; r = %.9f; amplitude = "
                "%.9f; } ); };\n",
                (x[0] + x[1]) / 2, (r[0] + r[1]) / 2, (x[0] + x[1]) / 2 + (aside ? 0.8 * width : 0),
                (r[0] + r[1]) / 2 + (aside ? 0 : 0.8 * depth), loud);
    }
    fputs(behind + 1, stream);
}

/* Ranges below the aperture. */
static void near_scene(int seed, FILE *stream)
{
    struct random random = random_seed((uint64_t)seed, 3);
    const double c = 1500, fc = 40e3 * pow(4, random_uniform(&random)), lambda = c / fc;
    const double band = fc * (0.05 + 0.35 * random_uniform(&random)), fs = band * (1.05 + 2 * random_uniform(&random));
    const int receivers = 1 + (int)(4 * random_uniform(&random)), pings = 100 + (int)(200 * random_uniform(&random));
    const double element = lambda * (1 + 4 * random_uniform(&random)), pitch = element / 2;
    const double spacing = receivers * pitch / 2, length = pings * spacing;
    const double r = 0.3 * pow(20, random_uniform(&random)),
                 r_step = c / (2 * fs) * (0.3 + 0.7 * random_uniform(&random));
    const int columns = 32, rows = 24;
    const double x_step = spacing / ceil(spacing / (element / 5)), half = columns / 2 * x_step;
    const double far = hypot(r + rows * r_step, length / 2 + half + receivers * pitch);
    const int samples = (int)fmin(1500, ceil(2 * far / c * fs) + 48);
    fprintf(stream,
            "description = \"near\";\nsonar = { sound_speed = 1500.0; fc = %.1f; bandwidth = %.3f; fs = %.3f; };\n"
            "pulse = { kind = \"flat\"; };\n"
            "array = { tx_length = %.9f; rx_length = %.9f; receivers = %d; first_offset = %.9f; pitch = %.9f; };\n"
            "track = { speed = %.9f; pri = %.9f; pings = %d; x_first = %.9f; };\n"
            "record = { first_sample = 0; samples = %d; };\nbeam = { kind = \"txrx\"; truncation = \"none\"; };\n"
            "targets = { fields = ( { x = [%.9f, %.9f]; r = [%.9f, %.9f]; count = 30; seed = %d; } ); };\n"
            "image = { x = { first = %.9f; step = %.12f; count = %d; }; r = { first = %.9f; step = %.9f; count = %d; "
            "}; };\n",
            fc, band, fs, element, pitch, receivers, pitch, pitch, spacing / (1.5 * samples / fs + 0.05),
            1.5 * samples / fs + 0.05, pings, -length / 2, samples, -half, half, r, r + rows * r_step, seed, -half,
            x_step, columns, r, r_step, rows);
}

static void scene_of(int seed, struct scene *scene)
{
    const char *path = path_of("random.cfg");
    FILE *file = fopen(path, "w+");
    assert_non_null(file);
    if (seed % KINDS == 1)
        near_scene(seed, file);
    else
        random_scene_write(file, (uint64_t)seed);
    if (seed % KINDS == 2) {
        static char text[TEXT];
        rewind(file);
        const size_t length = fread(text, 1, sizeof text - 1, file);
        text[length] = '\0';
        rewind(file);
        assert_int_equal(ftruncate(fileno(file), 0), 0);
        dark_targets(text, seed, file);
    }
    fclose(file);
    support_scene(path, scene);
}

/* Is there a warning but for the one that tells of the promise? */
static bool cause_warned(const char *reason)
{
    for (const char *at = reason; (at = strstr(at, OUTCOME_WARNING)); at++)
        if (strncmp(at, PROMISE, strlen(PROMISE)) != 0)
            return true;
    return false;
}

static void setting_hold(struct session *session, int seed, const char *text, struct tally *tally)
{
    struct spec spec;
    struct outcome outcome;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    outcome_measure(session, &spec, EFFORT_NONE, NULL, &outcome);
    const struct measurement *row = &outcome.row;
    if (strcmp(row->status, "ok") != 0) {
        tally->refused++;
        if (strcmp(row->status, "unsupported") != 0 || !*row->reason) {
            print_message("seed %d, %s: %s: %s\n", seed, text, row->status, row->reason);
            tally->broken++;
        }
    } else {
        const bool dark = support_peak(&session->reference) == 0, warned = cause_warned(row->reason);
        const double error = row->error, most = spec.algorithm->promise ? spec.algorithm->promise(spec.options) : NAN;
        const bool over = error > OVER * most;
        tally->ok++;
        tally->warned += warned;
        if (over && !strstr(row->reason, PROMISE))
            fail_msg("seed %d, %s: %.3g where %g is promised, and its row does not say so: %s", seed, text, error, most,
                     row->reason);
        if (!isfinite(support_peak(&outcome.image)) || (!dark && !isfinite(error)) || (over && !warned)) {
            print_message("seed %d, %s: an error of %.3g (%.3g after a gain) where %g is promised; %s\n", seed, text,
                          error, row->error_gain, most, row->reason);
            tally->broken++;
        }
    }
    outcome_free(&outcome);
    spec_free(&spec);
}

static void seed_hold(int seed, struct tally *tally)
{
    static const char *const precisions[] = {"float", "double"};
    struct scene scene;
    struct session session;
    char text[100];
    scene_of(seed, &scene);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    for (int p = 0; p < 2; p++)
        for (size_t k = 0; k < sizeof specs / sizeof *specs; k++) {
            snprintf(text, sizeof text, "%s%sprecision=%s", specs[k], strchr(specs[k], ':') ? "," : ":", precisions[p]);
            setting_hold(&session, seed, text, tally);
        }
    session_close(&session);
    scene_free(&scene);
}

static int given;
static char **ranges;

static void promises_held(void **state)
{
    (void)state;
    static char few[] = "1-6", *usual[] = {few};
    static struct tally tally;
    int seeds = 0;
    for (int k = 0; k < (given > 0 ? given : 1); k++) {
        int first, last;
        const char *range = (given > 0 ? ranges : usual)[k];
        const int read = sscanf(range, "%d-%d", &first, &last);
        if (read <= 0)
            fail_msg("%s is no range of seeds: accepted is 1-2000, or one seed", range);
        last = read > 1 ? last : first;
        for (int seed = first; seed <= last; seed++, seeds++)
            seed_hold(seed, &tally);
    }
    print_message("%d scenes: %d images, %d of them with a warning, %d refused, %d promises broken\n", seeds, tally.ok,
                  tally.warned, tally.refused, tally.broken);
    assert_int_equal(tally.broken, 0);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test_setup_teardown(promises_held, folder_make, folder_remove)};
    given = argc - 1;
    ranges = argv + 1;
    return cmocka_run_group_tests_name("promises", tests, NULL, NULL);
}
