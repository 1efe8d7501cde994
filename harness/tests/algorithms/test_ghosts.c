/* Grating lobes: a lone receiver whose pings are far apart, and targets so far from each other that back projection
   sees one in the image of the other. Transforms image such scenes only with an aperture limit within the sampled
   wavenumbers. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "range_migration/rma_conditions.h"
#include "tests/support.h"

/* Pings 0.04 m apart at 1 cm wavelength sample sines up to 0.0625; the beam ends at 0.025, the element's first null is
   at 0.0536 at the lowest frequency. */
static const double LIMIT = 0.0535714;

static void load(double apart, double limit, double squint, double half, struct scene *scene)
{
    char text[1500];
    const double c = cos(squint * M_PI / 180), s = sin(squint * M_PI / 180), r = 30;
    snprintf(text, sizeof text,
             "sonar = { fc = 150e3; bandwidth = 20e3; fs = 25e3; };\npulse = { kind = \"flat\"; };\n"
             "array = { tx_length = 0.2; rx_length = 0.2; receivers = 1; };\n"
             "track = { speed = 0.0; pri = 0.1; spacing = 0.04; pings = 220; x_first = -4.4; };\n"
             "record = { first_sample = 700; samples = 600; };\naperture_limit = %.17g;\n"
             "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.5; squint = %.17g; };\n"
             "targets = { points = ( { x = %.17g; r = %.17g; }, { x = %.17g; r = %.17g; } ); };\n"
             "image = { angle = %.17g; around_targets = { half_x = %.17g; half_r = 0.2; x_step = 0.04; r_step = 0.02; "
             "}; };\n",
             limit, squint, -apart * c + r * s, apart * s + r * c, apart * c + r * s, -apart * s + r * c, squint, half);
    support_write("scene.cfg", text);
    if (scene_load(path_of("scene.cfg"), SASBENCH_ROOT "/scenes", scene) != STATUS_OK)
        fail_msg("%s", status_message());
}

/* Error of a SPEC's image, or -1 where grating_lobes refuses. */
static double error_of(const char *spec, const struct scene *scene)
{
    const struct problem problem =
        problem_make(&scene->acquisition, scene->patch_count, scene->patches, PRECISION_DOUBLE);
    struct echoes echoes;
    struct image exact, image;
    double error = -1;
    support_echoes(scene, &echoes);
    if (support_image(spec, problem, &echoes, &image) == STATUS_OK) {
        assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
        error = support_difference(&image, &exact);
        image_free(&image);
        image_free(&exact);
    } else if (!strstr(status_message(), "condition grating_lobes:")) {
        fail_msg("%s: %s", spec, status_message());
    }
    echoes_free(&echoes);
    return error;
}

static double ghosts_of(const struct scene *scene)
{
    const struct problem problem =
        problem_make(&scene->acquisition, scene->patch_count, scene->patches, PRECISION_DOUBLE);
    struct straight_track track;
    assert_true(acquisition_is_straight(&scene->acquisition, &track));
    return ghosts_condition(&problem, &track).value;
}

/* Relative L2 of what the limit takes off the exact image. */
static double measured(double apart, double squint)
{
    struct scene scene, limited;
    struct echoes echoes;
    struct image with, without;
    load(apart, 1, squint, 0.4, &scene);
    load(apart, LIMIT, squint, 0.4, &limited);
    const struct problem all = problem_make(&scene.acquisition, scene.patch_count, scene.patches, PRECISION_DOUBLE);
    const struct problem sampled =
        problem_make(&limited.acquisition, limited.patch_count, limited.patches, PRECISION_DOUBLE);
    support_echoes(&scene, &echoes);
    assert_int_equal(support_image("reference:precision=double", all, &echoes, &with), STATUS_OK);
    assert_int_equal(support_image("reference:precision=double", sampled, &echoes, &without), STATUS_OK);
    double difference = support_difference(&without, &with);
    image_free(&with);
    image_free(&without);
    echoes_free(&echoes);
    scene_free(&scene);
    scene_free(&limited);
    return difference;
}

static void refused_or_right(void **state)
{
    (void)state;
    static const char *const specs[] = {"rma_numeric", "wk_classic:pad=2", "wk_squint:pad=2"};
    static const double aparts[] = {0.5, 1, 2, 3}, squints[] = {0, 15, -30};
    int refused = 0, accepted = 0;
    for (int n = 0; n < 4 * 3; n++) {
        const double apart = aparts[n % 4], squint = squints[n / 4], ghosts = measured(apart, squint);
        struct scene scene, limited;
        load(apart, 1, squint, 0.4, &scene);
        load(apart, LIMIT, squint, 0.4, &limited);
        double value = ghosts_of(&scene);
        print_message("%g m apart, squint %g: ghosts %.3f, predicted %.3f\n", apart, squint, ghosts, value);
        if (!(value >= ghosts / 1.5 && value <= 4 * ghosts + 0.02) || !(ghosts_of(&limited) < 5e-3))
            fail_msg("ghosts of %g, predicted %g; %g with the limit", ghosts, value, ghosts_of(&limited));
        for (int k = squint != 0; k < 3; k++) {
            double error = error_of(specs[k], &scene), within = error_of(specs[k], &limited);
            print_message("    %s: %.4f, %.4f\n", specs[k], error, within);
            refused += error < 0;
            accepted += error >= 0;
            if ((error < 0) != (value > 0.1) || error > 0.12
                || !(within >= 0 && within < (ghosts < 0.1 ? ghosts + 6e-3 : 1e-2)))
                fail_msg("%s: error %g, %g with the limit; ghosts %g", specs[k], error, within, value);
        }
        scene_free(&scene);
        scene_free(&limited);
    }
    assert_true(refused > 5 && accepted > 5); /* both do occur */
}

/* A patch so wide that back projection sees a target in it as ghosts at its ends. */
static void within_a_patch(void **state)
{
    (void)state;
    static const double halves[] = {0.8, 3};
    for (int k = 0; k < 2; k++) {
        struct scene scene;
        load(0, 1, 0, halves[k], &scene);
        double range_migration = error_of("rma_numeric", &scene), omega_k = error_of("wk_classic:pad=2", &scene);
        print_message("%g m to either side: %.4f, %.4f\n", halves[k], range_migration, omega_k);
        assert_true(k == 0 ? range_migration < 0.1 && omega_k >= 0 && omega_k < 0.1 : omega_k < 0);
        scene_free(&scene);
    }
}

/* Rows beside the record, ahead of it and behind it: patches of zeros, and the others as they are alone. */
static void rows_beside_the_record(void **state)
{
    (void)state;
    static const char *const specs[] = {"rma_lbf", "rma_numeric", "rma_delay"};
    static const double places[] = {30, 22, 38}; /* the record lasts from 26 to 34 m */
    char text[1500];
    snprintf(text, sizeof text,
             "sonar = { fc = 150e3; bandwidth = 15e3; fs = 20e3; };\npulse = { kind = \"flat\"; };\n"
             "array = { tx_length = 0.08; rx_length = 0.04; receivers = 8; first_offset = 0.04; pitch = 0.04; };\n"
             "track = { speed = 2.5; pri = 0.064; pings = 40; x_first = -3.2; };\n"
             "record = { first_sample = 693; samples = 214; };\nbeam = { kind = \"txrx\"; };\n"
             "targets = { points = ( { x = 0; r = %g; }, { x = 0.3; r = %g; }, { x = -0.3; r = %g; } ); };\n"
             "image = { around_targets = { half_x = 0.08; half_r = 0; x_step = 0.01; r_step = 0.0125; }; };\n",
             places[0], places[1], places[2]);
    struct scene scene;
    support_write("scene.cfg", text);
    if (scene_load(path_of("scene.cfg"), SASBENCH_ROOT "/scenes", &scene) != STATUS_OK)
        fail_msg("%s", status_message());
    for (int k = 0; k < 3; k++) {
        double error = error_of(specs[k], &scene);
        print_message("%s: %.4f\n", specs[k], error);
        assert_true(error >= 0 && error < 0.05);
    }
    scene_free(&scene);
}

/* Twice as many receivers as the spacing of the pings needs: the aliases of what is seen at broadside lie at
   wavenumbers that neither any ping nor any receiver sees from the columns wanted, and focus on rows nearer by (was
   .13). The records begin so near that the delays of the receivers are not small against the range. */
static void redundant_receivers(void **state)
{
    (void)state;
    struct scene scene;
    struct echoes echoes;
    struct image image;
    support_write("scene.cfg",
                  "sonar = { fc = 150e3; bandwidth = 7.5e3; fs = 11.25e3; };\npulse = { kind = \"flat\"; };\n"
                  "array = { tx_length = 0.08; rx_length = 0.04; receivers = 16; pitch = 0.04; };\n"
                  "track = { speed = 0.0; pri = 0.1; spacing = 0.16; pings = 4; x_first = -0.256; };\n"
                  "record = { first_sample = 7; samples = 290; };\nbeam = { kind = \"txrx\"; };\n"
                  "targets = { points = ( { x = 0.2500458846; r = 6.4164648; } ); };\n"
                  "image = { around_targets = { half_x = 0.16; half_r = 1.0; x_step = 0.01; r_step = 0.1; }; };\n");
    assert_int_equal(scene_load(path_of("scene.cfg"), SASBENCH_ROOT "/scenes", &scene), STATUS_OK);
    double error = error_of("rma_numeric", &scene);
    print_message("redundant receivers: %.4f\n", error);
    assert_true(error >= 0 && error < 0.05);
    const struct problem problem = problem_make(&scene.acquisition, scene.patch_count, scene.patches, PRECISION_FLOAT);
    support_echoes(&scene, &echoes);
    assert_int_equal(support_image("rma_delay", problem, &echoes, &image), STATUS_UNSUPPORTED);
    assert_non_null(strstr(status_message(), "condition delay_near:"));
    echoes_free(&echoes);
    scene_free(&scene);
}

/* Phase centres without gaps, one deep or several, make no ghosts; gaps, or a depth that changes from place to
   place, do, and are told. */
static void spacing_of_the_pings(void **state)
{
    (void)state;
    static const struct {
        double spacing;
        bool ghosts;
    } cases[] = {{0.16, false}, {0.08, false}, {0.16 / 3, false}, {0.1, true}, {0.12, true}, {0.2, true}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const double spacing = cases[k].spacing, away = 0.01 * 20 / (2 * spacing);
        char text[1500];
        snprintf(text, sizeof text,
                 "sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\npulse = { kind = \"flat\"; };\n"
                 "array = { tx_length = 0.08; rx_length = 0.04; receivers = 8; first_offset = 0.04; pitch = 0.04; };\n"
                 "track = { speed = 2.5; pri = %.17g; pings = %d; x_first = -3; };\n"
                 "record = { first_sample = 0; samples = 900; };\nbeam = { kind = \"txrx\"; };\n"
                 "targets = { points = ( { x = 0; r = 20; } ); };\n"
                 "image = { x = { first = 0; step = %.17g; count = 2; }; r = { first = 20.0; step = 0.1; count = 1; }; "
                 "};\n",
                 spacing / 2.5, (int)round(6 / spacing), away);
        struct scene scene;
        struct echoes echoes;
        struct image image;
        struct condition list[CONDITIONS_MAX];
        support_write("scene.cfg", text);
        if (scene_load(path_of("scene.cfg"), SASBENCH_ROOT "/scenes", &scene) != STATUS_OK)
            fail_msg("%s", status_message());
        const struct problem problem = problem_make(&scene.acquisition, 1, scene.patches, PRECISION_DOUBLE);
        support_echoes(&scene, &echoes);
        assert_int_equal(support_image("reference:precision=double", problem, &echoes, &image), STATUS_OK);
        const double ghost = cabs(image_pixel(&image, 0, 0, 1)) / cabs(image_pixel(&image, 0, 0, 0));
        int count = conditions_sampled(&problem, list, CONDITIONS_MAX), told = -1;
        for (int n = 0; n < count; n++)
            told = strcmp(list[n].name, "ghost") == 0 ? !condition_holds(&list[n]) : told;
        print_message("pings %.4g m apart: %.1f dB at %.2f m\n", spacing, 20 * log10(ghost), away);
        assert_int_equal(told, cases[k].ghosts);
        assert_true(cases[k].ghosts ? ghost > 0.02 : ghost < 0.01);
        image_free(&image);
        echoes_free(&echoes);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(refused_or_right, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(within_a_patch, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(rows_beside_the_record, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(spacing_of_the_pings, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(redundant_receivers, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
