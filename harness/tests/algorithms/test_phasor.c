/* Phasors in double, by long and by short polynomials: their stated errors (phasor.h), over a cycle. */
#define REAL_DOUBLE 1
#include "common/phasor.h"

#include "tests/support.h"

PHASOR(phasor_short, double, PHASOR_SHORT_SINE, PHASOR_SHORT_COSINE)

static void errors_are_as_stated(void **state)
{
    (void)state;
    enum { STEPS = 200000 };
    double worst[2] = {0};
    for (int k = 0; k <= STEPS; k++) {
        const double f = (double)k / STEPS - 0.5, angle = 2 * M_PI * f;
        double c[2], s[2];
        phasor(f, &c[0], &s[0]);
        phasor_short(f, &c[1], &s[1]);
        for (int n = 0; n < 2; n++)
            worst[n] = fmax(worst[n], hypot(c[n] - cos(angle), s[n] - sin(angle)));
    }
    print_message("long %.2g, short %.2g\n", worst[0], worst[1]);
    assert_true(worst[0] <= 2e-15);
    assert_true(worst[1] > 4e-10 && worst[1] <= 5e-10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(errors_are_as_stated)};
    return cmocka_run_group_tests_name("phasor", tests, NULL, NULL);
}
