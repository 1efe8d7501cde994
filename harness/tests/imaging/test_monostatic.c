/* The filter `monostatic`: multi-receiver echoes, squinted and not, that omega-k images within its error, and what it
   refuses. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "imaging/spec.h"
#include "scene/random.h"
#include "scene/scene.h"
#include "tests/support.h"

#define RECEIVERS_20 "base = {\n@include \"" SASBENCH_ROOT "/scenes/sq18/receivers_20.cfg\"\n};\n"

/* A beam of 20 degrees at broadside, whose track moves by `errors`, of which the imager is told. */
#define MOVED(errors)                                                                                                  \
    "sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\n"                                                          \
    "array = { tx_length = 0.0255; rx_length = 0.0255; receivers = 8; first_offset = 0.0; pitch = 0.0255; };\n"        \
    "record = { first_sample = 1080; samples = 220; };\n"                                                              \
    "beam = { kind = \"txrx\"; truncation = \"tx\"; limit = 0.443; };\n"                                               \
    "image = { x = { first = -1.0; step = 0.04; count = 50; }; r = { first = 28.5; step = 0.05; count = 60; }; };\n"   \
    "targets = { fields = ( { x = [-1.0, 1.0]; r = [28.5, 31.5]; count = 60; seed = 2; } ); };\n"                      \
    "track = { speed = 1.02; pri = 0.1; pings = 120; x_first = -6.1; errors_known = true; errors = ( " errors          \
    " ); };\n"

static void scene_load_text(const char *text, struct scene *scene)
{
    support_write("varied.cfg", text);
    if (scene_load(path_of("varied.cfg"), SASBENCH_ROOT "/scenes", scene) != STATUS_OK)
        fail_msg("%s: %s", text, status_message());
}

static void scene_make(const char *keys, struct scene *scene)
{
    char text[2000];
    snprintf(text, sizeof text, RECEIVERS_20 "%s", keys);
    scene_load_text(text, scene);
}

/* Invites the chain, whose name is then known. */
static void chain_settle(const char *text, char *settled, size_t size)
{
    struct spec spec;
    if (spec_own(text, &spec) != STATUS_OK)
        fail_msg("%s: %s", text, status_message());
    snprintf(settled, size, "%s%s%s", spec.algorithm->name, *spec.text ? ":" : "", spec.text);
    spec_free(&spec);
}

static double error_of(const char *text, const struct scene *scene, enum precision precision)
{
    char spec[300];
    struct echoes echoes;
    struct image exact, image;
    const struct problem problem = scene_problem(scene, PRECISION_DOUBLE);
    chain_settle(text, spec, sizeof spec - 20);
    if (precision == PRECISION_DOUBLE)
        strcat(spec, strchr(spec, '=') > strchr(spec, '|') ? ",precision=double" : ":precision=double");
    support_echoes(scene, &echoes);
    assert_int_equal(support_image("reference:precision=double", problem, &echoes, &exact), STATUS_OK);
    const enum status status = support_image(spec, problem, &echoes, &image);
    if (status != STATUS_OK)
        fail_msg("%s: %s", spec, status_message());
    const double error = support_difference(&image, &exact);
    image_free(&image);
    image_free(&exact);
    echoes_free(&echoes);
    return error;
}

/* By back projection of degree 5 behind the filter, whose error that is, and by an algorithm of one receiver, in both
   precisions. Frees the scene. */
static void errors_are_within(const char *name, size_t number, struct scene *scene, const char *algorithm,
                              double of_filter, double of_algorithm)
{
    char spec[60];
    snprintf(spec, sizeof spec, "monostatic | %s", algorithm);
    for (int precision = 0; precision < 2; precision++) {
        const double pairs = error_of("monostatic | bp_farrow:degree=5", scene, precision);
        const double error = error_of(spec, scene, precision);
        print_message("%s %zu: bp_farrow %.2g, %s %.2g\n", name, number, pairs, algorithm, error);
        assert_true(pairs <= of_filter && error <= of_algorithm);
    }
    scene_free(scene);
}

static void images_are_within_a_percent(void **state)
{
    (void)state;
    static const struct {
        const char *keys;
        double most; /* of wk_squint; back projection by degree 5 leaves the conversion's own */
    } cases[] = {
        {"", 0.01},
        {"pulse = { kind = \"flat\"; };\n", 0.01},
        {"track = { speed = -2.0; pri = 0.1; pings = 52; x_first = 5.2; };\n", 0.01},
        {"track = { speed = 0.0; pri = 0.1; spacing = 0.2; pings = 52; x_first = -5.2; };\n", 0.01},
        {"track = { speed = 2.0; pri = 0.1; pings = 53; x_first = -5.3; };\n", 0.01},
        /* Receivers on both sides; a raster a fiftieth of its spacing off. */
        {"array = { tx_length = 0.2; rx_length = 0.08; receivers = 5; first_offset = -0.16; pitch = 0.08; };\n", 0.01},
        {"array = { tx_length = 0.2; rx_length = 0.08; receivers = 5; first_offset = 0.08; pitch = 0.0808; };\n", 0.02},
        /* One receiver of a bistatic pair; one at the transmitter. */
        {"array = { tx_length = 0.2; rx_length = 0.2; receivers = 1; first_offset = 0.5; };\n"
         "track = { speed = 0.4; pri = 0.1; pings = 256; x_first = -5.12; };\n",
         0.01},
        {"array = { tx_length = 0.2; rx_length = 0.2; receivers = 1; first_offset = 0.0; };\n"
         "track = { speed = 0.4; pri = 0.1; pings = 256; x_first = -5.12; };\n",
         0.01},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct scene scene;
        scene_make(cases[k].keys, &scene);
        errors_are_within("case", k + 1, &scene, "wk_squint", cases[k].most, cases[k].most);
    }
}

/* Crooked tracks, relative to the exact image along them: sway of one wavelength and three, from ping to ping as well;
   surge; heave and yaw; raw echoes. */
static void crooked_tracks_are_imaged(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double most; /* of the conversion; range migration adds its own, which the straight track shows */
    } cases[] = {
        {"pulse = { kind = \"flat\"; };\n" MOVED(""), 1.5e-4},
        {"pulse = { kind = \"flat\"; };\n" MOVED("{ axis = \"sway\"; amplitude = 0.01; period = 4.0; }"), 2e-3},
        {"pulse = { kind = \"flat\"; };\n" MOVED("{ axis = \"sway\"; amplitude = 0.03; period = 4.0; }"), 6e-3},
        {"pulse = { kind = \"flat\"; };\n" MOVED("{ axis = \"sway\"; walk = 0.001; seed = 3; }"), 2e-3},
        {"pulse = { kind = \"flat\"; };\n" MOVED("{ axis = \"surge\"; amplitude = 0.001; period = 4.0; }"), 4e-3},
        {"pulse = { kind = \"lfm\"; duration = 1e-3; };\n" MOVED(
             "{ axis = \"heave\"; amplitude = 0.02; period = 4.0; }, { axis = \"yaw\"; amplitude = 1.0; period = 3.0; "
             "}"),
         8e-4},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct scene scene;
        scene_load_text(cases[k].text, &scene);
        errors_are_within("crooked", k + 1, &scene, "rma_delay", cases[k].most, cases[k].most + 0.012);
    }
}

static double between(struct random *random, double low, double high)
{
    return low + (high - low) * random_uniform(random);
}

static double between_powers(struct random *random, double low, double high)
{
    return low * pow(high / low, random_uniform(random));
}

/* A small scene of a track that sways by 0.01 to 3 wavelengths, heaves as a random walk and yaws. */
static void crooked_make(int seed, struct scene *scene)
{
    struct random random = random_seed((uint64_t)seed, 11);
    const double c = between(&random, 1400, 1600), fc = between_powers(&random, 20e3, 400e3), wavelength = c / fc;
    const double bandwidth = fc * between_powers(&random, 0.03, 0.6), fs = bandwidth * between(&random, 1.1, 3);
    const double element = wavelength * between_powers(&random, 1.2, 12),
                 r = wavelength * between_powers(&random, 3e2, 6e3);
    const int receivers = (int)between(&random, 1, 9);
    const double pitch = element * between(&random, 0.5, 1), spacing = receivers * pitch / 2;
    const double off = random_uniform(&random) < 0.5 ? 0 : between(&random, -0.02, 0.02);
    const double reach = r * wavelength / (2 * element), width = 40 * element * between(&random, 0.1, 0.6);
    const double track = 2 * reach * between(&random, 0.5, 1.5) + width,
                 depth = 30 * c / bandwidth * between(&random, 0.1, 0.6);
    const int pings = (int)fmin(fmax(track / spacing, 4), 2400.0 / receivers);
    const double sway = wavelength * between_powers(&random, 0.01, 3),
                 period = 0.5 * pings * between_powers(&random, 0.1, 2); /* s */
    const double yaw = between_powers(&random, 0.02, 2), heave = wavelength * between_powers(&random, 1e-3, 0.1);
    const double side = random_uniform(&random) < 0.5 ? 1 : -1, x_step = width / 40, r_step = depth / 30;
    const double offset = random_uniform(&random) < 0.3 ? -pitch : 0, phase = between(&random, 0, 360);
    const double yaw_period = period * between(&random, 0.3, 3);
    const bool raw = random_uniform(&random) < 0.3;
    const double pulse = between(&random, 20, 100) / bandwidth, nearest = 2 * r / c,
                 farthest = 2 * hypot(r + depth, reach + width) / c;
    const char *beam =
        random_uniform(&random) < 0.5 ? "kind = \"txrx\"; truncation = \"tx\"; limit = 0.443;" : "kind = \"txrx\";";
    const int first = (int)fmax((nearest - (raw ? 0 : 10 / bandwidth)) * fs - 5, 0);
    char waveform[100], text[3000];
    snprintf(waveform, sizeof waveform, raw ? "kind = \"lfm\"; duration = %.9g;" : "kind = \"flat\";", pulse);
    snprintf(
        text, sizeof text,
        "sonar = { sound_speed = %.9g; fc = %.9g; bandwidth = %.9g; fs = %.9g; };\n"
        "pulse = { %s };\n"
        "array = { tx_length = %.9g; rx_length = %.9g; receivers = %d; first_offset = %.9g; pitch = %.9g; };\n"
        "record = { first_sample = %d; samples = %d; };\nbeam = { %s };\n"
        "image = { x = { first = %.9g; step = %.9g; count = 41; }; r = { first = %.9g; step = %.9g; count = 31; }; };\n"
        "targets = { fields = ( { x = [%.9g, %.9g]; r = [%.9g, %.9g]; count = 40; seed = %d; } ); };\n"
        "track = { speed = %.9g; pri = 0.5; pings = %d; x_first = %.9g; errors_known = true; errors = (\n"
        "{ axis = \"sway\"; amplitude = %.9g; period = %.9g; phase = %.9g; },\n"
        "{ axis = \"heave\"; walk = %.9g; seed = %d; },\n{ axis = \"yaw\"; amplitude = %.9g; period = %.9g; } ); };\n",
        c, fc, bandwidth, fs, waveform, element, fmin(element, pitch), receivers, offset, pitch, first,
        (int)((farthest + (raw ? pulse : 10 / bandwidth)) * fs) - first + 10, beam, -width / 2, x_step, r, r_step,
        -width / 2, width / 2, r, r + depth, seed + 1, side * spacing * (1 + off) / 0.5, pings,
        -side * spacing * (1 + off) * (pings - 1) / 2, sway, period, phase, heave, seed + 2, yaw, yaw_period);
    scene_load_text(text, scene);
}

/* Relative L2 of the ghosts that a transform leaves out, by the condition. */
static double ghosts_of(const struct spec *spec, const struct problem *problem)
{
    struct condition list[CONDITIONS_MAX];
    const int count = algorithm_conditions(spec->algorithm, problem, spec->options, list, CONDITIONS_MAX);
    for (int k = 0; k < count; k++)
        if (strcmp(list[k].name, "grating_lobes") == 0)
            return list[k].value;
    return 0;
}

/* Whatever the track, an image is refused by name, or within what range migration promises of a straight one. */
static void random_tracks_are_imaged_or_refused(void **state)
{
    (void)state;
    enum { SCENES = 60 };
    int imaged = 0, wrong = 0;
    for (int seed = 1; seed <= SCENES; seed++) {
        struct scene scene;
        struct spec spec;
        void *plan;
        crooked_make(seed, &scene);
        assert_int_equal(spec_own("monostatic | rma_delay", &spec), STATUS_OK);
        const struct problem problem = scene_problem(&scene, spec.precision);
        const enum status status = algorithm_plan(spec.algorithm, &problem, spec.options, &plan);
        if (status == STATUS_OK) {
            spec.algorithm->destroy(plan);
            const double error = error_of("monostatic | rma_delay", &scene, PRECISION_FLOAT);
            const double most = hypot(0.12, ghosts_of(&spec, &problem));
            print_message("%d: error %.2g, at most %.2g\n", seed, error, most);
            imaged++;
            wrong += !(error <= most);
        } else {
            assert_int_equal(status, STATUS_UNSUPPORTED);
            assert_non_null(strstr(status_message(), "condition"));
        }
        spec_free(&spec);
        scene_free(&scene);
    }
    print_message("%d of %d scenes are imaged\n", imaged, SCENES);
    assert_true(imaged > SCENES / 2 && imaged < SCENES);
    assert_int_equal(wrong, 0);
}

/* More taps err less on a lone sonar, where nothing else does. */
static void taps_converge(void **state)
{
    (void)state;
    struct scene scene;
    scene_make("array = { tx_length = 0.2; rx_length = 0.2; receivers = 1; first_offset = 0.0; };\n"
               "track = { speed = 0.4; pri = 0.1; pings = 256; x_first = -5.12; };\n",
               &scene);
    assert_true(error_of("monostatic|reference", &scene, PRECISION_DOUBLE) <= 1e-3);
    scene_free(&scene);
    scene_make("", &scene);
    const double few = error_of("monostatic:taps=8|reference", &scene, PRECISION_DOUBLE);
    const double many = error_of("monostatic:taps=24|reference", &scene, PRECISION_DOUBLE);
    print_message("8 taps %.2g, 24 taps %.2g\n", few, many);
    assert_true(many < few);
    scene_free(&scene);
}

static void refused(const char *keys, const char *reason)
{
    struct scene scene;
    struct echoes echoes;
    struct image image;
    char spec[300];
    scene_make(keys, &scene);
    chain_settle("monostatic | wk_squint", spec, sizeof spec);
    support_echoes(&scene, &echoes);
    assert_int_equal(support_image(spec, scene_problem(&scene, PRECISION_DOUBLE), &echoes, &image), STATUS_UNSUPPORTED);
    if (!strstr(status_message(), reason))
        fail_msg("%s: %s", keys, status_message());
    echoes_free(&echoes);
    scene_free(&scene);
}

static void others_are_refused(void **state)
{
    (void)state;
    refused("track = { speed = 2.4; pri = 0.1; pings = 52; x_first = -6.2; };\n", "condition conversion");
    refused("array = { tx_length = 0.2; rx_length = 0.08; receivers = 5; first_offset = 6.0; pitch = 0.08; };\n",
            "condition conversion");
    refused("track = { speed = 2.0; pri = 0.1; pings = 52; x_first = -5.2; errors_known = true;\n"
            "errors = ( { axis = \"sway\"; amplitude = 0.05; period = 2.0; } ); };\n",
            "condition conversion");
    refused("track = { speed = 2.0; pri = 0.1; pings = 1; x_first = 0.0; };\n", "condition track");
}

static void threads_make_the_same_bits(void **state)
{
    (void)state;
    struct scene scene;
    struct echoes echoes;
    struct image images[2];
    char spec[300];
    scene_make("", &scene);
    chain_settle("monostatic | wk_squint", spec, sizeof spec);
    support_echoes(&scene, &echoes);
    const int threads = omp_get_max_threads();
    for (int k = 0; k < 2; k++) {
        omp_set_num_threads(1 + 2 * k);
        assert_int_equal(support_image(spec, scene_problem(&scene, PRECISION_FLOAT), &echoes, &images[k]), STATUS_OK);
    }
    omp_set_num_threads(threads);
    assert_true(support_difference(&images[0], &images[1]) == 0);
    image_free(&images[0]);
    image_free(&images[1]);
    echoes_free(&echoes);
    scene_free(&scene);
}

/* No file of the program's names code from elsewhere, and a filter forms no image. */
static void specs_are_the_programs_own(void **state)
{
    (void)state;
    static const char *const texts[] = {"monostatic",          "./a.so",
                                        "./a.so | bp_sinc",    "monostatic | ./a.so",
                                        "external:true",       "monostatic | external:true",
                                        "bp_sinc | wk_squint", "monostatic:taps=9 | wk_squint",
                                        "monostatic | auto"};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        struct spec spec;
        assert_int_equal(spec_own(texts[k], &spec), STATUS_INVALID);
        assert_null(spec.algorithm);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(images_are_within_a_percent),
        cmocka_unit_test(crooked_tracks_are_imaged),
        cmocka_unit_test(random_tracks_are_imaged_or_refused),
        cmocka_unit_test(taps_converge),
        cmocka_unit_test(others_are_refused),
        cmocka_unit_test(threads_make_the_same_bits),
        cmocka_unit_test(specs_are_the_programs_own),
    };
    return cmocka_run_group_tests_name("monostatic", tests, folder_make, folder_remove);
}
