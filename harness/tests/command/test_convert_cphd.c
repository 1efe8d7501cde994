/* `convert`: CPHD in both domains, against matched filters in the file's own earth-centred coordinates, where the
   receiver moves on while the echo of a pixel is awaited. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "convert/layouts.h"
#include "tests/command/convert_fixture.h"

enum { VECTORS = 24, SAMPLES = 240, WORDS = 24, XML_MOST = 8000 };

enum {
    TX_TIME,
    TX_POS,
    TX_VEL = 4,
    RCV_TIME = 7,
    RCV_POS,
    RCV_VEL = 11,
    SRP = 14,
    FDOP = 17,
    FX1,
    FX2,
    SC0,
    SCSS,
    AMP
};

/* A file as it is to be written. */
struct cphd {
    bool is_toa, is_planar;
    int sign, channels;
    const char *format, *head;
    double words[VECTORS][WORDS]; /* parameters */
    double complex signal[VECTORS * SAMPLES];
    char xml[XML_MOST];
    size_t cut; /* bytes that are missing at the end */
};

static struct cphd cphd;
static const double light = 299792458, latitude = 0.7, longitude = -1.4, height = 250;
static struct vector origin, axes[3]; /* of the image area, earth-centred */

static struct vector ecf(double lat, double lon)
{
    const double e2 = 0.00669437999014, n = 6378137 / sqrt(1 - e2 * pow(sin(lat), 2));
    return (struct vector){(n + height) * cos(lat) * cos(lon), (n + height) * cos(lat) * sin(lon),
                           (n * (1 - e2) + height) * sin(lat)};
}

static struct vector local(double x, double y, double z)
{
    struct vector sum = origin;
    const double steps[] = {x, y, z};
    for (int k = 0; k < 3; k++) {
        sum.x += steps[k] * axes[k].x;
        sum.y += steps[k] * axes[k].y;
        sum.z += steps[k] * axes[k].z;
    }
    return sum;
}

static double word_distance(const double *place, struct vector point)
{
    return sqrt(pow(place[0] - point.x, 2) + pow(place[1] - point.y, 2) + pow(place[2] - point.z, 2));
}

/* How much later than that of the reference point an echo arrives, s. */
static double later(int vector, double x, double y)
{
    const double *w = cphd.words[vector];
    const struct vector point = local(x, y, 0), reference = {w[SRP], w[SRP + 1], w[SRP + 2]};
    const double way = word_distance(w + TX_POS, reference) + word_distance(w + RCV_POS, reference);
    double delay = 0;
    for (int k = 0; k < 5; k++) {
        const double place[] = {w[RCV_POS] + w[RCV_VEL] * delay, w[RCV_POS + 1] + w[RCV_VEL + 1] * delay,
                                w[RCV_POS + 2] + w[RCV_VEL + 2] * delay};
        delay = (word_distance(w + TX_POS, point) + word_distance(place, point) - way) / light;
    }
    return delay;
}

static void words_put(double *to, struct vector v)
{
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
}

/* x of the image area runs 0.3 rad north of east. */
static void axes_find(double steps[2][2])
{
    const double turn = 0.3, d = 1e-4;
    const struct vector north = vector_difference(ecf(latitude + d, longitude), ecf(latitude - d, longitude));
    const struct vector east = vector_difference(ecf(latitude, longitude + d), ecf(latitude, longitude - d));
    const double n = vector_norm(north), e = vector_norm(east);
    for (int k = 0; k < 2; k++) {
        const double c = k ? -sin(turn) : cos(turn), s = k ? cos(turn) : sin(turn);
        axes[k] = (struct vector){c * east.x / e + s * north.x / n, c * east.y / e + s * north.y / n,
                                  c * east.z / e + s * north.z / n};
        steps[k][0] = s * 2 * d / n;
        steps[k][1] = c * 2 * d / e;
    }
    axes[2] = (struct vector){cos(latitude) * cos(longitude), cos(latitude) * sin(longitude), sin(latitude)};
    origin = ecf(latitude, longitude);
}

static void element(char *xml, const char *path, const char *text)
{
    char copy[200];
    int depth = 0;
    const char *names[10];
    snprintf(copy, sizeof copy, "%s", path);
    for (char *name = strtok(copy, "/"); name; name = strtok(NULL, "/"), depth++) {
        names[depth] = name;
        sprintf(xml + strlen(xml), "<c:%s>", name);
    }
    strcat(xml, text);
    while (depth-- > 0)
        sprintf(xml + strlen(xml), "</c:%s>", names[depth]);
    strcat(xml, "\n");
}

static void element_number(char *xml, const char *path, const char *name, double number)
{
    char whole[200], text[40];
    snprintf(whole, sizeof whole, "%s/%s", path, name);
    snprintf(text, sizeof text, " %.15g ", number);
    element(xml, whole, text);
}

static void place_element(char *xml, const char *path, struct vector place)
{
    element_number(xml, path, "X", place.x);
    element_number(xml, path, "Y", place.y);
    element_number(xml, path, "Z", place.z);
}

static int sample_bytes(void)
{
    return strcmp(cphd.format, "CF8") == 0 ? 8 : strcmp(cphd.format, "CI4") == 0 ? 4 : 2;
}

static void xml_make(double steps[2][2])
{
#define SCENE "SceneCoordinates/"
    static const struct {
        const char *name;
        int size;
    } parameters[] = {{"TxTime", 1}, {"TxPos", 3},  {"TxVel", 3}, {"RcvTime", 1}, {"RcvPos", 3},
                      {"RcvVel", 3}, {"SRPPos", 3}, {"aFDOP", 1}, {"FX1", 1},     {"FX2", 1},
                      {"SC0", 1},    {"SCSS", 1},   {"AmpSF", 1}};
    char *xml = cphd.xml, name[80];
    strcpy(xml, "<?xml version=\"1.0\"?>\n<c:CPHD xmlns:c=\"http://api.nsgreg.nga.mil/schema/cphd/1.1.0\">\n");
    element(xml, "Global/DomainType", cphd.is_toa ? "TOA" : "FX");
    element(xml, "Global/SGN", cphd.sign > 0 ? "+1" : "-1");
    place_element(xml, SCENE "IARP/ECF", origin);
    element_number(xml, SCENE "IARP/LLH", "Lat", latitude * 180 / M_PI);
    element_number(xml, SCENE "IARP/LLH", "Lon", longitude * 180 / M_PI);
    element_number(xml, SCENE "IARP/LLH", "HAE", height);
    for (int k = 0; k < 2; k++) {
        if (cphd.is_planar)
            place_element(xml, k ? SCENE "ReferenceSurface/Planar/uIAY" : SCENE "ReferenceSurface/Planar/uIAX",
                          axes[k]);
        for (int i = 0; i < 2 && !cphd.is_planar; i++)
            element_number(xml, k ? SCENE "ReferenceSurface/HAE/uIAYLL" : SCENE "ReferenceSurface/HAE/uIAXLL",
                           i ? "Lon" : "Lat", steps[k][i]);
    }
    element(xml, "Data/SignalArrayFormat", cphd.format);
    element_number(xml, "Data", "NumBytesPVP", 8 * WORDS);
    for (int k = 0; k < cphd.channels; k++) { /* the last one is the reference */
        const int ours = k == cphd.channels - 1;
        element(xml, "Data/Channel/Identifier", ours ? "main" : "other");
        element_number(xml, "Data/Channel", "NumVectors", ours ? VECTORS : 1);
        element_number(xml, "Data/Channel", "NumSamples", SAMPLES);
        element_number(xml, "Data/Channel", "SignalArrayByteOffset", k * SAMPLES * sample_bytes());
        element_number(xml, "Data/Channel", "PVPArrayByteOffset", k * 8 * WORDS);
    }
    element(xml, "Channel/RefChId", "main");
    for (int k = 0, word = 0; k < (int)COUNT_OF(parameters); k++) {
        snprintf(name, sizeof name, "PVP/%s", parameters[k].name);
        element_number(xml, name, "Offset", word);
        element_number(xml, name, "Size", parameters[k].size);
        strcat(name, "/Format");
        element(xml, name, parameters[k].size == 3 ? "X=F8;Y=F8;Z=F8;" : "F8");
        word += parameters[k].size;
    }
    strcat(xml, "</c:CPHD>\n");
}

/* Bands begin in three places; the reference point lies some thirty metres beside the targets. */
static void words_make(int v)
{
    double *w = cphd.words[v];
    const double azimuth = 4e-4 * (v - VECTORS / 2);
    const struct vector reference = local(20 + 0.1 * v, 15, 1),
                        ahead = {axes[0].x * 7000, axes[0].y * 7000, axes[0].z * 7000};
    w[TX_TIME] = 1 + 1e-3 * v;
    words_put(w + TX_POS, local(7000 * sin(azimuth), -7000 * cos(azimuth), 7200));
    words_put(w + RCV_POS, local(7000 * sin(azimuth) + 300, -6500, 7000 + v));
    words_put(w + RCV_VEL, ahead);
    words_put(w + SRP, reference);
    w[RCV_TIME] =
        w[TX_TIME] + 2e-8 + (word_distance(w + TX_POS, reference) + word_distance(w + RCV_POS, reference)) / light;
    w[FDOP] = 5e-6 * (v % 2);
    w[FX1] = 9.3e9 + 1e6 * (v % 3);
    w[FX2] = w[FX1] + 6e8;
    w[SC0] = cphd.is_toa ? -1.7e-7 : w[FX1];
    w[SCSS] = cphd.is_toa ? 1 / 7.5e8 : 2.5e6;
    w[AMP] = strcmp(cphd.format, "CF8") == 0 ? 0.5 : strcmp(cphd.format, "CI4") == 0 ? 1e-4 : 0.02;
}

/* As the file holds it: whole numbers, or floats. */
static double held(double part, double factor)
{
    return strcmp(cphd.format, "CF8") == 0 ? (float)(part / factor) : round(part / factor);
}

static void cphd_make(bool is_toa, int sign, const char *format, bool is_planar, int channels)
{
    static const struct vector targets[] = {{0.3, -0.6, 1}, {-0.9, 0.3, 0.5}}; /* z: amplitude */
    double steps[2][2];
    memset(&cphd, 0, sizeof cphd);
    cphd.is_toa = is_toa;
    cphd.sign = sign;
    cphd.format = format;
    cphd.is_planar = is_planar;
    cphd.channels = channels;
    cphd.head = "CPHD/1.1.0";
    axes_find(steps);
    xml_make(steps);
    for (int v = 0; v < VECTORS; v++) {
        const double *w = cphd.words[v];
        words_make(v);
        for (int k = 0; k < SAMPLES; k++) {
            double complex sum = 0;
            for (size_t n = 0; n < COUNT_OF(targets); n++) {
                const double delay = later(v, targets[n].x, targets[n].y), at = w[SC0] + k * w[SCSS];
                const double x = M_PI * (w[FX2] - w[FX1]) * (at - delay), lobe = is_toa ? sin(x) / x : 1;
                const double cycles = (is_toa ? (w[FX1] + w[FX2]) / 2 : at) * (1 + w[FDOP]) * delay;
                sum += targets[n].z * lobe * cexp(2 * M_PI * I * sign * cycles);
            }
            cphd.signal[v * SAMPLES + k] = held(creal(sum), w[AMP]) + I * held(cimag(sum), w[AMP]);
        }
    }
}

static unsigned char *big_endian(unsigned char *to, uint64_t number, int bytes)
{
    for (int k = bytes - 1; k >= 0; k--)
        *to++ = (unsigned char)(number >> 8 * k);
    return to;
}

static unsigned char *part_put(unsigned char *to, double part)
{
    const float single = (float)part;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    const int bytes = sample_bytes() / 2;
    return big_endian(to, bytes == 4 ? bits : (uint64_t)(int64_t)part, bytes);
}

static void cphd_write(const char *name)
{
    const size_t others = (size_t)cphd.channels - 1, xml = strlen(cphd.xml), first = 600;
    const size_t parameters = (VECTORS + others) * 8 * WORDS,
                 signal = (VECTORS + others) * SAMPLES * (size_t)sample_bytes(), pvp = first + xml + 2;
    unsigned char *bytes = calloc(pvp + parameters + signal, 1), *to = bytes + pvp + others * 8 * WORDS;
    assert_non_null(bytes);
    sprintf(
        (char *)bytes,
        "%s\nXML_BLOCK_SIZE := %zu\nXML_BLOCK_BYTE_OFFSET := %zu\nPVP_BLOCK_SIZE := %zu\nPVP_BLOCK_BYTE_OFFSET := %zu\n"
        "SIGNAL_BLOCK_SIZE := %zu\nSIGNAL_BLOCK_BYTE_OFFSET := %zu\nCLASSIFICATION := none\nRELEASE_INFO := none\n\f\n",
        cphd.head, xml, first, parameters, pvp, signal, pvp + parameters);
    memcpy(bytes + first, cphd.xml, xml);
    memcpy(bytes + first + xml, "\f\n", 2);
    for (int k = 0; k < VECTORS * WORDS; k++) {
        uint64_t bits;
        memcpy(&bits, &cphd.words[k / WORDS][k % WORDS], sizeof bits);
        to = big_endian(to, bits, 8);
    }
    to += others * SAMPLES * (size_t)sample_bytes();
    for (int k = 0; k < VECTORS * SAMPLES; k++)
        to = part_put(part_put(to, creal(cphd.signal[k])), cimag(cphd.signal[k]));
    assert_int_equal(to - bytes, pvp + parameters + signal);
    bytes_write(name, bytes, (size_t)(to - bytes) - cphd.cut);
    free(bytes);
}

static const struct raster around_centre = {-1.2, -1.2, 0.3};

/* Matched filters: in frequency, or of the records between their samples. */
static void cphd_sum(double complex *image)
{
    for (int v = 0; v < VECTORS; v++) {
        const double *w = cphd.words[v], middle = (w[FX1] + w[FX2]) / 2 * (1 + w[FDOP]);
        double complex record[SAMPLES];
        double delays[GRID * GRID];
        for (int k = 0; k < SAMPLES; k++) {
            record[k] = w[AMP] * cphd.signal[v * SAMPLES + k];
            record[k] = cphd.sign > 0 ? conj(record[k]) : record[k];
            if (cphd.is_toa)
                record[k] *= cexp(2 * M_PI * I * middle * w[SC0]);
        }
        for (int i = 0; i < GRID * GRID; i++) {
            const double delay = later(v, pixel_x(&around_centre, i), pixel_r(&around_centre, i));
            delays[i] = (delay - w[SC0]) / w[SCSS];
            for (int k = 0; k < SAMPLES && !cphd.is_toa; k++)
                image[i] += record[k] / SAMPLES * cexp(2 * M_PI * I * (w[SC0] + k * w[SCSS]) * (1 + w[FDOP]) * delay);
        }
        if (cphd.is_toa)
            record_add(record, SAMPLES, false, delays, middle * w[SCSS], image);
    }
}

/* Without libexpat no CPHD is read. */
static void skip_without_expat(void)
{
    struct recording recording;
    char path[600];
    const char *const paths[] = {path};
    cphd_make(false, -1, "CF8", true, 1);
    cphd_write("plain.cphd");
    snprintf(path, sizeof path, "%s", path_in("plain.cphd"));
    if (recording_read(paths, 1, &recording) == STATUS_OK)
        recording_free(&recording);
    else if (strstr(status_message(), "libexpat"))
        skip();
}

static void cphd_files_focus(void **state)
{
    (void)state;
    skip_without_expat();
    static const struct {
        bool is_toa;
        int sign;
        const char *format;
        bool is_planar;
        int channels;
        const char *told;
    } files[] = {{false, -1, "CF8", true, 1, "CPHD, 24 pings, 1 receiver, 315 samples\n"},
                 {false, 1, "CI4", false, 2,
                  "CPHD, 24 pings, 1 receiver, 315 samples\nchannel 2 of 2, the reference of the file\n"},
                 {true, -1, "CI2", false, 1, "CPHD, 24 pings, 1 receiver, 240 samples\n"},
                 {true, 1, "CF8", true, 1, "CPHD, 24 pings, 1 receiver, 240 samples\n"}};
    for (size_t k = 0; k < COUNT_OF(files); k++) {
        double complex image[GRID * GRID] = {0};
        cphd_make(files[k].is_toa, files[k].sign, files[k].format, files[k].is_planar, files[k].channels);
        cphd_write("pass 'a'.cphd");
        cphd_sum(image);
        assert_converted("pass 'a'.cphd", files[k].told, &around_centre, image);
    }
}

static void assert_cphd_refused(const char *field, const char *reason)
{
    cphd_write("bad.cphd");
    assert_field_refused(NULL, "bad.cphd", field, reason);
    cphd_make(false, -1, "CF8", true, 1);
}

/* Another text in the XML. */
static void swap(const char *from, const char *to)
{
    char *at = strstr(cphd.xml, from);
    assert_non_null(at);
    memmove(at + strlen(to), at + strlen(from), strlen(at + strlen(from)) + 1);
    memcpy(at, to, strlen(to));
}

static void cphd_fields_are_named(void **state)
{
    (void)state;
    skip_without_expat();
    static const struct {
        const char *from, *to, *field, *reason;
    } faults[] = {{">FX<", ">FT<", "Global/DomainType`", "is 'FT'; FX or TOA"},
                  {">-1<", ">0<", "Global/SGN`", "is '0'; +1 or -1"},
                  {"CF8", "CI8", "Data/SignalArrayFormat`", "is 'CI8'; CI2, CI4 or CF8"},
                  {"> 24 <", "> 25 <", "Data/Channel/PVPArrayByteOffset`", "end beyond their block"},
                  {"> 240 <", "> 241 <", "Data/Channel/SignalArrayByteOffset`", "end beyond their block"},
                  {"> 240 <", "> x <", "Data/Channel/NumSamples`", "is 'x'; a whole number from 2"},
                  {"> 192 <", "> 176 <", "PVP/AmpSF/Offset`", "is '22'; a whole number from 0 to 21"},
                  {">main<", ">mine<", "Channel/RefChId`", "is 'main'; one of"},
                  {"<c:RefChId>main</c:RefChId>", "", "Channel/RefChId`", "is missing; the identifier of a channel"},
                  {"<c:Offset> 14 </c:Offset>", "", "PVP/SRPPos/Offset`", "is missing; a whole number from 0"},
                  {">F8<", ">F4<", "PVP/TxTime/Format`", "is 'F4'; F8 is needed"},
                  {"<c:uIAX><c:X> ", "<c:uIAX><c:X> 1", "SceneCoordinates/ReferenceSurface/Planar/uIAX`", "m long"},
                  {"<c:uIAX><c:X> ", "<c:uIAX><c:X> x", "SceneCoordinates/ReferenceSurface/Planar/uIAX/X`", "'x"},
                  {"<c:Data>", "<c:Data><c:Channel><c:CompressedSignalSize>5</c:CompressedSignalSize></c:Channel>",
                   "Data/Channel/CompressedSignalSize`", "is '5'; a signal that is not packed"}};
    for (size_t k = 0; k < COUNT_OF(faults); k++) {
        swap(faults[k].from, faults[k].to);
        assert_cphd_refused(faults[k].field, faults[k].reason);
    }
}

static void cphd_vectors_are_checked(void **state)
{
    (void)state;
    skip_without_expat();
    static const struct refusal refusals[] = {
        {{"convert", "old.cphd", "-o", "none.mat"}, {"old.cphd: begins with 'CPHD/0.3'; a whole head of CPHD/1.0"}},
        {{"convert", "cut.cphd", "-o", "none.mat"},
         {"cut.cphd: variable `SIGNAL_BLOCK_SIZE` of its head", "whole file"}},
        {{"convert", "torn.cphd", "-o", "none.mat"}, {"torn.cphd: its XML is damaged at line 3"}},
        {{"convert", "nan.cphd", "-o", "none.mat"}, {"nan.cphd: sample 4 of vector 3 is nan"}},
        {{"convert", "nan.cphd", "nan.cphd", "-o", "none.mat"},
         {"nan.cphd: is CPHD, of which one file", "2 are given"}}};
    cphd.words[2][RCV_TIME] += 1e-3;
    assert_cphd_refused("PVP/RcvTime` of vector 3", "s after `PVP/TxTime`");
    cphd.words[5][SCSS] *= 1 + 1e-5;
    assert_cphd_refused("PVP/SCSS` of vector 6", "of the first vector 2500000; the same step");
    cphd.words[0][SCSS] = 0;
    assert_cphd_refused("PVP/SCSS` of vector 1", "step > 0");
    cphd.words[5][SC0] += 1e9;
    assert_cphd_refused("PVP/SC0` of vector 6", "too far from the other vectors'");
    cphd.words[1][AMP] = 0;
    assert_cphd_refused("PVP/AmpSF` of vector 2", "is no factor > 0");
    cphd.words[7][RCV_VEL + 1] = NAN;
    assert_cphd_refused("PVP/RcvVel` of vector 8", "is no finite number");
    cphd_make(true, -1, "CF8", true, 1);
    cphd.words[4][FX2] += 1e9;
    assert_cphd_refused("PVP/FX2` of vector 5", "no band above 0");
    cphd.head = "CPHD/0.3";
    cphd_write("old.cphd");
    cphd.head = "CPHD/1.0.1";
    cphd.cut = 8;
    cphd_write("cut.cphd");
    cphd.cut = 0;
    cphd.signal[2 * SAMPLES + 3] = NAN;
    cphd_write("nan.cphd");
    swap("</c:Global>", "</c:Globe>");
    cphd_write("torn.cphd");
    assert_all_refused(refusals, COUNT_OF(refusals));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cphd_files_focus),
        cmocka_unit_test(cphd_fields_are_named),
        cmocka_unit_test(cphd_vectors_are_checked),
    };
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
