/* What images show against their echoes: the definitions, what noise and targets make of them, and that rows warn where
   errors outgrow the promises. */
#include "tests/support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contract/delay.h"
#include "measure/darkness.h"
#include "measure/outcome.h"

/* The sums as they are written, of compressed echoes in double of a band of half the sampling rate; every pair
   counts. */
static struct darkness plain(const struct echoes *echoes, const struct image *image)
{
    const struct acquisition *a = echoes->acquisition;
    const double complex *samples = echoes->samples;
    double met = 0, steps = 0, shown = 0;
    for (int k = 0; k < image->patch_count; k++)
        for (int n = 0; n < image->patches[k].r_count * image->patches[k].x_count; n++) {
            const struct grid *g = &image->patches[k];
            const struct vector pixel = grid_point(g, n / g->x_count, n % g->x_count);
            shown += pow(cabs(image_pixel(image, k, n / g->x_count, n % g->x_count)), 2);
            for (int pair = 0; pair < a->pings * a->receivers; pair++) {
                const int ping = pair / a->receivers;
                const double tau = delay_exact(a->tx[ping], a->rx[pair], a->velocity[ping], pixel, a->sound_speed);
                const double at = (tau - a->t0[ping]) * a->fs;
                const double complex *record = samples + (size_t)pair * (size_t)a->samples;
                if (at >= 0 && at <= a->samples - 1) {
                    const double complex here = record[(size_t)floor(at)], next = record[(size_t)ceil(at)];
                    met += (pow(cabs(here), 2) + pow(cabs(next), 2)) / 2;
                    steps += pow(cabs(next - here), 2);
                }
            }
        }
    return (struct darkness){.ratio = met / shown, .edges = steps / met / (2 * (1 - 2 / M_PI))};
}

/* Noise on 24 pings, two patches in turned axes: all pairs are read. */
static void test_definition_and_noise(void **state)
{
    (void)state;
    struct acquisition acquisition;
    struct echoes echoes;
    struct image image;
    const struct grid patches[] = {{-1, 0.02, 40, 20.5, 0.03, 20, 0.3}, {-2, 0.05, 20, 20.8, 0.05, 20, 0.3}};
    support_flat_noise(0.5, &acquisition, &echoes);
    struct problem problem = problem_make(&acquisition, 2, patches, PRECISION_DOUBLE);
    if (support_image("bp_sinc:precision=double", problem, &echoes, &image) != STATUS_OK)
        fail_msg("%s", status_message());
    const struct darkness found = image_darkness(&echoes, &image);
    const struct darkness expected = plain(&echoes, &image);
    assert_close(found.ratio, expected.ratio, 1e-9);
    assert_close(found.edges, expected.edges, 1e-9);
    assert_close(found.edges, 1, 0.05);
    assert_close(found.ratio, pow(found.echoes / found.image, 2), 1e-9);
    assert_close(found.ratio, 1, 0.3);
    /* The units are the image's: echoes divided by a power of two. */
    echoes.exponent = 600;
    assert_int_equal(image_scale(&image, 600), STATUS_OK);
    const struct darkness scaled = image_darkness(&echoes, &image);
    assert_close(scaled.ratio, found.ratio, 1e-12);
    assert_close(ldexp(scaled.echoes, -600), found.echoes, 1e-12 * found.echoes);
    image_free(&image);
    echoes_free(&echoes);
    acquisition_free(&acquisition);
}

/* ---- rows ---- */

enum { SEEDS = 50 };
static const char *const specs[] = {"bp_sinc", "rma_delay"};
enum { SPECS = sizeof specs / sizeof *specs };

struct row {
    double error; /* after one best gain; NAN where there is no row */
    bool warned, side_lobes, ghosts, sampled;
};

static void rows_of(const struct scene *scene, struct row rows[SPECS])
{
    static struct outcome outcome;
    struct session session;
    struct spec spec;
    assert_int_equal(session_open(scene, &session), STATUS_OK);
    for (int k = 0; k < SPECS; k++) {
        assert_int_equal(spec_parse(specs[k], &spec), STATUS_OK);
        outcome_measure(&session, &spec, EFFORT_NONE, NULL, &outcome);
        rows[k] = (struct row){outcome.row.error_gain, strstr(outcome.reason, "condition dark_image") != NULL,
                               strstr(outcome.reason, "condition side_lobes") != NULL,
                               strstr(outcome.reason, "condition unseen_echoes") != NULL,
                               strstr(outcome.reason, "condition doppler") == NULL};

        outcome_free(&outcome);
        spec_free(&spec);
    }
    session_close(&session);
}

/* One of the scatterers put beside the grid along the track, still in the beam, and made stronger than all. */
static void darken(struct scene *scene, int seed)
{
    struct random random = random_seed((uint64_t)seed, 1);
    const struct grid *g = &scene->patches[0];
    const double sine = condition_beam_sine(&scene->acquisition), far = sine * g->r_first;
    const double beside = (0.1 + 0.7 * random_uniform(&random)) * far, middle = g->r_first + g->r_count / 2 * g->r_step;
    scene->targets[0] = (struct target){seed % 2 ? g->x_first - beside : g->x_first + g->x_count * g->x_step + beside,
                                        middle, pow(10, 2 + 2 * random_uniform(&random))};
}

/* Ordinary images warn of nothing; whatever a bright neighbour throws beyond a tenth is warned of. */
static void test_random_scenes(void **state)
{
    (void)state;
    int wrong = 0;
    for (int seed = 1; seed <= SEEDS; seed++) {
        struct scene scene;
        struct row plain[SPECS], dark[SPECS];
        support_random_scene(seed, &scene);
        rows_of(&scene, plain);
        darken(&scene, seed);
        rows_of(&scene, dark);
        scene_free(&scene);
        for (int k = 0; k < SPECS; k++) {
            if (plain[k].warned || plain[k].side_lobes || (plain[k].ghosts && plain[k].sampled))
                fail_msg("seed %d, %s: warned of an ordinary image", seed, specs[k]);
            const bool over = dark[k].error > 0.1 && plain[k].error <= 0.1;
            if (over && !dark[k].warned)
                fail_msg("seed %d, %s: an error of %.3g, %.3g without the neighbour, and no warning", seed, specs[k],
                         dark[k].error, plain[k].error);
            wrong += over;
        }
    }
    assert_true(wrong >= SEEDS / 4);
}

/* A scene of 100 kHz at 21 m in its parts. */
static void scene_make(const char *targets, const char *image, struct scene *scene)
{
    char text[2000];
    snprintf(text, sizeof text,
             "sonar = { fc = 100e3; bandwidth = 20e3; fs = 30e3; };\npulse = { kind = \"lfm\"; duration = 2e-3; };\n"
             "array = { tx_length = 0.1; rx_length = 0.05; receivers = 6; first_offset = 0.05; pitch = 0.05; };\n"
             "track = { speed = 2.0; pri = 0.075; pings = 60; x_first = -4.5; };\n"
             "record = { first_sample = 760; samples = 400; };\nbeam = { kind = \"txrx\"; truncation = \"none\"; };\n"
             "targets = { %s };\nimage = { %s };\n",
             targets, image);
    support_write("scene.cfg", text);
    if (scene_load(path_of("scene.cfg"), SASBENCH_ROOT "/scenes", scene) != STATUS_OK)
        fail_msg("%s", status_message());
}

static void test_scenes(void **state)
{
    (void)state;
    static const char small[] = "x = { first = -0.3; step = 0.02; count = 31; }; r = { first = 21.2; step = 0.02; "
                                "count = 41; };";
    static const char fields[] = "fields = ( { x = [%.1f, %.1f]; r = [20.0, 24.0]; count = 1500; seed = 3; }, "
                                 "{ x = [%.1f, %.1f]; r = [20.0, 24.0]; count = 1500; seed = 4; } );";
    static const struct {
        const char *targets, *image;
        bool dark, side_lobes;
    } cases[] = {
        {"points = ( { x = 0.0; r = 21.4; }, { x = 1.2; r = 21.4; amplitude = 100.0; } );", small, true, false},
        {"points = ( { x = 0.0; r = 21.4; }, { x = 1.2; r = 21.4; amplitude = 1.0; } );", small, false, false},
        /* 2 and 32 cells of 0.0375 m beyond the last row; 8, where a chirp's lobes come from the middle of its band; as
           strong as the one inside */
        {"points = ( { x = 0.0; r = 21.4; }, { x = 0.0; r = 22.075; amplitude = 10.0; } );", small, false, true},
        {"points = ( { x = 0.0; r = 21.4; }, { x = 0.0; r = 22.3; amplitude = 1000.0; } );", small, false, false},
        {"points = ( { x = 0.0; r = 21.4; }, { x = 0.0; r = 23.2; amplitude = 1e5; } );", small, false, true},
        {"points = ( { x = 0.0; r = 21.4; }, { x = 0.0; r = 22.075; amplitude = 1.0; } );", small, false, false},
        {"points = ( { x = 0.0; r = 21.4; } );", small, false, false},
        /* in the middle of a patch wider than the beam */
        {"points = ( { x = 0.0; r = 21.4; } );",
         "x = { first = -6.0; step = 0.02; count = 601; }; r = { first = 20.4; step = 0.02; count = 101; };", false,
         false},
        /* one pixel a resolution cell, and fewer */
        {"points = ( { x = 0.0; r = 21.4; } );",
         "x = { first = -1.0; step = 0.1; count = 21; }; r = { first = 20.4; step = 0.1; count = 21; };", false, false},
    };
    static const double gaps[] = {0.4, 0.7, 1};
    char targets[400];
    struct scene scene;
    struct row rows[SPECS];
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        scene_make(cases[c].targets, cases[c].image, &scene);
        rows_of(&scene, rows);
        for (int k = 0; k < SPECS; k++) {
            assert_int_equal(rows[k].warned, cases[c].dark);
            if (rows[k].side_lobes != cases[c].side_lobes)
                fail_msg("case %zu, %s: side_lobes %d", c + 1, specs[k], rows[k].side_lobes);
        }
        scene_free(&scene);
    }
    for (size_t n = 0; n < sizeof gaps / sizeof *gaps; n++) {
        snprintf(targets, sizeof targets, fields, -5.0, -gaps[n], gaps[n], 5.0);
        scene_make(targets, small, &scene);
        rows_of(&scene, rows);
        for (int k = 0; k < SPECS; k++)
            assert_true(rows[k].warned);
        scene_free(&scene);
    }
    snprintf(targets, sizeof targets, fields, -5.0, 0.0, 0.0, 5.0);
    scene_make(targets, small, &scene);
    rows_of(&scene, rows);
    for (int k = 0; k < SPECS; k++)
        assert_false(rows[k].warned);
    scene_free(&scene);
}

/* An image between fields of scatterers, of which pings that do not sample it make ghosts; and the same within an
   aperture limit at the edge of what is sampled, c/(4 fc spacing/M). */
static void test_ghosts(void **state)
{
    (void)state;
    static const char format[] =
        "sonar = { sound_speed = 1500.0; fc = 80e3; bandwidth = 3e3; fs = 10e3; };\npulse = { kind = \"flat\"; };\n"
        "array = { tx_length = 0.14; rx_length = 0.07; receivers = 4; first_offset = 0.07; pitch = 0.07; };\n"
        "track = { speed = 2.7; pri = 0.05; spacing = 0.14; pings = 19; x_first = -1.26; };\naperture_limit = %g;\n"
        "record = { first_sample = 43; samples = 200; };\n"
        "beam = { kind = \"txrx\"; truncation = \"tx\"; limit = 1.0; };\n"
        "targets = { fields = ( { x = [-2.3, -0.55]; r = [5.0, 6.0]; count = 200; seed = 3; }, "
        "{ x = [0.55, 2.3]; r = [5.0, 6.0]; count = 200; seed = 4; } ); };\n"
        "image = { x = { first = -0.46; step = 0.023; count = 41; }; r = { first = 5.0; step = 0.04; count = 25; }; "
        "};\n";
    static const double limits[] = {1, 0.2, 0.133};
    for (int n = 0; n < 3; n++) {
        char text[2000];
        struct scene scene;
        struct row rows[SPECS];
        snprintf(text, sizeof text, format, limits[n]);
        support_write("scene.cfg", text);
        support_scene(path_of("scene.cfg"), &scene);
        rows_of(&scene, rows);
        scene_free(&scene);
        for (int k = 0; k < SPECS; k++)
            assert_int_equal(rows[k].ghosts, n < 2);
        assert_true(rows[1].error > 0.3 || n > 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_definition_and_noise),
        cmocka_unit_test_setup_teardown(test_scenes, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_ghosts, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_random_scenes, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
