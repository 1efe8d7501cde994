/* `convert`: USTB's UFF, real samples as well as I and Q, against delay and sum by its own conventions. */
#include <math.h>
#include <string.h>

#include "tests/command/convert_fixture.h"

enum { FRAMES = 2, WAVES = 3, ELEMENTS = 8, DEPTHS = 200, RECORDS = FRAMES * WAVES * ELEMENTS, OF_WAVE = 6 };

enum { DISTANCE, AZIMUTH, ELEVATION, WAVEFRONT, DELAY, SPEED };

/* In HDF5's order; all numbers are single there. */
struct uff {
    float real[RECORDS * DEPTHS], imag[RECORDS * DEPTHS], geometry[7][ELEMENTS], waves[WAVES][OF_WAVE];
    float fs, first, speed, modulation, centre;
    unsigned long long samples, elements;
    bool is_complex;
    int count; /* of waves */
    const char *left_out;
};

static struct uff uff;

/* From time zero of a wave's records to the echo of (x, 0, z): the source's time zero is when its wave passes the
   origin, and `delay` what the records begin later than others. */
static double uff_delay(int wave, int element, double x, double z)
{
    const float *w = uff.waves[wave];
    const double source[] = {w[DISTANCE] * sin(w[AZIMUTH]) * cos(w[ELEVATION]), w[DISTANCE] * sin(w[ELEVATION]),
                             w[DISTANCE] * cos(w[AZIMUTH]) * cos(w[ELEVATION])};
    double sum = source[2] < -1e-3 ? -w[DISTANCE] : w[DISTANCE];
    sum += sqrt(pow(source[0] - x, 2) + pow(source[1], 2) + pow(source[2] - z, 2));
    sum += sqrt(pow(uff.geometry[0][element] - x, 2) + pow(uff.geometry[1][element], 2)
                + pow(uff.geometry[2][element] - z, 2));
    return sum / uff.speed - w[DELAY];
}

/* Elements 0, 3 and 6 send, the last from behind the origin; pulses of three cycles from one target. The second frame
   is half as strong. */
static void uff_make(bool is_complex)
{
    memset(&uff, 0, sizeof uff);
    uff.fs = 20e6F;
    uff.first = 5e-6F;
    uff.speed = 1540;
    uff.modulation = is_complex ? 5e6F : 0;
    uff.centre = 4.5e6F;
    uff.samples = DEPTHS;
    uff.elements = ELEMENTS;
    uff.is_complex = is_complex;
    uff.count = WAVES;
    for (int e = 0; e < ELEMENTS; e++) {
        uff.geometry[0][e] = 3e-4F * (float)(e - 3);
        uff.geometry[1][e] = e % 2 ? 1e-4F : -1e-4F;
        uff.geometry[2][e] = e == 6 ? -1.2e-3F : 0;
        uff.geometry[5][e] = 2.5e-4F;
    }
    for (int k = 0; k < WAVES; k++) {
        const double x = uff.geometry[0][3 * k], y = uff.geometry[1][3 * k], z = uff.geometry[2][3 * k];
        const double distance = sqrt(x * x + y * y + z * z);
        const float wave[OF_WAVE] = {(float)distance,
                                     (float)atan2(x, z),
                                     (float)asin(y / distance),
                                     1,
                                     (float)(distance / uff.speed) - 1e-7F * (float)k,
                                     uff.speed};
        memcpy(uff.waves[k], wave, sizeof wave);
    }
    for (int i = 0; i < RECORDS * DEPTHS; i++) {
        const int element = i / DEPTHS % ELEMENTS, wave = i / DEPTHS / ELEMENTS % WAVES;
        const double time = uff.first + i % DEPTHS / uff.fs, after = time - uff_delay(wave, element, 5e-4, 6e-3);
        const double envelope = exp(-pow(after / 0.25e-6, 2)) * (i < RECORDS * DEPTHS / FRAMES ? 1 : 0.5);
        const double complex turn = envelope * cexp(2 * M_PI * I * (5e6 * after - uff.modulation * time));
        uff.real[i] = (float)creal(turn);
        uff.imag[i] = (float)cimag(turn);
    }
}

static void uff_write(const char *file)
{
    static const char *const of_wave[OF_WAVE] = {"source/distance", "source/azimuth", "source/elevation",
                                                 "wavefront",       "delay",          "sound_speed"};
    char names[WAVES * OF_WAVE][80];
    const unsigned long long waves = (unsigned long long)uff.count, frames = FRAMES * WAVES / waves;
    const struct set data = {"channel_data/data/real", uff.real, true, 4, {frames, waves, ELEMENTS, uff.samples}};
    struct set sets[9 + WAVES * OF_WAVE] = {
        data,
        data,
        {"channel_data/probe/geometry", uff.geometry, true, 2, {7, uff.elements}},
        {"channel_data/sampling_frequency", &uff.fs, true, 2, {1, 1}},
        {"channel_data/initial_time", &uff.first, true, 2, {1, 1}},
        {"channel_data/sound_speed", &uff.speed, true, 2, {1, 1}},
        {"channel_data/modulation_frequency", &uff.modulation, true, 2, {1, 1}},
        {"channel_data/pulse/center_frequency", uff.centre > 0 ? &uff.centre : NULL, true, 2, {1, 1}}};
    sets[1].name = "channel_data/data/imag";
    sets[1].values = uff.is_complex ? uff.imag : NULL;
    if (!uff.is_complex)
        sets[0].name = "channel_data/data";
    for (int k = 0; k < WAVES * OF_WAVE; k++) {
        char group[40] = "";
        if (uff.count > 1)
            snprintf(group, sizeof group, "sequence_%04d/", k / OF_WAVE + 1);
        snprintf(names[k], sizeof *names, "channel_data/sequence/%s%s", group, of_wave[k % OF_WAVE]);
        if (k < uff.count * OF_WAVE || uff.count == 2)
            sets[9 + k] = (struct set){names[k], &uff.waves[k / OF_WAVE][k % OF_WAVE], true, 2, {1, 1}};
    }
    sets_write(file, sets, COUNT_OF(sets), uff.left_out);
}

static const struct raster below = {4e-4, 5.9e-3, 3e-5};

static void uff_sum(double complex *image)
{
    for (int record = 0; record < RECORDS; record++) {
        const int element = record % ELEMENTS, wave = record / ELEMENTS % uff.count;
        double complex samples[DEPTHS];
        double delays[GRID * GRID];
        for (int n = 0; n < DEPTHS; n++)
            samples[n] = uff.real[record * DEPTHS + n] + I * (uff.is_complex ? uff.imag[record * DEPTHS + n] : 0);
        /* I and Q turn with the time from zero on, of which a record begins at `first`. */
        for (int n = 0; n < DEPTHS && uff.is_complex; n++)
            samples[n] *= cexp(2 * M_PI * I * uff.modulation * uff.first);
        for (int i = 0; i < GRID * GRID; i++)
            delays[i] = uff.fs * (uff_delay(wave, element, pixel_x(&below, i), pixel_r(&below, i)) - uff.first);
        record_add(samples, DEPTHS, !uff.is_complex, delays, uff.modulation / uff.fs, image);
    }
}

static void uff_files_focus(void **state)
{
    (void)state;
    static const struct {
        bool is_complex;
        int waves;
        float centre;
        const char *told;
    } files[] = {{false, WAVES, 0, "USTB ultrasound (UFF), 6 pings, 8 receivers, 100 samples\nbandwidth is stated"},
                 {false, WAVES, 4.9e6F, "USTB ultrasound (UFF), 6 pings, 8 receivers, 98 samples\nbandwidth"},
                 {true, WAVES, 0, "USTB ultrasound (UFF), 6 pings, 8 receivers, 200 samples\nbandwidth is stated"},
                 {true, 1, 0, "USTB ultrasound (UFF), 6 pings, 8 receivers, 200 samples\nbandwidth is stated"}};
    for (size_t k = 0; k < COUNT_OF(files); k++) {
        double complex image[GRID * GRID] = {0};
        uff_make(files[k].is_complex);
        uff.count = files[k].waves;
        uff.centre = files[k].centre;
        uff_write("data 'a'.uff");
        uff_sum(image);
        assert_converted("data 'a'.uff", files[k].told, &below, image);
    }
}

static void assert_uff_refused(const char *field, const char *reason)
{
    char name[80];
    snprintf(name, sizeof name, "channel_data/%s`", field);
    uff_write("bad.h5");
    assert_field_refused(NULL, "bad.h5", name, reason);
}

static void uff_faults_are_named(void **state)
{
    (void)state;
    static const char *const needed[] = {"data/imag",    "probe/geometry",
                                         "initial_time", "sampling_frequency",
                                         "sound_speed",  "sequence/sequence_0002/source/azimuth"};
    uff_make(true);
    const struct uff good = uff;
    for (size_t k = 0; k < COUNT_OF(needed); k++) {
        char name[80];
        snprintf(name, sizeof name, "channel_data/%s", needed[k]);
        uff.left_out = name;
        assert_uff_refused(needed[k], "is missing");
    }
    uff = good;
    uff.waves[1][WAVEFRONT] = 0;
    assert_uff_refused("sequence/sequence_0002/wavefront", "is 0, a plane wave");
    uff.waves[1][WAVEFRONT] = 2;
    assert_uff_refused("sequence/sequence_0002/wavefront", "is 2, a photoacoustic one");
    uff = good;
    uff.waves[2][DISTANCE] = INFINITY;
    assert_uff_refused("sequence/sequence_0003/source/distance", "is inf m, of a plane wave");
    uff = good;
    uff.waves[0][DISTANCE] = 0.02F;
    assert_uff_refused("sequence/sequence_0001/source/distance", "wavelengths from the nearest element");
    uff = good;
    uff.waves[0][AZIMUTH] = NAN;
    assert_uff_refused("sequence/sequence_0001/source/azimuth", "at (1, 1, 1) is nan");
    uff = good;
    uff.waves[0][SPEED] = 1480;
    assert_uff_refused("sequence/sequence_0001/sound_speed", "is 1480 m/s, `channel_data/sound_speed` 1540 m/s");
    uff = good;
    uff.count = 2;
    assert_uff_refused("sequence/sequence_0003/source/distance", "is of wave 3, but the data have 2 waves");
    uff = good;
    uff.elements = 7;
    assert_uff_refused("probe/geometry", "is [7 x 7 x 1], channel_data/data/real [200 x 8 x 3 x 2]");
    uff = good;
    uff.samples = 1;
    assert_uff_refused("data/real", "is [1 x 8 x 3 x 2]");
    uff = good;
    uff.modulation = 0;
    assert_uff_refused("modulation_frequency", "is 0 Hz of complex data");
    uff = good;
    uff.imag[7] = NAN;
    assert_uff_refused("data/imag", "is nan");
    uff_make(false);
    uff.modulation = 5e6F;
    assert_uff_refused("modulation_frequency", "is 5e+06 Hz of real data");
    uff_make(false);
    uff.real[7] = INFINITY;
    assert_uff_refused("data", "at (8, 1, 1) is inf");
    uff_make(false);
    uff.centre = 10e6F;
    assert_uff_refused("pulse/center_frequency", "is 1e+07 Hz, `channel_data/sampling_frequency` 2e+07 Hz");
    uff.left_out = "channel_data/data";
    assert_uff_refused("data", "is missing");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(uff_files_focus),
        cmocka_unit_test(uff_faults_are_named),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
