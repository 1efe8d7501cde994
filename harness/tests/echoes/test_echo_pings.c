/* Some pings of an echo file, read alone: what they are in the whole file, of any version, class and packing. */
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "tests/echoes/mat_fixture.h"

static void some_pings_are_those_of_the_whole(void **state)
{
    (void)state;
    static const bool chosen[][P] = {{true, true, true}, {false, true, false}, {true, false, true}, {false}};
    static const int16_t integers[N * M * P] = {-3, 4, 5, 7, -11, 2, 6, 8, 1, 30000};
    const enum mat_ft versions[] = {MAT_FT_MAT5, MAT_FT_MAT73};
    for (int n = 0; n < 8; n++) {
        const bool other = n / 4 == 1;
        mat_t *mat = file_begin(versions[n % 2], n / 2 % 2 == 1, other ? "samples" : "");
        if (other)
            variable_add(mat, &(struct mat_values){"samples", MAT_C_INT16, MAT_T_INT16, {N, M, P}, integers, NULL},
                         n / 2 % 2 == 1);
        Mat_Close(mat);
        struct acquisition a, again;
        struct echoes whole, part;
        assert_ok(echo_file_read(path, &a, &whole));
        for (size_t k = 0; k < sizeof chosen / sizeof *chosen; k++) {
            const struct pings pings = {P, chosen[k]};
            assert_ok(echo_file_read_pings(path, &pings, &again, &part));
            assert_true(again.pings == P && again.receivers == M && again.samples == N && again.fs == a.fs);
            for (size_t i = 0; i < N * M * P; i++) {
                const double complex wanted = ((const double complex *)whole.samples)[i];
                const double complex found = ((const double complex *)part.samples)[i];
                assert_true(found == (chosen[k][i / (N * M)] ? wanted : 0));
            }
            memory_sparse_free((void *)part.samples);
            acquisition_free(&again);
        }
        echoes_free(&whole);
        acquisition_free(&a);
    }
}

static void none_are_the_geometry_alone(void **state)
{
    (void)state;
    Mat_Close(file_begin(MAT_FT_MAT73, false, ""));
    struct acquisition a;
    struct echoes echoes;
    assert_ok(echo_file_read_pings(path, &(struct pings){0, NULL}, &a, &echoes));
    assert_true(a.pings == P && a.receivers == M && a.samples == N);
    memory_sparse_free((void *)echoes.samples);
    acquisition_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(some_pings_are_those_of_the_whole, fixture_make, directory_remove),
        cmocka_unit_test_setup_teardown(none_are_the_geometry_alone, fixture_make, directory_remove)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
