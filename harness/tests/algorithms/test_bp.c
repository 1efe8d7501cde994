/* The back projection engines. The exact path against a naive sum, one pair at a time, on random tracks in space: which
   pairs count, how samples are read, records that begin and end inside the image, aperture limits on oblique headings.
   test_bp_invariant.c and test_bp_general.c hold the fast paths to it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/fft_length.h"
#include "backprojection/bp.h"
#include "contract/delay.h"
#include "backprojection/pairs/pairs.h"
#include "scene/random.h"
#include "tests/support.h"

static double uniform(struct random *random, double low, double high)
{
    return low + (high - low) * random_uniform(random);
}

/* A wobbling track and a grid near it; every third one is straight, records are short enough to be left by some
   pairs. */
static void random_case(uint64_t seed, struct acquisition *a, struct grid *grid, struct echoes *echoes)
{
    struct random random = random_seed(seed, 0);
    *a = (struct acquisition){.sound_speed = 1500,
                              .fc = uniform(&random, 20e3, 150e3),
                              .fs = 30e3,
                              .bandwidth = 15e3,
                              .samples = (int)uniform(&random, 20, 300),
                              .receivers = (int)uniform(&random, 1, 5),
                              .pings = (int)uniform(&random, 1, 9),
                              .compressed = true,
                              .aperture_limit = seed % 2 ? INFINITY : uniform(&random, 0.05, 0.99)};
    assert_int_equal(acquisition_allocate(a), STATUS_OK);
    double wobble = seed % 3 ? uniform(&random, 0, 3) : 0, height = seed % 3 ? uniform(&random, -4, 4) : 0;
    double speed = seed % 5 ? uniform(&random, -4, 4) : 0;
    double slope = seed % 3 ? uniform(&random, -3, 3) : 0, t0 = floor(uniform(&random, 0, 300)) / a->fs;
    for (int p = 0; p < a->pings; p++) {
        a->t0[p] = seed % 4 ? t0 : t0 + p / a->fs;
        a->tx[p] = (struct vector){p * 0.7 - 2, slope * p * 0.7 + wobble * random_uniform(&random), height};
        a->velocity[p] = (struct vector){speed, speed * slope, 0};
        for (int m = 0; m < a->receivers; m++)
            a->rx[p * a->receivers + m] = (struct vector){a->tx[p].x + 0.1 * m - 0.15, a->tx[p].y + 0.01 * m, height};
    }
    *grid = (struct grid){uniform(&random, -6, 1), uniform(&random, 0.02, 0.4), (int)uniform(&random, 1, 20),
                          uniform(&random, -8, 8), uniform(&random, 0.01, 0.2), (int)uniform(&random, 1, 600)};
    support_noise(a, &random, echoes);
}

/* How a method reads a record at sample coordinate q, written down once more from its definition. */
static double complex read_nearest(const double complex *s, int n, double q)
{
    (void)n;
    return s[(int)floor(q + 0.5)];
}

static double complex read_linear3(const double complex *s, int n, double q)
{
    double point = floor(q * 4 + 0.5) / 4;
    int i = (int)floor(point);
    return (1 - (point - i)) * s[i] + (i + 1 < n ? (point - i) * s[i + 1] : 0);
}

static double complex read_sinc6(const double complex *s, int n, double q)
{
    double complex sum = 0;
    for (int i = (int)floor(q) - 2; i <= (int)floor(q) + 3; i++) {
        double z = M_PI * (q - i);
        if (i >= 0 && i < n)
            sum += s[i] * (fabs(z) < 1e-9 ? 1 : sin(z) / z);
    }
    return sum;
}

static const struct {
    const char *spec;
    double complex (*read)(const double complex *s, int n, double q);
} methods[] = {
    {"bp_nearest:precision=double,exact=true", read_nearest},
    {"bp_linear:beta=3,precision=double,exact=true", read_linear3},
    {"bp_sinc:taps=6,precision=double,exact=true", read_sinc6},
};

/* The pixel by definition; *pairs counts what it sums. */
static double complex naive(const struct echoes *echoes, double x, double r, int method, long long *pairs)
{
    const struct acquisition *a = echoes->acquisition;
    double complex sum = 0;
    for (int p = 0; p < a->pings; p++) {
        struct vector h = acquisition_heading(a, p), d = {x - a->tx[p].x, r - a->tx[p].y, -a->tx[p].z};
        double sine = fabs(d.x * h.x + d.y * h.y + d.z * h.z) / sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
        if (sine > a->aperture_limit)
            continue;
        for (int m = 0; m < a->receivers; m++) {
            int pair = p * a->receivers + m;
            double tau = delay_exact(a->tx[p], a->rx[pair], a->velocity[p], (struct vector){x, r, 0}, a->sound_speed);
            double q = (tau - a->t0[p]) * a->fs, cycles = a->fc * tau;
            if (q < 0 || q > a->samples - 1)
                continue;
            ++*pairs;
            sum += methods[method].read((const double complex *)echoes->samples + (size_t)pair * (size_t)a->samples,
                                        a->samples, q)
                   * cexp(I * 2 * M_PI * (cycles - rint(cycles)));
        }
    }
    return sum;
}

static void naive_sums(void **state)
{
    (void)state;
    double largest = 0, total = 0, possible = 0;
    for (uint64_t seed = 1; seed <= 150; seed++) {
        struct acquisition a;
        struct grid grid;
        struct echoes echoes;
        random_case(seed, &a, &grid, &echoes);
        struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        int method = (int)(seed % 3);
        struct image image;
        assert_int_equal(support_image(methods[method].spec, problem, &echoes, &image), STATUS_OK);
        long long pairs = 0;
        for (int i = 0; i < grid.r_count; i++)
            for (int j = 0; j < grid.x_count; j++) {
                double complex exact =
                    naive(&echoes, grid.x_first + j * grid.x_step, grid.r_first + i * grid.r_step, method, &pairs);
                largest = worse_of(largest, cabs(image_pixel(&image, 0, i, j) - exact));
            }
        if ((double)pairs != pairs_count(&problem))
            fail_msg("seed %d: %lld pairs by definition, %.0f counted", (int)seed, pairs, pairs_count(&problem));
        total += (double)pairs;
        possible += (double)grid_pixels(&grid) * a.pings * a.receivers;
        image_free(&image);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
    print_message("%.0f of %.0f pairs summed, largest difference %.1e\n", total, possible, largest);
    assert_true(total > 0.05 * possible && total < 0.95 * possible); /* the cases do cut */
    assert_true(largest < 1e-9);
}

/* An interpolator of no paper claims no paper's FLOPs. */
static void own_interpolator_claims_nothing(void **state)
{
    (void)state;
    struct acquisition a;
    struct grid grid;
    struct echoes echoes;
    random_case(1, &a, &grid, &echoes);
    struct problem problem = problem_make(&a, 1, &grid, PRECISION_FLOAT);
    const struct bp_options options = {.phase_limit = 1e-4};
    for (int claims = 0; claims < 2; claims++) {
        const struct interpolator own = {.upsample = 1, .steps = 1, .taps = 1, .in_papers = claims};
        void *plan;
        assert_int_equal(bp_plan(&problem, &own, &options, &plan), STATUS_OK);
        struct work work = bp_work(plan);
        assert_true((work.published[0].source != NULL) == claims && (work.published[1].source != NULL) == claims);
        bp_destroy(plan);
    }
    echoes_free(&echoes);
    acquisition_free(&a);
}

/* The inverse FFT of zero padding is as long as the record that it makes. */
static void zero_padding_counts_its_transform(void **state)
{
    (void)state;
    struct acquisition a;
    struct grid grid;
    struct echoes echoes;
    double published[2];
    random_case(1, &a, &grid, &echoes);
    struct problem problem = problem_make(&a, 1, &grid, PRECISION_FLOAT);
    const struct bp_options options = {.phase_limit = 1e-4};
    for (int n = 0; n < 2; n++) {
        const struct interpolator nearest = {.upsample = n ? 8 : 1, .steps = 1, .taps = 1, .in_papers = true};
        void *plan;
        assert_int_equal(bp_plan(&problem, &nearest, &options, &plan), STATUS_OK);
        published[n] = bp_work(plan).published[0].flops;
        bp_destroy(plan);
    }
    double longer = fft_flops(8.0 * a.samples) - fft_flops(a.samples);
    assert_close(published[1] - published[0], (double)a.pings * a.receivers * longer, 1e-6 * published[0]);
    echoes_free(&echoes);
    acquisition_free(&a);
}

/* Against values of another program, which summed the Bessel function's series: the last taps lie at the window's edge.
   A whole sample is itself. */
static void sinc_weights_are_windowed(void **state)
{
    (void)state;
    static const struct {
        int taps;
        double beta, fraction, w[8];
    } cases[] = {
        {8,
         5,
         0.25,
         {-0.0115847635, 0.0466115998, -0.144077369, 0.892489092, 0.277273324, -0.0822561849, 0.0247605933,
          -0.00421441999}},
        {4, 5, 0.5, {-0.0489230272, 0.552596886, 0.552596886, -0.0489230272}},
        {4, 0, 0.5, {-0.212206591, 0.636619772, 0.636619772, -0.212206591}},
        {4, 5, 0, {0, 1, 0, 0}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double w[8];
        sinc_weights(cases[k].taps, cases[k].beta, cases[k].fraction, w);
        for (int n = 0; n < cases[k].taps; n++)
            assert_close(w[n], cases[k].w[n], 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(naive_sums),
        cmocka_unit_test(sinc_weights_are_windowed),
        cmocka_unit_test(zero_padding_counts_its_transform),
        cmocka_unit_test(own_interpolator_claims_nothing),
    };
    return cmocka_run_group_tests_name("bp", tests, NULL, NULL);
}
