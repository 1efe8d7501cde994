/* `convert`: AirSAS recordings, against matched filters of their real samples in their own conventions. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/command/convert_fixture.h"

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

static double swing; /* by how much even pings are warmer than 20 degrees, and odd ones colder */

static double celsius_of(int ping)
{
    return ping % 2 ? 20 - swing : 20 + swing;
}

static double speed_of(int ping)
{
    return 331.6 + 0.61 * celsius_of(ping);
}

/* With the tables beside it. */
static void airsas_make(void)
{
    static const struct vector targets[] = {{0.05, 1.3, 1}, {-0.1, 1.15, 0.7}}; /* z: amplitude */
    text_write("acquistionParams.csv", chirp_text);
    text_write("sensorCoordinates.csv", sensor_text);
    memset(&airsas, 0, sizeof airsas);
    airsas.positions = airsas.temperatures = PINGS;
    for (int p = 0; p < PINGS; p++) {
        airsas.position[p] = 0.01 * (p - PINGS / 2);
        airsas.temperature[p] = celsius_of(p) - 0.5;
        airsas.temperature[PINGS + p] = celsius_of(p) + 0.5;
    }
    for (int m = 0; m < MICROPHONES; m++) {
        airsas.pings[m] = PINGS;
        for (int i = 0; i < PINGS * SAMPLES; i++)
            for (size_t n = 0; n < COUNT_OF(targets); n++) {
                const double delay = way(i / SAMPLES, m, targets[n].x, targets[n].y) / speed_of(i / SAMPLES);
                airsas.ts[m][i] +=
                    (float)(targets[n].z * creal(chirp_at((i % SAMPLES - group_delay) / chirp_fs - delay)));
            }
    }
}

static void airsas_write(const char *name)
{
    const struct set sets[] = {
        {"ch1/ts", airsas.pings[0] ? airsas.ts[0] : NULL, true, 2, {airsas.pings[0], SAMPLES}},
        {"ch3/ts", airsas.pings[1] ? airsas.ts[1] : NULL, true, 2, {airsas.pings[1], SAMPLES}},
        {"na/position", airsas.positions ? airsas.position : NULL, false, 1, {airsas.positions}},
        {"na/temperature", airsas.temperatures ? airsas.temperature : NULL, false, 2, {2, airsas.temperatures}}};
    sets_write(name, sets, COUNT_OF(sets), NULL);
}

static const struct raster ahead = {0.018, 1.268, 0.008};

/* Each pixel's matched filter in time, on the real samples. */
static void airsas_sum(double complex *image)
{
    double energy = 0;
    for (int n = 0; n < (int)(chirp_s * chirp_fs); n++)
        energy += pow(cabs(chirp_at(n / chirp_fs)), 2);
    for (int i = 0; i < GRID * GRID; i++)
        for (int p = 0; p < PINGS; p++)
            for (int m = 0; m < MICROPHONES; m++) {
                const double delay = way(p, m, pixel_x(&ahead, i), pixel_r(&ahead, i)) / speed_of(p);
                const int first = (int)ceil(delay * chirp_fs + group_delay);
                for (int n = first; n < SAMPLES && n <= first + chirp_s * chirp_fs; n++)
                    image[i] += 2 / energy * airsas.ts[m][p * SAMPLES + n]
                                * conj(chirp_at((n - group_delay) / chirp_fs - delay));
            }
}

static void airsas_file_focuses(void **state)
{
    (void)state;
    double complex image[GRID * GRID] = {0};
    airsas_make();
    airsas_write("sas.h5");
    airsas_sum(image);
    assert_converted("sas.h5", "AirSAS, 32 pings, 2 receivers, 480 samples\n", &ahead, image);
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
    airsas_make();
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

/* Each ping has its own: the file's echoes are moved to one. */
static void sound_speeds_are_united(void **state)
{
    (void)state;
    double complex image[GRID * GRID] = {0};
    swing = 1;
    airsas_make();
    airsas_write("sas.h5");
    airsas_sum(image);
    assert_converted("sas.h5",
                     "AirSAS, 32 pings, 2 receivers, 480 samples\n"
                     "echoes are compressed, and moved from the sound speeds of the pings to their mean, 343.8 m/s",
                     &ahead, image);
    swing = 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(airsas_file_focuses),
        cmocka_unit_test(airsas_faults_are_named),
        cmocka_unit_test(sound_speeds_are_united),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
