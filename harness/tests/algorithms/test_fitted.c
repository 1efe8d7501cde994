/* Least-squares taps: their weights against the normal equations solved anew in long double, their error against
   published figures, and images of flat spectra against the error that these weights predict. */
#include <math.h>
#include <stdio.h>

#include "backprojection/fitted.h"
#include "metrics/metrics.h"
#include "tests/support.h"

enum { MOST = FITTED_TAPS_MOST };

static long double sinc(long double x)
{
    return x == 0 ? 1 : sinl((long double)M_PI * x) / ((long double)M_PI * x);
}

/* R w = s by elimination, with the pivots as they come: R is positive. */
static void solve_anew(int taps, double band, double fraction, long double w[MOST])
{
    long double matrix[MOST][MOST];
    for (int i = 0; i < taps; i++) {
        for (int k = 0; k < taps; k++)
            matrix[i][k] = sinc((long double)band * (i - k)) + (i == k ? 1e-12L : 0);
        w[i] = sinc((long double)band * ((long double)fraction - (1 - taps / 2 + i)));
    }
    for (int i = 0; i < taps; i++)
        for (int row = i + 1; row < taps; row++) {
            const long double share = matrix[row][i] / matrix[i][i];
            for (int k = i; k < taps; k++)
                matrix[row][k] -= share * matrix[i][k];
            w[row] -= share * w[i];
        }
    for (int i = taps - 1; i >= 0; i--) {
        for (int k = i + 1; k < taps; k++)
            w[i] -= matrix[i][k] * w[k];
        w[i] /= matrix[i][i];
    }
}

/* Frequencies, evenly from -most to most (cycles a sample). */
struct comb {
    int count;
    double most;
};

/* In the middle of 200 parts of a flat band. */
static struct comb flat_comb(double band)
{
    return (struct comb){200, 0.4975 * band};
}

/* rms of what weights leave of the exponential. */
static double left_over(int taps, struct comb comb, double fraction, const long double w[MOST])
{
    long double square = 0;
    for (int n = 0; n < comb.count; n++) {
        const long double nu = comb.most * (2.0L * n / (comb.count - 1) - 1);
        long double re = 0, im = 0; /* the exponential is 1 where it is asked for */
        for (int k = 0; k < taps; k++) {
            const long double turn = 2 * (long double)M_PI * nu * (1 - taps / 2 + k - (long double)fraction);
            re += w[k] * cosl(turn);
            im += w[k] * sinl(turn);
        }
        square += (re - 1) * (re - 1) + im * im;
    }
    return (double)sqrtl(square / comb.count);
}

static const double bands[] = {0, 0.01, 0.1, 0.25, 0.4, 0.5, 1 / 1.2, 1};

/* The weights leave what the solution leaves, at any fraction. 1e-9: rounding in double, which 1e-12 on the diagonal
   amplifies; it allows an error of 1e-6 itself. */
static void weights_solve_the_equations(void **state)
{
    (void)state;
    double worst = 0, apart = 0;
    for (size_t b = 0; b < sizeof bands / sizeof *bands; b++)
        for (int taps = 2; taps <= FITTED_TAPS_MOST; taps += 2) {
            struct fitted fitted;
            fitted_make(taps, bands[b], &fitted);
            for (int n = 0; n <= 20; n++) {
                double w[MOST], mirrored[MOST];
                long double own[MOST], anew[MOST];
                fitted_weights(&fitted, n / 20.0, w);
                fitted_weights(&fitted, 1 - n / 20.0, mirrored);
                solve_anew(taps, bands[b], n / 20.0, anew);
                for (int k = 0; k < taps; k++) {
                    own[k] = w[k];
                    apart = worse_of(apart, fabs(w[k] - mirrored[taps - 1 - k]));
                    assert_true(fabs(w[k]) < 2);
                }
                const double mine = left_over(taps, flat_comb(bands[b]), n / 20.0, own);
                const double least = left_over(taps, flat_comb(bands[b]), n / 20.0, anew);
                worst = worse_of(worst, fabs(mine - least));
                if (!(fabs(mine - least) <= 1e-9 + 1e-6 * least))
                    fail_msg("%d taps, band %g, fraction %g: leaves %g, the solution %g", taps, bands[b], n / 20.0,
                             mine, least);
            }
        }
    print_message("what is left differs by %.1e, mirrored weights by %.1e\n", worst, apart);
}

/* The law: rms over all fractions of what taps fitted to a band leave. */
static double law(int taps, double band, struct comb comb)
{
    enum { FRACTIONS = 64 };
    double square = 0;
    for (int n = 0; n < FRACTIONS; n++) {
        const double fraction = (n + 0.5) / FRACTIONS;
        long double w[MOST];
        solve_anew(taps, band, fraction, w);
        square += pow(left_over(taps, comb, fraction, w), 2) / FRACTIONS;
    }
    return sqrt(square);
}

/* Errors as they were measured on one line of flat noise by a program apart from this one, to one or two digits. */
static void law_has_its_figures(void **state)
{
    (void)state;
    static const struct {
        int taps;
        double band, error;
    } figures[] = {{4, 0.5, 9e-3},    {6, 0.5, 1.3e-3},  {8, 0.5, 1.9e-4},  {4, 1 / 1.2, .09},
                   {6, 1 / 1.2, .05}, {8, 1 / 1.2, .02}, {6, 0.25, 1.7e-5}, {6, 0.5 / 1.2, 4.1e-4}};
    for (size_t k = 0; k < sizeof figures / sizeof *figures; k++) {
        const double error = law(figures[k].taps, figures[k].band, flat_comb(figures[k].band));
        print_message("%d taps, band %.3f: %.3g, measured elsewhere %.2g\n", figures[k].taps, figures[k].band, error,
                      figures[k].error);
        assert_close(error / figures[k].error, 1, 0.25);
    }
}

/* Measured errors lie within a tenth of the law's, with any number of taps, at any band, with padding, by both engines
   and by the plain path. The law is taken over the noise's bins, as most of the error lies at the edge of the band. */
static void images_follow_the_law(void **state)
{
    (void)state;
    static const double sampled[] = {0.4, 0.5, 1 / 1.2};
    static const char *const engines[] = {"engine=invariant", "engine=general,phase_limit=1e-8", "exact=true"};
    const struct grid grid = {-2.0, 0.171 / 7, 161, 21.03, 0.017, 61};
    for (size_t b = 0; b < sizeof sampled / sizeof *sampled; b++) {
        struct acquisition a;
        struct echoes echoes;
        struct image exact;
        support_flat_noise(sampled[b], &a, &echoes);
        struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
        for (int n = 0; n < 18; n++) {
            const int taps = 2 + 2 * (n % 6), factor = 1 << n / 6;
            const double edge = floor(sampled[b] * a.samples / 2);
            const struct comb bins = {2 * (int)edge + 1, edge / a.samples / factor};
            const double predicted = law(taps, sampled[b] / factor, bins);
            struct image image;
            char spec[120];
            snprintf(spec, sizeof spec, "bp_fitted:taps=%d,factor=%d,precision=double,%s", taps, factor,
                     engines[(n + n / 6) % 3]);
            assert_int_equal(support_image(spec, problem, &echoes, &image), STATUS_OK);
            const double error = metrics_error(&image, &exact).error;
            print_message("%-72s band %.2f: error %.3g, by the law %.3g\n", spec, sampled[b], error, predicted);
            if (predicted > 3e-8 && !(fabs(error / predicted - 1) < 0.1))
                fail_msg("%s: error is %g, the law says %g", spec, error, predicted);
            image_free(&image);
        }
        image_free(&exact);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* Of a tone the weights hardly depend on the fraction: one branch would do, and is not taken for none. */
static void tones_are_read_as_branches(void **state)
{
    (void)state;
    static const char *const methods[] = {"bp_fitted:taps=8,factor=1", "bp_fitted:taps=4,factor=4"};
    const struct grid grid = {-2.0, 0.171 / 7, 161, 21.03, 0.017, 61};
    struct acquisition a;
    struct echoes echoes;
    support_flat_noise(1e-12, &a, &echoes);
    struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
    for (int n = 0; n < 4; n++) {
        const char *precision = n % 2 ? "double" : "float";
        struct image image, plain;
        char spec[120];
        snprintf(spec, sizeof spec, "%s,engine=general,precision=%s", methods[n / 2], precision);
        assert_int_equal(support_image(spec, problem, &echoes, &image), STATUS_OK);
        snprintf(spec, sizeof spec, "%s,exact=true,precision=double", methods[n / 2]);
        assert_int_equal(support_image(spec, problem, &echoes, &plain), STATUS_OK);
        const double error = metrics_error(&image, &plain).error;
        print_message("%s in %s: %.3g off the plain path\n", methods[n / 2], precision, error);
        assert_true(error < 1e-4);
        image_free(&plain);
        image_free(&image);
    }
    echoes_free(&echoes);
    acquisition_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_solve_the_equations),
        cmocka_unit_test(law_has_its_figures),
        cmocka_unit_test(images_follow_the_law),
        cmocka_unit_test(tones_are_read_as_branches),
    };
    return cmocka_run_group_tests_name("fitted", tests, NULL, NULL);
}
