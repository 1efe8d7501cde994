/* `convert`: files in each layout, of known targets, become echo files. Their image is that of a direct sum over the
   layout's own numbers in its own conventions, which shares no code with ours. */
#include <complex.h>
#include <hdf5.h>
#include <math.h>
#include <matio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "convert/layouts.h"
#include "tests/command/program.h"

enum { GRID = 9 }; /* pixels along each axis */

/* Where they begin, m. */
struct raster {
    double x, r, step;
};

static double pixel_x(const struct raster *raster, int pixel)
{
    return raster->x + raster->step * (pixel % GRID);
}

static double pixel_r(const struct raster *raster, int pixel)
{
    return raster->r + raster->step * (pixel / GRID);
}

/* The image of an echo file against one that was summed here. */
static void assert_image(const char *echoes, const struct raster *raster, const double complex *wanted)
{
    char text[100];
    const char *const image[ARGUMENTS_MAX] = {
        "image", "--echoes", echoes, "--grid", text, "-a", "reference:precision=double", "-o", "image.mat"};
    struct grid grid;
    double complex *pixels;
    double error = 0, energy = 0;
    snprintf(text, sizeof text, "%g:%g:%d,%g:%g:%d", raster->x, raster->step, GRID, raster->r, raster->step, GRID);
    free(program_output(image));
    assert_int_equal(image_file_read(path_in("image.mat"), &grid, &pixels), STATUS_OK);
    assert_int_equal(grid.x_count * grid.r_count, GRID * GRID);
    for (int k = 0; k < GRID * GRID; k++) {
        error += pow(cabs(pixels[k] - wanted[k]), 2);
        energy += pow(cabs(wanted[k]), 2);
    }
    free(pixels);
    print_message("%s: error %.2g\n", echoes, sqrt(error / energy));
    if (!(error <= 1e-6 * energy))
        fail_msg("%s: error %g, at most 1e-3 is accepted", echoes, sqrt(error / energy));
}

/* --- AFRL Gotcha ----------------------------------------------------------------------------------------------- */

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
    assert_string_equal(told, "AFRL Gotcha phase history: 80 pings, 1 receiver, 315 samples\n");
    free(told);
    assert_image("both.mat", &around_centre, image);
}

/* A file is refused for a field, without a process of its own for each; strange_files_are_refused has those. */
static void assert_field_refused(const char *good, const char *bad, const char *field, const char *reason)
{
    char paths[2][600], begin[700];
    const char *const both[] = {paths[0], paths[1]};
    struct recording recording;
    snprintf(paths[0], sizeof *paths, "%s", path_in(good ? good : bad));
    snprintf(paths[1], sizeof *paths, "%s", path_in(bad));
    snprintf(begin, sizeof begin, "%s: variable `%s", paths[1], field);
    const enum status status = recording_read(both, good ? 2 : 1, &recording);
    if (status != STATUS_INVALID || strncmp(status_message(), begin, strlen(begin)) != 0
        || !strstr(status_message(), reason) || strchr(status_message(), '\n'))
        fail_msg("status %d, '%s', not '%s ... %s'", status, status_message(), begin, reason);
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

/* --- AirSAS ---------------------------------------------------------------------------------------------------- */

enum { SAMPLES = 1200, PINGS = 32, MICROPHONES = 2 };

/* A recording by microphones 1 and 3. */
struct airsas {
    float ts[MICROPHONES][PINGS * SAMPLES];
    double position[PINGS], temperature[2 * PINGS]; /* of one sensor, then of the other */
    size_t pings[MICROPHONES], positions, temperatures;
};

static struct airsas airsas;
static const double chirp_fs = 100e3, chirp_s = 1e-3, group_delay = 12.5, image_z = 0.6032;
static const struct vector speaker = {0.02, 0, 0.9}, microphones[MICROPHONES] = {{0.1, 0.01, 0.95}, {-0.08, 0, 1}};
static const char chirp_text[] = "parameter,value\nfs,100000\ndelay,12.5\n,\n,\n,\n,\n,\nstart,30e3\nstop,10e3\n"
                                 "length,1e-3\namplitude,1\n,\nshape,0.2\n";
static const char sensor_text[] = "sensor,x,y,z\nspeaker,0.02,0,0.9\nm1,0.1,0.01,0.95\nm2,0,0,0\nm3,-0.08,0,1\n";

/* The chirp as a complex number: 30 to 10 kHz, tapered over a tenth at each end. */
static double complex chirp_at(double t)
{
    const double edge = fmin(t, chirp_s - 1 / chirp_fs - t) / (chirp_s - 1 / chirp_fs);
    if (edge < 0)
        return 0;
    return (edge < 0.1 ? 0.5 - 0.5 * cos(10 * M_PI * edge) : 1) * cexp(2 * M_PI * I * (30e3 - 10e6 * t) * t) / I;
}

static double way(int ping, int microphone, double x, double y)
{
    double sum = 0;
    for (int k = 0; k < 2; k++) {
        const struct vector place = k ? microphones[microphone] : speaker;
        sum += sqrt(pow(place.x + airsas.position[ping] - x, 2) + pow(place.y - y, 2) + pow(place.z - image_z, 2));
    }
    return sum;
}

static void airsas_make(double celsius)
{
    static const struct vector targets[] = {{0.05, 1.3, 1}, {-0.1, 1.15, 0.7}}; /* z: amplitude */
    memset(&airsas, 0, sizeof airsas);
    airsas.positions = airsas.temperatures = PINGS;
    for (int p = 0; p < PINGS; p++) {
        airsas.position[p] = 0.01 * (p - PINGS / 2);
        airsas.temperature[p] = celsius - 0.5;
        airsas.temperature[PINGS + p] = celsius + 0.5;
    }
    for (int m = 0; m < MICROPHONES; m++) {
        airsas.pings[m] = PINGS;
        for (int i = 0; i < PINGS * SAMPLES; i++)
            for (size_t n = 0; n < COUNT_OF(targets); n++) {
                const double delay = way(i / SAMPLES, m, targets[n].x, targets[n].y) / (331.6 + 0.61 * celsius);
                airsas.ts[m][i] +=
                    (float)(targets[n].z * creal(chirp_at((i % SAMPLES - group_delay) / chirp_fs - delay)));
            }
    }
}

/* A data set, in HDF5's order. */
static void set_write(hid_t file, const char *name, hid_t type, int rank, const hsize_t *dims, const void *values)
{
    const hid_t links = H5Pcreate(H5P_LINK_CREATE), space = H5Screate_simple(rank, dims, NULL);
    H5Pset_create_intermediate_group(links, 1);
    const hid_t set = H5Dcreate2(file, name, type, space, links, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Dclose(set);
    H5Sclose(space);
    H5Pclose(links);
}

static void airsas_write(const char *name)
{
    const hid_t file = H5Fcreate(path_in(name), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    for (int m = 0; m < MICROPHONES; m++)
        if (airsas.pings[m] > 0)
            set_write(file, m ? "ch3/ts" : "ch1/ts", H5T_NATIVE_FLOAT, 2, (hsize_t[]){airsas.pings[m], SAMPLES},
                      airsas.ts[m]);
    if (airsas.positions > 0)
        set_write(file, "na/position", H5T_NATIVE_DOUBLE, 1, (hsize_t[]){airsas.positions}, airsas.position);
    if (airsas.temperatures > 0)
        set_write(file, "na/temperature", H5T_NATIVE_DOUBLE, 2, (hsize_t[]){2, airsas.temperatures},
                  airsas.temperature);
    H5Fclose(file);
}

static const struct raster ahead = {0.018, 1.268, 0.008};

/* Each pixel's matched filter in time, on the real samples. */
static void airsas_sum(double celsius, double complex *image)
{
    double energy = 0;
    for (int n = 0; n < (int)(chirp_s * chirp_fs); n++)
        energy += pow(cabs(chirp_at(n / chirp_fs)), 2);
    for (int i = 0; i < GRID * GRID; i++)
        for (int p = 0; p < PINGS; p++)
            for (int m = 0; m < MICROPHONES; m++) {
                const double delay = way(p, m, pixel_x(&ahead, i), pixel_r(&ahead, i)) / (331.6 + 0.61 * celsius);
                const int first = (int)ceil(delay * chirp_fs + group_delay);
                for (int n = first; n < SAMPLES && n <= first + chirp_s * chirp_fs; n++)
                    image[i] += 2 / energy * airsas.ts[m][p * SAMPLES + n]
                                * conj(chirp_at((n - group_delay) / chirp_fs - delay));
            }
}

static void airsas_file_focuses(void **state)
{
    (void)state;
    static const char *const convert[ARGUMENTS_MAX] = {"convert", "sas.h5", "-o", "sas.mat"};
    double complex image[GRID * GRID] = {0};
    text_write("acquistionParams.csv", chirp_text);
    text_write("sensorCoordinates.csv", sensor_text);
    airsas_make(20);
    airsas_write("sas.h5");
    airsas_sum(20, image);
    char *told = program_output(convert);
    print_message("%s", told);
    free(told);
    assert_image("sas.mat", &ahead, image);
}

static void assert_airsas_refused(const char *field, const char *reason)
{
    airsas_write("bad.h5");
    assert_field_refused(NULL, "bad.h5", field, reason);
}

static void airsas_faults_are_named(void **state)
{
    (void)state;
    static const struct refusal tables[] = {
        {{"convert", "alone/sas.h5", "-o", "none.mat"}, {"alone/sas.h5: acquistionParams.csv is missing", "beside"}},
        {{"convert", "sas.h5", "-o", "none.mat"}, {"acquistionParams.csv: row 8, column 2 is 'fast'", "first freq"}}};
    static const struct refusal chirps[] = {
        {{"convert", "sas.h5", "-o", "none.mat"}, {"from 30000 to 60000 Hz (rows 8, 9)", "half the sampling rate"}},
        {{"convert", "sas.h5", "sas.h5", "-o", "none.mat"}, {"sas.h5: is AirSAS, of which one file", "2 are given"}}};
    static const struct refusal sensors[] = {
        {{"convert", "sas.h5", "-o", "none.mat"}, {"sensorCoordinates.csv: row 4, column 2 is ''", "microphone"}}};
    text_write("acquistionParams.csv", chirp_text);
    text_write("sensorCoordinates.csv", sensor_text);
    airsas_make(20);
    airsas_write("sas.h5");
    const struct airsas good = airsas;
    airsas.pings[0] = airsas.pings[1] = 0;
    assert_airsas_refused("ch1/ts`", "is missing, and so are ch2 to ch4");
    airsas = good;
    airsas.pings[1]--;
    assert_airsas_refused("ch3/ts`", "is [1200 x 31 x 1], ch1/ts [1200 x 32 x 1]");
    airsas = good;
    airsas.ts[1][SAMPLES + 4] = NAN;
    assert_airsas_refused("ch3/ts`", "at (5, 2, 1) is nan");
    airsas = good;
    airsas.positions = 0;
    assert_airsas_refused("na/position`", "is missing");
    airsas.positions = PINGS - 1;
    assert_airsas_refused("na/position`", "is [31 x 1 x 1], ch1/ts [1200 x 32 x 1]");
    airsas = good;
    airsas.temperatures = 0;
    assert_airsas_refused("na/temperature`", "is missing");
    airsas.temperatures = PINGS - 1;
    assert_airsas_refused("na/temperature`", "is [31 x 2 x 1]");
    airsas = good;
    airsas.temperature[3] = airsas.temperature[PINGS + 3] = 293;
    assert_airsas_refused("na/temperature`", "of ping 4 is 293");
    text_write("acquistionParams.csv", "name,value\na,1e5\nb,0\n,\n,\n,\n,\n,\nc,fast\n");
    assert_int_equal(system("mkdir \"$TMPDIR/alone\" && cp \"$TMPDIR/sas.h5\" \"$TMPDIR/alone\""), 0);
    assert_all_refused(tables, COUNT_OF(tables));
    text_write("acquistionParams.csv", "a,1e5\nb,0\n,\n,\n,\n,\n,\nc,3e4\nd,6e4\ne,1e-3\n,\n,\nf,0.2\n");
    assert_all_refused(chirps, COUNT_OF(chirps));
    text_write("acquistionParams.csv", chirp_text);
    text_write("sensorCoordinates.csv", "sensor,x,y,z\n,0,0,0\n,0,0,0\n,0,0,0\n");
    assert_all_refused(sensors, COUNT_OF(sensors));
}

/* One sound speed stands for all: half the pings are 0.61 m/s above the mean of 343.19 m/s, half below. */
static void sound_speeds_are_averaged(void **state)
{
    (void)state;
    static const char *const convert[ARGUMENTS_MAX] = {"convert", "sas.h5", "-o", "sas.mat"};
    double speed, phase, range;
    text_write("acquistionParams.csv", chirp_text);
    text_write("sensorCoordinates.csv", sensor_text);
    airsas_make(20);
    for (int p = 0; p < PINGS; p++)
        for (int k = 0; k < 2; k++)
            airsas.temperature[k * PINGS + p] = p % 2 ? 18 : 20;
    airsas_write("sas.h5");
    char *told = program_output(convert);
    const char *note = strstr(told, "sound speed ");
    assert_non_null(note);
    assert_int_equal(sscanf(note,
                            "sound speed %lf m/s, the mean of all pings; their own would turn phases by up to %lf "
                            "rad at %lf m",
                            &speed, &phase, &range),
                     3);
    assert_true(fabs(speed - 343.19) < 0.01);
    assert_true(fabs(range - 343.19 / 2 * (SAMPLES - group_delay) / chirp_fs) < 0.01);
    assert_true(fabs(phase - 2 * M_PI * 20e3 * (2 * range / (343.19 - 0.61) - 2 * range / 343.19)) < 0.05);
    free(told);
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
        cmocka_unit_test(gotcha_files_focus),        cmocka_unit_test(gotcha_faults_are_named),
        cmocka_unit_test(airsas_file_focuses),       cmocka_unit_test(airsas_faults_are_named),
        cmocka_unit_test(sound_speeds_are_averaged), cmocka_unit_test(strange_files_are_refused),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
