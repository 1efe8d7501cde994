/* `check` on scenes that violate one condition each names exactly that one; sensitivities are what delays say. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "advise/check.h"
#include "tests/support.h"

/* study/quick, compressed, by parts that the tests vary. */
struct parts {
    const char *sonar, *array, *track, *record, *limit, *beam, *targets, *image;
};
static const struct parts plain = {
    "fc = 150e3; bandwidth = 15e3; fs = 30e3;",
    "receivers = 8; first_offset = 0.04; pitch = 0.04;",
    "speed = 2.5; pri = 0.064; pings = 18; x_first = -1.52;",
    "first_sample = 0; samples = 4000;",
    "",
    "kind = \"rect\"; truncation = \"tx\"; limit = 0.443;",
    "{ x = 0.0; r = 20.0; }",
    "x = { first = -0.6; step = 0.02; count = 61; }; r = { first = 19.9; step = 0.025; count = 9; };",
};

static struct scene scene_of(const struct parts *varied)
{
    struct scene scene;
    char text[2000];
#define PART(field) (varied->field ? varied->field : plain.field)
    snprintf(text, sizeof text,
             "sonar = { %s };\npulse = { kind = \"flat\"; };\narray = { tx_length = 0.08; rx_length = 0.04; %s };\n"
             "track = { %s };\nrecord = { %s };\n%s\nbeam = { %s };\n"
             "targets = { points = ( %s ); };\nimage = { %s };\n",
             PART(sonar), PART(array), PART(track), PART(record), PART(limit), PART(beam), PART(targets), PART(image));
    support_write("scene.cfg", text);
    support_scene(path_of("scene.cfg"), &scene);
    return scene;
}

/* What check prints of a SPEC, or of the scene by itself; for the caller to free. */
static char *checked(const struct scene *scene, const char *text, bool *refused)
{
    static char *printed; /* gcc 12 takes what is found in it for a pointer to a local one */
    static size_t size;
    struct spec spec;
    struct check_found found;
    FILE *stream = open_memstream(&printed, &size);
    assert_non_null(stream);
    check_scene(scene, &found);
    if (text) {
        found.count = 0; /* the SPEC's alone */
        assert_int_equal(spec_parse(text, &spec), STATUS_OK);
        assert_int_equal(check_algorithm(scene, &spec, &found, refused), STATUS_OK);
        spec_free(&spec);
    }
    check_print(stream, scene, &found, true);
    fclose(stream);
    return printed;
}

/* Does exactly the line of `name` not say "met", but `verdict`? An empty name: all hold. */
static bool names_one(const char *printed, const char *verdict, const char *name)
{
    int failing = 0, right = 0;
    char *text = strdup(printed), *rest = text;
    for (char *line; (line = strsep(&rest, "\n"));) {
        char first[20], second[40];
        if (strncmp(line, "  ", 2) != 0
            || line[2] == ' ' /* a line goes on */ || sscanf(line, "%19s %39s", first, second) != 2
            || !strcmp(first, "met") || !strcmp(first, "near"))
            continue;
        failing++;
        right += !strcmp(first, verdict) && !strcmp(second, name);
    }
    free(text);
    return *name ? failing == 1 && right == 1 : failing == 0;
}

static const struct {
    const char *spec, *verdict, *name;
    struct parts parts;
} cases[] = {
    {"rma_lbf", "", "", {0}},
    {"bp_sinc", "", "", {0}},
    {"rma_numeric", "REFUSED", "above_dc", {.sonar = "fc = 20e3; bandwidth = 40e3; fs = 80e3;"}},
    {"bp_sinc", "warns", "above_dc", {.sonar = "fc = 20e3; bandwidth = 40e3; fs = 80e3;"}},
    {"rma_numeric",
     "REFUSED",
     "subsonic",
     {.track = "speed = 1400.0; pri = 0.3; pings = 3; x_first = -420.0;",
      .record = "first_sample = 0; samples = 8000;"}},
    {"rma_numeric", "REFUSED", "pings", {.track = "speed = 2.5; pri = 0.064; pings = 1;"}},
    {"rma_numeric", "REFUSED", "whole_aperture", {.limit = "aperture_limit = 0.03;"}},
    {"rma_numeric",
     "REFUSED",
     "in_front",
     {.image = "x = { first = -0.6; step = 0.02; count = 61; }; r = { first = 0.0; step = 0.025; count = 900; };"}},
    {"rma_numeric", "warns", "ghost", {.track = "speed = 2.5; pri = 0.06; pings = 18; x_first = -1.4;"}},
    {"bp_nearest", "warns", "unambiguous", {.track = "speed = 10.0; pri = 0.016; pings = 18; x_first = -1.52;"}},
    {"rma_numeric",
     "REFUSED",
     "stationary",
     {.sonar = "fc = 2e3; bandwidth = 1e3; fs = 30e3;",
      .image = "x = { first = -0.1; step = 0.02; count = 11; }; r = { first = 0.5; step = 0.1; count = 1; };"}},
    {"rma_numeric",
     "REFUSED",
     "spa_amplitude",
     {.array = "receivers = 8; first_offset = 0.32; pitch = 0.005;",
      .track = "speed = 2.5; pri = 0.008; pings = 18; x_first = -0.17;",
      .image = "x = { first = -0.1; step = 0.02; count = 11; }; r = { first = 0.3; step = 0.1; count = 1; };"}},
    {"rma_numeric",
     "REFUSED",
     "doppler",
     {.array = "receivers = 8; first_offset = 0.04; pitch = 0.08;",
      .track = "speed = 2.5; pri = 0.128; pings = 18; x_first = -2.88;"}},
    {"rma_pca",
     "REFUSED",
     "pca_law",
     {.array = "receivers = 8; first_offset = -4.0; pitch = 0.02;",
      .track = "speed = 2.5; pri = 0.032; pings = 18; x_first = -0.72;"}},
    {"rma_lbf",
     "REFUSED",
     "predicted_error",
     {.image = "x = { first = 5.0; step = 0.02; count = 11; }; r = { first = 20.0; step = 0.1; count = 1; };"}},
    {"rma_numeric",
     "REFUSED",
     "squint",
     {.beam = "kind = \"rect\"; truncation = \"tx\"; limit = 0.443; squint = 5.0;"}},
    {"rma_numeric",
     "REFUSED",
     "axes",
     {.image = "angle = 1.0; x = { first = -0.6; step = 0.02; count = 61; };"
               "r = { first = 19.9; step = 0.025; count = 9; };"}},
    {"bp_nearest:engine=invariant",
     "REFUSED",
     "invariance",
     {.image = "x = { first = -0.6; step = 0.021; count = 61; }; r = { first = 19.9; step = 0.025; count = 9; };"}},
    {"bp_nearest",
     "note",
     "invariance",
     {.image = "x = { first = -0.6; step = 0.021; count = 61; }; r = { first = 19.9; step = 0.025; count = 9; };"}},
    {"wk_classic",
     "",
     "",
     {.array = "receivers = 1;",
      .track = "speed = 1.0; pri = 0.03; pings = 146; x_first = -2.2;",
      .record = "first_sample = 0; samples = 1600;"}},
    {"wk_classic",
     "REFUSED",
     "monostatic",
     {.array = "receivers = 1; first_offset = 0.04;", .track = "speed = 2.5; pri = 0.03; pings = 40; x_first = -1.4;"}},
    {"bp_sinc", "warns", "dynamic", {.targets = "{ x = 0.0; r = 20.0; }, { x = 0.1; r = 20.0; amplitude = 1e-8; }"}},
    {"bp_sinc", "note", "float_range", {.targets = "{ x = 0.0; r = 20.0; amplitude = 1e-44; }"}},
};

static void exactly_the_violated_condition_is_named(void **state)
{
    (void)state;
    int failures = 0;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct scene scene = scene_of(&cases[k].parts);
        bool refused;
        char *printed = checked(&scene, cases[k].spec, &refused);
        if (!names_one(printed, cases[k].verdict, cases[k].name) || refused != !strcmp(cases[k].verdict, "REFUSED")) {
            failures++;
            print_error("%s should name %s alone:\n", cases[k].spec, cases[k].name);
            fputs(printed, stderr); /* longer than cmocka prints */
        }
        free(printed);
        scene_free(&scene);
    }
    assert_int_equal(failures, 0);
}

static char *scene_checked(const struct scene *scene)
{
    return checked(scene, NULL, NULL);
}

/* The value of a condition's line. */
static double value_with(const char *printed, const char *verdict, const char *name)
{
    char line[60];
    double value = NAN;
    snprintf(line, sizeof line, "%-7s  %s ", verdict, name);
    const char *found = strstr(printed, line);
    if (found)
        sscanf(found + strlen(line), "%lf", &value);
    return value;
}

static double value_of(const char *printed, const char *name)
{
    return value_with(printed, "met", name);
}

/* Mistakes that any algorithm's image shows: units, pixels, records. */
static void mistakes_of_the_scene_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *name; /* empty: none */
        double value;
        struct parts parts;
    } mistakes[] = {
        {"", 0, {0}},
        /* 150, 15 and 30 kHz typed as Hz: wavelength 10 m, the longest step 0.16 m from ping to ping */
        {"wavelength",
         62.5,
         {.sonar = "fc = 150.0; bandwidth = 15.0; fs = 30.0;",
          .image = "x = { first = 0.0; step = 0.02; count = 1; };"
                   "r = { first = 20.0; step = 0.025; count = 1; };"}},
        {"narrow_band", 1e4, {.sonar = "fc = 150e3; bandwidth = 15.0; fs = 30e3;"}},
        /* resolution along x: 1/(2 * 2 sin * (fc + B/2)/c), sin = 0.443 lambda/0.08 m, less the array's length */
        {"pixel_x",
         0.05 / (0.04 / 0.886 / 1.05),
         {.image = "x = { first = -0.6; step = 0.05; count = 25; }; r = { first = 19.9; step = 0.025; count = 9; };"}},
        {"pixel_r",
         0.06 / 0.05,
         {.image = "x = { first = -0.6; step = 0.02; count = 61; }; r = { first = 19.9; step = 0.06; count = 4; };"}},
        /* 4000 samples reach to 100 m: of 17 rows from 90 to 122 m those from 100 m on are not met, but the array makes
           delays longer by its offset squared */
        {"pixels_met",
         100 * 11.0 / 17,
         {.beam = "kind = \"rect\"; truncation = \"none\";",
          .image = "x = { first = 0.0; step = 0.02; count = 1; }; r = { first = 90.0; step = 0.04; count = 801; };"}},
        /* the record ends at 99.975 m; pings that see the place from its sides are up to 12 mm farther */
        {"beam_in_record",
         100,
         {.image = "x = { first = 0.0; step = 0.02; count = 1; }; r = { first = 99.968; step = 0.004; count = 2; };"}},
    };
    int failures = 0;
    for (size_t k = 0; k < sizeof mistakes / sizeof *mistakes; k++) {
        struct scene scene = scene_of(&mistakes[k].parts);
        char *printed = scene_checked(&scene);
        const double value = *mistakes[k].name ? value_with(printed, "warns", mistakes[k].name) : 0;
        if (!names_one(printed, "warns", mistakes[k].name)
            || (*mistakes[k].name && !is_close(value / mistakes[k].value, 1, 0.2))) {
            failures++;
            print_error("should name '%s' alone, with %g:\n", mistakes[k].name, mistakes[k].value);
            fputs(printed, stderr);
        }
        free(printed);
        scene_free(&scene);
    }
    assert_int_equal(failures, 0);
}

/* Patches beyond the record are counted, and so are the pixels in them. */
static void patches_beyond_the_record_are_counted(void **state)
{
    (void)state;
    struct scene scene = scene_of(&(struct parts){.image = "patches = ( { x = { first = 0.0; step = 0.02; count = 5; };"
                                                           "r = { first = 20.0; step = 0.025; count = 8; }; },"
                                                           "{ x = { first = 0.0; step = 0.02; count = 5; };"
                                                           "r = { first = 120.0; step = 0.025; count = 24; }; } );"});
    char *printed = scene_checked(&scene);
    assert_close(value_with(printed, "warns", "patches_met"), 1, 1e-9);
    assert_close(value_with(printed, "warns", "pixels_met"), 75, 1e-6);
    free(printed);
    scene_free(&scene);
}

/* Gaps between pings are told of a track with errors as of an even one. */
static void gaps_are_told_of_an_uneven_track(void **state)
{
    (void)state;
    struct scene scene = scene_of(&(struct parts){.track = "speed = 2.5; pri = 0.08; pings = 18; x_first = -1.9;"});
    for (int p = 0; p < scene.acquisition.pings; p++) {
        scene.acquisition.tx[p].y += p % 2 ? 0.01 : -0.01;
        for (int m = 0; m < scene.acquisition.receivers; m++)
            scene.acquisition.rx[p * scene.acquisition.receivers + m].y += p % 2 ? 0.01 : -0.01;
    }
    bool refused;
    assert_false(acquisition_is_straight(&scene.acquisition, NULL));
    char *printed = checked(&scene, "bp_nearest", &refused);
    assert_close(value_with(printed, "warns", "ghost"), 0.25, 1e-3);
    assert_non_null(strstr(printed, "pings 0.16 m apart in place of 0.2 m, a PRI of 0.064 s at 2.5 m/s"));
    free(printed);
    /* A transmitter that moves before an array that stands is no track with gaps. */
    for (int p = 0; p < scene.acquisition.pings; p++)
        for (int m = 0; m < scene.acquisition.receivers; m++)
            scene.acquisition.rx[p * scene.acquisition.receivers + m] = scene.acquisition.rx[m];
    printed = checked(&scene, "bp_nearest", &refused);
    assert_null(strstr(printed, "ghost"));
    free(printed);
    scene_free(&scene);
}

/* Recorded samples of a real signal: passband, or a lost part. */
static void echoes_without_an_imaginary_part_are_told(void **state)
{
    (void)state;
    struct scene scene = scene_of(&(struct parts){0});
    const struct acquisition *a = &scene.acquisition;
    const size_t count = (size_t)a->pings * (size_t)a->receivers * (size_t)a->samples;
    scene.recorded = calloc(count, sizeof *scene.recorded);
    assert_non_null(scene.recorded);
    scene.recorded[count / 2] = -2;
    char *printed = scene_checked(&scene);
    assert_true(names_one(printed, "warns", "imaginary"));
    free(printed);
    scene.recorded[1] = 1e-3 * I;
    printed = scene_checked(&scene);
    assert_true(names_one(printed, "", ""));
    free(printed);
    scene_free(&scene);
}

/* Delays are those that pings see, wherever in the patch and the beam that is: 20 m ahead or abeam. */
static void delays_are_those_of_what_is_seen(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        struct parts parts;
        double range, doppler; /* m, and F |dtau/dx| 2 spacing/M with spacing/M = 0.02 m */
    } views[] = {
        {"plain", {0}, 20, 157.5e3 / 1500 * (0.443 / 4 + (0.32 + 2.5 * 0.027) / 19.9) * 2 * 0.02},
        {"pings that see a part of the patch without its corners and middle",
         {.track = "speed = 2.5; pri = 0.064; pings = 2; x_first = 11.3;",
          .image = "x = { first = -60.0; step = 0.5; count = 242; }; r = { first = 20.0; step = 0.025; count = 1; };"},
         20,
         0},
        {"squint of 30 degrees",
         {.beam = "kind = \"rect\"; truncation = \"tx\"; limit = 0.443; squint = 30.0;",
          .track = "speed = 0.0; spacing = 0.16; pri = 0.064; pings = 18; x_first = -12.9;"},
         20.1 / 0.837, /* 33.2 degrees off broadside; at 26.8 the way back to the last receiver is flatter */
         157.5e3 / 1500 * (1 - 0.4513 - 0.4398) * 2 * 0.02},
    };
    for (size_t k = 0; k < sizeof views / sizeof *views; k++) {
        struct scene scene = scene_of(&views[k].parts);
        bool refused;
        char *printed = checked(&scene, "bp_nearest", &refused);
        const double phase = 8 * M_PI * 150e3 * 2 * views[k].range / 1500 * 0x1p-53;
        const double digits = value_of(printed, "phase_digits"), doppler = value_of(printed, "doppler");
        if (!is_close(digits / phase, 1, 0.02)
            || (views[k].doppler > 0 && !is_close(doppler / views[k].doppler, 1, 0.01)))
            fail_msg("%s: phase_digits %g, not %g; doppler %g, not %g", views[k].what, digits, phase, doppler,
                     views[k].doppler);
        free(printed);
        scene_free(&scene);
    }
}

/* The worst of several values is none where one of them is none. */
static void no_worst_hides_a_nan(void **state)
{
    (void)state;
    assert_true(isnan(condition_worse(NAN, 1)) && isnan(condition_worse(1, NAN)));
    assert_true(condition_worse(1, 2) == 2 && condition_worse(2, 1) == 2);
}

/* What no condition knows, the plan does: columns that no wavenumber of the track reaches. */
static void refusals_of_the_plan_are_told(void **state)
{
    (void)state;
    struct scene scene = scene_of(&(struct parts){
        .image = "x = { first = 0.0; step = 0.2; count = 60; }; r = { first = 20.0; step = 0.1; count = 1; };"});
    bool refused;
    char *printed = checked(&scene, "rma_numeric", &refused);
    if (!refused || !strstr(printed, "condition in_wavenumbers:"))
        fputs(printed, stderr);
    assert_true(
        refused
        && strstr(printed, "  REFUSED  rma_numeric: condition in_wavenumbers: how far columns from 0 to 11.8 m"));
    free(printed);
    scene_free(&scene);
}

/* Rows of which the record holds the nearest. */
static void rows_beyond_the_record_are_refused(void **state)
{
    (void)state;
    struct scene scene = scene_of(&(struct parts){
        .record = "first_sample = 240; samples = 40;",
        .image = "x = { first = -0.1; step = 0.02; count = 11; }; r = { first = 6.5; step = 0.1; count = 35; };"});
    bool refused;
    char *printed = checked(&scene, "rma_numeric", &refused);
    if (!refused
        || !strstr(printed,
                   "condition in_record: how far rows from 6.5 to 9.9 m lie outside the record's 6 to 6.975 m"))
        fputs(printed, stderr);
    assert_true(refused && strstr(printed, "is 2.92; at most 2 is needed"));
    free(printed);
    scene_free(&scene);
}

/* Broadside and slow, the phase is 4 pi fc r/c: so is what it changes by. */
static void sensitivities_are_those_of_the_delay(void **state)
{
    (void)state;
    struct scene scene = scene_of(&(struct parts){0});
    struct sensitivity list[SENSITIVITIES];
    check_sensitivities(&scene, list);
    const double phase = 4 * M_PI * 150e3 * 20 / 1500;
    assert_close(list[0].kappa / phase, 1, 0.01);
    assert_close(list[1].kappa / phase, 1, 0.01);
    assert_close(list[2].kappa / phase, 1, 0.01);
    assert_true(list[3].kappa < 1e-3 * phase);
    assert_close(list[4].kappa / (2 * M_PI * 150e3 / 1500), 1, 0.01);
    for (int q = 0; q < 3; q++) {
        assert_close(list[q].shift_m / 20e-5, 1, 0.01);
        assert_true(list[q].spread < 0.02 * list[q].phase);
    }
    scene_free(&scene);
}

/* And so it is 30 degrees ahead, and broadside in an image of turned axes. */
static void sensitivities_follow_beam_and_axes(void **state)
{
    (void)state;
    static const struct {
        struct parts parts;
        double range; /* m */
    } views[] = {
        {{.beam = "kind = \"rect\"; truncation = \"tx\"; limit = 0.443; squint = 30.0;",
          .image = "x = { first = 11.5; step = 0.02; count = 5; }; r = { first = 19.9; step = 0.025; count = 9; };"},
         20 / 0.866},
        {{.image = "angle = 30.0; x = { first = -10.04; step = 0.02; count = 5; };"
                   "r = { first = 17.22; step = 0.025; count = 9; };"},
         20},
    };
    for (size_t k = 0; k < sizeof views / sizeof *views; k++) {
        struct scene scene = scene_of(&views[k].parts);
        struct sensitivity list[SENSITIVITIES];
        check_sensitivities(&scene, list);
        assert_close(list[0].kappa / (4 * M_PI * 150e3 * views[k].range / 1500), 1, 0.05);
        assert_close(list[1].kappa / (4 * M_PI * 150e3 * views[k].range / 1500), 1, 0.05);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(exactly_the_violated_condition_is_named, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(mistakes_of_the_scene_are_named, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(patches_beyond_the_record_are_counted, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(gaps_are_told_of_an_uneven_track, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(echoes_without_an_imaginary_part_are_told, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(delays_are_those_of_what_is_seen, folder_make, folder_remove),
        cmocka_unit_test(no_worst_hides_a_nan),
        cmocka_unit_test_setup_teardown(refusals_of_the_plan_are_told, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(rows_beyond_the_record_are_refused, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(sensitivities_are_those_of_the_delay, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(sensitivities_follow_beam_and_axes, folder_make, folder_remove),
    };
    return cmocka_run_group_tests_name("check", tests, NULL, NULL);
}
