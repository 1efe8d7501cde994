/* Bands that reach the ends of the sampled one: records that are hardly oversampled, and raw pulses whose band lies off
   the carrier. Errors are as asked for, or as forecast. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/farrow.h"
#include "metrics/metrics.h"
#include "scene/simulate.h"
#include "tests/support.h"

/* Forecasts are root mean squares over scenes. */
static const double SPREAD = 1.25;

/* The error that SPEC promises: its setting `error`, or, where it has none, what it forecasts, with its spread. */
static double promise_of(const char *text, const struct problem *problem)
{
    const char *asked = strstr(text, "error=");
    struct forecast forecast;
    struct spec spec;
    if (asked)
        return strtod(asked + strlen("error="), NULL);
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    assert_int_equal(algorithm_forecast(spec.algorithm, problem, spec.options, &forecast), STATUS_OK);
    spec_free(&spec);
    return SPREAD * forecast_error(&forecast);
}

static void check(const char *what, const char *spec, const struct problem *problem, const struct echoes *echoes,
                  const struct image *exact)
{
    struct image image;
    assert_int_equal(support_image(spec, *problem, echoes, &image), STATUS_OK);
    const double error = metrics_error(&image, exact).error, promise = promise_of(spec, problem);
    print_message("%s, %s: error %.2e, promised %.2e\n", what, spec, error, promise);
    if (!(error <= promise))
        fail_msg("%s, %s: error is %g, promised %g", what, spec, error, promise);
    image_free(&image);
}

/* Small images, whose few cells have more energy at the band's edges than a flat spectrum has by up to a quarter, and
   errors that the law says to be just within those asked for. */
static void bare_sampling_holds(void **state)
{
    (void)state;
    static const double oversampling[] = {1, 1.005, 1.01, 1.05};
    enum { PLACES = 8 };
    for (size_t k = 0; k < sizeof oversampling / sizeof *oversampling; k++) {
        struct acquisition a;
        struct echoes echoes;
        char what[80], spec[120];
        support_flat_noise(1 / oversampling[k], &a, &echoes);
        for (int n = 0; n < PLACES; n++)
            for (int degree = 3; degree <= 4; degree++) {
                const double asked = 1.01 * farrow_error(degree, 1 / oversampling[k]);
                const struct grid grid = {-0.02, 0.01, 5, 20.3 + 0.2 * n, 0.005, 16, 0};
                const struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
                struct image exact;
                assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
                snprintf(what, sizeof what, "fs/B %.3f, r from %.1f m", oversampling[k], grid.r_first);
                snprintf(spec, sizeof spec, "bp_farrow:precision=double,error=%.9g", asked);
                check(what, spec, &problem, &echoes, &exact);
                snprintf(spec, sizeof spec, "bp_factorised:precision=double,stages=0,error=%.9g", asked);
                check(what, spec, &problem, &echoes, &exact);
                image_free(&exact);
            }
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* Raw echoes at fs = 3B of a chirp about `offset` fs, from everywhere. Both are freed by the caller. */
static void off_carrier(double offset, struct acquisition *a, struct echoes *echoes)
{
    enum { PULSE = 160, BEFORE = PULSE - 1 };
    struct random random = random_seed(5, 1);
    support_flat_noise(1 / 3.0, a, echoes);
    double complex *s = (double complex *)echoes->samples;
    a->compressed = false;
    a->pulse_length = PULSE;
    a->pulse = malloc(PULSE * sizeof *a->pulse);
    assert_non_null(a->pulse);
    pulse_lfm(a->bandwidth, PULSE / a->fs, a->fs, PULSE, a->pulse);
    for (int k = 0; k < PULSE; k++)
        a->pulse[k] *= cexp(2 * M_PI * I * offset * k);
    for (int p = 0; p < a->pings; p++) {
        double complex field[240 + BEFORE];
        assert_int_equal(a->samples, 240);
        for (int n = 0; n < a->samples + BEFORE; n++)
            field[n] = random_normal(&random);
        for (int n = 0; n < a->samples; n++, s++) {
            *s = 0;
            for (int k = 0; k < PULSE; k++)
                *s += a->pulse[k] * field[n + BEFORE - k];
        }
    }
    assert_int_equal(acquisition_check(a, "off the carrier"), STATUS_OK);
}

static void pulses_off_the_carrier_hold(void **state)
{
    (void)state;
    static const double offsets[] = {-0.33, -0.3, -0.1, 0, 0.2, 0.3, 0.33};
    static const char *const specs[] = {"bp_farrow:precision=double,error=1e-4",
                                        "bp_farrow:precision=double,error=1e-2",
                                        "bp_farrow:precision=double,factor=2,error=1e-6,phase_limit=1e-8",
                                        "bp_factorised:precision=double,stages=0,error=1e-2",
                                        "bp_factorised:precision=double,stages=1,base=4,factor=4,error=1e-2",
                                        "bp_factorised:precision=double,stages=2,base=4,factor=4,error=1e-3",
                                        "bp_fitted:precision=double",
                                        "bp_fitted:precision=double,taps=4,factor=2",
                                        "bp_sinc:precision=double,window=kaiser_band",
                                        "bp_linear:precision=double,preemphasis=on",
                                        "bp_zeropad:precision=double"};
    for (size_t k = 0; k < sizeof offsets / sizeof *offsets; k++) {
        struct acquisition a;
        struct echoes echoes;
        struct image exact;
        char what[40];
        off_carrier(offsets[k], &a, &echoes);
        const struct grid grid = {-0.4, 0.04, 21, 20.4, 0.02, 41, 0};
        const struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
        assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
        snprintf(what, sizeof what, "%+.2f fs off the carrier", offsets[k]);
        for (size_t n = 0; n < sizeof specs / sizeof *specs; n++)
            check(what, specs[n], &problem, &echoes, &exact);
        image_free(&exact);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bare_sampling_holds),
        cmocka_unit_test(pulses_off_the_carrier_hold),
    };
    return cmocka_run_group_tests_name("band_edges", tests, NULL, NULL);
}
