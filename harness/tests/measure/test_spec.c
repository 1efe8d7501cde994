/* SPEC parsing: what is accepted, what it becomes, and what the refusals say. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "guests/guests.h"
#include "imaging/spec.h"
#include "tests/assertions.h"

/* Two algorithms that exist only here: one with every type of param, one without any. */
struct full_options {
    double unused;
    int taps;
    int window;
    double spacing;
    double length;
};

static const char *const windows[] = {"none", "kaiser", NULL};

static const struct param full_params[] = {
    {PARAM(struct full_options, taps), .summary = "kernel length", .initial = 8, .min = -4, .max = 64,
     .sweep = "4 8 16"},
    {PARAM_NAMED(struct full_options, window, windows), .summary = "of the kernel", .initial = 0},
    {PARAM(struct full_options, spacing), .summary = "of the blocks", .initial = 0.1, .min = 1e-3, .max = 1e3},
    {PARAM(struct full_options, length), .summary = "without an upper bound", .min = 0, .max = INFINITY},
    {.name = NULL},
};

static const struct algorithm full = {
    .name = "full",
    .options_size = sizeof(struct full_options),
    .params = full_params,
};
static const struct algorithm bare = {.name = "bare"};
const struct algorithm *const algorithms[] = {&full, &bare, NULL};
const struct algorithm *const algorithm_filters[] = {NULL};

const struct algorithm *algorithm_find(const char *name)
{
    for (int i = 0; algorithms[i]; i++)
        if (strcmp(algorithms[i]->name, name) == 0)
            return algorithms[i];
    return NULL;
}

static void defaults_are_used(void **state)
{
    (void)state;
    struct spec spec;
    assert_int_equal(spec_parse("full", &spec), STATUS_OK);
    const struct full_options *options = spec.options;
    assert_ptr_equal(spec.algorithm, &full);
    assert_int_equal(spec.precision, PRECISION_FLOAT);
    assert_int_equal(options->taps, 8);
    assert_int_equal(options->window, 0);
    assert_true(options->spacing == 0.1);
    assert_string_equal(spec.text, "taps=8,window=none,spacing=0.1,length=0");
    spec_free(&spec);
    assert_null(spec.options);
}

static void settings_are_read_in_any_order(void **state)
{
    (void)state;
    struct spec spec;
    assert_int_equal(spec_parse("full:spacing=2.50e1,precision=double,window=kaiser,taps=10", &spec), STATUS_OK);
    const struct full_options *options = spec.options;
    assert_int_equal(spec.precision, PRECISION_DOUBLE);
    assert_int_equal(options->taps, 10);
    assert_int_equal(options->window, 1);
    assert_true(options->spacing == 25);
    /* Table order, canonical numbers, no precision. */
    assert_string_equal(spec.text, "taps=10,window=kaiser,spacing=25,length=0");
    spec_free(&spec);
}

static void algorithm_without_params(void **state)
{
    (void)state;
    struct spec spec;
    assert_int_equal(spec_parse("bare:precision=double", &spec), STATUS_OK);
    assert_ptr_equal(spec.algorithm, &bare);
    assert_null(spec.options);
    assert_string_equal(spec.text, "");
    assert_int_equal(spec.precision, PRECISION_DOUBLE);
    spec_free(&spec);
}

static void canonical_text_reads_back(void **state)
{
    (void)state;
    const char *const spacings[] = {"0.3333333333333333", "1e-3", "1000", "0.30000000000000004", "123.456"};
    for (size_t i = 0; i < sizeof spacings / sizeof *spacings; i++) {
        char text[300];
        struct spec first, second;
        snprintf(text, sizeof text, "full:spacing=%s", spacings[i]);
        assert_int_equal(spec_parse(text, &first), STATUS_OK);
        snprintf(text, sizeof text, "full:%s", first.text);
        assert_int_equal(spec_parse(text, &second), STATUS_OK);
        const struct full_options *a = first.options, *b = second.options;
        assert_true(a->spacing == b->spacing && a->spacing == strtod(spacings[i], NULL));
        assert_string_equal(first.text, second.text);
        spec_free(&first);
        spec_free(&second);
    }
}

/* The SPEC, and what the message must hold: the value, and what would be accepted. */
static const struct {
    const char *text, *value, *accepted;
} bad_specs[] = {
    {"", "unknown algorithm ''", "full, bare"},
    {"fulll", "'fulll'", "full, bare"},
    {"Full:taps=8", "'Full'", "full, bare"},
    {" full", "' full'", "full, bare"},
    {"full,taps=8", "'full,taps=8'", "full, bare"},
    {"full:", "''", "key=value"},
    {"full:taps=8,", "''", "key=value"},
    {"full:,taps=8", "''", "key=value"},
    {"full:taps=8,,window=none", "''", "key=value"},
    {"full:taps", "'taps'", "key=value"},
    {"full:tap=8", "'tap'", "taps, window, spacing, length, precision"},
    {"full:Taps=8", "'Taps'", "taps, window, spacing, length, precision"},
    {"full:taps =8", "'taps '", "taps, window, spacing, length, precision"},
    {"full:=8", "unknown key ''", "taps, window, spacing, length, precision"},
    {"bare:taps=8", "'taps'", "accepted: precision"},
    {"full:taps=8,taps=8", "taps is given twice", "once"},
    {"full:precision=float,precision=float", "precision is given twice", "once"},
    {"full:taps=", "taps is ''", "from -4 to 64"},
    {"full:taps= 8", "taps is ' 8'", "from -4 to 64"},
    {"full:taps=8 ", "taps is '8 '", "from -4 to 64"},
    {"full:taps=8x", "taps is '8x'", "from -4 to 64"},
    {"full:taps=8.5", "taps is '8.5'", "whole number from -4 to 64"},
    {"full:taps=8e0", "taps is '8e0'", "whole number"},
    {"full:taps=0x8", "taps is '0x8'", "whole number"},
    {"full:taps=8-", "taps is '8-'", "whole number"},
    {"full:taps=-", "taps is '-'", "whole number"},
    {"full:taps=8=8", "taps is '8=8'", "whole number"},
    {"full:taps=65", "taps is '65'", "from -4 to 64"},
    {"full:taps=-5", "taps is '-5'", "from -4 to 64"},
    {"full:taps=4294967304", "taps is '4294967304'", "from -4 to 64"},
    {"full:taps=99999999999999999999", "taps is '99999999999999999999'", "from -4 to 64"},
    {"full:spacing=nan", "spacing is 'nan'", "from 0.001 to 1000"},
    {"full:spacing=inf", "spacing is 'inf'", "from 0.001 to 1000"},
    {"full:spacing=1e999", "spacing is '1e999'", "from 0.001 to 1000"},
    {"full:spacing=1e-999", "spacing is '1e-999'", "from 0.001 to 1000"},
    {"full:spacing=0.0009", "spacing is '0.0009'", "from 0.001 to 1000"},
    {"full:spacing=1000.1", "spacing is '1000.1'", "from 0.001 to 1000"},
    {"full:spacing=1e", "spacing is '1e'", "from 0.001 to 1000"},
    {"full:spacing=0x1p3", "spacing is '0x1p3'", "from 0.001 to 1000"},
    {"full:spacing=1.2.3", "spacing is '1.2.3'", "from 0.001 to 1000"},
    {"full:spacing=", "spacing is ''", "from 0.001 to 1000"},
    {"full:length=1e999", "length is '1e999'", "from 0 to inf"},
    {"full:length=inf", "length is 'inf'", "from 0 to inf"},
    {"full:length=-1", "length is '-1'", "from 0 to inf"},
    {"full:window=hann", "window is 'hann'", "none, kaiser"},
    {"full:window=", "window is ''", "none, kaiser"},
    {"full:window=1", "window is '1'", "none, kaiser"},
    {"full:precision=half", "precision is 'half'", "float, double"},
};

static void bad_specs_are_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof bad_specs / sizeof *bad_specs; i++) {
        struct spec spec;
        status_set(STATUS_OK, "%s", "");
        if (spec_parse(bad_specs[i].text, &spec) != STATUS_INVALID)
            fail_msg("'%s' was accepted", bad_specs[i].text);
        if (!strstr(status_message(), bad_specs[i].value) || !strstr(status_message(), bad_specs[i].accepted))
            fail_msg("'%s': the message lacks \"%s\" or \"%s\": %s", bad_specs[i].text, bad_specs[i].value,
                     bad_specs[i].accepted, status_message());
        assert_null(spec.algorithm);
        assert_null(spec.options);
        spec_free(&spec);
    }
}

static void long_text_is_refused(void **state)
{
    (void)state;
    char text[5000];
    memset(text, 'a', sizeof text);
    text[sizeof text - 1] = '\0';
    struct spec spec;
    assert_int_equal(spec_parse(text, &spec), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "full, bare"));
    memcpy(text, "full:taps=", 10);
    assert_int_equal(spec_parse(text, &spec), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "from -4 to 64"));
}

static void values_are_formatted(void **state)
{
    (void)state;
    char text[32];
    param_format(&full_params[0], 8, text, sizeof text);
    assert_string_equal(text, "8");
    param_format(&full_params[1], 1, text, sizeof text);
    assert_string_equal(text, "kaiser");
    param_format(&full_params[2], 0.1, text, sizeof text);
    assert_string_equal(text, "0.1");
    param_format(&full_params[2], 64, text, 2);
    assert_string_equal(text, "6");
}

/* Nothing but a user's own SPEC loads a shared object; two kinds of name end differently. */
static void guests_are_invited(void **state)
{
    (void)state;
    struct spec spec;
    const char *rest;
    assert_ptr_equal(guest_find("bare:x=1", &rest), &bare);
    assert_string_equal(rest, ":x=1");
    assert_null(guest_find("./no:such.so:taps=8", &rest));
    assert_string_equal(rest, ":taps=8");
    assert_null(guest_find("no.sol:taps=8", &rest));
    assert_string_equal(rest, ":taps=8");
    assert_int_equal(guest_invite("bare"), STATUS_OK);
    assert_int_equal(guest_invite("neither"), STATUS_OK); /* spec_parse refuses it */
    assert_int_equal(spec_parse("./no.so:taps=8", &spec), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "unknown algorithm './no.so'"));
    assert_int_equal(guest_invite("./no.so:taps=8"), STATUS_INVALID);
    assert_string_equal(status_message(), "./no.so: cannot be read: No such file or directory");
    char text[300];
    memset(text, 'a', sizeof text);
    memcpy(text + sizeof text - 4, ".so", 4);
    assert_int_equal(guest_invite(text), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "its name has 299 characters, must have at most 200"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_are_used),        cmocka_unit_test(settings_are_read_in_any_order),
        cmocka_unit_test(algorithm_without_params), cmocka_unit_test(canonical_text_reads_back),
        cmocka_unit_test(bad_specs_are_refused),    cmocka_unit_test(long_text_is_refused),
        cmocka_unit_test(values_are_formatted),     cmocka_unit_test(guests_are_invited),
    };
    return cmocka_run_group_tests_name("spec", tests, NULL, NULL);
}
