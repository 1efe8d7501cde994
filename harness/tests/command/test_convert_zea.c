/* `convert`: zea's ultrasound, real samples as well as I and Q, against delay and sum by its own conventions. */
#include <math.h>
#include <string.h>

#include "tests/command/convert_fixture.h"

enum { FRAMES = 2, SENT = 3, DEPTHS = 200, ELEMENTS = 8, RECORDS = FRAMES * SENT * ELEMENTS };

/* In HDF5's order. */
struct zea {
    float raw[FRAMES * SENT * DEPTHS * ELEMENTS * 2];
    double probe[ELEMENTS][3], first[SENT], delays[SENT][ELEMENTS], weights[SENT][ELEMENTS], fs, fc, speed, peak;
    unsigned long long channels, elements, sent;
    const char *left_out;
};

static struct zea zea;

/* The delay from sample 0 of a transmission to the echo's peak, from depth z. */
static double zea_delay(int sent, int element, double x, double z)
{
    const int sender = 3 * sent;
    double sum = zea.delays[sent][sender] - zea.first[sent] + zea.peak;
    for (int k = 0; k < 2; k++) {
        const double *place = zea.probe[k ? element : sender];
        sum += sqrt(pow(place[0] - x, 2) + pow(place[1], 2) + pow(place[2] - z, 2)) / zea.speed;
    }
    return sum;
}

/* Element 3 k sends; pulses of three cycles from one target. The second frame is half as strong. */
static void zea_make(int channels)
{
    memset(&zea, 0, sizeof zea);
    zea.fs = 20e6;
    zea.fc = 5e6;
    zea.speed = 1540;
    zea.peak = 0.3e-6;
    zea.channels = (unsigned long long)channels;
    zea.elements = ELEMENTS;
    zea.sent = SENT;
    for (int e = 0; e < ELEMENTS; e++) {
        zea.probe[e][0] = 3e-4 * (e - 3);
        zea.probe[e][1] = e % 2 ? 1e-4 : -1e-4;
    }
    for (int k = 0; k < SENT; k++) {
        zea.first[k] = 4e-6 + 1e-7 * k;
        zea.weights[k][3 * k] = 0.5;
        for (int e = 0; e < ELEMENTS; e++)
            zea.delays[k][e] = 1e-7 * e;
    }
    for (int i = 0; i < RECORDS * DEPTHS; i++) {
        const int element = i % ELEMENTS, depth = i / ELEMENTS % DEPTHS, sent = i / ELEMENTS / DEPTHS % SENT;
        const double after = depth / zea.fs - zea_delay(sent, element, 5e-4, 6e-3);
        const double envelope = exp(-pow(after / 0.25e-6, 2)) * (i < RECORDS * DEPTHS / FRAMES ? 1 : 0.5);
        const double complex turn = cexp(2 * M_PI * I * zea.fc * (channels == 2 ? after - depth / zea.fs : after));
        zea.raw[i * channels] = (float)(envelope * creal(turn));
        if (channels == 2)
            zea.raw[i * channels + 1] = (float)(envelope * cimag(turn));
    }
}

#define ZEA_SETS                                                                                                       \
    {                                                                                                                  \
        {"data/raw_data", zea.raw, true, 5, {FRAMES, SENT, DEPTHS, ELEMENTS, zea.channels}},                           \
            {"scan/probe_geometry", zea.probe, false, 2, {zea.elements, 3}},                                           \
            {"scan/sampling_frequency", &zea.fs, false, 0, {0}}, {"scan/center_frequency", &zea.fc, false, 0, {0}},    \
            {"scan/sound_speed", &zea.speed, false, 0, {0}}, {"scan/initial_times", zea.first, false, 1, {zea.sent}},  \
            {"scan/t0_delays", zea.delays, false, 2, {zea.sent, ELEMENTS}},                                            \
            {"scan/tx_apodizations", zea.weights, false, 2, {zea.sent, ELEMENTS}},                                     \
            {"scan/t_peak", &zea.peak, false, 0, {0}},                                                                 \
    }

static const struct raster below = {4e-4, 5.9e-3, 3e-5};

/* Delay and sum. */
static void zea_sum(double complex *image)
{
    const int channels = (int)zea.channels;
    for (int record = 0; record < RECORDS; record++) {
        const int element = record % ELEMENTS, ping = record / ELEMENTS;
        double complex samples[DEPTHS];
        double delays[GRID * GRID];
        for (int n = 0; n < DEPTHS; n++) {
            const float *raw = zea.raw + ((ping * DEPTHS + n) * ELEMENTS + element) * channels;
            samples[n] = channels == 2 ? raw[0] + I * raw[1] : raw[0];
        }
        for (int i = 0; i < GRID * GRID; i++)
            delays[i] = zea.fs * zea_delay(ping % SENT, element, pixel_x(&below, i), pixel_r(&below, i));
        record_add(samples, DEPTHS, channels == 1, delays, channels == 2 ? zea.fc / zea.fs : 0, image);
    }
}

static void zea_files_focus(void **state)
{
    (void)state;
    for (int channels = 1; channels <= 2; channels++) {
        double complex image[GRID * GRID] = {0};
        zea_make(channels);
        const struct set sets[] = ZEA_SETS;
        sets_write("echo.hdf5", sets, COUNT_OF(sets), NULL);
        zea_sum(image);
        assert_converted("echo.hdf5",
                         channels == 1 ? "zea ultrasound, 6 pings, 8 receivers, 100 samples\nbandwidth is stated"
                                       : "zea ultrasound, 6 pings, 8 receivers, 200 samples\nbandwidth is stated",
                         &below, image);
    }
}

static void assert_zea_refused(const char *field, const char *reason)
{
    const struct set sets[] = ZEA_SETS;
    ASSERT_SETS_REFUSED(sets, zea.left_out, field, reason);
}

static void zea_faults_are_named(void **state)
{
    (void)state;
    static const char *const needed[] = {"data/raw_data",         "scan/probe_geometry", "scan/sampling_frequency",
                                         "scan/center_frequency", "scan/sound_speed",    "scan/initial_times",
                                         "scan/t0_delays",        "scan/tx_apodizations"};
    zea_make(1);
    const struct zea good = zea;
    for (size_t k = 0; k < COUNT_OF(needed); k++) {
        zea.left_out = needed[k];
        assert_zea_refused(needed[k], "is missing");
    }
    zea = good;
    for (int e = 0; e < ELEMENTS; e++)
        zea.weights[1][e] = 1;
    assert_zea_refused("scan/tx_apodizations",
                       "of transmission 2 has 8 elements that send, as plane and focused waves");
    memset(zea.weights, 0, sizeof zea.weights);
    assert_zea_refused("scan/tx_apodizations", "of transmission 1 has 0 elements");
    zea = good;
    zea.sent = 2;
    assert_zea_refused("scan/initial_times", "is [2 x 1 x 1], of 8 elements and 3 transmissions");
    zea = good;
    zea.elements = 7;
    assert_zea_refused("scan/probe_geometry", "is [3 x 7 x 1], of 8");
    zea = good;
    zea.fc = 10e6;
    assert_zea_refused("scan/center_frequency", "is 1e+07 Hz, `scan/sampling_frequency` 2e+07 Hz");
    zea = good;
    zea.delays[2][6] = NAN;
    assert_zea_refused("scan/t0_delays", "at (7, 3, 1) is nan");
    zea = good;
    zea.raw[5] = INFINITY;
    assert_zea_refused("data/raw_data", "is inf");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(zea_files_focus),
        cmocka_unit_test(zea_faults_are_named),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
