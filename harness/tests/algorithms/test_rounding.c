/* Images in all four rounding modes. The nearest samples are the same ones, but for what rounding itself does, and so
   are the bits for any number of threads. Threads take over the mode when they are started: each mode has a process of
   its own. */
#include <fenv.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "scene/random.h"
#include "tests/support.h"

enum { PINGS = 9, RECEIVERS = 3, SAMPLES = 500, COLUMNS = 331, ROWS = 11, PIXELS = COLUMNS * ROWS };

static const int modes[] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
static const char *const isas[] = {"baseline", "v3", "v4"}; /* where the machine has less, the most that it has */

/* The largest difference from the image in the usual mode. In single precision a position within 2^-17 of a tie takes
   the other sample, and on a line of nine steps one within 2^-19 the other step, in either: a few of 10^5 pairs. */
static const struct {
    const char *spec;
    double most[2]; /* by enum precision */
} methods[] = {
    {"bp_nearest:engine=general", {2e-2, 1e-7}},
    {"bp_zeropad:factor=8,engine=general", {4e-3, 1e-7}},
    {"bp_linear:beta=8,engine=general", {4e-3, 4e-3}},
    {"bp_sinc:taps=8,engine=general", {1e-4, 1e-7}},
    {"bp_farrow:degree=5,engine=general", {1e-4, 1e-7}},
    {"bp_fitted:factor=2,engine=general", {1e-4, 1e-7}},
    {"bp_nearest:exact=true", {3e-6, 1e-9}},
    {"bp_nearest:engine=invariant", {3e-6, 1e-9}},
    {"bp_zeropad:factor=8,engine=invariant", {3e-6, 1e-9}},
    {"bp_sinc:taps=8,engine=invariant", {3e-6, 1e-9}},
    {"bp_farrow:degree=5,engine=invariant", {4e-6, 1e-9}}, /* two float transforms in directed modes */
    {"bp_fitted:factor=2,engine=invariant", {4e-6, 1e-8}}, /* what it reads beyond the fitted band is less certain */
};
enum { METHODS = sizeof methods / sizeof *methods, ISAS = sizeof isas / sizeof *isas, IMAGES = METHODS * ISAS * 2 };

static void make_echoes(struct acquisition *a, struct echoes *echoes)
{
    struct random random = random_seed(5, 0);
    *a = support_acquisition(PINGS, RECEIVERS, SAMPLES);
    for (int p = 0; p < PINGS; p++) {
        a->t0[p] = 700 / 30e3;
        a->tx[p].x = (p - PINGS / 2) * 0.16;
        a->velocity[p].x = 2.5;
        for (int m = 0; m < RECEIVERS; m++)
            a->rx[p * RECEIVERS + m].x = a->tx[p].x + 0.04 + 0.04 * m;
    }
    support_noise(a, &random, echoes);
}

/* All images in one mode; the child's end of the pipe. Returns what the process ends with: 0, or a code that says why
   not. */
static int form_images(int mode, FILE *out)
{
    struct acquisition a;
    struct echoes echoes;
    struct grid grid = {-3.013, 0.02, COLUMNS, 19.87, 0.31, ROWS};
    make_echoes(&a, &echoes);
    if (fesetround(mode) != 0)
        return 2;
    for (int n = 0; n < IMAGES; n++) {
        char spec[96];
        struct image images[3];
        struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        enum precision precision = n % 2 ? PRECISION_DOUBLE : PRECISION_FLOAT;
        snprintf(spec, sizeof spec, "%s,precision=%s", methods[n / 2 % METHODS].spec, precision_name(precision));
        setenv("SASBENCH_ISA", isas[n / 2 / METHODS], 1);
        for (int t = 0; t < 3; t++) {
            omp_set_num_threads(3 - t); /* all threads start in this mode */
            if (support_image(spec, problem, &echoes, &images[t]) != STATUS_OK)
                return 3;
            if (memcmp(images[t].pixels[0], images[0].pixels[0], PIXELS * precision_size(precision)) != 0)
                return 4;
        }
        for (int i = 0; i < PIXELS; i++) {
            double complex value = image_pixel(&images[0], 0, i / COLUMNS, i % COLUMNS);
            if (fwrite(&value, sizeof value, 1, out) != 1)
                return 5;
        }
        for (int t = 0; t < 3; t++)
            image_free(&images[t]);
    }
    echoes_free(&echoes);
    acquisition_free(&a);
    return fflush(out) == 0 ? 0 : 5;
}

static void images_of_mode(int mode, double complex *images)
{
    int ends[2], status = 0;
    assert_int_equal(pipe(ends), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        FILE *out = fdopen(ends[1], "wb");
        close(ends[0]);
        _exit(out ? form_images(mode, out) : 5);
    }
    FILE *in = fdopen(ends[0], "rb");
    close(ends[1]);
    size_t count = in ? fread(images, sizeof *images, (size_t)IMAGES * PIXELS, in) : 0;
    if (in)
        fclose(in);
    assert_int_equal(waitpid(child, &status, 0), child);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        fail_msg("mode %d: status %d (4: the bits depend on the number of threads)", mode, status);
    assert_int_equal(count, (size_t)IMAGES * PIXELS);
}

static void rounding_modes_agree(void **state)
{
    (void)state;
    double complex *usual = malloc(sizeof *usual * IMAGES * PIXELS), *other = malloc(sizeof *other * IMAGES * PIXELS);
    assert_true(usual && other);
    double worst[METHODS][2] = {{0}};
    images_of_mode(modes[0], usual);
    for (size_t k = 1; k < sizeof modes / sizeof *modes; k++) {
        images_of_mode(modes[k], other);
        for (int n = 0; n < IMAGES; n++) {
            double difference = 0, norm = 0;
            for (int i = n * PIXELS; i < (n + 1) * PIXELS; i++) {
                difference += pow(cabs(other[i] - usual[i]), 2);
                norm += pow(cabs(usual[i]), 2);
            }
            int method = n / 2 % METHODS, precision = n % 2 ? PRECISION_DOUBLE : PRECISION_FLOAT;
            worst[method][precision] = fmax(worst[method][precision], sqrt(difference / norm));
            if (!(sqrt(difference / norm) <= methods[method].most[precision]))
                fail_msg("%s, %s, %s: mode %d differs by %g", methods[method].spec,
                         precision_name((enum precision)precision), isas[n / 2 / METHODS], modes[k],
                         sqrt(difference / norm));
        }
    }
    for (int m = 0; m < METHODS; m++)
        print_message("%s: rounding modes within %.1e (float), %.1e (double)\n", methods[m].spec,
                      worst[m][PRECISION_FLOAT], worst[m][PRECISION_DOUBLE]);
    free(usual);
    free(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rounding_modes_agree),
    };
    return cmocka_run_group_tests_name("rounding", tests, NULL, NULL);
}
