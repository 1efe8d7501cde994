/* Farrow branches: their responses against the exponential that they expand, and the a-priori error against published
   figures, against the cut expansion, and against images of flat spectra. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "backprojection/farrow.h"
#include "backprojection/traces.h"
#include "metrics/metrics.h"
#include "tests/support.h"

/* The polynomial of the branches at u. */
static double complex response(int degree, double nu, double u)
{
    double gains[FARROW_MOST + 1];
    double complex sum = 0;
    farrow_gains(degree, nu, gains);
    for (int m = degree; m >= 0; m--)
        sum = sum * u + gains[m] * (m % 2 ? I : 1);
    return sum;
}

static void responses_tend_to_the_exponential(void **state)
{
    (void)state;
    for (int degree = FARROW_LEAST; degree <= FARROW_MOST; degree++) {
        double worst = 0, square = 0, law = 0;
        enum { PLACES = 400 };
        for (int k = -8; k <= 8; k++) {
            const double nu = k / 16.0;
            for (int n = 0; n < PLACES; n++) {
                const double u = (n + 0.5) / PLACES - 0.5;
                const double off = cabs(response(degree, nu, u) - cexp(2 * M_PI * I * nu * u));
                worst = worse_of(worst, off);
                square += off * off / (17 * PLACES);
            }
        }
        /* the law's mean over the same 17 frequencies, by the difference quotient of band times mean square */
        for (int k = -8; k <= 8; k++) {
            const double band = fabs(k / 8.0), step = 1e-3, low = fmax(1e-9, band - step), high = fmin(1, band + step);
            law += (high * pow(farrow_error(degree, high), 2) - low * pow(farrow_error(degree, low), 2)) / (high - low)
                   / 17;
        }
        print_message("degree %d: largest error up to fs/2 %.1e, rms %.2e, by the law %.2e\n", degree, worst,
                      sqrt(square), sqrt(law));
        assert_close(sqrt(square / law), 1, 0.02);
    }
}

/* rms over a flat band, computed apart from the program: what polynomials of least squares leave of the exponential, by
   quadrature over u and nu. */
static void law_has_its_figures(void **state)
{
    (void)state;
    static const struct {
        double band, error[6]; /* degrees 2 to 7 */
    } figures[] = {
        {0.5, {4.51e-3, 3.95e-4, 2.82e-5, 1.71e-6, 8.96e-8, 4.14e-9}},
        {1 / 1.2, {2.00e-2, 2.94e-3, 3.51e-4, 3.56e-5, 3.12e-6, 2.41e-7}},
    };
    for (int k = 0; k < 2; k++)
        for (int degree = 2; degree <= 7; degree++)
            assert_close(farrow_error(degree, figures[k].band) / figures[k].error[degree - 2], 1, 0.005);
    struct acquisition a = {.fc = 10, .fs = 1, .bandwidth = 0.7, .compressed = true};
    struct law_spectrum echoes, noise;
    assert_true(law_spectrum(&a, 0, &echoes));
    a.noise = 1; /* has all frequencies */
    assert_true(law_spectrum(&a, 0, &noise));
    for (int degree = FARROW_LEAST; degree < FARROW_MOST; degree++) { /* the least that is enough, near its bound */
        assert_int_equal(farrow_degree(farrow_error(degree, 0.7) * 1.01, &echoes, 1), degree);
        assert_int_equal(farrow_degree(farrow_error(degree, 0.7) * 0.99, &echoes, 1), degree + 1);
        assert_int_equal(farrow_degree(farrow_error(degree, 0.35) * 1.01, &echoes, 2), degree);
        assert_int_equal(farrow_degree(farrow_error(degree, 1) * 1.01, &noise, 1), degree);
        assert_int_equal(farrow_degree(farrow_error(degree, 1) * 0.99, &noise, 1), degree + 1);
    }
    assert_true(farrow_error(FARROW_MOST, 1) <= 1e-8); /* any `error` that bp_farrow accepts is reached */
}

/* rms over u of what the branches leave of the exponential. */
static double left_out(int degree, double nu)
{
    enum { PLACES = 200 };
    double square = 0;
    for (int n = 0; n < PLACES; n++) {
        const double u = (n + 0.5) / PLACES - 0.5;
        square += pow(cabs(response(degree, nu, u) - cexp(2 * M_PI * I * nu * u)), 2) / PLACES;
    }
    return sqrt(square);
}

/* What taps make at nu of branch m, less what it is. */
static double complex taps_error(const struct farrow_taps *taps, const double *gains, int m, double nu)
{
    double complex sum = -gains[m] * (m % 2 ? I : 1);
    for (int k = -taps->reach; k <= taps->reach; k++)
        sum += cexp(2 * M_PI * I * nu * k)
               * (taps->own[m][taps->reach + k] * gains[m % 2] * (m % 2 ? I : 1)
                  + taps->other[m][taps->reach + k] * gains[1 - m % 2] * (m % 2 ? 1 : I));
    return sum;
}

/* What branches that are made of the first two add to the error is a share of what there is anyway at every frequency,
   in any degree, with upsampling; in double it is next to nothing. */
static void taps_add_a_share(void **state)
{
    (void)state;
    enum { FREQUENCIES = 300 };
    static const double bands[] = {0.1, 0.5, 0.95};
    for (int n = 0; n < 12 * (FARROW_MOST - FARROW_LEAST + 1); n++) {
        const int degree = FARROW_LEAST + n / 12, upsample = 1 + n % 2;
        const enum precision precision = n / 2 % 2 ? PRECISION_DOUBLE : PRECISION_FLOAT;
        const double band = bands[n / 4 % 3], law = farrow_error(degree, band / upsample);
        const double floor = precision == PRECISION_DOUBLE ? 1e-12 : 1e-9;
        struct farrow_taps taps;
        double share = 0, most = 0, gain = 0;
        farrow_taps_make(degree, upsample, band, farrow_reach(degree, upsample, precision), &taps);
        for (int k = 0; k < FREQUENCIES; k++) {
            const double nu = (k + 0.5) / FREQUENCIES / 2 / upsample;
            double gains[FARROW_MOST + 1], added = 0;
            farrow_gains(degree, nu, gains);
            for (int m = 2; m <= degree; m++)
                added += cabs(taps_error(&taps, gains, m, nu)) * pow(0.5, m);
            share = worse_of(share, added / (left_out(degree, nu) + law + floor));
            most = worse_of(most, added);
        }
        for (int m = 2; m <= degree; m++)
            for (int k = 0; k <= 2 * taps.reach; k++)
                gain += (fabs(taps.own[m][k]) + fabs(taps.other[m][k])) * pow(0.5, m);
        print_message(
            "degree %d, upsampled %d times, band %.2f, reach %d: %.2g of the error, %.1e at most, taps %.2g\n", degree,
            upsample, band, taps.reach, share, most, gain);
        assert_true(share <= FARROW_SHARE && (precision == PRECISION_FLOAT || most <= 2e-10));
        assert_true(gain < 10); /* of rounding */
    }
}

/* Rows hold what the branches' responses make of each frequency, at the record's ends as well. */
static void rows_hold_branches(void **state)
{
    (void)state;
    enum { SAMPLES = 60, GUARD = 16 };
    static double complex record[SAMPLES], row[(FARROW_MOST + 1) * (2 * SAMPLES + 2 * GUARD)];
    for (int n = 0; n < 2 * (FARROW_MOST - FARROW_LEAST + 1); n++) {
        const int degree = FARROW_LEAST + n / 2, upsample = 1 + n % 2;
        struct acquisition a = support_acquisition(1, 1, SAMPLES);
        struct traces *traces;
        struct traces_shape shape;
        const struct traces_form form = {.upsample = upsample, .degree = degree, .guard = GUARD};
        assert_int_equal(traces_double.plan(&a, &form, 1, &shape, &traces), STATUS_OK);
        for (int k = 1 - SAMPLES / 2; k < SAMPLES / 2; k++) {
            const double nu = (double)k / SAMPLES / upsample;
            double gains[FARROW_MOST + 1];
            farrow_gains(degree, nu, gains);
            for (int i = 0; i < SAMPLES; i++)
                record[i] = cexp(2 * M_PI * I * k * i / SAMPLES);
            traces_double.fill(traces, 0, record, row);
            for (int m = 0; m <= degree; m++)
                for (int i = 0; i < shape.length; i++) {
                    const bool inside = i >= GUARD && i < shape.length - GUARD;
                    const double complex factor = m % 2 ? I * gains[m] : gains[m];
                    const double complex value = factor * cexp(2 * M_PI * I * nu * (i - GUARD));
                    if (!(cabs(row[m * shape.length + i] - (inside ? value : 0)) <= 1e-9))
                        fail_msg("degree %d, bin %d, branch %d, value %d", degree, k, m, i);
                }
        }
        traces_double.destroy(traces);
        acquisition_free(&a);
    }
}

/* Measured errors lie within a tenth of the law's, in any degree, at any band, with upsampling, by both engines. */
static void images_follow_the_law(void **state)
{
    (void)state;
    static const double bands[] = {0.4, 0.5, 1 / 1.2};
    const struct grid grid = {-2.0, 0.171 / 7, 161, 21.03, 0.017, 61};
    for (size_t b = 0; b < sizeof bands / sizeof *bands; b++) {
        struct acquisition a;
        struct echoes echoes;
        struct image exact;
        support_flat_noise(bands[b], &a, &echoes);
        struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
        for (int n = 0; n < 4 * (FARROW_MOST - FARROW_LEAST); n++) {
            const int degree = FARROW_LEAST + n / 4, factor = 1 + n % 2;
            const double law = farrow_error(degree, bands[b] / factor);
            struct image image;
            char spec[120];
            snprintf(spec, sizeof spec, "bp_farrow:degree=%d,factor=%d,precision=double,%s", degree, factor,
                     n / 2 % 2 ? "exact=true" : "engine=invariant");
            assert_int_equal(support_image(spec, problem, &echoes, &image), STATUS_OK);
            const double error = metrics_error(&image, &exact).error;
            print_message("%-64s band %.2f: error %.3g, by the law %.3g\n", spec, bands[b], error, law);
            if (law > 1e-9 && !(fabs(error / law - 1) < 0.1))
                fail_msg("%s: error is %g, the law says %g", spec, error, law);
            image_free(&image);
        }
        image_free(&exact);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* degree=auto is the least degree that holds `error`: the same bits. */
static void auto_takes_the_least(void **state)
{
    (void)state;
    static const struct {
        const char *automatic, *chosen;
    } pairs[] = {
        {"bp_farrow", "bp_farrow:degree=4"}, /* 1e-4 at fs = 2B */
        {"bp_farrow:error=1e-3", "bp_farrow:degree=3"},
        {"bp_farrow:error=1e-5", "bp_farrow:degree=5"},
        {"bp_farrow:error=1e-5,factor=2", "bp_farrow:degree=4,factor=2"},
        {"bp_farrow:error=0.1", "bp_farrow:degree=2"},
    };
    const struct grid grid = {-0.5, 0.02, 30, 21.03, 0.017, 9};
    struct acquisition a;
    struct echoes echoes;
    support_flat_noise(0.5, &a, &echoes);
    struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        struct image images[2];
        assert_int_equal(support_image(pairs[k].automatic, problem, &echoes, &images[0]), STATUS_OK);
        assert_int_equal(support_image(pairs[k].chosen, problem, &echoes, &images[1]), STATUS_OK);
        assert_memory_equal(images[0].pixels[0], images[1].pixels[0],
                            grid_pixels(&grid) * precision_size(images[0].precision));
        image_free(&images[0]);
        image_free(&images[1]);
    }
    echoes_free(&echoes);
    acquisition_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(responses_tend_to_the_exponential),
        cmocka_unit_test(law_has_its_figures),
        cmocka_unit_test(taps_add_a_share),
        cmocka_unit_test(rows_hold_branches),
        cmocka_unit_test(images_follow_the_law),
        cmocka_unit_test(auto_takes_the_least),
    };
    return cmocka_run_group_tests_name("farrow", tests, NULL, NULL);
}
