/* MATLAB files whose variables hold fewer numbers than their dimensions say: libmatio and HDF5 would read on beyond
   them, fill up with zeros, or leave memory as it was. What is allocated here is poisoned, so that none of this can
   look like a number that is meant. */
#include <hdf5.h>
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "tests/echoes/mat_fixture.h"

enum { TAG = 8, ROOM = 1 << 14 };

/* A file of version 5, made by hand. */
static struct {
    unsigned char bytes[ROOM];
    size_t size;
    bool is_big_endian, is_packed, is_small; /* is_small: up to four bytes stand in the tag */
} made;

/* A variable of it: numbers of one type, of whose parts so many bytes are written. */
struct element {
    const char *name;
    enum matio_classes class;
    enum matio_types type;
    int rows, columns, pages;
    bool is_complex;
    double value; /* the first one; each further one is one more */
    size_t kept[2];
};

static void word_add(uint32_t value)
{
    for (int i = 0; i < 4; i++)
        made.bytes[made.size++] = (unsigned char)(value >> 8 * (made.is_big_endian ? 3 - i : i));
}

/* Numbers in the machine's order, `size` bytes each. */
static void data_add(uint32_t type, const void *data, size_t bytes, size_t size)
{
    const bool is_small = made.is_small && bytes > 0 && bytes <= 4;
    word_add(is_small ? (uint32_t)bytes << 16 | type : type);
    if (!is_small)
        word_add((uint32_t)bytes);
    for (size_t i = 0; i < bytes; i++)
        made.bytes[made.size++] =
            ((const unsigned char *)data)[made.is_big_endian ? i / size * size + size - 1 - i % size : i];
    for (; bytes % (is_small ? 4 : 8) != 0; bytes++)
        made.bytes[made.size++] = 0;
}

static size_t number_put(unsigned char *to, enum matio_types type, double value)
{
    const size_t size = Mat_SizeOf(type);
    const int64_t whole = (int64_t)value;
    const float single = (float)value;
    memcpy(to,
           type == MAT_T_DOUBLE   ? (const void *)&value
           : type == MAT_T_SINGLE ? (const void *)&single
                                  : &whole,
           size);
    return size;
}

static void element_add(const struct element *e)
{
    const size_t start = made.size;
    const uint32_t flags[2] = {(uint32_t)e->class | (e->is_complex ? 0x800 : 0), 0};
    const int32_t dims[3] = {e->rows, e->columns, e->pages};
    word_add(MAT_T_MATRIX);
    word_add(0);
    data_add(MAT_T_UINT32, flags, sizeof flags, 4);
    data_add(MAT_T_INT32, dims, e->pages == 1 ? 8 : 12, 4);
    data_add(MAT_T_INT8, e->name, strlen(e->name), 1);
    for (int part = 0; part < 1 + e->is_complex; part++) {
        unsigned char numbers[MOST * 8];
        size_t size = 0;
        for (int i = 0; i < e->rows * e->columns * e->pages; i++)
            size +=
                number_put(numbers + size, e->type, strcmp(e->name, "format") == 0 ? "sas-echoes 1"[i] : e->value + i);
        data_add(e->type, numbers, e->kept[part] < size ? e->kept[part] : size, Mat_SizeOf(e->type));
    }
    const size_t end = made.size;
    made.size = start + 4;
    word_add((uint32_t)(end - start - TAG));
    made.size = end;
    if (made.is_packed) {
        unsigned char packed[ROOM];
        uLongf length = sizeof packed;
        assert_int_equal(compress(packed, &length, made.bytes + start, end - start), Z_OK);
        made.size = start;
        word_add(MAT_T_COMPRESSED);
        word_add((uint32_t)length);
        memcpy(made.bytes + made.size, packed, length);
        made.size += length;
    }
}

/* Everything that an echo file needs, `other` in place of the variable of its name, first, in its place or last. */
static void file_make(const struct element *other, int place)
{
    static const size_t all[2] = {SIZE_MAX, SIZE_MAX};
    const struct element elements[] = {
        {"format", MAT_C_CHAR, MAT_T_UINT16, 1, 12, 1},
        {"samples", MAT_C_DOUBLE, MAT_T_DOUBLE, N, M, P, true, 1},
        {"compressed", MAT_C_DOUBLE, MAT_T_UINT8, 1, 1, 1, false, 0},
        {"pulse", MAT_C_DOUBLE, MAT_T_DOUBLE, K, 1, 1, true, 1},
        {"fs", MAT_C_DOUBLE, MAT_T_DOUBLE, 1, 1, 1, false, 30e3},
        {"fc", MAT_C_DOUBLE, MAT_T_DOUBLE, 1, 1, 1, false, 100e3},
        {"bandwidth", MAT_C_DOUBLE, MAT_T_UINT16, 1, 1, 1, false, 20e3},
        {"sound_speed", MAT_C_DOUBLE, MAT_T_DOUBLE, 1, 1, 1, false, 1500},
        {"t0", MAT_C_DOUBLE, MAT_T_DOUBLE, 1, 1, 1, false, 0.1},
        {"tx", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, P, 1, false, 1},
        {"rx", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, M, P, false, 1},
        {"velocity", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, 1, 1, false, 1},
    };
    memset(made.bytes, ' ', 124);
    memcpy(made.bytes, "MATLAB 5.0 MAT-file", 19);
    made.size = 124;
    made.bytes[made.size++] = made.is_big_endian;
    made.bytes[made.size++] = !made.is_big_endian;
    memcpy(made.bytes + made.size, made.is_big_endian ? "MI" : "IM", 2);
    made.size += 2;
    bool is_placed = place == 0;
    if (place == 0)
        element_add(other);
    for (size_t k = 0; k < sizeof elements / sizeof *elements; k++) {
        struct element element = elements[k];
        const bool is_other = strcmp(element.name, other->name) == 0;
        memcpy(element.kept, all, sizeof all);
        if (!is_other)
            element_add(&element);
        else if (place == 1)
            element_add(other);
        is_placed = is_placed || (is_other && place == 1);
    }
    if (!is_placed)
        element_add(other);
    bytes_write(made.bytes, made.size);
}

static void each_short_element_is_refused(void **state)
{
    (void)state;
    static const struct {
        struct element element;
        const char *says;
    } cases[] = {
        {{"format", MAT_C_CHAR, MAT_T_UTF8, 1, 12, 1, false, 0, {11}}, "`format` has 11 bytes, its dimensions need 12"},
        {{"format", MAT_C_CHAR, MAT_T_UINT16, 1, 12, 1, false, 0, {8}}, "`format` has 8 bytes, its dimensions need 24"},
        {{"samples", MAT_C_DOUBLE, MAT_T_DOUBLE, N, M, P, true, 1, {232, 240}},
         "`samples` has 232 bytes, its dimensions need 240"},
        {{"samples", MAT_C_DOUBLE, MAT_T_DOUBLE, N, M, P, true, 1, {240, 8}},
         "`samples` has 8 bytes of its imaginary part, its dimensions need 240"},
        {{"samples", MAT_C_SINGLE, MAT_T_SINGLE, N, M, P, true, 1, {120, 0}},
         "`samples` has 0 bytes of its imaginary part, its dimensions need 120"},
        {{"samples", MAT_C_DOUBLE, MAT_T_INT16, N, M, P, true, 1, {57, 60}},
         "`samples` has 57 bytes, its dimensions need 60"},
        {{"pulse", MAT_C_DOUBLE, MAT_T_DOUBLE, K, 1, 1, true, 1, {24, 32}},
         "`pulse` has 24 bytes, its dimensions need 32"},
        {{"fs", MAT_C_DOUBLE, MAT_T_DOUBLE, 1, 1, 1, false, 30e3, {4}}, "`fs` has 4 bytes, its dimensions need 8"},
        {{"t0", MAT_C_DOUBLE, MAT_T_DOUBLE, 1, P, 1, false, 1, {16}}, "`t0` has 16 bytes, its dimensions need 24"},
        {{"tx", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, P, 1, false, 1, {8}}, "`tx` has 8 bytes, its dimensions need 72"},
        {{"tx", MAT_C_INT32, MAT_T_INT8, 3, P, 1, false, 1, {3}}, "`tx` has 3 bytes, its dimensions need 9"},
        {{"rx", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, M, P, false, 1, {143}}, "`rx` has 143 bytes, its dimensions need 144"},
        {{"rx", MAT_C_INT64, MAT_T_INT64, 3, M, P, false, 1, {0}}, "`rx` has 0 bytes, its dimensions need 144"},
        {{"velocity", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, 1, 1, false, 1, {20}},
         "`velocity` has 20 bytes, its dimensions need 24"},
        {{"area", MAT_C_DOUBLE, MAT_T_DOUBLE, 1, 4, 1, false, 1, {24}}, "`area` has 24 bytes, its dimensions need 32"},
    };
    for (size_t k = 0; k < 24 * sizeof cases / sizeof *cases; k++) {
        made.is_packed = k / 3 % 2;
        made.is_big_endian = k / 6 % 2;
        made.is_small = k / 12 % 2;
        file_make(&cases[k / 24].element, k % 3);
        assert_echoes_invalid(cases[k / 24].says);
    }
    made.is_packed = made.is_big_endian = made.is_small = false;
}

/* Every type that may stand in a file for numbers or text is read as it is meant, or refused. */
static void each_stored_type_is_read_or_refused(void **state)
{
    (void)state;
    for (int k = 0; k < 2 * 2 * 19; k++) {
        const enum matio_types type = k / 4;
        const bool is_text = k % 2;
        const bool is_number = (type >= MAT_T_INT8 && type <= MAT_T_SINGLE) || type == MAT_T_DOUBLE
                               || type == MAT_T_INT64 || type == MAT_T_UINT64;
        const bool is_code = type == MAT_T_UINT8 || type == MAT_T_UINT16 || type == MAT_T_UTF8 || type == MAT_T_UTF16;
        const struct element number = {"tx", MAT_C_DOUBLE, type, 3, P, 1, false, 1, {SIZE_MAX}};
        const struct element text = {"format", MAT_C_CHAR, type, 1, 12, 1, false, 0, {SIZE_MAX}};
        struct acquisition a;
        struct echoes echoes;
        char says[64];
        made.is_packed = k / 2 % 2;
        made.is_small = k % 3 == 0;
        file_make(is_text ? &text : &number, 1);
        if (!(is_text ? is_code : is_number)) {
            snprintf(says, sizeof says, "`%s` is stored as type %d", is_text ? "format" : "tx", (int)type);
            assert_echoes_invalid(says);
            continue;
        }
        assert_ok(echo_file_read(path, &a, &echoes));
        for (int p = 0; p < P && !is_text; p++)
            assert_true(a.tx[p].x == 3 * p + 1 && a.tx[p].y == 3 * p + 2 && a.tx[p].z == 3 * p + 3);
        acquisition_free(&a);
        echoes_free(&echoes);
    }
    made.is_packed = made.is_small = false;
}

/* ---- Version 7.3 ---- */

enum layout {
    WHOLE,
    PACKED,
    EXTERNAL,
    VIRTUAL,
    LINKED,
    UNWRITTEN,
    PART_WRITTEN,
    SHORT_CHUNK,
    SHORT_PACKED,
    SKIPPED,
    NBIT
};

static char beside[200];
static const hsize_t tx_dims[2] = {P, 3};
static const double tx_values[P * 3] = {1, 2, 3, 4, 5, 6, 7, 8, 9};

static void class_add(hid_t set)
{
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, 6);
    const hid_t attribute = H5Acreate2(set, "MATLAB_class", type, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, type, "double") >= 0);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
}

static hid_t settings_make(enum layout layout, hid_t space)
{
    const hid_t settings = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t whole[2] = {P, 3}, row[2] = {1, 3};
    FILE *file;
    if (layout == EXTERNAL) {
        file = fopen(beside, "wb");
        assert_true(file && fwrite(tx_values, 8, 4, file) == 4 && fclose(file) == 0);
        H5Pset_external(settings, beside, 0, sizeof tx_values);
    } else if (layout == VIRTUAL) {
        H5Pset_virtual(settings, space, beside, "/tx", space);
    } else if (layout == PART_WRITTEN) {
        H5Pset_chunk(settings, 2, row);
    } else if (layout != WHOLE && layout != UNWRITTEN && layout != LINKED) {
        H5Pset_chunk(settings, 2, whole);
    }
    if (layout == PACKED) {
        H5Pset_shuffle(settings);
    }
    if (layout == PACKED || layout == SHORT_PACKED || layout == SKIPPED) {
        H5Pset_deflate(settings, 6);
    }
    if (layout == PACKED) {
        H5Pset_fletcher32(settings);
    }
    if (layout == NBIT) {
        H5Pset_nbit(settings);
    }
    return settings;
}

static void values_write(enum layout layout, hid_t set, hid_t space)
{
    const hsize_t start[2] = {0, 0}, rows[2] = {2, 3};
    unsigned char packed[200];
    uLongf length = sizeof packed;
    compress(packed, &length, (const unsigned char *)tx_values, 24);
    if (layout == WHOLE || layout == PACKED || layout == LINKED || layout == NBIT) {
        assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, tx_values) >= 0);
    } else if (layout == PART_WRITTEN) {
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, rows, NULL);
        const hid_t part = H5Screate_simple(2, rows, NULL);
        assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, part, space, H5P_DEFAULT, tx_values) >= 0);
        H5Sclose(part);
    } else if (layout == SHORT_CHUNK || layout == SKIPPED) {
        assert_true(H5Dwrite_chunk(set, H5P_DEFAULT, layout == SKIPPED, start, 32, tx_values) >= 0);
    } else if (layout == SHORT_PACKED) {
        assert_true(H5Dwrite_chunk(set, H5P_DEFAULT, 0, start, length, packed) >= 0);
    }
}

/* An echo file whose `tx` lies in this way. */
static void file_lay(enum layout layout)
{
    Mat_Close(file_begin(MAT_FT_MAT73, false, "tx"));
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t home = layout == LINKED ? H5Fcreate(beside, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT) : file;
    const hid_t space = H5Screate_simple(2, tx_dims, NULL), settings = settings_make(layout, space);
    const hid_t set = H5Dcreate2(home, "tx", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, settings, H5P_DEFAULT);
    assert_true(set >= 0);
    class_add(set);
    values_write(layout, set, space);
    H5Dclose(set);
    H5Sclose(space);
    H5Pclose(settings);
    if (layout == LINKED) {
        assert_true(H5Lcreate_external(beside, "/tx", file, "tx", H5P_DEFAULT, H5P_DEFAULT) >= 0);
        H5Fclose(home);
    }
    H5Fclose(file);
}

static void numbers_that_hdf5_would_make_up_are_refused(void **state)
{
    (void)state;
    static const struct {
        enum layout layout;
        const char *says;
    } cases[] = {
        {WHOLE, NULL},
        {PACKED, NULL},
        {EXTERNAL, "`tx` is kept in another file; numbers in the file itself are needed"},
        {VIRTUAL, "`tx` is kept in another file"},
        {LINKED, "`tx` is kept in another file"},
        {UNWRITTEN, "`tx` has 0 bytes, its dimensions need 72"},
        {PART_WRITTEN, "`tx` has 48 bytes, its dimensions need 72"},
        {SHORT_CHUNK, "`tx` has 32 bytes, its dimensions need 72"},
        {SHORT_PACKED, "`tx` has 24 bytes, its dimensions need 72"},
        {SKIPPED, "`tx` has 32 bytes, its dimensions need 72"},
        {NBIT, "`tx` is packed otherwise"},
    };
    snprintf(beside, sizeof beside, "%s/beside", directory);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct acquisition a;
        struct echoes echoes;
        file_lay(cases[k].layout);
        if (cases[k].says) {
            assert_echoes_invalid(cases[k].says);
        } else {
            assert_ok(echo_file_read(path, &a, &echoes));
            assert_true(a.tx[0].x == 1 && a.tx[P - 1].z == 9);
            acquisition_free(&a);
            echoes_free(&echoes);
        }
        unlink(beside);
    }
}

/* What libmatio cannot read is the end of its list. */
static void what_hides_variables_is_refused(void **state)
{
    (void)state;
    const struct element area = {"area", MAT_C_DOUBLE, MAT_T_DOUBLE, 1, 4, 1, false, 1, {SIZE_MAX}};
    const double nothing = 0;
    struct acquisition a;
    struct echoes echoes;
    file_make(&area, 2);
    assert_ok(echo_file_read(path, &a, &echoes));
    assert_true(a.area.half_r == 4);
    acquisition_free(&a);
    echoes_free(&echoes);
    file_make(&(struct element){"tx_length", MAT_C_DOUBLE, MAT_T_DOUBLE, 1, 1, 1, false, 0.1, {SIZE_MAX}}, 0);
    data_add(MAT_T_DOUBLE, &nothing, sizeof nothing, 8);
    element_add(&area);
    bytes_write(made.bytes, made.size);
    assert_echoes_invalid("holds something that cannot be read before a variable that is needed");
    Mat_Close(file_begin(MAT_FT_MAT73, false, ""));
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t group = H5Gcreate2(file, "group", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(H5Gcreate2(group, "group", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Gclose(group);
    H5Fclose(file);
    assert_echoes_invalid("holds something that cannot be read before a variable that is needed");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_short_element_is_refused),
        cmocka_unit_test(each_stored_type_is_read_or_refused),
        cmocka_unit_test(numbers_that_hdf5_would_make_up_are_refused),
        cmocka_unit_test(what_hides_variables_is_refused),
    };
    mallopt(M_PERTURB, 0xa5);
    return cmocka_run_group_tests(tests, fixture_make, directory_remove);
}
