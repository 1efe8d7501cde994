/* MATLAB files: what is written comes back, what MATLAB may write is read. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/echoes/mat_fixture.h"

static void assert_same_echoes(const struct echoes *written, const struct echoes *read)
{
    const struct acquisition *a = written->acquisition, *b = read->acquisition;
    const double scalars[][2] = {
        {a->sound_speed, b->sound_speed},
        {a->fc, b->fc},
        {a->fs, b->fs},
        {a->bandwidth, b->bandwidth},
        {a->samples, b->samples},
        {a->receivers, b->receivers},
        {a->pings, b->pings},
        {a->pri, b->pri},
        {a->tx_length, b->tx_length},
        {a->rx_length, b->rx_length},
        {a->aperture_limit, b->aperture_limit},
        {a->echo_sine, b->echo_sine},
        {a->echo_tapers, b->echo_tapers},
        {a->echo_squint, b->echo_squint},
        {a->area.x, b->area.x},
        {a->area.r, b->area.r},
        {a->area.half_x, b->area.half_x},
        {a->area.half_r, b->area.half_r},
        {a->compressed, b->compressed},
        {a->pulse_length, b->pulse_length},
    };
    for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++) {
        assert_true(scalars[i][0] == scalars[i][1]);
    }
    size_t pings = (size_t)a->pings, records = pings * (size_t)a->receivers;
    assert_memory_equal(a->t0, b->t0, pings * sizeof *a->t0);
    assert_memory_equal(a->tx, b->tx, pings * sizeof *a->tx);
    assert_memory_equal(a->velocity, b->velocity, pings * sizeof *a->velocity);
    assert_memory_equal(a->rx, b->rx, records * sizeof *a->rx);
    if (!a->compressed) {
        assert_memory_equal(a->pulse, b->pulse, (size_t)a->pulse_length * sizeof *a->pulse);
    }
    struct echoes doubles;
    assert_ok(echoes_convert(written, PRECISION_DOUBLE, &doubles));
    assert_int_equal(read->precision, PRECISION_DOUBLE);
    assert_int_equal((uintptr_t)read->samples % 64, 0);
    assert_memory_equal(doubles.samples, read->samples, records * (size_t)a->samples * sizeof(double complex));
    echoes_free(&doubles);
}

static void assert_round_trip(struct acquisition *a, enum precision precision)
{
    struct acquisition b;
    struct echoes written, read;
    assert_ok(echoes_allocate(a, precision, &written));
    fill_echoes(&written);
    assert_ok(echo_file_write(path, &written, &(struct echo_notes){.description = "round trip"}));
    assert_ok(echo_file_read(path, &b, &read));
    assert_ptr_equal(read.acquisition, &b);
    assert_same_echoes(&written, &read);
    acquisition_free(&b);
    echoes_free(&written);
    echoes_free(&read);
}

static void echoes_of_every_shape_come_back(void **state)
{
    (void)state;
    const struct {
        int samples, receivers, pings;
    } shapes[] = {{5, 3, 4}, {2, 1, 1}, {7, 1, 3}, {6, 4, 1}, {3, 3, 3}, {1000, 5, 9}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        for (int variant = 0; variant < 4; variant++) {
            struct acquisition a =
                make_acquisition(shapes[i].samples, shapes[i].receivers, shapes[i].pings, variant & 1);
            assert_round_trip(&a, variant & 2 ? PRECISION_FLOAT : PRECISION_DOUBLE);
            acquisition_free(&a);
        }
    }
}

static void what_varies_from_ping_to_ping_comes_back(void **state)
{
    (void)state;
    struct acquisition a = make_acquisition(5, 2, 3, false);
    a.t0[1] = 0.06;
    assert_round_trip(&a, PRECISION_DOUBLE);
    a.velocity[2].y = -1;
    assert_round_trip(&a, PRECISION_DOUBLE);
    a.tx_length = a.rx_length = 0;
    a.aperture_limit = INFINITY;
    assert_round_trip(&a, PRECISION_DOUBLE);
    acquisition_free(&a);
}

static const struct grid grids[] = {
    {-1, 0.02, 3, 40, 0.5, 4, 0.3}, {0.1, 1, 1, -2, 0.1, 6}, {0.1, 0.3, 5, 7, 1, 1}, {3, 1, 1, 4, 1, 1}};

static const struct image_origin origin = {.algorithm = "bp_linear",
                                           .options = "beta=8",
                                           .scene = "of/here",
                                           .engine = "invariant",
                                           .scene_hash = "0123456789abcdef",
                                           .commit = "4fedc99",
                                           .date = "2026-11-25T09:45:24Z",
                                           .fc = 150e3,
                                           .sound_speed = 1500.25};

static void images_come_back_as_matlab_has_them(void **state)
{
    (void)state;
    for (int precision = PRECISION_FLOAT; precision <= PRECISION_DOUBLE; precision++) {
        struct image image;
        assert_ok(image_allocate(4, grids, (enum precision)precision, &image));
        for (int patch = 0; patch < 4; patch++) {
            const struct grid *grid = &grids[patch];
            for (int i = 0; i < grid->r_count * grid->x_count; i++) {
                if (precision == PRECISION_FLOAT) {
                    ((float complex *)image.pixels[patch])[i] = (float)i / 3 + 2 * I;
                } else {
                    ((double complex *)image.pixels[patch])[i] = i / 3.0 + 2 * I;
                }
            }
            struct image one = {1, grid, image.precision, &image.pixels[patch]};
            assert_ok(image_file_write(path, &one, &origin));

            struct grid back;
            double complex *pixels;
            assert_ok(image_file_read(path, &back, &pixels));
            assert_int_equal(back.x_count, grid->x_count);
            assert_int_equal(back.r_count, grid->r_count);
            assert_true(back.x_first == grid->x_first && back.r_first == grid->r_first);
            assert_true(back.angle_rad == grid->angle_rad);
            assert_true(fabs(back.x_step - grid->x_step) < 1e-12 || grid->x_count == 1);
            assert_true(fabs(back.r_step - grid->r_step) < 1e-12 || grid->r_count == 1);
            for (int i = 0; i < grid->r_count; i++) {
                for (int j = 0; j < grid->x_count; j++) {
                    assert_true(pixels[i * grid->x_count + j] == image_pixel(&image, patch, i, j));
                }
            }
            free(pixels);

            mat_t *mat = Mat_Open(path, MAT_ACC_RDONLY);
            matvar_t *matvar = Mat_VarRead(mat, "image");
            const mat_complex_split_t *parts = matvar->data;
            assert_int_equal(matvar->rank, 2);
            assert_int_equal(matvar->dims[0], grid->r_count);
            assert_int_equal(matvar->dims[1], grid->x_count);
            assert_int_equal(matvar->class_type, precision == PRECISION_FLOAT ? MAT_C_SINGLE : MAT_C_DOUBLE);
            if (patch == 0 && precision == PRECISION_DOUBLE) { /* second row, first column */
                assert_true(((const double *)parts->Re)[1] == creal(image_pixel(&image, 0, 1, 0)));
            }
            Mat_VarFree(matvar);
            matvar = Mat_VarRead(mat, "algorithm");
            assert_int_equal(matvar->class_type, MAT_C_CHAR);
            assert_memory_equal(matvar->data, "bp_linear", 9);
            Mat_VarFree(matvar);
            Mat_Close(mat);
        }
        image_free(&image);
    }
}

/* All patches of a file, with what it says of itself; a patch that lacks an axis is refused. */
static void all_patches_come_back(void **state)
{
    (void)state;
    struct image image;
    struct image_file file;
    assert_ok(image_allocate(4, grids, PRECISION_DOUBLE, &image));
    for (int patch = 0; patch < 4; patch++) {
        ((double complex *)image.pixels[patch])[0] = patch + 1;
    }
    assert_ok(image_file_write(path, &image, &origin));
    assert_ok(image_file_open(path, &file));
    assert_int_equal(file.image.patch_count, 4);
    for (int patch = 0; patch < 4; patch++) {
        const struct grid *back = &file.image.patches[patch];
        assert_int_equal(back->x_count * back->r_count, grids[patch].x_count * grids[patch].r_count);
        assert_true(back->x_first == grids[patch].x_first && back->r_first == grids[patch].r_first);
        assert_true(back->angle_rad == grids[patch].angle_rad);
        assert_true(image_pixel(&file.image, patch, 0, 0) == patch + 1);
    }
    assert_memory_equal(&file.origin, &origin, sizeof origin);
    image_file_close(&file);
    const struct image_origin little = {.algorithm = "bp_nearest", .fc = NAN, .sound_speed = NAN}; /* no options */
    assert_ok(image_file_write(path, &image, &little));
    bool is = false;
    assert_ok(image_file_is(path, &is));
    assert_true(is);
    assert_ok(image_file_open(path, &file));
    assert_string_equal(file.origin.algorithm, "bp_nearest");
    assert_string_equal(file.origin.options, "");
    assert_true(isnan(file.origin.fc) && isnan(file.origin.sound_speed));
    image_file_close(&file);
    image_free(&image);

    static const char *const names[] = {"image", "x", "r", "image_2", "x_2"};
    static const double value[2] = {1, 2};
    for (int count = 3; count <= 5; count += 2) {
        mat_t *mat = Mat_CreateVer(path, NULL, MAT_FT_MAT5);
        for (int k = 0; k < count; k++) {
            variable_add(mat, &(struct mat_values){names[k], MAT_C_DOUBLE, MAT_T_DOUBLE, {1, 1, 1}, value, NULL}, true);
        }
        Mat_Close(mat);
        assert_int_equal(image_file_open(path, &file), count == 3 ? STATUS_OK : STATUS_INVALID);
        if (count == 3) { /* says nothing of itself */
            assert_string_equal(file.origin.date, "");
            assert_true(isnan(file.origin.fc));
            image_file_close(&file);
        }
    }
    assert_non_null(strstr(status_message(), "variable `r_2` is missing"));
}

static void both_versions_are_read(void **state)
{
    (void)state;
    const enum mat_ft versions[] = {MAT_FT_MAT5, MAT_FT_MAT73};
    for (int i = 0; i < 4; i++) {
        Mat_Close(file_begin(versions[i / 2], i % 2, ""));
        struct acquisition a;
        struct echoes echoes;
        assert_ok(echo_file_read(path, &a, &echoes));
        assert_int_equal(a.samples, N);
        assert_int_equal(a.receivers, M);
        assert_int_equal(a.pings, P);
        assert_true(a.t0[P - 1] == 0.1 && a.velocity[P - 1].z == 1e-3 * 3 && a.tx_length == 0.1);
        assert_true(a.rx_length == 0 && isinf(a.aperture_limit) && a.pulse_length == K);
        assert_true(a.echo_squint == 0 && a.area.half_x == 0); /* as files have it that do not say */
        assert_true(a.rx[2 * M + 1].y == 1e-3 * (3 * (2 * M + 1) + 2));
        assert_true(((const double complex *)echoes.samples)[N * M * P - 1] == 1e-3 * (N * M * P) * (1 + I));
        acquisition_free(&a);
        echoes_free(&echoes);
    }
}

static void other_classes_and_shapes_are_read(void **state)
{
    (void)state;
    const int16_t integers[N * M * P] = {-3, 4, 5};
    const float single = 30e3f;
    const double t0[P] = {0.1, 0.2, 0.3}, velocity[3 * P] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    const uint16_t format[] = {'s', 'a', 's', '-', 'e', 'c', 'h', 'o', 'e', 's', ' ', '1'};
    const enum mat_ft versions[] = {MAT_FT_MAT5, MAT_FT_MAT73};
    for (int i = 0; i < 2; i++) {
        struct acquisition a;
        struct echoes echoes;
        const char *const excepts[] = {"samples", "fs", "t0", "velocity", "format", "pulse"};
        for (int k = 0; k < 6; k++) {
            mat_t *mat = file_begin(versions[i], true, excepts[k]);
            switch (k) {
            case 0:
                variable_add(mat, &(struct mat_values){"samples", MAT_C_INT16, MAT_T_INT16, {N, M, P}, integers, NULL},
                             true);
                break;
            case 1:
                variable_add(mat, &(struct mat_values){"fs", MAT_C_SINGLE, MAT_T_SINGLE, {1, 1, 1}, &single, NULL},
                             true);
                break;
            case 2:
                variable_add(mat, &(struct mat_values){"t0", MAT_C_DOUBLE, MAT_T_DOUBLE, {P, 1, 1}, t0, NULL}, true);
                break;
            case 3:
                variable_add(
                    mat, &(struct mat_values){"velocity", MAT_C_DOUBLE, MAT_T_DOUBLE, {3, P, 1}, velocity, NULL}, true);
                break;
            case 4:
                variable_add(mat, &(struct mat_values){"format", MAT_C_CHAR, MAT_T_UINT16, {1, 12, 1}, format, NULL},
                             true);
                break;
            default:
                variable_add(mat, &(struct mat_values){"pulse", MAT_C_DOUBLE, MAT_T_DOUBLE, {1, 3, 1}, t0, NULL}, true);
            }
            Mat_Close(mat);
            assert_ok(echo_file_read(path, &a, &echoes));
            const double complex *samples = echoes.samples;
            assert_true(k != 0 || (samples[0] == -3 && samples[1] == 4 && samples[3] == 0));
            assert_true(k != 1 || a.fs == 30e3);
            assert_true(k != 2 || (a.t0[0] == 0.1 && a.t0[2] == 0.3));
            assert_true(k != 3 || (a.velocity[1].x == 3 && a.velocity[2].z == 8));
            assert_true(k != 5 || (a.pulse_length == 3 && a.pulse[2] == 0.3));
            acquisition_free(&a);
            echoes_free(&echoes);
        }
    }
}

/* The image of echoes does not depend on the unit that pulse and samples share, and a padded text is the text. */
static void extreme_pulses_are_brought_to_one(void **state)
{
    (void)state;
    const double powers[] = {1, 0x1p-500, 0x1p500, 0x1p-140};
    double complex first[N * M * P], pulse[K];
    for (int i = 0; i < 4; i++) {
        double values[MOST];
        for (int k = 0; k < MOST; k++) {
            values[k] = powers[i] * 0.9 / (k + 1);
        }
        mat_t *mat = file_begin(MAT_FT_MAT73, true, "format");
        variable_add(
            mat, &(struct mat_values){"format", MAT_C_CHAR, MAT_T_UTF8, {1, 16, 1}, "sas-echoes 1\0\0\0", NULL}, true);
        Mat_VarDelete(mat, "pulse");
        Mat_VarDelete(mat, "samples");
        variable_add(mat, &(struct mat_values){"samples", MAT_C_DOUBLE, MAT_T_DOUBLE, {N, M, P}, values, values}, true);
        variable_add(mat, &(struct mat_values){"pulse", MAT_C_DOUBLE, MAT_T_DOUBLE, {K, 1, 1}, values, values}, true);
        Mat_Close(mat);
        struct acquisition a;
        struct echoes echoes;
        assert_ok(echo_file_read(path, &a, &echoes));
        if (i == 0) {
            memcpy(first, echoes.samples, sizeof first);
            memcpy(pulse, a.pulse, sizeof pulse);
        }
        assert_memory_equal(echoes.samples, first, sizeof first);
        assert_memory_equal(a.pulse, pulse, sizeof pulse);
        acquisition_free(&a);
        echoes_free(&echoes);
    }
}

static void unknown_variables_are_ignored(void **state)
{
    (void)state;
    const enum mat_ft versions[] = {MAT_FT_MAT5, MAT_FT_MAT73};
    for (int i = 0; i < 2; i++) {
        mat_t *mat = file_begin(versions[i], true, "samples");
        size_t dims[2] = {1, 1};
        const char *fields[] = {"samples", NULL};
        matvar_t *matvar = Mat_VarCreateStruct2("note", 2, dims, fields);
        double values[MOST] = {1};
        Mat_VarSetStructFieldByName(matvar, "samples", 0,
                                    Mat_VarCreate("samples", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values, 0));
        Mat_VarWrite(mat, matvar, MAT_COMPRESSION_ZLIB);
        Mat_VarFree(matvar);
        variable_add(mat, &(struct mat_values){"description", MAT_C_DOUBLE, MAT_T_DOUBLE, {2, 2, 1}, values, NULL},
                     true);
        variable_add(mat, &(struct mat_values){"samples", MAT_C_DOUBLE, MAT_T_DOUBLE, {N, M, P}, values, NULL}, true);
        Mat_Close(mat);
        struct acquisition a;
        struct echoes echoes;
        assert_ok(echo_file_read(path, &a, &echoes));
        assert_true(((const double complex *)echoes.samples)[0] == 1);
        acquisition_free(&a);
        echoes_free(&echoes);
    }
}

static void recorded_files_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int samples, receivers, pings;
    } files[] = {{"pins_in_water.mat", 350, 32, 32}, {"gotcha_4deg.mat", 512, 1, 469}};
    const char *data = getenv("SASBENCH_DATA");
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char name[4096];
        snprintf(name, sizeof name, "%s/%s", data ? data : "", files[i].name);
        if (!data || access(name, R_OK) != 0) {
            print_message("SASBENCH_DATA does not hold %s\n", files[i].name);
            skip();
        }
        struct acquisition a;
        struct echoes echoes;
        assert_ok(echo_file_read(name, &a, &echoes));
        assert_int_equal(a.samples, files[i].samples);
        assert_int_equal(a.receivers, files[i].receivers);
        assert_int_equal(a.pings, files[i].pings);
        assert_true(a.compressed);
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

/* Shapes that MATLAB, Octave and SciPy leave when one dimension is 1, and coordinates in rows, are what they can only
   be. */
static void unambiguous_shapes_are_taken(void **state)
{
    (void)state;
    enum { SAMPLES = 6, PINGS = 4 };
    double samples[SAMPLES * PINGS], tx[3 * PINGS], rx[3 * PINGS];
    static const double velocity[] = {1.5, 0, 0}, scalars[] = {1, 30e3, 100e3, 20e3, 1500, 0.01};
    static const char *const names[] = {"compressed", "fs", "fc", "bandwidth", "sound_speed", "t0"};
    for (int k = 0; k < SAMPLES * PINGS; k++)
        samples[k] = k + 1;
    for (int in_rows = 0; in_rows < 2; in_rows++) {
        struct acquisition a;
        struct echoes echoes;
        for (int p = 0; p < PINGS; p++)
            for (int c = 0; c < 3; c++) {
                const int at = in_rows ? c * PINGS + p : 3 * p + c; /* MATLAB's order */
                tx[at] = c == 0 ? 0.1 * p : c;
                rx[at] = c == 0 ? 0.1 * p + 0.03 : c;
            }
        const size_t rows = in_rows ? PINGS : 3, columns = in_rows ? 3 : PINGS;
        mat_t *mat = Mat_CreateVer(path, NULL, MAT_FT_MAT5);
        variable_add(mat, &(struct mat_values){"format", MAT_C_CHAR, MAT_T_UTF8, {1, 12, 1}, "sas-echoes 1", NULL},
                     true);
        for (int k = 0; k < 6; k++)
            variable_add(mat, &(struct mat_values){names[k], MAT_C_DOUBLE, MAT_T_DOUBLE, {1, 1, 1}, &scalars[k], NULL},
                         true);
        variable_add(mat,
                     &(struct mat_values){"samples", MAT_C_DOUBLE, MAT_T_DOUBLE, {SAMPLES, PINGS, 1}, samples, samples},
                     true);
        variable_add(mat, &(struct mat_values){"tx", MAT_C_DOUBLE, MAT_T_DOUBLE, {rows, columns, 1}, tx, NULL}, true);
        variable_add(mat, &(struct mat_values){"rx", MAT_C_DOUBLE, MAT_T_DOUBLE, {rows, columns, 1}, rx, NULL}, true);
        variable_add(mat,
                     &(struct mat_values){
                         "velocity", MAT_C_DOUBLE, MAT_T_DOUBLE, {in_rows ? 1 : 3, in_rows ? 3 : 1, 1}, velocity, NULL},
                     true);
        Mat_Close(mat);
        assert_ok(echo_file_read(path, &a, &echoes));
        assert_true(a.samples == SAMPLES && a.receivers == 1 && a.pings == PINGS);
        for (int p = 0; p < PINGS; p++) {
            assert_true(a.tx[p].x == 0.1 * p && a.tx[p].y == 1 && a.tx[p].z == 2);
            assert_true(a.rx[p].x == 0.1 * p + 0.03 && a.rx[p].y == 1 && a.rx[p].z == 2);
            assert_true(a.velocity[p].x == 1.5 && a.velocity[p].y == 0);
            assert_true(creal(((const double complex *)echoes.samples)[SAMPLES * p + 2]) == SAMPLES * p + 3);
        }
        echoes_free(&echoes);
        acquisition_free(&a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(echoes_of_every_shape_come_back),
        cmocka_unit_test(what_varies_from_ping_to_ping_comes_back),
        cmocka_unit_test(images_come_back_as_matlab_has_them),
        cmocka_unit_test(all_patches_come_back),
        cmocka_unit_test(both_versions_are_read),
        cmocka_unit_test(other_classes_and_shapes_are_read),
        cmocka_unit_test(extreme_pulses_are_brought_to_one),
        cmocka_unit_test(unknown_variables_are_ignored),
        cmocka_unit_test(recorded_files_are_read),
        cmocka_unit_test(unambiguous_shapes_are_taken),
    };
    return cmocka_run_group_tests(tests, fixture_make, directory_remove);
}
