/* MATLAB files as h5py writes them: texts padded or of any length, and complex numbers of `r` and `i`. */
#include <complex.h>
#include <hdf5.h>
#include <stdlib.h>
#include <string.h>

#include "tests/echoes/mat_fixture.h"

/* The one file, of version 7.3, whose MATLAB_class are texts of this size: 0, as long as they are; H5T_VARIABLE. */
static void file_make(size_t size)
{
    static const char *const names[] = {"format", "samples", "compressed", "pulse",       "fs", "fc",
                                        "t0",     "tx",      "bandwidth",  "sound_speed", "rx", "velocity"};
    Mat_Close(file_begin(MAT_FT_MAT73, false, ""));
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), one = H5Screate(H5S_SCALAR);
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        const hid_t set = H5Dopen2(file, names[k], H5P_DEFAULT), text = H5Tcopy(H5T_C_S1);
        assert_true(set >= 0);
        char padded[32] = "double";
        const char *class = strcmp(names[k], "format") == 0 ? strncpy(padded, "char", sizeof padded) : padded;
        H5Tset_size(text, size > 0 ? size : strlen(class));
        H5Tset_strpad(text, H5T_STR_NULLPAD);
        assert_true(H5Adelete(set, "MATLAB_class") >= 0);
        const hid_t attribute = H5Acreate2(set, "MATLAB_class", text, one, H5P_DEFAULT, H5P_DEFAULT);
        assert_true(H5Awrite(attribute, text, size == H5T_VARIABLE ? (const void *)&class : padded) >= 0);
        H5Aclose(attribute);
        H5Tclose(text);
        H5Dclose(set);
    }
    H5Sclose(one);
    H5Fclose(file);
}

/* The samples as complex numbers of these members. */
static void samples_rename(const char *real, const char *imaginary)
{
    const hsize_t dims[3] = {P, M, N};
    const double values[P * M * N][2] = {{1, 2}};
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), space = H5Screate_simple(3, dims, NULL),
                type = H5Tcreate(H5T_COMPOUND, sizeof *values), text = H5Tcopy(H5T_C_S1), one = H5Screate(H5S_SCALAR);
    H5Tset_size(text, strlen("double"));
    H5Tinsert(type, real, 0, H5T_NATIVE_DOUBLE);
    H5Tinsert(type, imaginary, sizeof **values, H5T_NATIVE_DOUBLE);
    assert_true(H5Ldelete(file, "samples", H5P_DEFAULT) >= 0);
    const hid_t set = H5Dcreate2(file, "samples", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    const hid_t attribute = H5Acreate2(set, "MATLAB_class", text, one, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, text, "double");
    H5Aclose(attribute);
    H5Dclose(set);
    H5Sclose(one);
    H5Tclose(text);
    H5Tclose(type);
    H5Sclose(space);
    H5Fclose(file);
}

static double complex first_sample(void)
{
    struct acquisition a;
    struct echoes echoes;
    assert_ok(echo_file_read(path, &a, &echoes));
    const double complex first = ((const double complex *)echoes.samples)[0];
    acquisition_free(&a);
    echoes_free(&echoes);
    return first;
}

/* Without a zero behind, with one, and with some. */
static void padded_classes_are_read(void **state)
{
    (void)state;
    Mat_Close(file_begin(MAT_FT_MAT73, false, ""));
    const double complex usual = first_sample();
    const size_t sizes[] = {0, 7, 20};
    for (int k = 0; k < 3; k++) {
        file_make(sizes[k]);
        assert_true(first_sample() == usual);
    }
}

static void classes_of_any_length_are_refused(void **state)
{
    (void)state;
    file_make(H5T_VARIABLE);
    assert_echoes_invalid("MATLAB_class is no text of fixed length (h5py: numpy.bytes_('double'))");
}

static void other_names_of_parts_are_refused(void **state)
{
    (void)state;
    file_make(0);
    samples_rename("real", "imag");
    assert_true(first_sample() == 1 + 2 * I);
    samples_rename("r", "i");
    assert_echoes_invalid("variable `samples` is of complex numbers without members `real` and `imag`");
    samples_rename("real", "i");
    assert_echoes_invalid("h5py: a dtype [('real', 'f8'), ('imag', 'f8')]");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(padded_classes_are_read),
                                       cmocka_unit_test(classes_of_any_length_are_refused),
                                       cmocka_unit_test(other_names_of_parts_are_refused)};
    return cmocka_run_group_tests(tests, fixture_make, directory_remove);
}
