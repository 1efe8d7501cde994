/* The acquisition's promises and track shapes, and the memory of samples and images. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "tests/assertions.h"

enum { SAMPLES = 16, RECEIVERS = 3, PINGS = 8, PULSE = 4 };

/* A straight track: spacing 0.3 m, receivers 0.05 m apart, lambda = 0.015 m, so that the tolerance is 15 um. */
static struct acquisition make_straight(double x_first, double spacing, double speed)
{
    struct acquisition a = {.sound_speed = 1500,
                            .fc = 100e3,
                            .fs = 30e3,
                            .bandwidth = 20e3,
                            .samples = SAMPLES,
                            .receivers = RECEIVERS,
                            .pings = PINGS,
                            .aperture_limit = INFINITY,
                            .pulse_length = PULSE};
    assert_int_equal(acquisition_allocate(&a), STATUS_OK);
    for (int p = 0; p < PINGS; p++) {
        a.t0[p] = 0.1;
        a.tx[p].x = x_first + p * spacing;
        a.velocity[p].x = speed;
        for (int m = 0; m < RECEIVERS; m++) {
            a.rx[p * RECEIVERS + m].x = a.tx[p].x - 0.1 + m * 0.05;
        }
    }
    a.pulse[1] = 1;
    return a;
}

static void whole_acquisition_is_accepted(void **state)
{
    (void)state;
    struct acquisition a = make_straight(-1, 0.3, 1.5);
    assert_int_equal(acquisition_check(&a, "scene"), STATUS_OK);
    a.fs = a.bandwidth;
    a.t0[2] = -0.1;
    a.aperture_limit = 0.2;
    assert_int_equal(acquisition_check(&a, "scene"), STATUS_OK);
    acquisition_free(&a);
    assert_null(a.t0);
    acquisition_free(&a);
}

/* Every double of the struct and its arrays, with values that are refused, and what the message must name. */
static void each_broken_promise_is_refused(void **state)
{
    (void)state;
    struct acquisition a = make_straight(-1, 0.3, 1.5);
    const struct {
        double *field;
        double value;
        const char *says;
    } broken[] = {
        {&a.sound_speed, 0, "sound_speed is 0"},
        {&a.sound_speed, NAN, "sound_speed is"},
        {&a.sound_speed, INFINITY, "sound_speed is inf"},
        {&a.sound_speed, 1.5, "velocity of ping 1"},
        {&a.sound_speed, 3.5e192, "at most 1e+09 m/s is accepted"}, /* its square is infinite */
        {&a.fc, -1, "fc is -1"},
        {&a.fc, NAN, "fc is"},
        {&a.fc, 1e-320, "wavelength"},
        {&a.fc, 2e12, "phase error"},
        {&a.fc, 1e-36, "fc is 1e-36 Hz; at least"},
        {&a.fs, 0, "fs is 0"},
        {&a.fs, 19999, "bandwidth is 20000 Hz; at most fs = 19999 Hz"},
        {&a.bandwidth, 0, "bandwidth is 0"},
        {&a.bandwidth, INFINITY, "bandwidth is inf"},
        {&a.pri, -0.1, "pri is -0.1 s; a finite number >= 0"},
        {&a.pri, INFINITY, "pri is inf"},
        {&a.tx_length, -0.1, "tx_length is -0.1"},
        {&a.tx_length, NAN, "tx_length is"},
        {&a.rx_length, INFINITY, "rx_length is inf"},
        {&a.aperture_limit, 0, "aperture limit is 0"},
        {&a.aperture_limit, NAN, "aperture limit is"},
        {&a.t0[3], NAN, "t0 of ping 4"},
        {&a.t0[3], 1e7, "ping 4"},
        {&a.t0[3], -1e7, "ping 4"},
        {&a.tx[7].y, INFINITY, "tx of ping 8"},
        {&a.rx[2 * RECEIVERS + 1].z, NAN, "rx 2 of ping 3"},
        {&a.velocity[5].y, 1500, "velocity of ping 6"},
        {&a.velocity[5].z, NAN, "velocity of ping 6"},
        {(double *)&a.pulse[0], NAN, "energy of pulse"},
        {(double *)&a.pulse[3] + 1, INFINITY, "energy of pulse"},
        {(double *)&a.pulse[1], 0, "energy of pulse is 0"},
    };
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
        double kept = *broken[i].field;
        *broken[i].field = broken[i].value;
        assert_int_equal(acquisition_check(&a, "place.mat"), STATUS_INVALID);
        if (!strstr(status_message(), broken[i].says) || strncmp(status_message(), "place.mat: ", 11) != 0) {
            fail_msg("\"%s\" does not say \"%s\"", status_message(), broken[i].says);
        }
        *broken[i].field = kept;
        assert_int_equal(acquisition_check(&a, "place.mat"), STATUS_OK);
    }
    acquisition_free(&a);
}

static void broken_counts_are_refused(void **state)
{
    (void)state;
    struct acquisition a = make_straight(-1, 0.3, 1.5);
    const struct {
        int *field;
        int value;
        const char *says;
    } broken[] = {
        {&a.samples, 1, "samples is 1; at least 2"},
        {&a.receivers, 0, "receivers is 0"},
        {&a.pings, -1, "pings is -1"},
        {&a.pulse_length, 0, "pulse has 0 samples"},
    };
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
        int kept = *broken[i].field;
        *broken[i].field = broken[i].value;
        assert_int_equal(acquisition_check(&a, "scene"), STATUS_INVALID);
        if (!strstr(status_message(), broken[i].says)) {
            fail_msg("\"%s\" does not say \"%s\"", status_message(), broken[i].says);
        }
        *broken[i].field = kept;
    }
    a.compressed = true;
    assert_int_equal(acquisition_check(&a, "scene"), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "compressed echoes have none"));
    acquisition_free(&a);

    struct acquisition huge = {.sound_speed = 1500,
                               .fc = 100e3,
                               .fs = 30e3,
                               .bandwidth = 20e3,
                               .samples = INT32_MAX,
                               .receivers = INT32_MAX,
                               .pings = 2,
                               .aperture_limit = 1,
                               .compressed = true};
    assert_int_equal(acquisition_check(&huge, "scene"), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "do not fit"));
}

static void straight_tracks_are_recognised(void **state)
{
    (void)state;
    const struct {
        double x_first, spacing, speed;
    } cases[] = {{-1, 0.3, 1.5}, {12.25, -0.3, -1.5}, {0, 0.8, 0}, {1e4, 0.3, 7}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct acquisition a = make_straight(cases[i].x_first, cases[i].spacing, cases[i].speed);
        struct straight_track track;
        assert_true(acquisition_is_straight(&a, &track));
        assert_true(acquisition_is_straight(&a, NULL));
        /* The phase turns by 1 rad in 1.2 mm: 1e-11 m is far below what double images can show. */
        assert_true(fabs(track.x_first - cases[i].x_first) <= 1e-11);
        assert_true(fabs(track.spacing - cases[i].spacing) <= 1e-12);
        assert_true(track.speed == cases[i].speed);
        a.pings = 1;
        assert_true(acquisition_is_straight(&a, &track));
        assert_true(track.x_first == cases[i].x_first && track.spacing == 0);
        acquisition_free(&a);
    }
}

/* lambda/1000 is 15 um; the least-squares points lie between the shifted ping and the others. */
static void tolerance_is_a_thousandth_of_a_wavelength(void **state)
{
    (void)state;
    struct acquisition a = make_straight(-1, 0.3, 1.5);
    const struct {
        double *field;
        double accepted, refused;
    } changes[] = {
        {&a.tx[3].x, 12e-6, 30e-6},
        {&a.tx[0].y, 14e-6, 16e-6},
        {&a.tx[7].z, -14e-6, -16e-6},
        {&a.rx[3 * RECEIVERS].x, 14e-6, 16e-6},
        {&a.rx[3 * RECEIVERS + 2].y, 14e-6, 16e-6},
        {&a.rx[2].z, -14e-6, -16e-6},
        {&a.velocity[4].x, 14e-5, 16e-5}, /* times 0.1005 s */
        {&a.velocity[0].y, 14e-5, 16e-5},
        {&a.velocity[7].z, 14e-5, 16e-5},
        {&a.t0[5], 9e-9, 11e-9}, /* times 1500 m/s */
    };
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        double kept = *changes[i].field;
        *changes[i].field = kept + changes[i].accepted;
        if (!acquisition_is_straight(&a, NULL)) {
            fail_msg("change %zu by %g is refused", i, changes[i].accepted);
        }
        *changes[i].field = kept + changes[i].refused;
        if (acquisition_is_straight(&a, NULL)) {
            fail_msg("change %zu by %g is accepted", i, changes[i].refused);
        }
        *changes[i].field = kept;
    }
    acquisition_free(&a);
}

static void jitter_within_the_tolerance_is_straight(void **state)
{
    (void)state;
    /* Both ends off to the same side: a line through the ends alone would miss the middle by 26 um. */
    struct acquisition a = make_straight(-1, 0.3, 1.5);
    const double jitter[PINGS] = {13e-6, -13e-6, 13e-6, -13e-6, -13e-6, 13e-6, -13e-6, 13e-6};
    for (int p = 0; p < PINGS; p++) {
        a.tx[p].x += jitter[p];
        for (int m = 0; m < RECEIVERS; m++) {
            a.rx[p * RECEIVERS + m].x += jitter[0];
        }
    }
    struct straight_track track;
    assert_true(acquisition_is_straight(&a, &track));
    assert_true(fabs(track.x_first + 1) < 5e-6 && fabs(track.spacing - 0.3) < 2e-6);
    acquisition_free(&a);
}

static void other_tracks_are_not_straight(void **state)
{
    (void)state;
    struct acquisition still = make_straight(2, 0, 0);
    assert_false(acquisition_is_straight(&still, NULL));
    acquisition_free(&still);

    struct acquisition uneven = make_straight(-1, 0.3, 1.5);
    uneven.tx[4].x += 0.01;
    for (int m = 0; m < RECEIVERS; m++) {
        uneven.rx[4 * RECEIVERS + m].x += 0.01;
    }
    assert_false(acquisition_is_straight(&uneven, NULL));
    acquisition_free(&uneven);

    struct acquisition curved = make_straight(-1, 0.3, 1.5);
    for (int p = 0; p < PINGS; p++) {
        curved.tx[p].y = 0.01 * p * p;
    }
    assert_false(acquisition_is_straight(&curved, NULL));
    acquisition_free(&curved);
}

static void assert_heading(const struct acquisition *a, int ping, double x, double y, double z)
{
    struct vector heading = acquisition_heading(a, ping);
    assert_true(fabs(heading.x - x) < 1e-15 && fabs(heading.y - y) < 1e-15 && fabs(heading.z - z) < 1e-15);
}

static void heading_follows_the_track(void **state)
{
    (void)state;
    struct acquisition a = make_straight(0, -0.3, 1.5);
    assert_heading(&a, 0, -1, 0, 0);
    assert_heading(&a, 3, -1, 0, 0);
    assert_heading(&a, PINGS - 1, -1, 0, 0);
    a.tx[1] = (struct vector){0, 3, 0};
    a.tx[2] = (struct vector){4, 3, 0};
    a.tx[3] = (struct vector){4, 3, 2};
    assert_heading(&a, 0, 0, 1, 0);
    assert_heading(&a, 1, 0.8, 0.6, 0); /* from ping 0 at the origin to ping 2 */
    a.pings = 1;
    a.velocity[0] = (struct vector){0, 0, -2};
    assert_heading(&a, 0, 0, 0, -1);
    a.velocity[0] = (struct vector){0, 0, 0};
    assert_heading(&a, 0, 1, 0, 0);
    acquisition_free(&a);
}

/* Of either sign, in either precision, of few numbers and of many (for threads). */
static void the_largest_part_is_found(void **state)
{
    (void)state;
    enum { COUNT = 1 << 17 };
    static float complex single[COUNT];
    static double complex both[COUNT];
    static const double parts[] = {-0.0, -3, 1e30, INFINITY, -INFINITY, NAN};
    for (size_t n = 0; n < sizeof parts / sizeof *parts; n++)
        for (int count = 1; count <= COUNT; count += COUNT - 1) {
            const double part = parts[n];
            single[count - 1] = __builtin_complex(0.5F, (float)part);
            both[count - 1] = __builtin_complex(part, -0.5);
            const double least = largest_part(single, PRECISION_FLOAT, (size_t)count),
                         most = largest_part(both, PRECISION_DOUBLE, (size_t)count);
            const double expected = fmax(fabs(part), 0.5);
            assert_true(isnan(part) ? isnan(least) && isnan(most) : least == (float)expected && most == expected);
            single[count - 1] = 0;
            both[count - 1] = 0;
        }
    assert_true(largest_part(both, PRECISION_DOUBLE, 0) == 0);
}

static void samples_are_allocated_and_converted(void **state)
{
    (void)state;
    struct acquisition a = make_straight(0, 0.3, 1.5);
    struct echoes floats, doubles, again;
    assert_int_equal(echoes_allocate(&a, PRECISION_FLOAT, &floats), STATUS_OK);
    assert_ptr_equal(floats.acquisition, &a);
    assert_int_equal((uintptr_t)floats.samples % 64, 0);
    float complex *values = (float complex *)floats.samples;
    const int count = SAMPLES * RECEIVERS * PINGS;
    for (int i = 0; i < count; i++) {
        values[i] = (float)i / 3 - I * (float)i;
    }
    assert_int_equal(echoes_convert(&floats, PRECISION_DOUBLE, &doubles), STATUS_OK);
    assert_true(((const double complex *)doubles.samples)[count - 1] == values[count - 1]);
    assert_int_equal(echoes_convert(&doubles, PRECISION_FLOAT, &again), STATUS_OK);
    assert_memory_equal(again.samples, floats.samples, (size_t)count * sizeof *values);
    echoes_free(&floats);
    echoes_free(&doubles);
    echoes_free(&again);
    assert_null(again.samples);
    echoes_free(&again);
    a.samples = a.receivers = a.pings = INT32_MAX;
    assert_int_equal(echoes_allocate(&a, PRECISION_DOUBLE, &doubles), STATUS_FAILED);
    assert_null(doubles.samples);
    acquisition_free(&a);
}

static void images_are_allocated_and_scaled(void **state)
{
    (void)state;
    const struct grid patches[] = {{0, 1, 3, 0, 1, 2}, {0, 1, 1, 0, 1, 5}};
    struct image image;
    assert_int_equal(image_allocate(2, patches, PRECISION_FLOAT, &image), STATUS_OK);
    ((float complex *)image.pixels[0])[1 * 3 + 2] = 0.1f + 2 * I;
    ((float complex *)image.pixels[1])[4] = -7;
    assert_int_equal(image_scale(&image, 200), STATUS_OK);
    assert_true(image_pixel(&image, 0, 1, 2) == 0x1p200 * 0.1f + 0x1p201 * I);
    assert_true(image_pixel(&image, 1, 4, 0) == -7 * 0x1p200);
    assert_true(image_pixel(&image, 1, 3, 0) == 0);
    image_free(&image);
    image_free(&image);
    const struct grid huge = {0, 1, INT32_MAX, 0, 1, INT32_MAX};
    assert_int_equal(image_allocate(1, &huge, PRECISION_DOUBLE, &image), STATUS_FAILED);
    assert_null(image.pixels);
}

static void sizes_do_not_overflow(void **state)
{
    (void)state;
    assert_int_equal(size_product(2, 3, 4, 5), 120);
    assert_int_equal(size_product(SIZE_MAX, 1, 1, 1), SIZE_MAX);
    assert_int_equal(size_product((size_t)1 << 32, (size_t)1 << 32, 1, 1), 0);
    assert_int_equal(size_product(1, 1, (size_t)1 << 63, 2), 0);
    assert_int_equal(precision_size(PRECISION_FLOAT), 8);
    assert_int_equal(precision_size(PRECISION_DOUBLE), 16);
    assert_string_equal(precision_name(PRECISION_FLOAT), "float");
    assert_string_equal(precision_name(PRECISION_DOUBLE), "double");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_acquisition_is_accepted),
        cmocka_unit_test(each_broken_promise_is_refused),
        cmocka_unit_test(broken_counts_are_refused),
        cmocka_unit_test(straight_tracks_are_recognised),
        cmocka_unit_test(tolerance_is_a_thousandth_of_a_wavelength),
        cmocka_unit_test(jitter_within_the_tolerance_is_straight),
        cmocka_unit_test(other_tracks_are_not_straight),
        cmocka_unit_test(heading_follows_the_track),
        cmocka_unit_test(the_largest_part_is_found),
        cmocka_unit_test(samples_are_allocated_and_converted),
        cmocka_unit_test(images_are_allocated_and_scaled),
        cmocka_unit_test(sizes_do_not_overflow),
    };
    return cmocka_run_group_tests_name("acquisition", tests, NULL, NULL);
}
