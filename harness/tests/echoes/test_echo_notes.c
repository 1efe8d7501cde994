/* What an echo file says of the scene: its image and its point targets. */
#include <complex.h>
#include <math.h>
#include <string.h>

#include "tests/echoes/mat_fixture.h"

static void notes_come_back(void **state)
{
    (void)state;
    struct acquisition a = make_acquisition(5, 2, 3, true);
    struct echoes echoes;
    struct grid patches[] = {{-0.1, 0.02, 3, 1.0 / 3, 0.5, 1, 0}, {1e6, 0.25, 1000, -40, 1e-3, 7, -1.25}};
    struct target targets[] = {{-0.0, 20.1, 1}, {1 / 7.0, -3, -0.5 + 2 * I}, {0, 0, 0}};
    assert_ok(echoes_allocate(&a, PRECISION_DOUBLE, &echoes));
    fill_echoes(&echoes);
    for (int k = 0; k < 4; k++) { /* both, one of them, none */
        struct echo_notes read, written = {.patch_count = k & 1 ? 2 : 0, .patches = patches, .targets = targets};
        written.target_count = k & 2 ? 3 : 0;
        assert_ok(echo_file_write(path, &echoes, &written));
        assert_ok(echo_notes_read(path, &read));
        assert_int_equal(read.patch_count, written.patch_count);
        assert_int_equal(read.target_count, written.target_count);
        for (int n = 0; n < read.patch_count; n++) {
            const struct grid *g = &read.patches[n], *of = &patches[n];
            assert_true(g->x_first == of->x_first && g->x_step == of->x_step && g->x_count == of->x_count);
            assert_true(g->r_first == of->r_first && g->r_step == of->r_step && g->r_count == of->r_count);
            assert_true(g->angle_rad == of->angle_rad);
        }
        for (int n = 0; n < read.target_count; n++) {
            assert_true(read.targets[n].x == targets[n].x && read.targets[n].r == targets[n].r);
            assert_true(read.targets[n].amplitude == targets[n].amplitude);
        }
        echo_notes_free(&read);
    }
    echoes_free(&echoes);
    acquisition_free(&a);
}

/* Each is refused by the notes alone: the echoes are as they were. */
static void wrong_notes_are_refused(void **state)
{
    (void)state;
    static const double good[14] = {0, 0.1, 3, 20, 0.1, 5, 0, 1, 0.1, 3, 20, 0.1, 5, 0};
    static const struct {
        const char *name;
        size_t rows, columns;
        size_t place;
        double value;
    } wrongs[] = {
        {"image_grid", 6, 2, 0, 0},           {"image_grid", 2, 7, 0, 0},      {"image_grid", 7, 2, 9, 2.5},
        {"image_grid", 7, 2, 12, NAN},        {"image_grid", 7, 1, 2, 1e10},   {"image_grid", 7, 1, 5, -1},
        {"image_grid", 7, 1, 6, INFINITY},    {"image_grid", 7, 1, 6, 90},     {"point_targets", 3, 2, 0, 0},
        {"point_targets", 4, 2, 7, INFINITY}, {"point_targets", 4, 1, 0, NAN},
    };
    static const enum mat_ft versions[] = {MAT_FT_MAT5, MAT_FT_MAT73};
    for (size_t k = 0; k < 2 * sizeof wrongs / sizeof *wrongs; k++) {
        double values[14];
        memcpy(values, good, sizeof values);
        values[wrongs[k / 2].place] = wrongs[k / 2].value;
        mat_t *mat = file_begin(versions[k % 2], true, "");
        variable_add(mat,
                     &(struct mat_values){wrongs[k / 2].name,
                                          MAT_C_DOUBLE,
                                          MAT_T_DOUBLE,
                                          {wrongs[k / 2].rows, wrongs[k / 2].columns, 1},
                                          values,
                                          NULL},
                     true);
        Mat_Close(mat);
        struct echo_notes notes;
        assert_invalid(echo_notes_read(path, &notes), wrongs[k / 2].name);
        assert_null(notes.patches);
        struct acquisition a;
        struct echoes echoes;
        assert_ok(echo_file_read(path, &a, &echoes));
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(notes_come_back), cmocka_unit_test(wrong_notes_are_refused)};
    return cmocka_run_group_tests(tests, fixture_make, directory_remove);
}
