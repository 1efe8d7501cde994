/* MATLAB files that are refused in one line, and places that cannot be written. */
#define _GNU_SOURCE /* memmem */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/echoes/mat_fixture.h"

/* Written in place of the variable of that name. */
static const struct wrong {
    const char *name;
    enum matio_classes class; /* MAT_C_EMPTY: left out */
    size_t rows, columns, pages;
    bool is_complex;
    double value;
    const char *says;
} wrongs[] = {
    {"format", MAT_C_EMPTY, 0, 0, 0, false, 0, "`format` is missing; the text \"sas-echoes 1\""},
    {"format", MAT_C_DOUBLE, 1, 12, 1, false, 's', "`format` is numeric; the text"},
    {"format", MAT_C_CHAR, 1, 12, 1, false, 'x', "`format` is \"xxxxxxxxxxxx\""},
    {"format", MAT_C_CHAR, 1, 3, 1, false, 's', "`format` is \"sss\""},
    {"samples", MAT_C_EMPTY, 0, 0, 0, false, 0, "`samples` is missing; a complex array [N x M x P]"},
    {"samples", MAT_C_CELL, N, M, P, false, 0, "`samples` is a cell array"},
    {"samples", MAT_C_STRUCT, 1, 1, 1, false, 0, "`samples` is a struct"},
    {"samples", MAT_C_CHAR, N, M, 1, false, 'x', "`samples` is text"},
    {"samples", MAT_C_DOUBLE, 0, M, P, false, 0, "`samples` is "},
    {"samples", MAT_C_DOUBLE, N, M, P, true, NAN, "`samples` at (1, 1, 1) is nan"},
    {"samples", MAT_C_DOUBLE, N, M, P, true, INFINITY, "`samples` at (1, 1, 1) is inf"},
    {"samples", MAT_C_DOUBLE, 1, M, P, true, 1, "samples is 1; at least 2"},
    {"samples", MAT_C_DOUBLE, N, P, M, true, 1,
     "`samples` is [5 x 3 x 2], `tx` and `rx` have 2 receivers and 3 pings; a complex array [N x M x P]"},
    {"compressed", MAT_C_EMPTY, 0, 0, 0, false, 0, "`compressed` is missing"},
    {"compressed", MAT_C_DOUBLE, 1, 1, 1, false, 2, "`compressed` is 2; 0 (raw) or 1"},
    {"compressed", MAT_C_DOUBLE, 1, 1, 1, false, NAN, "`compressed` is nan"},
    {"compressed", MAT_C_DOUBLE, 1, 1, 1, false, 1, "pulse has 4 samples; compressed echoes have none"},
    {"pulse", MAT_C_EMPTY, 0, 0, 0, false, 0, "`pulse` is missing; raw echoes (compressed 0) need a complex array"},
    {"pulse", MAT_C_DOUBLE, 2, 2, 1, true, 1, "`pulse` is [2 x 2 x 1]"},
    {"pulse", MAT_C_DOUBLE, 4, 1, 1, true, 0, "energy of pulse is 0"},
    {"fs", MAT_C_DOUBLE, 1, 1, 1, false, 10e3, "at most fs = 10000 Hz"},
    {"fs", MAT_C_DOUBLE, 1, 1, 1, true, 30e3, "`fs` is complex; a scalar in Hz"},
    {"fs", MAT_C_DOUBLE, 2, 1, 1, false, 30e3, "`fs` is [2 x 1 x 1]; a scalar in Hz"},
    {"fs", MAT_C_DOUBLE, 1, 1, 1, false, INFINITY, "fs is inf"},
    {"fc", MAT_C_DOUBLE, 1, 1, 1, false, 1e14, "phase error"},
    {"fc", MAT_C_DOUBLE, 1, 1, 1, false, 0, "fc is 0"},
    {"bandwidth", MAT_C_DOUBLE, 1, 1, 1, false, -5, "bandwidth is -5"},
    {"sound_speed", MAT_C_CHAR, 1, 4, 1, false, '1', "`sound_speed` is text; a real scalar or [1 x P] in m/s"},
    {"sound_speed", MAT_C_DOUBLE, 1, P + 1, 1, false, 1500, "`sound_speed` is [1 x 4 x 1]"},
    {"sound_speed", MAT_C_DOUBLE, 1, P, 1, false, -1500, "sound_speed is -1500"},
    {"sound_speed", MAT_C_DOUBLE, 1, 1, 1, false, NAN, "sound_speed is nan"},
    {"t0", MAT_C_DOUBLE, 1, P + 1, 1, false, 0.1, "`t0` is [1 x 4 x 1]"},
    {"t0", MAT_C_DOUBLE, 1, 1, 1, false, NAN, "t0 of ping 1"},
    {"tx", MAT_C_DOUBLE, 2, P, 1, false, 0, "`tx` is [2 x 3 x 1]"},
    {"tx", MAT_C_DOUBLE, 3, P, 1, true, 0, "`tx` is complex"},
    {"rx", MAT_C_DOUBLE, 3, M, P + 1, false, 0, "`rx` is [3 x 2 x 4], samples [5 x 2 x 3]"},
    {"rx", MAT_C_DOUBLE, 3, M *P, 1, false, 0, "`rx` is [3 x 6 x 1]"},
    {"rx", MAT_C_DOUBLE, 3, M, P, false, INFINITY, "rx 1 of ping 1"},
    {"velocity", MAT_C_DOUBLE, 3, 2, 1, false, 0, "`velocity` is [3 x 2 x 1]"},
    {"velocity", MAT_C_DOUBLE, 3, 1, 1, false, 2000, "a speed below sound_speed = 1500"},
    {"tx_length", MAT_C_DOUBLE, 1, 1, 1, false, -1, "tx_length is -1"},
    {"beam_limit", MAT_C_DOUBLE, 1, 1, 1, false, 1.5, "`beam_limit` is 1.5; a scalar in (0, 1]"},
    {"beam_limit", MAT_C_DOUBLE, 1, 1, 1, false, 0, "`beam_limit` is 0"},
    {"echo_sine", MAT_C_DOUBLE, 1, 1, 1, false, 0, "`echo_sine` is 0; a scalar > 0"},
    {"echo_sine", MAT_C_DOUBLE, 1, 1, 1, false, NAN, "`echo_sine` is nan"},
    {"echo_sine", MAT_C_DOUBLE, 2, 1, 1, false, 1, "`echo_sine` is [2 x 1 x 1]"},
    {"echo_tapers", MAT_C_DOUBLE, 1, 1, 1, false, 2, "`echo_tapers` is 2; 0 or 1"},
    {"echo_squint", MAT_C_DOUBLE, 1, 1, 1, false, 20, "`echo_squint` is 20; a scalar between -pi/2 and pi/2 in rad"},
    {"echo_squint", MAT_C_DOUBLE, 1, 1, 1, false, NAN, "`echo_squint` is nan"},
    {"area", MAT_C_DOUBLE, 1, 3, 1, false, 1, "`area` is [1 x 3 x 1]"},
    {"area", MAT_C_DOUBLE, 1, 4, 1, false, 0, "`area` has 0 at place 3; a real array [1 x 4] in m"},
    {"area", MAT_C_DOUBLE, 4, 1, 1, false, INFINITY, "`area` has inf at place 1"},
    {"area", MAT_C_DOUBLE, 1, 4, 1, true, 1, "`area` is complex"},
};

static void wrong_write(mat_t *mat, const struct wrong *wrong, double *values, char *text)
{
    const bool is_text = wrong->class == MAT_C_CHAR;
    size_t dims[2] = {1, 1};
    const char *fields[] = {"field", NULL};
    if (wrong->class == MAT_C_EMPTY)
        return;
    if (wrong->class != MAT_C_CELL && wrong->class != MAT_C_STRUCT) {
        variable_add(mat,
                     &(struct mat_values){wrong->name,
                                          wrong->class,
                                          is_text ? MAT_T_UTF8 : MAT_T_DOUBLE,
                                          {wrong->rows, wrong->columns, wrong->pages},
                                          is_text ? (void *)text : (void *)values,
                                          wrong->is_complex ? values : NULL},
                     true);
        return;
    }
    matvar_t *matvar = wrong->class == MAT_C_CELL ? Mat_VarCreate(wrong->name, MAT_C_CELL, MAT_T_CELL, 2, dims, NULL, 0)
                                                  : Mat_VarCreateStruct2(wrong->name, 2, dims, fields);
    matvar_t *inner = Mat_VarCreate("field", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values, 0);
    if (wrong->class == MAT_C_CELL)
        Mat_VarSetCell(matvar, 0, inner);
    else
        Mat_VarSetStructFieldByName(matvar, "field", 0, inner);
    Mat_VarWrite(mat, matvar, MAT_COMPRESSION_ZLIB);
    Mat_VarFree(matvar);
}

static void each_wrong_variable_is_refused(void **state)
{
    (void)state;
    const enum mat_ft versions[] = {MAT_FT_MAT5, MAT_FT_MAT73};
    for (size_t i = 0; i < 2 * sizeof wrongs / sizeof *wrongs; i++) {
        size_t k = i / 2, count = wrongs[k].rows * wrongs[k].columns * wrongs[k].pages;
        mat_t *mat = file_begin(versions[i % 2], true, wrongs[k].name);
        double values[MOST];
        char text[MOST];
        assert_true(count <= MOST);
        for (int j = 0; j < MOST; j++) {
            values[j] = wrongs[k].value;
            text[j] = (char)(wrongs[k].class == MAT_C_CHAR ? wrongs[k].value : 0);
        }
        wrong_write(mat, &wrongs[k], values, text);
        Mat_Close(mat);
        assert_echoes_invalid(wrongs[k].says);
    }
}

/* At 4000 km float's numbers are 0.25 m apart, at 8 m 5e-7 m: the wavelength is 15 mm. */
static void coarse_positions_are_refused(void **state)
{
    (void)state;
    const enum mat_ft versions[] = {MAT_FT_MAT5, MAT_FT_MAT73};
    static const char *const names[] = {"tx", "rx"};
    for (int i = 0; i < 8; i++) {
        const size_t receivers = i & 2 ? M : 1;
        const bool is_far = i & 4;
        float places[3 * M * P] = {0};
        for (size_t k = 0; k < 3 * receivers * P; k += 3)
            places[k] = is_far ? 4e6f : 8;
        mat_t *mat = file_begin(versions[i & 1], true, names[receivers == M]);
        const struct mat_values tx = {"tx", MAT_C_SINGLE, MAT_T_SINGLE, {3, P, 1}, places, NULL};
        const struct mat_values rx = {"rx", MAT_C_SINGLE, MAT_T_SINGLE, {3, M, P}, places, NULL};
        variable_add(mat, receivers == M ? &rx : &tx, true);
        Mat_Close(mat);
        struct acquisition a;
        struct echoes echoes;
        const enum status status = echo_file_read(path, &a, &echoes);
        assert_int_equal(status, is_far ? STATUS_INVALID : STATUS_OK);
        if (is_far) {
            assert_non_null(strstr(status_message(), names[receivers == M]));
            assert_non_null(
                strstr(status_message(), "is of class single, whose values at 4000000 m lie 16.7 wavelengths"));
        } else {
            acquisition_free(&a);
            echoes_free(&echoes);
        }
    }
}

static void other_files_are_refused(void **state)
{
    (void)state;
    unlink(path);
    assert_echoes_invalid("cannot be read: No such file");
    assert_int_equal(mkdir(path, 0700), 0);
    assert_echoes_invalid("is not a regular file");
    rmdir(path);
    bytes_write("", 0);
    assert_echoes_invalid("is not a MATLAB file");
    bytes_write("scene = { x = 1; };\n", 20);
    assert_echoes_invalid("is not a MATLAB file");
    /* Version 4, 26 bytes that claim 23 GB: type, rows, columns, imaginary, name length, name. */
    const uint32_t header[5] = {0, 54000, 54000, 0, 6};
    unsigned char bytes[26] = {0};
    memcpy(bytes, header, sizeof header);
    memcpy(bytes + sizeof header, "image", 6);
    bytes_write(bytes, sizeof bytes);
    assert_echoes_invalid("is not a MATLAB file of version 5 or 7.3");
}

/* Files of other programs are called by their names, and how to write a right one is said. */
static void other_formats_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *bytes, *says;
    } files[] = {
        {"# Created by Octave 8.4.0\n# name: samples\n", "Octave's text format; save -v7"},
        {"Octave-1-L\0", "Octave's binary format; save -v7"},
        {"\x93NUMPY\x01", "a NumPy array; scipy.io.savemat"},
        {"PK\x03\x04 and more", "a zip archive (NumPy's .npz?); scipy.io.savemat"},
        {"samples,1,2,3\n", "; save -v7 writes one (MATLAB, Octave)"},
    };
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        bytes_write(files[k].bytes, strlen(files[k].bytes));
        assert_echoes_invalid(files[k].says);
    }
    /* All variables within a struct. */
    size_t dims[2] = {1, 1};
    const char *fields[] = {"samples", NULL};
    double value = 1;
    mat_t *mat = Mat_CreateVer(path, NULL, MAT_FT_MAT5);
    matvar_t *matvar = Mat_VarCreateStruct2("sonar", 2, dims, fields);
    Mat_VarSetStructFieldByName(matvar, "samples", 0,
                                Mat_VarCreate("samples", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, &value, 0));
    Mat_VarWrite(mat, matvar, MAT_COMPRESSION_NONE);
    Mat_VarFree(matvar);
    Mat_Close(mat);
    assert_echoes_invalid("`format` is missing");
    assert_echoes_invalid("holds a struct `sonar`");
    assert_echoes_invalid("'-struct', 'sonar'");
    bool is = true;
    assert_int_equal(echo_file_is(path, &is), STATUS_OK);
    assert_false(is);
    assert_int_equal(image_file_is(path, &is), STATUS_OK);
    assert_false(is);
}

static void absurd_sizes_are_refused(void **state)
{
    (void)state;
    struct rlimit before, after;
    getrlimit(RLIMIT_AS, &before);
    Mat_Close(file_begin(MAT_FT_MAT5, false, ""));
    size_t size;
    unsigned char *bytes = bytes_read(&size);
    const int32_t dims[3] = {N, M, P};
    unsigned char *at = memmem(bytes, size, dims, sizeof dims);
    assert_non_null(at);
    const int32_t claims[][3] = {
        {INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MAX, M, P}, {-1, -1, -1}, {1 << 20, 64, P}, {N, M, 1 << 20}};
    for (size_t i = 0; i < sizeof claims / sizeof *claims; i++) {
        memcpy(at, claims[i], sizeof dims);
        bytes_write(bytes, size);
        assert_echoes_invalid("`samples` claims more numbers than the file's");
    }
    free(bytes);
    getrlimit(RLIMIT_AS, &after);
    assert_true(before.rlim_cur == after.rlim_cur && before.rlim_max == after.rlim_max);
}

static void truncated_files_are_refused(void **state)
{
    (void)state;
    const struct {
        enum mat_ft version;
        bool packed;
        size_t step;
    } files[] = {{MAT_FT_MAT5, true, 16}, {MAT_FT_MAT5, false, 16}, {MAT_FT_MAT73, false, 197}};
    for (int i = 0; i < 3; i++) {
        Mat_Close(file_begin(files[i].version, files[i].packed, ""));
        size_t size;
        unsigned char *bytes = bytes_read(&size);
        for (size_t kept = 0; kept < size; kept += files[i].step) {
            bytes_write(bytes, kept);
            assert_echoes_invalid("");
        }
        bytes_write(bytes, size - 1);
        assert_echoes_invalid("");
        free(bytes);
    }
}

/* libmatio and HDF5 crash over some of these: it must be the reader's child that does. */
static void damaged_files_do_no_harm(void **state)
{
    (void)state;
    uint32_t random = 1;
    const enum mat_ft versions[] = {MAT_FT_MAT5, MAT_FT_MAT73};
    for (int i = 0; i < 4; i++) {
        Mat_Close(file_begin(versions[i / 2], i % 2, ""));
        size_t size;
        unsigned char *bytes = bytes_read(&size);
        for (int run = 0; run < 60; run++) {
            random = random * 1664525u + 1013904223u;
            /* Around 2090 lies a datatype of the unpacked 7.3 file over which HDF5 1.10.8 crashes. */
            size_t place = i == 2 ? 2061 + (size_t)run : (random >> 8) % size;
            unsigned char kept = bytes[place];
            bytes[place] ^= (unsigned char)(run % 2 ? 0xff : 1 << (run / 2 % 8));
            bytes_write(bytes, size);
            bytes[place] = kept;
            struct acquisition a;
            struct echoes echoes;
            enum status status = echo_file_read(path, &a, &echoes);
            if (status == STATUS_OK) { /* the damage is in a value */
                acquisition_free(&a);
                echoes_free(&echoes);
            } else {
                assert_invalid(status, "");
            }
        }
        free(bytes);
    }
}

static void wrong_images_are_refused(void **state)
{
    (void)state;
    const struct grid grid = {0, 0.1, 3, 10, 0.1, 2};
    struct grid back;
    double complex *pixels;
    static const struct {
        const char *name;
        size_t rows, columns, pages;
        double values[4];
        const char *says;
    } cases[] = {
        {"x", 1, 2, 1, {0, 1}, "`x` is [1 x 2 x 1] for 3 pixels"},
        {"x", 1, 3, 1, {0, 1, 2.1}, "`x` has 1 at place 2"},
        {"x", 1, 3, 1, {2, 1, 0}, "`x` has 2 at place 1"},
        {"x", 1, 3, 1, {0, NAN, 2}, "`x` has nan at place 2"},
        {"x", 1, 3, 1, {0, 1, INFINITY}, "`x` has"},
        {"r", 3, 1, 1, {0, 1, 2}, "`r` is [3 x 1 x 1] for 2 pixels"},
        {"image", 2, 1, 2, {0}, "`image` is [2 x 1 x 2]"},
        {"angle", 1, 1, 1, {2}, "`angle` is 2; a scalar between"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double x[] = {0, 0.1, 0.2}, r[] = {10, 10.1}, image[6] = {0};
        mat_t *mat = Mat_CreateVer(path, NULL, MAT_FT_MAT5);
        variable_add(mat,
                     &(struct mat_values){cases[i].name,
                                          MAT_C_DOUBLE,
                                          MAT_T_DOUBLE,
                                          {cases[i].rows, cases[i].columns, cases[i].pages},
                                          cases[i].values,
                                          NULL},
                     true);
        if (strcmp(cases[i].name, "x") != 0) {
            variable_add(mat, &(struct mat_values){"x", MAT_C_DOUBLE, MAT_T_DOUBLE, {1, 3, 1}, x, NULL}, true);
        }
        if (strcmp(cases[i].name, "r") != 0) {
            variable_add(mat, &(struct mat_values){"r", MAT_C_DOUBLE, MAT_T_DOUBLE, {1, 2, 1}, r, NULL}, true);
        }
        if (strcmp(cases[i].name, "image") != 0) {
            variable_add(mat, &(struct mat_values){"image", MAT_C_DOUBLE, MAT_T_DOUBLE, {2, 3, 1}, image, NULL}, true);
        }
        Mat_Close(mat);
        assert_invalid(image_file_read(path, &back, &pixels), cases[i].says);
        assert_null(pixels);
    }
    struct image image;
    assert_ok(image_allocate(1, &grid, PRECISION_FLOAT, &image));
    assert_ok(image_file_write(path, &image, &(struct image_origin){.algorithm = "a", .fc = NAN, .sound_speed = NAN}));
    assert_echoes_invalid("`format` is missing");
    image_free(&image);
}

static void unwritable_places_are_refused(void **state)
{
    (void)state;
    struct acquisition a = make_acquisition(4, 1, 1, true);
    struct echoes echoes;
    assert_ok(echoes_allocate(&a, PRECISION_DOUBLE, &echoes));
    unlink(path);
    char kept[sizeof path];
    snprintf(kept, sizeof kept, "%s", path);
    snprintf(path, sizeof path, "%s/none/test.mat", directory);
    assert_invalid(echo_file_write(path, &echoes, NULL), "cannot be written: No such file or directory");
    snprintf(path, sizeof path, "%s", directory);
    assert_invalid(echo_file_write(path, &echoes, NULL), "not a regular file");
    snprintf(path, sizeof path, "/dev/null");
    assert_invalid(echo_file_write(path, &echoes, NULL), "not a regular file");
    snprintf(path, sizeof path, "%s", kept);
    echoes_free(&echoes);
    acquisition_free(&a);
}

/* The disk is full from `limit` bytes on; the old file stays whatever happens. */
static void full_disk_is_noticed(void **state)
{
    (void)state;
    struct acquisition a = make_acquisition(300, 2, 3, false);
    struct echoes echoes;
    assert_ok(echoes_allocate(&a, PRECISION_DOUBLE, &echoes));
    fill_echoes(&echoes);
    assert_ok(echo_file_write(path, &echoes, &(struct echo_notes){.description = "first"}));
    struct stat whole, now;
    assert_int_equal(stat(path, &whole), 0);
    signal(SIGXFSZ, SIG_IGN);
    struct rlimit old;
    getrlimit(RLIMIT_FSIZE, &old);
    for (rlim_t limit = 0; limit < (rlim_t)whole.st_size + 200; limit += 171) {
        fflush(NULL);
        setrlimit(RLIMIT_FSIZE, &(struct rlimit){limit, old.rlim_max});
        enum status status = echo_file_write(path, &echoes, &(struct echo_notes){.description = "first"});
        setrlimit(RLIMIT_FSIZE, &old);
        if (limit < (rlim_t)whole.st_size - 8) { /* the header's date does not change the size by more */
            assert_invalid(status, "cannot be written: ");
        }
        assert_no_temporary_files();
        assert_int_equal(stat(path, &now), 0);
        assert_true(llabs((long long)now.st_size - (long long)whole.st_size) <= 8);
    }
    signal(SIGXFSZ, SIG_DFL);
    echoes_free(&echoes);
    acquisition_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_wrong_variable_is_refused), cmocka_unit_test(other_files_are_refused),
        cmocka_unit_test(coarse_positions_are_refused),   cmocka_unit_test(other_formats_are_named),
        cmocka_unit_test(absurd_sizes_are_refused),       cmocka_unit_test(truncated_files_are_refused),
        cmocka_unit_test(damaged_files_do_no_harm),       cmocka_unit_test(wrong_images_are_refused),
        cmocka_unit_test(unwritable_places_are_refused),  cmocka_unit_test(full_disk_is_noticed),
    };
    return cmocka_run_group_tests(tests, fixture_make, directory_remove);
}
