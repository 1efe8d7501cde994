/* Some pings of an echo file, read alone: what they are in the whole file, of any version, class and packing. */
#include <stdlib.h>
#include <string.h>

#include "tests/echoes/mat_fixture.h"

static void some_pings_are_those_of_the_whole(void **state)
{
    (void)state;
    static const bool chosen[][P] = {{true, true, true}, {false, true, false}, {true, false, true}, {false}};
    static const int16_t integers[N * M * P] = {-3, 4, 5, 7, -11, 2, 6, 8, 1, 30000};
    const enum mat_ft versions[] = {MAT_FT_MAT5, MAT_FT_MAT73};
    static const float floats[N * M * P] = {1e-3f, -2, 3, 4e5f, 5, 6, 7, 8, 9, 10}, imaginary[N * M * P] = {0, 1, -1};
    static const double pulse[K] = {1e100, 2e99}, speeds[P] = {1500, 1499, 1502};
    const struct mat_values others[] = {
        {"samples", MAT_C_INT16, MAT_T_INT16, {N, M, P}, integers, NULL},
        {"samples", MAT_C_SINGLE, MAT_T_SINGLE, {N, M, P}, floats, imaginary},
        {"samples", MAT_C_SINGLE, MAT_T_SINGLE, {N, M, P}, floats, NULL},
        {"pulse", MAT_C_DOUBLE, MAT_T_DOUBLE, {K, 1, 1}, pulse, pulse},
        {"sound_speed", MAT_C_DOUBLE, MAT_T_DOUBLE, {1, P, 1}, speeds, NULL},
    };
    for (int n = 0; n < 4 * (1 + (int)(sizeof others / sizeof *others)); n++) {
        const struct mat_values *other = n < 4 ? NULL : &others[n / 4 - 1];
        const bool moved = other && strcmp(other->name, "sound_speed") == 0; /* in the precision that was read */
        mat_t *mat = file_begin(versions[n % 2], n / 2 % 2 == 1, other ? other->name : "");
        if (other)
            variable_add(mat, other, n / 2 % 2 == 1);
        Mat_Close(mat);
        struct acquisition a, again;
        struct echoes whole;
        int exponent;
        assert_ok(echo_file_read(path, &a, &whole));
        assert_ok(echo_file_open(path, &again, &exponent));
        assert_true(again.pings == P && again.receivers == M && again.samples == N && again.fs == a.fs);
        for (size_t k = 0; k < 2 * (sizeof chosen / sizeof *chosen); k++) {
            const bool *read = chosen[k / 2], single = k % 2;
            float complex singles[N * M * P] = {0};
            double complex doubles[N * M * P] = {0};
            double largest = 0, most = 0;
            const struct pings pings = {P,        read,  single ? PRECISION_FLOAT : PRECISION_DOUBLE,
                                        exponent, N * M, single ? (void *)singles : doubles,
                                        &largest};
            assert_ok(echo_file_read_pings(path, &again, &pings));
            for (size_t i = 0; i < N * M * P; i++) {
                const double complex wanted = read[i / (N * M)] ? ((const double complex *)whole.samples)[i] : 0;
                assert_true(single && moved ? cabs(singles[i] - wanted) < 1e-5
                                            : (single ? singles[i] == (float complex)wanted : doubles[i] == wanted));
                most = fmax(most, fmax(fabs(creal(wanted)), fabs(cimag(wanted))));
            }
            assert_true(moved || largest == most);
        }
        acquisition_free(&again);
        echoes_free(&whole);
        acquisition_free(&a);
    }
}

static void none_are_the_geometry_alone(void **state)
{
    (void)state;
    Mat_Close(file_begin(MAT_FT_MAT73, false, ""));
    struct acquisition a;
    int exponent;
    assert_ok(echo_file_open(path, &a, &exponent));
    assert_true(a.pings == P && a.receivers == M && a.samples == N && exponent == 0);
    acquisition_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(some_pings_are_those_of_the_whole, fixture_make, directory_remove),
        cmocka_unit_test_setup_teardown(none_are_the_geometry_alone, fixture_make, directory_remove)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
