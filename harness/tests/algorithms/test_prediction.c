/* Range migration on scenes that nobody chose for it: images within the error that was predicted, or refused by
   name. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/support.h"

/* 150 kHz, receivers 0.04 m apart, tracks about x = 0, one target at range r and 21 rows about it. */
struct setup {
    const char *what;
    double bandwidth, first_offset, tx_length, spacing, r, target, half, first; /* Hz, m: columns first +- half */
    int receivers, pings, columns;
    const char *beam;
    const char *spec, *refused; /* refused by this condition; "": not refused */
    double error, predicted;    /* at most; what the prediction makes of it: where not refused */
};

#define OPEN  "kind = \"rect\";"
#define CUT   "kind = \"rect\"; truncation = \"tx\"; limit = 0.443;"
#define TAPER "kind = \"txrx\";"

static const struct setup setups[] = {
    {"plain", 15e3, 0.04, 0.08, 0.16, 20, 0, 0.5, 0, 8, 17, 33, CUT, "rma_lbf", "", 0.005, 1.67e-2},
    {"narrow columns, few pings", 15e3, 0.04, 0.08, 0.1, 4, 0, 0.05, 0, 8, 4, 33, OPEN, "rma_lbf", "", 0.1, 1.35e-2},
    {"echoes from beyond the element's null", 15e3, 0.04, 0.28, 0.8, 100, 0, 0.56, 0, 40, 21, 33, OPEN, "rma_lbf", "",
     0.005, 1.78e-3}, /* was 0.70 */
    {"more wavenumbers than sampled, of the upper band's edge alone", 140e3, 0.04, 0.08, 0.16, 20, 0, 0.5, 0, 8, 17, 33,
     OPEN, "rma_lbf", "", 0.02, 1.81e-2}, /* was refused */
    {"receiver far astern, deep", 15e3, -1.84, 0.08, 0.03, 20, 0, 0.7, 0, 2, 17, 33, OPEN, "rma_numeric", "", 0.05,
     1.9e-3}, /* was 0.15, by a lone block */
    {"two pings, one of them in the beam", 15e3, 0.04, 0.08, 0.16, 20, 0.9, 1.5, 1.2, 8, 2, 33, CUT, "rma_lbf", "",
     0.06, 1.5e-2},
    {"two pings, wide columns", 15e3, 0.04, 0.08, 0.8, 100, 0, 12, 0, 40, 2, 81, OPEN, "rma_lbf", "doppler", 0, 0},
    {"five pings close to the rows", 15e3, 0.04, 0.08, 0.2, 4, 0, 0.64, 0, 8, 5, 65, OPEN, "rma_lbf", "doppler", 0, 0},
    {"nine pings close to the rows, wide columns", 15e3, 0.04, 0.08, 0.1, 4, 0, 3, 0, 8, 9, 65, OPEN, "rma_lbf",
     "doppler", 0, 0},
    {"receiver 104 wavelengths astern", 15e3, -1.04, 0.08, 0.005, 4, 0, 0.1, 0, 1, 81, 33, OPEN, "rma_pca", "pca_law",
     0, 0},
    {"rows nearer than the array is long, where the formula ends inside the beam", 15e3, 0.04, 0.08, 0.8, 0.66, 0, 0.16,
     0, 40, 21, 33, OPEN, "rma_lbf", "spa_amplitude", 0, 0},
    {"columns that no ping sees", 15e3, 0.04, 0.08, 0.16, 20, 5, 0.3, 5, 8, 9, 33, CUT, "rma_lbf", "predicted_error", 0,
     0},
};

static struct scene scene_of(const struct setup *s)
{
    char text[2000];
    double fs = 2 * s->bandwidth, delay = 2 * s->r / 1500, aside = s->half + s->pings * s->spacing / 2;
    int first = (int)(delay * fs) - 100, count = (int)((hypot(s->r, 2 * aside) - s->r) / 750 * fs) + 300;
    snprintf(
        text, sizeof text,
        "sonar = { fc = 150e3; bandwidth = %.17g; fs = %.17g; };\npulse = { kind = \"flat\"; };\n"
        "array = { tx_length = %.17g; rx_length = 0.04; receivers = %d; first_offset = %.17g; pitch = 0.04; };\n"
        "track = { speed = 2.5; pri = %.17g; pings = %d; x_first = %.17g; };\n"
        "record = { first_sample = %d; samples = %d; };\nbeam = { %s };\n"
        "targets = { points = ( { x = %.17g; r = %.17g; } ); };\n"
        "image = { x = { first = %.17g; step = %.17g; count = %d; }; r = { first = %.17g; step = 0.01; count = 21; "
        "}; };\n",
        s->bandwidth, fs, s->tx_length, s->receivers, s->first_offset, s->spacing / 2.5, s->pings,
        -(s->pings - 1) * s->spacing / 2, first > 0 ? first : 0, count, s->beam, s->target, s->r, s->first - s->half,
        2 * s->half / (s->columns - 1), s->columns, s->r - 0.2);
    struct scene scene;
    support_write("scene.cfg", text);
    if (scene_load(path_of("scene.cfg"), SASBENCH_ROOT "/scenes", &scene) != STATUS_OK)
        fail_msg("%s: %s", s->what, status_message());
    return scene;
}

/* What the condition of this name says of a SPEC; NAN without it. */
static double condition_value(const char *text, const struct problem *problem, const char *name)
{
    struct condition list[CONDITIONS_MAX];
    struct spec spec;
    double value = NAN;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    int count = algorithm_conditions(spec.algorithm, problem, spec.options, list, CONDITIONS_MAX);
    for (int k = 0; k < count; k++)
        if (strcmp(list[k].name, name) == 0)
            value = list[k].value;
    spec_free(&spec);
    return value;
}

static void images_are_right_or_refused(void **state)
{
    (void)state;
    int failures = 0;
    for (size_t k = 0; k < sizeof setups / sizeof *setups; k++) {
        const struct setup *s = &setups[k];
        struct scene scene = scene_of(s);
        struct problem problem = problem_make(&scene.acquisition, scene.patch_count, scene.patches, PRECISION_DOUBLE);
        struct echoes echoes;
        struct image exact, image;
        char spec[60], name[60];
        support_echoes(&scene, &echoes);
        snprintf(spec, sizeof spec, "%s:precision=double", s->spec);
        snprintf(name, sizeof name, "condition %s:", s->refused);
        assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
        if (support_image(spec, problem, &echoes, &image) == STATUS_OK) {
            double error = support_difference(&image, &exact);
            double predicted = condition_value(spec, &problem, "predicted_error");
            print_message("    %s: %.2e, predicted %.2e\n", s->what, error, predicted);
            if (!is_close(predicted / s->predicted, 1, 0.05))
                print_error("%s: an error of %g is predicted, not %g\n", s->what, predicted, s->predicted), failures++;
            if (s->refused[0] || !(error <= s->error))
                print_error("%s: error %g of %s is accepted\n", s->what, error, spec), failures++;
            image_free(&image);
        } else {
            print_message("    %s: %s\n", s->what, status_message());
            if (!s->refused[0] || !strstr(status_message(), name))
                print_error("%s: %s\n", s->what, status_message()), failures++;
        }
        image_free(&exact);
        echoes_free(&echoes);
        scene_free(&scene);
    }
    assert_int_equal(failures, 0);
}

/* Pings 0.11 m apart see targets at 1.6 m, at the edge of their beams, and neither those of the first row at all nor
   those of the last so badly (was accepted, with an error of 0.37); receivers 0.6 m to either side of the transmitter,
   1.1 m from the nearest row (was 1.3). Omega-k of two pings that see a target at the edges of their beams (was 0.72),
   of near rows that few pings see (was 0.48), and in turned axes at 0.3 of the speed of sound (was 0.12). */
static const struct {
    const char *text, *spec, *refused;
} wrong[] = {
    {"sonar = { sound_speed = 794; fc = 58115; bandwidth = 1984; fs = 7935; };\npulse = { kind = \"flat\"; };\n"
     "array = { tx_length = 0.3; rx_length = 0.09; receivers = 1; };\n"
     "track = { speed = 7.94; pri = 0.0143; pings = 3; x_first = -0.208; };\n"
     "record = { first_sample = 1; samples = 250; };\n"
     "beam = { kind = \"txrx\"; truncation = \"tx\"; limit = 0.443; };\n"
     "targets = { points = ( { x = 0.0015; r = 1.6; } ); };\n"
     "image = { x = { first = -0.0041; step = 3.35e-4; count = 21; }; r = { first = 0.179; step = 0.02; count = "
     "400; }; };\n",
     "rma_numeric", "condition predicted_error:"},
    {"sonar = { sound_speed = 2294; fc = 42367; bandwidth = 517; fs = 620; };\npulse = { kind = \"flat\"; };\n"
     "array = { tx_length = 0.97; rx_length = 0.607; receivers = 3; first_offset = -0.607; pitch = 0.635; };\n"
     "track = { speed = 2; pri = 0.238; pings = 2; x_first = -0.256; };\n"
     "record = { first_sample = 0; samples = 65; };\n"
     "beam = { kind = \"txrx\"; truncation = \"doppler\"; limit = 0.5; };\n"
     "targets = { points = ( { x = 0.0067; r = 2.734; } ); };\n"
     "image = { x = { first = -0.024; step = 0.00116; count = 33; }; r = { first = 1.149; step = 1.775; count = 6; "
     "}; };\n",
     "rma_numeric", "condition spa_amplitude:"},
    {"sonar = { sound_speed = 4400; fc = 271e3; bandwidth = 102e3; fs = 204e3; };\npulse = { kind = \"flat\"; };\n"
     "array = { tx_length = 0.368; rx_length = 0.32; receivers = 1; };\n"
     "track = { speed = 0; pri = 0.1; spacing = -0.16; pings = 2; x_first = -0.0383; };\n"
     "record = { first_sample = 27; samples = 46; };\n"
     "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.443; squint = 20.0; };\n"
     "targets = { points = ( { x = -0.00617; r = 0.55; } ); };\n"
     "image = { around_targets = { half_x = 0.00705; half_r = 0; x_step = 8.8e-5; r_step = 0.017; }; };\n",
     "wk_classic", "condition predicted_error:"},
    {"sonar = { fc = 60463; bandwidth = 15649; fs = 18778; };\npulse = { kind = \"flat\"; };\n"
     "array = { tx_length = 0.267; rx_length = 0.134; receivers = 1; };\n"
     "track = { speed = 0; pri = 0.1; spacing = 0.0334; pings = 36; x_first = -1.097; };\n"
     "record = { first_sample = 17; samples = 221; };\n"
     "beam = { kind = \"txrx\"; truncation = \"tx\"; limit = 1; squint = 5.0; };\n"
     "targets = { points = ( { x = -0.0162; r = 3.489; }, { x = 0.0114; r = 4.731; } ); };\n"
     "image = { x = { first = -0.0215; step = 0.00131; count = 33; }; r = { first = 0.777; step = 0.024; count = "
     "81; "
     "}; };\n",
     "wk_squint", "condition predicted_error:"},
    {"sonar = { sound_speed = 1480; fc = 53879; bandwidth = 4286; fs = 5144; };\npulse = { kind = \"flat\"; };\n"
     "array = { tx_length = 0.0634; rx_length = 0.0308; receivers = 1; };\n"
     "track = { speed = 444; pri = 3.468e-5; pings = 90; x_first = -27.27; };\n"
     "record = { first_sample = 131; samples = 299; };\n"
     "beam = { kind = \"rect\"; truncation = \"sine\"; limit = 0.2786; squint = 45.0; };\n"
     "targets = { points = ( { x = 0.258; r = 28.45; } ); };\n"
     "image = { x = { first = -0.285; step = 0.00475; count = 160; }; r = { first = 28.45; step = 0.14; count = 1; "
     "}; "
     "};\n",
     "wk_squint", "condition subsonic:"},
};

static void wrong_images_are_refused(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        struct scene scene;
        struct echoes echoes;
        struct image image;
        support_write("scene.cfg", wrong[k].text);
        assert_int_equal(scene_load(path_of("scene.cfg"), SASBENCH_ROOT "/scenes", &scene), STATUS_OK);
        const struct problem problem =
            problem_make(&scene.acquisition, scene.patch_count, scene.patches, PRECISION_DOUBLE);
        support_echoes(&scene, &echoes);
        assert_int_equal(support_image(wrong[k].spec, problem, &echoes, &image), STATUS_UNSUPPORTED);
        print_message("    %s\n", status_message());
        assert_non_null(strstr(status_message(), wrong[k].refused));
        echoes_free(&echoes);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(images_are_right_or_refused, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(wrong_images_are_refused, folder_make, folder_remove),
    };
    return cmocka_run_group_tests_name("prediction", tests, NULL, NULL);
}
