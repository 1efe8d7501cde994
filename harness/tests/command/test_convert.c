/* `convert`: AFRL Gotcha phase history becomes an echo file, whose image is that of a direct sum over the layout's own
   numbers in its own conventions, which shares no code with ours. What is no recording is refused. */
#include <math.h>
#include <matio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/command/convert_fixture.h"

enum { FREQUENCIES = 240, PULSES = 40, FP = 0, FREQ, X, Y, Z, R0, FIELDS };

/* A file as it is to be written. */
struct gotcha {
    float fp[2][PULSES * FREQUENCIES]; /* parts */
    double numbers[FIELDS][FREQUENCIES];
    size_t rows[FIELDS], columns[FIELDS];
    bool left_out[FIELDS];
};

static struct gotcha gotcha;
static const double light_speed = 299792458;

static double antenna_distance(int pulse, double x, double y)
{
    return sqrt(pow(gotcha.numbers[X][pulse] - x, 2) + pow(gotcha.numbers[Y][pulse] - y, 2)
                + pow(gotcha.numbers[Z][pulse], 2));
}

/* An arc about the scene, seen from pulse `first` of two passes on; r0 is a little off the distance, as in autofocused
   data. */
static void gotcha_make(int first)
{
    static const struct {
        double x, y, amplitude;
    } targets[] = {{0.3, -0.6, 1}, {-0.9, 0.3, 0.5}};
    memset(&gotcha, 0, sizeof gotcha);
    for (int k = 0; k < FIELDS; k++) {
        gotcha.rows[k] = k == FREQ ? FREQUENCIES : k == FP ? FREQUENCIES : 1;
        gotcha.columns[k] = k == FREQ ? 1 : PULSES;
    }
    for (int k = 0; k < FREQUENCIES; k++)
        gotcha.numbers[FREQ][k] = 9.3e9 + 2.5e6 * k;
    for (int p = 0; p < PULSES; p++) {
        const double azimuth = 4e-4 * (first + p - PULSES);
        gotcha.numbers[X][p] = 7000 * sin(azimuth);
        gotcha.numbers[Y][p] = -7000 * cos(azimuth);
        gotcha.numbers[Z][p] = 7200 + 0.1 * p;
        gotcha.numbers[R0][p] = antenna_distance(p, 0, 0) + 0.05 * sin(p);
        for (int k = 0; k < FREQUENCIES; k++) {
            double complex sum = 0;
            for (size_t n = 0; n < COUNT_OF(targets); n++)
                sum += targets[n].amplitude
                       * cexp(-4 * M_PI * I * gotcha.numbers[FREQ][k] / light_speed
                              * (antenna_distance(p, targets[n].x, targets[n].y) - gotcha.numbers[R0][p]));
            gotcha.fp[0][p * FREQUENCIES + k] = (float)creal(sum);
            gotcha.fp[1][p * FREQUENCIES + k] = (float)cimag(sum);
        }
    }
}

static void gotcha_write(const char *name, enum mat_ft version, enum matio_compression packed)
{
    static const char *const names[FIELDS] = {"fp", "freq", "x", "y", "z", "r0"};
    const char *given[FIELDS];
    unsigned count = 0;
    for (int k = 0; k < FIELDS; k++)
        if (!gotcha.left_out[k])
            given[count++] = names[k];
    mat_t *mat = Mat_CreateVer(path_in(name), NULL, version);
    assert_non_null(mat);
    matvar_t *data = Mat_VarCreateStruct("data", 2, (size_t[]){1, 1}, given, count);
    for (int k = 0; k < FIELDS; k++) {
        size_t dims[] = {gotcha.rows[k], gotcha.columns[k]};
        mat_complex_split_t parts = {gotcha.fp[0], gotcha.fp[1]};
        if (gotcha.left_out[k])
            continue;
        const bool is_complex = k == FP && dims[1] > 0; /* libmatio crashes on an empty one */
        Mat_VarSetStructFieldByName(
            data, names[k], 0,
            is_complex ? Mat_VarCreate(NULL, MAT_C_SINGLE, MAT_T_SINGLE, 2, dims, &parts, MAT_F_COMPLEX)
                       : Mat_VarCreate(NULL, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, gotcha.numbers[k], 0));
    }
    assert_int_equal(Mat_VarWrite(mat, data, packed), 0);
    Mat_VarFree(data);
    Mat_Close(mat);
}

static const struct raster around_centre = {-1.2, -1.2, 0.3};

/* Each pixel's matched filter in frequency. */
static void gotcha_sum(double complex *image)
{
    for (int i = 0; i < GRID * GRID; i++)
        for (int p = 0; p < PULSES; p++) {
            const double range = antenna_distance(p, pixel_x(&around_centre, i), pixel_r(&around_centre, i));
            for (int k = 0; k < FREQUENCIES; k++)
                image[i] +=
                    (gotcha.fp[0][p * FREQUENCIES + k] + I * gotcha.fp[1][p * FREQUENCIES + k]) / FREQUENCIES
                    * cexp(4 * M_PI * I * gotcha.numbers[FREQ][k] / light_speed * (range - gotcha.numbers[R0][p]));
        }
}

static void gotcha_files_focus(void **state)
{
    (void)state;
    static const char *const one[ARGUMENTS_MAX] = {"convert", "pass 'one'.mat", "-o", "one.mat"};
    static const char *const both[ARGUMENTS_MAX] = {"convert", "pass 'one'.mat", "two.mat", "-o", "both.mat"};
    static const char *const new[ARGUMENTS_MAX] = {"convert", "new.mat", "-o", "newer.mat"};
    double complex image[GRID * GRID] = {0};
    gotcha_make(0);
    gotcha_write("pass 'one'.mat", MAT_FT_MAT5, MAT_COMPRESSION_ZLIB);
    gotcha_write("new.mat", MAT_FT_MAT73, MAT_COMPRESSION_NONE);
    gotcha_sum(image);
    free(program_output(one));
    assert_image("one.mat", &around_centre, image);
    free(program_output(new));
    assert_image("newer.mat", &around_centre, image);
    gotcha_make(PULSES);
    gotcha_write("two.mat", MAT_FT_MAT5, MAT_COMPRESSION_NONE);
    gotcha_sum(image);
    char *told = program_output(both);
    assert_string_equal(told, "both.mat: AFRL Gotcha phase history, 80 pings, 1 receiver, 315 samples\n");
    free(told);
    assert_image("both.mat", &around_centre, image);
}

static void assert_gotcha_refused(const char *good, const char *field, const char *reason)
{
    static const enum mat_ft versions[] = {MAT_FT_MAT5, MAT_FT_MAT73};
    char name[80];
    snprintf(name, sizeof name, "data/%s", field);
    for (size_t k = 0; k < COUNT_OF(versions); k++) {
        gotcha_write("bad.mat", versions[k], MAT_COMPRESSION_NONE);
        assert_field_refused(good, "bad.mat", name, reason);
    }
}

static void gotcha_faults_are_named(void **state)
{
    (void)state;
    static const char *const names[FIELDS] = {"fp`", "freq`", "x`", "y`", "z`", "r0`"};
    gotcha_make(0);
    gotcha_write("right.mat", MAT_FT_MAT5, MAT_COMPRESSION_ZLIB);
    const struct gotcha good = gotcha;
    for (int k = 0; k < FIELDS; k++, gotcha = good) {
        gotcha.left_out[k] = true;
        assert_gotcha_refused(NULL, names[k], "is missing; a ");
        gotcha = good;
        gotcha.columns[k] = 0;
        assert_gotcha_refused(NULL, names[k], "is empty; a ");
        gotcha = good;
        if (k == FP)
            gotcha.fp[1][FREQUENCIES + 2] = NAN;
        else
            gotcha.numbers[k][2] = INFINITY;
        assert_gotcha_refused(NULL, names[k], k == FP ? "at (3, 2, 1) is " : "is inf");
        gotcha = good;
        if (k == FREQ)
            gotcha.rows[k]--;
        else
            gotcha.columns[k]--;
        assert_gotcha_refused(NULL, k == FP ? "x` is [1 x 40 x 1]" : names[k],
                              k == FP ? "data/fp [240 x 39]" : "data/fp [240 x 40]");
    }
    gotcha.numbers[FREQ][100] += 1e4;
    assert_gotcha_refused(NULL, "freq` at place 101 is 9550010000 Hz", "0.004 steps of 2500000 Hz off");
    gotcha = good;
    for (int k = 0; k < FREQUENCIES; k++)
        gotcha.numbers[FREQ][k] *= 1 + 1e-6;
    assert_gotcha_refused("right.mat", "freq` has 240 frequencies from 9300009300 Hz",
                          "right.mat 240 from 9300000000 Hz");
    gotcha = good;
    gotcha.numbers[R0][3] = -gotcha.numbers[R0][3];
    assert_gotcha_refused(NULL, "r0` at place 4 is -100", "> 0");
}

static void strange_files_are_refused(void **state)
{
    (void)state;
    static const struct refusal refusals[] = {
        {{"convert", "text.mat", "-o", "none.mat"}, {"text.mat: is neither a MATLAB file", "nor HDF5"}},
        {{"convert", "cut.mat", "-o", "none.mat"}, {"cut.mat: is cut short or damaged"}},
        {{"convert", "cut.h5", "-o", "none.mat"}, {"cut.h5: is cut short or damaged"}},
        {{"convert", "sub", "-o", "none.mat"}, {"sub: is not a regular file"}},
        {{"convert", "nothing.mat", "-o", "none.mat"}, {"nothing.mat: cannot be read: No such file"}},
        {{"convert", "good.mat", "-o", "none.mat"},
         {"good.mat: has no field of a known layout", "Gotcha phase history (data/fp"}},
        {{"convert", "kept.mat", "-o", "kept.mat"}, {"kept.mat is the recording itself"}},
        {{"convert", "kept.mat", "good.mat", "-o", "none.mat"}, {"good.mat: has no field of a known layout"}},
        {{"convert", "kept.mat", "-o", "none.png"}, {"none.png has another ending"}},
        {{"convert", "kept.mat", "uneven.mat", "-o", "none.mat"}, {"uneven.mat: variable `data/freq`"}},
        {{"convert", "kept.mat"}, {"-o FILE.mat is missing"}},
        {{"convert", "-o", "none.mat"}, {"an argument is missing"}},
    };
    size_t size;
    gotcha_make(0);
    gotcha_write("kept.mat", MAT_FT_MAT5, MAT_COMPRESSION_NONE);
    gotcha.numbers[FREQ][100] += 1e4;
    gotcha_write("uneven.mat", MAT_FT_MAT5, MAT_COMPRESSION_NONE);
    char *bytes = bytes_read("kept.mat", &size);
    bytes_write("cut.mat", bytes, size / 2);
    free(bytes);
    gotcha_write("whole.h5", MAT_FT_MAT73, MAT_COMPRESSION_NONE);
    bytes = bytes_read("whole.h5", &size);
    bytes_write("cut.h5", bytes, size / 2);
    free(bytes);
    text_write("text.mat", "no numbers\n");
    assert_int_equal(system("mkdir \"$TMPDIR/sub\" && ln -s nowhere \"$TMPDIR/nothing.mat\""), 0);
    assert_all_refused(refusals, COUNT_OF(refusals));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gotcha_files_focus),
        cmocka_unit_test(gotcha_faults_are_named),
        cmocka_unit_test(strange_files_are_refused),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
