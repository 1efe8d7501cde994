/* Samples that no pixel reads are left out: they may hold anything, the image stays what it is from whole records, and
   the counted work falls by what the shorter transforms save. Values between samples are made of a part of compressed
   records, which hold nothing beyond their band. */
#include <complex.h>
#include <fftw3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/pairs/pairs.h"
#include "backprojection/traces.h"
#include "contract/delay.h"
#include "common/fft_length.h"
#include "scene/random.h"
#include "range_migration/rma_engine.h"
#include "tests/support.h"

enum { SAMPLES = 1500, PULSE = 90, PINGS = 13, RECEIVERS = 5, PATCHES = 3 };

/* Patches of a record that holds 9 to 46.5 m, seen by a straight track. */
static const struct patch_case {
    const char *name;
    int patches;
    struct grid grids[2];
    double speed, limit; /* m/s; aperture limit */
    int receivers;       /* 0: RECEIVERS, which are the most */
    double spacing;      /* m, of the pings; 0: 0.1 */
} cases[] = {
    {"middle", 1, {{-0.4, 0.02, 41, 25, 0.02, 30, 0}}, 2.5, INFINITY},
    {"limited", 1, {{-0.4, 0.02, 41, 25, 0.02, 30, 0}}, 2.5, 0.03},
    {"fast", 1, {{-0.4, 0.02, 41, 25, 0.02, 30, 0}}, -75, INFINITY},
    {"ahead", 1, {{19.6, 0.02, 41, 25, 0.02, 30, 0}}, 2.5, INFINITY},
    {"joined pings", 1, {{-6, 0.1, 121, 25, 0.02, 9, 0}}, 2.5, 0.3, 1, 0.8},
    {"record's start", 1, {{-0.4, 0.02, 41, 8.8, 0.02, 30, 0}}, 2.5, INFINITY},
    {"record's end", 1, {{-0.4, 0.02, 41, 46.2, 0.02, 30, 0}}, 2.5, INFINITY},
    {"beyond the record", 1, {{-0.4, 0.02, 41, 60, 0.02, 30, 0}}, 2.5, INFINITY},
    {"across r = 0", 1, {{-0.4, 0.02, 41, -12, 0.4, 61, 0}}, 2.5, INFINITY},
    {"behind the track", 1, {{-0.4, 0.02, 41, -31, 0.03, 30, 0}}, 2.5, 0.3},
    {"two patches", 2, {{-0.4, 0.02, 21, 20, 0.02, 9, 0}, {0.1, 0.02, 31, 31, 0.02, 9, 0}}, 2.5, INFINITY},
};

/* How a method reads records. */
static const struct method {
    const char *spec;
    bool between, whole; /* values between samples, of raw echoes as a whole; all values depend on all samples */
    double pair_flops;   /* where the records' own work is known by it */
} methods[] = {
    {"bp_nearest:", false, false, 8},
    {"bp_linear:beta=8,", false, false, 16},
    {"bp_sinc:taps=8,", false, false, 0},
    {"bp_sinc:taps=20,", false, false, 0},
    {"bp_fitted:taps=6,factor=1,", false, false, 0},
    {"bp_linear:beta=2,preemphasis=on,", true, true, 0},
    {"bp_farrow:degree=3,", true, false, 0},
    {"bp_farrow:degree=4,", true, false, 0},
    {"bp_zeropad:factor=4,", true, false, 0},
    {"bp_fitted:taps=6,factor=2,", true, false, 0},
};

/* Nothing beyond the band. */
static void limit_band(struct acquisition *a, struct echoes *echoes)
{
    double complex *s = (double complex *)echoes->samples;
    fftw_plan there = fftw_plan_dft_1d(SAMPLES, s, s, FFTW_FORWARD, FFTW_ESTIMATE);
    fftw_plan back = fftw_plan_dft_1d(SAMPLES, s, s, FFTW_BACKWARD, FFTW_ESTIMATE);
    for (int i = 0; i < PINGS * a->receivers; i++, s += SAMPLES) {
        fftw_execute_dft(there, s, s);
        for (int k = 0; k < SAMPLES; k++)
            s[k] = fmin(k, SAMPLES - k) * a->fs < a->bandwidth / 2 * SAMPLES ? s[k] / SAMPLES : 0;
        fftw_execute_dft(back, s, s);
    }
    a->noise = 0;
    fftw_destroy_plan(there);
    fftw_destroy_plan(back);
}

static void make_case(const struct patch_case *c, bool raw, struct acquisition *a, struct echoes *echoes)
{
    struct random random = random_seed(31, (uint64_t)(c - cases));
    const int receivers = c->receivers > 0 ? c->receivers : RECEIVERS;
    *a = support_acquisition(PINGS, receivers, SAMPLES);
    a->aperture_limit = c->limit;
    for (int p = 0; p < PINGS; p++) {
        a->t0[p] = 2 * 9 / a->sound_speed;
        a->tx[p].x = (p - PINGS / 2) * (c->spacing > 0 ? c->spacing : 0.1);
        a->velocity[p].x = c->speed;
        for (int m = 0; m < receivers; m++)
            a->rx[p * receivers + m].x = a->tx[p].x - 0.04 * (m + 1);
    }
    if (raw) {
        a->compressed = false;
        a->pulse_length = PULSE;
        a->pulse = calloc(PULSE, sizeof *a->pulse);
        assert_non_null(a->pulse);
        for (int k = 0; k < PULSE; k++)
            a->pulse[k] = cexp(I * M_PI * a->bandwidth / a->fs / PULSE * pow(k - PULSE / 2.0, 2));
    }
    support_noise(a, &random, echoes);
    limit_band(a, echoes);
}

/* The samples that a plan says it does not read, as marks; how many. */
static int unread_mark(const char *skipped, bool *unread)
{
    int count = 0, first, last;
    memset(unread, 0, SAMPLES * sizeof *unread);
    const char *at = strstr(skipped, "samples ");
    if (!at)
        return 0;
    for (at += strlen("samples "); sscanf(at, "%d-%d", &first, &last) == 2; at += strlen(" and ")) {
        assert_true(first >= 0 && first <= last && last < SAMPLES);
        for (int n = first; n <= last; n++, count++)
            unread[n] = true;
        at += strspn(at, "0123456789-");
        if (strncmp(at, " and ", strlen(" and ")) != 0)
            break;
    }
    assert_non_null(strstr(at, "of 1500, which no pixel reads"));
    return count;
}

/* The samples between which the delays of all pairs lie, found one by one; how many. */
static int samples_met(const struct problem *problem, int *first, int *last)
{
    const struct acquisition *a = problem->acquisition;
    double least = INFINITY, most = -INFINITY;
    for (int k = 0; k < problem->patch_count; k++) {
        const struct grid *g = &problem->patches[k];
        for (int n = 0; n < g->x_count * g->r_count; n++)
            for (int i = 0; i < a->pings * a->receivers; i++) {
                const int p = i / a->receivers;
                const struct vector pixel = grid_point(g, n / g->x_count, n % g->x_count), tx = a->tx[p];
                const struct vector h = acquisition_normal(a, p);
                const double x = pixel.x - tx.x, y = pixel.y - tx.y, distance = sqrt(x * x + y * y + tx.z * tx.z);
                const double tau = delay_exact(tx, a->rx[i], a->velocity[p], pixel, a->sound_speed);
                const double q = (tau - a->t0[p]) * a->fs;
                if (!(q >= 0 && q <= a->samples - 1)
                    || !(fabs(x * h.x + y * h.y - tx.z * h.z) <= a->aperture_limit * distance))
                    continue;
                least = fmin(least, q);
                most = fmax(most, q);
            }
    }
    if (!(least <= most))
        return 0;
    *first = (int)floor(least);
    *last = (int)ceil(most);
    return *last - *first + 1;
}

/* The image of records whose samples that are left out are no numbers. */
static void assert_not_read(const struct patch_case *c, const struct problem *problem, const struct echoes *echoes,
                            const char *text, const struct image *image, const bool *unread)
{
    const int records = PINGS * problem->acquisition->receivers;
    struct echoes spoilt;
    struct image unspoilt;
    assert_int_equal(echoes_convert(echoes, PRECISION_DOUBLE, &spoilt), STATUS_OK);
    for (int n = 0; n < records * SAMPLES; n++)
        if (unread[n % SAMPLES])
            ((double complex *)spoilt.samples)[n] = NAN;
    assert_int_equal(support_image(text, *problem, &spoilt, &unspoilt), STATUS_OK);
    if (!(support_difference(&unspoilt, image) == 0))
        fail_msg("%s, %s: reads samples that it says it does not", c->name, text);
    echoes_free(&spoilt);
    image_free(&unspoilt);
}

/* One method on a case: the difference of its image from that of records read as a whole, which they are where pixels
   beside it meet both their ends. `met`: samples between which the pairs' delays lie. */
static double left_out(const struct patch_case *c, const struct acquisition *a, const struct echoes *echoes,
                       const struct method *method, const char *text, int met)
{
    const double r[] = {9 + 0.5 * 750 / a->fs, 9 + (SAMPLES - 1.5) * 750 / a->fs};
    struct grid grids[PATCHES + 1];
    memcpy(grids, c->grids, sizeof c->grids);
    for (int k = 0; k < 2; k++)
        grids[c->patches + k] = (struct grid){-0.4, c->grids[0].x_step, 41, r[k], 1, 1, 0};
    const struct problem part = problem_make(a, c->patches, grids, PRECISION_DOUBLE),
                         all = problem_make(a, c->patches + 2, grids, part.precision);
    const struct work work = support_work(text, part), whole_work = support_work(text, all);
    struct image image, whole;
    bool unread[SAMPLES];
    assert_int_equal(support_image(text, part, echoes, &image), STATUS_OK);
    assert_int_equal(support_image(text, all, echoes, &whole), STATUS_OK);
    assert_null(strstr(whole_work.skipped, "samples"));
    const int left = unread_mark(work.skipped, unread), pulse = a->compressed ? 1 : PULSE;
    struct image same = whole;
    same.patch_count = c->patches;
    const double difference = support_difference(&image, &same);
    if (method->whole || (method->between && !a->compressed))
        assert_int_equal(left, 0);
    else if (!method->between || c - cases < 2) /* nearly all that no pair meets, but for some where the record fades */
        assert_true(left >= 0.8 * (SAMPLES - met - pulse - (method->between ? 160 : 60)));
    if (left > 0)
        assert_not_read(c, &part, echoes, text, &image, unread);
    if (method->pair_flops > 0 && !a->compressed && work.pairs > 0) {
        const int held = SAMPLES - left - (unread[SAMPLES - 1] ? pulse - 1 : 0);
        const double length = fft_length_quick(held + pulse - 1), length_whole = fft_length_quick(SAMPLES + pulse - 1);
        const double flops = work.flops - method->pair_flops * work.pairs;
        const double flops_whole = whole_work.flops - method->pair_flops * whole_work.pairs;
        assert_close(flops / flops_whole,
                     (2 * fft_flops(length) + 6 * length) / (2 * fft_flops(length_whole) + 6 * length_whole), 1e-9);
    }
    image_free(&image);
    image_free(&whole);
    return difference;
}

/* Values that no sample outside changes are the same to the last bit; those of shorter transforms but for rounding. */
static void samples_left_out(void **state)
{
    (void)state;
    static const char *const engines[] = {"general", "invariant"};
    double worst[2] = {0, 0};
    for (size_t n = 0; n < 2 * sizeof cases / sizeof *cases; n++) {
        const struct patch_case *c = &cases[n / 2];
        const bool raw = n % 2;
        struct acquisition a;
        struct echoes echoes;
        make_case(c, raw, &a, &echoes);
        int first, last;
        const struct problem problem = problem_make(&a, c->patches, c->grids, PRECISION_DOUBLE);
        const int met = samples_met(&problem, &first, &last);
        struct acquisition filtered = a;
        filtered.filtered = true; /* who knows what is beyond the band? */
        assert_null(strstr(
            support_work("bp_farrow:degree=3", problem_make(&filtered, c->patches, c->grids, PRECISION_DOUBLE)).skipped,
            "samples"));
        for (size_t m = 0; m < 4 * sizeof methods / sizeof *methods; m++) {
            const struct method *method = &methods[m / 4];
            char text[100];
            snprintf(text, sizeof text, "%sengine=%s,precision=%s", method->spec, engines[m % 2],
                     m / 2 % 2 ? "double" : "float");
            const double difference = left_out(c, &a, &echoes, method, text, met);
            const bool shorter = raw != method->between && !method->whole;
            if (!(difference <= (shorter ? (m / 2 % 2 ? 5e-15 : 1.5e-6) : 0)))
                fail_msg("%s, %s, %s: differs by %g", c->name, text, raw ? "raw" : "compressed", difference);
            worst[m / 2 % 2] = worse_of(worst[m / 2 % 2], difference);
        }
        echoes_free(&echoes);
        acquisition_free(&a);
    }
    print_message("largest difference: %.1e float, %.1e double\n", worst[0], worst[1]);
}

/* Records correlated as a whole; *out points into `a`. */
static void compress(const struct acquisition *a, const struct echoes *raw, struct acquisition *out,
                     struct echoes *echoes)
{
    struct traces_shape shape;
    struct traces *traces;
    assert_int_equal(traces_double.plan(a, &(struct traces_form){.upsample = 1}, 1, &shape, &traces), STATUS_OK);
    *out = *a;
    out->compressed = true;
    assert_int_equal(echoes_allocate(out, PRECISION_DOUBLE, echoes), STATUS_OK);
    for (int i = 0; i < PINGS * RECEIVERS; i++)
        traces_double.fill(traces, 0, (const double complex *)raw->samples + i * SAMPLES,
                           (double complex *)echoes->samples + i * SAMPLES);
    traces_double.destroy(traces);
}

/* What range migration compresses of a record; its work does not grow with what is recorded beside it. */
static void read_by(const char *text, struct problem problem, int *from, int *end)
{
    struct acquisition longer = *problem.acquisition;
    struct spec spec;
    void *plan;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    problem.precision = spec.precision;
    if (algorithm_plan(spec.algorithm, &problem, spec.options, &plan) != STATUS_OK)
        fail_msg("%s: %s", text, status_message());
    *from = ((const struct rma *)plan)->from;
    *end = *from + ((const struct rma *)plan)->read;
    spec.algorithm->destroy(plan);
    spec_free(&spec);
    const double flops = support_work(text, problem).flops;
    longer.samples *= 2;
    problem.acquisition = &longer;
    assert_up_to(support_work(text, problem).flops / flops, 1.02, "%s, records of twice the length", text);
}

/* Range migration compresses what its swaths take of the records: the image is that of whole ones. */
static void swaths_left_out(void **state)
{
    (void)state;
    static const struct {
        const char *spec;
        double bound; /* rma_delay: of its taps, which follow the replica where there is one */
    } runs[] = {{"rma_lbf:variant=corrected,precision=float", 1e-6},
                {"rma_numeric:precision=double", 1e-14},
                {"rma_delay:precision=float", 4e-5},
                {"rma_delay:precision=double", 4e-5}};
    for (size_t n = 0; n < sizeof runs / sizeof *runs; n++) {
        struct acquisition a, whole;
        struct echoes echoes, compressed;
        struct image image, from_whole, spoilt;
        int from, end;
        make_case(&cases[0], true, &a, &echoes);
        a.echo_sine = 0.02;
        compress(&a, &echoes, &whole, &compressed);
        const struct problem problem = problem_make(&a, 1, cases[0].grids, PRECISION_DOUBLE);
        read_by(runs[n].spec, problem, &from, &end);
        assert_true(from > SAMPLES / 4 && end < 3 * SAMPLES / 4);
        assert_int_equal(support_image(runs[n].spec, problem, &echoes, &image), STATUS_OK);
        assert_int_equal(support_image(runs[n].spec, problem_make(&whole, 1, cases[0].grids, PRECISION_DOUBLE),
                                       &compressed, &from_whole),
                         STATUS_OK);
        const double difference = support_difference(&image, &from_whole);
        for (int i = 0; i < PINGS * RECEIVERS * SAMPLES; i++)
            if (i % SAMPLES < from || i % SAMPLES >= end)
                ((double complex *)echoes.samples)[i] = NAN;
        assert_int_equal(support_image(runs[n].spec, problem, &echoes, &spoilt), STATUS_OK);
        print_message("%s: samples %d to %d, %.1e from that of whole records\n", runs[n].spec, from, end - 1,
                      difference);
        assert_up_to(difference, runs[n].bound, "%s", runs[n].spec);
        assert_true(support_difference(&spoilt, &image) == 0);
        image_free(&image);
        image_free(&from_whole);
        image_free(&spoilt);
        echoes_free(&compressed);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

static double uniform(struct random *random, double low, double high)
{
    return low + (high - low) * random_uniform(random);
}

/* Any track in space, any array, fast or slow: no pair's delay is outside the bounds, which are not far from it. */
static void bounds_hold(void **state)
{
    (void)state;
    struct random random = random_seed(32, 0);
    double loosest = 0;
    for (int n = 0; n < 300; n++) {
        struct acquisition a = support_acquisition(4, 3, SAMPLES);
        const double speed = a.sound_speed * pow(10, uniform(&random, -4, -0.5));
        a.aperture_limit = n % 2 ? INFINITY : uniform(&random, 0.01, 0.9);
        for (int i = 0; i < 12; i++) {
            const int p = i / 3;
            if (i % 3 == 0) {
                a.t0[p] = uniform(&random, 0, 0.03);
                a.tx[p] = (struct vector){uniform(&random, -5, 5), uniform(&random, -3, 3), uniform(&random, -9, 9)};
                a.velocity[p] =
                    (struct vector){speed * uniform(&random, -0.5, 0.5), speed * uniform(&random, -0.5, 0.5),
                                    speed * uniform(&random, -0.5, 0.5)};
            }
            a.rx[i] = (struct vector){a.tx[p].x + uniform(&random, -2, 2), a.tx[p].y + uniform(&random, -1, 1),
                                      a.tx[p].z + uniform(&random, -1, 1)};
        }
        const struct grid grid = {uniform(&random, -20, 20), 0.3, 11, uniform(&random, -30, 30), 0.4, 9, 0};
        const struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        const struct sample_span span = pairs_samples(&problem, NULL, 0);
        int first, last;
        assert_true(span.first >= 0 && span.last <= SAMPLES - 1 && span.first <= span.last);
        if (samples_met(&problem, &first, &last) > 0) {
            if (!(span.first <= first && span.last >= last))
                fail_msg("case %d: pairs meet samples %d to %d, bounds are %g to %g", n, first, last, span.first,
                         span.last);
            loosest = fmax(loosest, (span.last - span.first) - (last - first));
        }
        acquisition_free(&a);
    }
    print_message("bounds are at most %.0f samples wider\n", loosest);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(samples_left_out), cmocka_unit_test(swaths_left_out),
                                       cmocka_unit_test(bounds_hold)};
    return cmocka_run_group_tests_name("samples_read", tests, NULL, NULL);
}
