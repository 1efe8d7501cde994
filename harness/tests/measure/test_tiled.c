/* `run --memory`: an image measured in tiles is the whole one, and its errors on some pixels are those of all. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "echoes/matfile.h"
#include "measure/outcome.h"
#include "measure/session.h"
#include "measure/tile_size.h"
#include "measure/tiled.h"
#include "metrics/metrics.h"
#include "scene/simulate.h"
#include "tests/support.h"

static struct scene whole, part; /* of one file: its echoes in memory, and in the file */
static struct session session;   /* of `whole` */

static enum status pings_simulate(void *simulation, int first, int count, double complex *samples)
{
    return simulation_pings(simulation, first, count, samples);
}

static int recording_make(void **state)
{
    static const struct grid grid = {-1, 0.02, 100, 60, 0.05, 200, 0};
    static const struct echo_notes none;
    struct scene scene;
    struct simulation *simulation;
    if (folder_make(state) != 0 || scene_load("study/swath", SASBENCH_ROOT "/scenes", &scene) != STATUS_OK
        || simulation_open(&scene, 1, &simulation) != STATUS_OK)
        return -1;
    const struct sample_source source = {simulation_exponent(simulation), pings_simulate, simulation};
    const char *path = path_of("swath.mat");
    const bool made = echo_file_stream(path, &scene.acquisition, &source, &none) == STATUS_OK;
    simulation_close(simulation);
    scene_free(&scene);
    return made && scene_from_echoes(path, &grid, path, true, &whole) == STATUS_OK
                   && scene_from_echoes(path, &grid, path, false, &part) == STATUS_OK
                   && session_open(&whole, &session) == STATUS_OK
               ? 0
               : -1;
}

static int recording_remove(void **state)
{
    session_close(&session);
    scene_free(&whole);
    scene_free(&part);
    return folder_remove(state);
}

/* Enough for half the image in one tile. */
static double memory_for_several(const struct spec *spec)
{
    struct tiles tiles = {.grid = *part.patches, .precision = spec->precision};
    struct tile_cost cost;
    tiles.rows = tiles.grid.r_count / 2;
    tiles.columns = tiles.grid.x_count;
    assert_int_equal(tile_cost(spec, &part, &tiles, &cost), STATUS_OK);
    return cost.bytes * 16 / 15 + 2.0 * tiles.rows * tiles.columns * (double)precision_size(spec->precision);
}

static void image_of_tiles(void **state)
{
    (void)state;
    /* What tiles may differ by: range migration images other pings for each. */
    static const struct {
        const char *spec;
        double most;
    } cases[] = {{"bp_nearest", 0}, {"bp_sinc:taps=8", 0}, {"bp_linear:precision=double", 0}, {"rma_delay", 4e-3}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct spec spec;
        struct image image;
        struct work work;
        struct tiled_image tiled;
        assert_int_equal(spec_parse(cases[k].spec, &spec), STATUS_OK);
        const struct problem problem = scene_problem(&whole, spec.precision);
        assert_int_equal(imaging_form(&spec, &problem, &session.echoes[spec.precision], &image, &work), STATUS_OK);
        if (tiled_measure(&spec, &part, memory_for_several(&spec), &tiled) != STATUS_OK)
            fail_msg("%s: %s", cases[k].spec, status_message());
        assert_true(tiles_count(&tiled.tiles) > 1);
        assert_true(support_difference(&tiled.image, &image) <= cases[k].most);
        const struct error_metrics all = metrics_error(&tiled.image, &session.reference);
        const struct probe_error *some = &tiled.error;
        if (!(some->low / 1.5 <= all.error_gain && all.error_gain <= some->high * 1.5))
            fail_msg("%s: %g of all pixels, %g to %g of some", cases[k].spec, all.error_gain, some->low, some->high);
        assert_true(some->high / some->low < 4 && some->pixels <= PROBE_PIXELS * tiles_count(&tiled.tiles));
        assert_true(tiled.timing.runs == 1 && tiled.timing.run_s > 0 && tiled.timing.plan_s > 0);
        assert_true(tiled.timing.work.pairs == work.pairs && tiled.timing.work.flops > work.flops / 2);
        double stages = 0;
        for (int n = 0; n < tiled.timing.stages.count; n++)
            stages += tiled.timing.stages.stage[n].seconds;
        assert_true(stages > 0 && stages <= tiled.timing.run_s * (1 + 1e-9));
        image_free(&image);
        image_free(&tiled.image);
        spec_free(&spec);
    }
}

/* A tile's cost is that of a whole one, where a narrow one is left at the end of the image, nearest to the track's
   middle. */
static void cost_of_whole_tiles(void **state)
{
    (void)state;
    struct tiles tiles = {.grid = *part.patches, .precision = PRECISION_FLOAT};
    tiles.grid.x_first = -10;
    tiles.columns = tiles.grid.x_count - 1;
    tiles.rows = tiles.grid.r_count - 1;
    const struct pixel_window w = tile_dearest(&part.acquisition, &tiles);
    assert_int_equal(w.columns, tiles.columns);
    assert_int_equal(w.rows, tiles.rows);
    assert_int_equal(w.column, 1);
    assert_int_equal(w.row, 1);
}

static void assert_refused(const char *text, double memory, const char *why)
{
    struct session tiled;
    struct outcome outcome;
    struct spec spec;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    session_open_tiled(&part, memory, &tiled);
    outcome_measure(&tiled, &spec, EFFORT_WHOLE, NULL, &outcome);
    if (strcmp(outcome.row.status, "unsupported") != 0 || !strstr(outcome.reason, why))
        fail_msg("%s: %s: %s", text, outcome.row.status, outcome.reason);
    outcome_free(&outcome);
    session_close(&tiled);
    spec_free(&spec);
}

static void refusals(void **state)
{
    (void)state;
    assert_refused("auto", 1e9, "but auto");
    assert_refused("bp_nearest", 1e5, "whole image of 0.16 MB");
    assert_refused("bp_nearest", 42.8e6, "no tile fits");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(image_of_tiles),
        cmocka_unit_test(cost_of_whole_tiles),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, recording_make, recording_remove);
}
