/* What is lost where geometry is left out: the laws against errors measured by the exact image of a geometry without
   it. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "metrics/metrics.h"
#include "backprojection/pairs/omission.h"
#include "backprojection/pairs/pairs.h"
#include "contract/condition.h"
#include "imaging/imaging.h"
#include "tests/support.h"

/* Speckle before an array whose pings lie half of it apart. */
struct setup {
    double fc, bandwidth, element, r, slow; /* Hz, Hz, wavelengths, m; the interval over the way's time */
    int receivers;
};

static const struct setup setups[] = {
    {100e3, 20e3, 4, 20, 4, 8},   {150e3, 15e3, 6, 60, 10, 16}, {60e3, 20e3, 3, 12, 3, 6},
    {200e3, 20e3, 8, 90, 20, 20}, {80e3, 8e3, 5, 35, 6, 10},    {250e3, 60e3, 6, 25, 2, 8},
};
static const double RATIO = 1.4; /* predicted over measured at most, and 1 over it at least */
enum { SETUPS = sizeof setups / sizeof *setups };

static void scene_make(const struct setup *s, struct scene *scene)
{
    char text[2000];
    const double c = 1500, wavelength = c / s->fc, element = s->element * wavelength, pitch = element / 2;
    const double spacing = s->receivers * pitch / 2, pri = s->slow * 2 * s->r / c, fs = 1.5 * s->bandwidth;
    const double aside = s->r / sqrt(s->element * s->element - 1) + 0.5; /* the beam's main lobe */
    const int pings = (int)ceil(2 * aside / spacing) + 2;
    const double late = 2 * (hypot(s->r + 1, aside + 1) - s->r) / c;
    const int first = (int)(2 * s->r / c * fs) - 40;
    snprintf(
        text, sizeof text,
        "sonar = { fc = %.17g; bandwidth = %.17g; fs = %.17g; };\npulse = { kind = \"flat\"; };\n"
        "array = { tx_length = %.17g; rx_length = %.17g; receivers = %d; first_offset = %.17g; pitch = %.17g; };\n"
        "track = { speed = %.17g; pri = %.17g; pings = %d; x_first = %.17g; };\n"
        "record = { first_sample = %d; samples = %d; };\n"
        "beam = { kind = \"txrx\"; truncation = \"tx\"; limit = 1.0; };\n"
        "targets = { fields = ( { x = [-0.4, 0.4]; r = [%.6f, %.6f]; count = 40; seed = 5; } ); };\n"
        "image = { x = { first = -0.5; step = %.17g; count = %d; }; r = { first = %.17g; step = %.17g; count = 12; "
        "}; };\n",
        s->fc, s->bandwidth, fs, element, pitch, s->receivers, pitch, pitch, spacing / pri, pri, pings,
        -(pings - 1) * spacing / 2, first, (int)(late * fs) + 80, s->r, s->r + 12 * c / (2 * fs) * 0.8, element / 8,
        (int)(1 / (element / 8)) + 1, s->r, c / (2 * fs) * 0.8);
    support_write("scene.cfg", text);
    if (scene_load(path_of("scene.cfg"), SASBENCH_ROOT "/scenes", scene) != STATUS_OK)
        fail_msg("%s", status_message());
}

/* The exact image of the scene's echoes as another acquisition has it. */
static void image_by(const struct scene *scene, const struct acquisition *acquisition, const struct echoes *echoes,
                     struct image *image)
{
    const struct problem problem = problem_make(acquisition, scene->patch_count, scene->patches, PRECISION_DOUBLE);
    assert_int_equal(support_image("reference:precision=double", problem, echoes, image), STATUS_OK);
}

static void compare(int setup, const char *what, double predicted, double measured)
{
    print_message("setup %d, %-22s predicted %.3e, measured %.3e, ratio %.2f\n", setup, what, predicted, measured,
                  predicted / measured);
    if (!(predicted < RATIO * measured && predicted > measured / RATIO))
        fail_msg("setup %d, %s: %g is predicted, %g measured", setup, what, predicted, measured);
}

static void apertures(const struct setup *s, const struct scene *scene, const struct echoes *echoes,
                      const struct image *exact)
{
    static const double errors[] = {0.1, 0.03};
    const struct problem problem =
        problem_make(&scene->acquisition, scene->patch_count, scene->patches, PRECISION_DOUBLE);
    for (size_t k = 0; k < sizeof errors / sizeof *errors; k++) {
        struct acquisition limited = scene->acquisition;
        struct image image;
        char what[40];
        limited.aperture_limit = aperture_sine(&problem, errors[k]);
        image_by(scene, &limited, echoes, &image);
        snprintf(what, sizeof what, "aperture to %.3f", limited.aperture_limit);
        compare((int)(s - setups), what, aperture_error(&problem, limited.aperture_limit),
                metrics_error(&image, exact).error_gain);
        image_free(&image);
    }
}

static void laws_hold(void **state)
{
    (void)state;
    for (int k = 0; k < SETUPS; k++) {
        struct scene scene;
        struct echoes echoes;
        struct image exact;
        scene_make(&setups[k], &scene);
        support_echoes(&scene, &echoes);
        image_by(&scene, &scene.acquisition, &echoes, &exact);
        apertures(&setups[k], &scene, &echoes, &exact);
        image_free(&exact);
        echoes_free(&echoes);
        scene_free(&scene);
    }
}

/* Beams with edges, and a scene's own limit of the aperture: side lobes of both apertures are beside the targets. */
static void beams_that_end_at_once(void **state)
{
    (void)state;
    static const char *const names[] = {"pf05/nine", "sq18/squint_00"};
    static const double parts[] = {0.3, 0.7, 0.9, 0.97, 0.997};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        struct scene scene;
        struct echoes echoes;
        struct image exact;
        if (scene_load(names[n], SASBENCH_ROOT "/scenes", &scene) != STATUS_OK)
            fail_msg("%s", status_message());
        const struct problem problem =
            problem_make(&scene.acquisition, scene.patch_count, scene.patches, PRECISION_DOUBLE);
        support_echoes(&scene, &echoes);
        image_by(&scene, &scene.acquisition, &echoes, &exact);
        for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
            struct acquisition limited = scene.acquisition;
            struct image image;
            limited.aperture_limit = parts[k] * fmin(limited.aperture_limit, condition_seen_sine(&limited));
            image_by(&scene, &limited, &echoes, &image);
            const double planned = aperture_planned(&problem, limited.aperture_limit);
            const double measured = metrics_error(&image, &exact).error_gain;
            print_message("%-16s aperture to %.4f: planned %.3f, measured %.3f, ratio %.2f; the energy law says %.3f\n",
                          names[n], limited.aperture_limit, planned, measured, planned / measured,
                          aperture_error(&problem, limited.aperture_limit));
            assert_true(planned >= measured && planned < 1.6 * measured);
            image_free(&image);
        }
        image_free(&exact);
        echoes_free(&echoes);
        scene_free(&scene);
    }
}

/* Settings may limit the aperture: the image is that of an acquisition with the limit, to the last bit; records of
   pings that then meet no pixel are not read, for they may hold anything, and their transforms are not counted. */
static void pings_left_out(void **state)
{
    (void)state;
    static const char *const engines[] = {"general", "invariant"};
    struct scene scene;
    struct echoes echoes;
    scene_make(&setups[0], &scene);
    support_echoes(&scene, &echoes);
    scene.acquisition.noise = 1; /* for records as a whole, whatever samples are read */
    const struct problem problem = problem_make(&scene.acquisition, scene.patch_count, scene.patches, PRECISION_DOUBLE);
    struct acquisition limited = scene.acquisition;
    limited.aperture_limit = 0.1;
    const struct problem less = problem_make(&limited, scene.patch_count, scene.patches, PRECISION_DOUBLE);
    bool met[200];
    const int pings = limited.pings, count = pings_met(&less, met);
    assert_true(pings <= 200 && count < pings && count > pings / 4);
    assert_int_equal(pings_met(&problem, met), pings);
    pings_met(&less, met);
    for (size_t k = 0; k < sizeof engines / sizeof *engines; k++) {
        char all[80], some[100];
        struct image by_scene, by_setting, unread;
        snprintf(all, sizeof all, "bp_zeropad:factor=2,precision=double,engine=%s", engines[k]);
        snprintf(some, sizeof some, "%s,aperture=0.1", all);
        assert_int_equal(support_image(all, less, &echoes, &by_scene), STATUS_OK);
        assert_int_equal(support_image(some, problem, &echoes, &by_setting), STATUS_OK);
        assert_true(support_difference(&by_setting, &by_scene) == 0);
        struct echoes spoilt;
        support_echoes(&scene, &spoilt);
        const int values = limited.receivers * limited.samples;
        for (int n = 0; n < pings * values; n++)
            if (!met[n / values])
                ((double complex *)spoilt.samples)[n] = NAN;
        assert_int_equal(support_image(some, problem, &spoilt, &unread), STATUS_OK);
        assert_true(support_difference(&unread, &by_scene) == 0);
        const struct work whole = support_work(all, problem), part = support_work(some, problem);
        struct spec spec;
        assert_int_equal(spec_parse(some, &spec), STATUS_OK);
        const struct work_bounds bounds = work_bounds(spec.algorithm, spec.options, &problem, &part);
        assert_int_equal(work_check(some, &bounds, &part), STATUS_OK);
        spec_free(&spec);
        const double records = (part.flops - 8 * part.pairs) / (whole.flops - 8 * whole.pairs);
        print_message("%s: %.3f of the pairs, %.3f of the records' FLOPs for %d of %d pings\n", engines[k],
                      part.pairs / whole.pairs, records, count, pings);
        assert_true(part.pairs < 0.9 * whole.pairs);
        assert_close(records, (double)count / pings, 1e-9);
        assert_non_null(strstr(part.skipped, "which no pixel meets"));
        echoes_free(&spoilt);
        image_free(&by_scene);
        image_free(&by_setting);
        image_free(&unread);
    }
    echoes_free(&echoes);
    scene_free(&scene);
}

/* Few pings have no law. */
static void few_pings(void **state)
{
    (void)state;
    struct acquisition a = support_acquisition(5, 1, 64);
    const struct grid grid = {0, 0.01, 4, 10, 0.01, 4};
    const struct problem problem = problem_make(&a, 1, &grid, PRECISION_DOUBLE);
    assert_true(isnan(aperture_error(&problem, 0.1)));
    assert_true(isinf(aperture_sine(&problem, 0.1)));
    acquisition_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(laws_hold, folder_make, folder_remove),
        cmocka_unit_test(beams_that_end_at_once),
        cmocka_unit_test_setup_teardown(pings_left_out, folder_make, folder_remove),
        cmocka_unit_test(few_pings),
    };
    return cmocka_run_group_tests_name("omission", tests, NULL, NULL);
}
