/* Errors measured on few pixels, beside those of all pixels: fields, lone targets, a shadow, a loud neighbour,
   images of several patches and turned ones. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "imaging/imaging.h"
#include "metrics/metrics.h"
#include "imaging/probe.h"
#include "measure/session.h"
#include "measure/timing.h"
#include "tests/support.h"

enum { MOST = 400 };

static const char *const specs[] = {"bp_nearest", "bp_linear:beta=2", "bp_farrow:degree=2",      "bp_fitted:taps=6",
                                    "bp_sinc",    "bp_factorised",    "rma_delay:taps=8,terms=1"};

struct tally {
    double ratio[MOST]; /* estimate over error */
    int count, inside;  /* intervals that hold the error */
};

/* Segments stand in order of the pilot's brightness, the image's brightest pixel among the first. */
static void order_check(const struct probe *probe, const struct image *pilot)
{
    double before = INFINITY, brightest = 0, first = 0;
    for (int k = 0; k < probe->count; k++) {
        const struct probe_place *p = &probe->places[k];
        double energy = 0;
        for (int j = 0; j < probe->grids[k].x_count; j++) {
            const double square = pow(cabs(image_pixel(pilot, p->patch, p->row, p->column + j)), 2);
            energy += square;
            first = k < 32 ? fmax(first, square) : first;
        }
        assert_true(energy <= before * (1 + 1e-12));
        before = energy;
    }
    for (int k = 0; k < pilot->patch_count; k++)
        for (int i = 0; i < pilot->patches[k].r_count; i++)
            for (int j = 0; j < pilot->patches[k].x_count; j++)
                brightest = fmax(brightest, pow(cabs(image_pixel(pilot, k, i, j)), 2));
    assert_true(first == brightest);
}

static void scene_probe(struct scene *scene, const char *name, struct tally *tally)
{
    const struct region everywhere = {0, NULL};
    struct session session;
    struct spec spec, exact;
    struct probe probe;
    struct image pilot, image;
    assert_int_equal(session_open(scene, &session), STATUS_OK);
    const struct problem problem = scene_problem(scene, PRECISION_FLOAT);
    assert_int_equal(spec_parse("reference:precision=double", &exact), STATUS_OK);
    assert_int_equal(spec_parse(specs[0], &spec), STATUS_OK);
    assert_int_equal(session_image(&session, &spec, &pilot), STATUS_OK);
    spec_free(&spec);
    assert_int_equal(probe_make(&exact, &problem, &session.echoes[PRECISION_DOUBLE], &pilot, &everywhere, &probe),
                     STATUS_OK);
    if (!probe.whole)
        order_check(&probe, &pilot);
    for (size_t k = 0; k < sizeof specs / sizeof *specs; k++) {
        assert_int_equal(spec_parse(specs[k], &spec), STATUS_OK);
        if (session_image(&session, &spec, &image) == STATUS_OK) {
            const double error = metrics_error(&image, &session.reference).error_gain;
            const struct probe_error e = probe_measure(&probe, &image);
            print_message("%-12s %-26s %.2e, on %d pixels %.2e (%.2e to %.2e)\n", name, specs[k], error, e.pixels,
                          e.error_gain, e.low, e.high);
            assert_true(e.low <= e.error_gain && e.error_gain <= e.high && tally->count < MOST);
            if (probe.whole)
                assert_close(e.error_gain, error, 1e-9 * error);
            else
                assert_true(e.pixels <= PROBE_PIXELS);
            tally->ratio[tally->count++] = e.error_gain / error;
            tally->inside += e.low * 0.999999 <= error && error <= e.high * 1.000001;
            image_free(&image);
        }
        spec_free(&spec);
    }
    probe_free(&probe);
    image_free(&pilot);
    spec_free(&exact);
    session_close(&session);
}

/* A random scene with as many pixels again on either axis; every third of lone targets. */
static void scene_probe_seed(int seed, int times, struct tally *tally)
{
    struct scene scene;
    char name[32];
    support_random_scene(seed, &scene);
    struct grid *g = &scene.patches[0];
    g->x_count *= times;
    g->r_count *= times;
    g->x_step /= times;
    g->r_step /= times;
    if (seed % 3 == 0)
        scene.target_count = 1 + seed % 4;
    snprintf(name, sizeof name, "seed %d", seed);
    scene_probe(&scene, name, tally);
    scene_free(&scene);
}

/* Nine of ten errors lie in their intervals, and all estimates near the error; of few pixels they are the error. */
static void errors_are_near(void **state)
{
    (void)state;
    static struct tally tally;
    for (int seed = 3001; seed < 3011; seed++)
        scene_probe_seed(seed, 3, &tally);
    scene_probe_seed(3001, 1, &tally);
    const double middle = median(tally.ratio, tally.count); /* sorts them */
    print_message("%d images: %.2f to %.2f of the error, median %.2f; %d within their interval\n", tally.count,
                  tally.ratio[0], tally.ratio[tally.count - 1], middle, tally.inside);
    assert_true(tally.inside >= 0.85 * tally.count && middle > 0.9 && middle < 1.1);
    assert_true(tally.ratio[0] > 0.5 && tally.ratio[tally.count - 1] < 2);
}

/* Pixels alone, formed of the probe's problem, tell the same as the whole image does; only segments of a region are
   taken. */
static void pixels_and_regions(void **state)
{
    (void)state;
    struct scene scene;
    struct session session;
    struct spec spec;
    struct probe probe;
    struct image image, pixels;
    support_scene("study/swath", &scene);
    assert_true(scene.reference_count > 0);
    const struct region region = {scene.reference_count, scene.reference_patches};
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    const struct problem problem = scene_problem(&scene, PRECISION_FLOAT);
    assert_int_equal(spec_parse("bp_fitted:taps=6,engine=general", &spec), STATUS_OK);
    assert_int_equal(session_image(&session, &spec, &image), STATUS_OK);
    struct spec exact;
    assert_int_equal(spec_parse("reference:precision=double", &exact), STATUS_OK);
    assert_int_equal(probe_make(&exact, &problem, &session.echoes[PRECISION_DOUBLE], &image, &region, &probe),
                     STATUS_OK);
    for (int k = 0; k < probe.count; k++) {
        const struct vector middle = grid_point(&probe.grids[k], 0, (probe.grids[k].x_count - 1) / 2.0);
        bool inside = false;
        for (int n = 0; n < region.count; n++) {
            struct grid wide = region.grids[n];
            wide.x_first -= 4 * scene.patches[0].x_step; /* half a segment */
            wide.x_count += (int)ceil(8 * scene.patches[0].x_step / wide.x_step);
            const struct vector at = grid_coordinates(&wide, middle.x, middle.y);
            inside |= fabs((at.x - wide.x_first) / wide.x_step - (wide.x_count - 1) / 2.0) <= wide.x_count / 2.0
                      && fabs((at.y - wide.r_first) / wide.r_step - (wide.r_count - 1) / 2.0) <= wide.r_count / 2.0;
        }
        assert_true(inside);
    }
    /* One column, narrower than any segment, and a region that the image does not show. */
    struct grid column = scene.reference_patches[0];
    column.x_count = 1;
    const struct region narrow = {1, &column};
    struct probe other;
    assert_int_equal(probe_make(&exact, &problem, &session.echoes[PRECISION_DOUBLE], &image, &narrow, &other),
                     STATUS_OK);
    assert_true(other.count > 0 && other.count <= column.r_count);
    probe_free(&other);
    column.r_first = 1e4;
    assert_int_equal(probe_make(&exact, &problem, &session.echoes[PRECISION_DOUBLE], &image, &narrow, &other),
                     STATUS_OK);
    assert_true(other.count > 0);
    probe_free(&other);
    const struct problem part = probe_problem(&probe, &problem);
    assert_int_equal(imaging_form(&spec, &part, &session.echoes[PRECISION_FLOAT], &pixels, NULL), STATUS_OK);
    const struct probe_error whole = probe_measure(&probe, &image), few = probe_measure_pixels(&probe, &pixels);
    const double error = metrics_error(&image, &session.reference).error_gain;
    print_message("%.3e of the image, %.3e of the pixels, %.3e measured\n", whole.error_gain, few.error_gain, error);
    assert_close(few.error_gain, whole.error_gain, 0.02 * whole.error_gain);
    assert_true(error > 0.5 * whole.low && error < 2 * whole.high);
    image_free(&pixels);
    image_free(&image);
    probe_free(&probe);
    spec_free(&exact);
    spec_free(&spec);
    session_close(&session);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(errors_are_near, folder_make, folder_remove),
        cmocka_unit_test(pixels_and_regions),
    };
    return cmocka_run_group_tests_name("probe", tests, NULL, NULL);
}
