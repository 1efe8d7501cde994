/* Verdicts under other assumptions: what a set changes, that nothing else is measured, and which verdicts flip. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "papers/assumptions.h"
#include "claims/reproduce.h"
#include "tests/planted.h"

static const struct assumptions *set_named(const char *name)
{
    const struct assumptions *set = assumption_sets;
    while (set->name && strcmp(set->name, name) != 0)
        set++;
    assert_non_null(set->name);
    return set;
}

/* A set that changes a scene names it; one that does not leaves name and hash. */
static void scenes_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *set, *scene, *assumed;
    } cases[] = {
        {"nominal", "bp22/table3", "bp22/table3"},
        {"c_1450", "bp22/table3", "bp22/table3@c_1450"},
        {"cut_443", "bp22/table3", "bp22/table3@cut_443"},
        {"cut_443", "zp15/many", "zp15/many"}, /* another beam */
        {"off_bins", "bp22/table3", "bp22/table3@off_bins"},
        {"off_bins", "bp22/speckle", "bp22/speckle"}, /* scatterers have no place */
        {"off_pings", "sq18/squint_20", "sq18/squint_20@off_pings"},
        {"off_bins", "sq18/squint_20", "sq18/squint_20"}, /* printed */
        {"nominal", "bp22/table3@c_1450", "bp22/table3@c_1450"},
        {"off_bins", "bp22/table3@c_1450", "bp22/table3@c_1450"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct scene scene, plain;
        char name[40];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(cases[k].scene, "@"), cases[k].scene);
        support_scene(name, &plain);
        assumptions_choose(set_named(cases[k].set));
        assert_string_equal(assumed_scene_name(cases[k].scene), cases[k].assumed);
        assert_int_equal(assumed_scene_load(cases[k].scene, &scene), STATUS_OK);
        assert_string_equal(scene.name, cases[k].assumed);
        assert_true((scene.hash == plain.hash) == (strcmp(cases[k].assumed, name) == 0));
        scene_free(&scene);
        scene_free(&plain);
    }
    assumptions_choose(assumption_sets);
}

/* Targets move with their pixels: on range bins to the nearest new one, or half a bin off. */
static void targets_move_with_pixels(void **state)
{
    (void)state;
    static const char *const scenes[] = {"bp22/table3", "lbf21/blocks_9_6"};
    for (int s = 0; s < 2; s++)
        for (const struct assumptions *set = assumption_sets; set->name; set++) {
            struct scene scene, plain;
            support_scene(scenes[s], &plain);
            assumptions_choose(set);
            assert_int_equal(assumed_scene_load(scenes[s], &scene), STATUS_OK);
            const double bin = scene.acquisition.sound_speed / (2 * scene.acquisition.fs);
            for (int k = 0; k < scene.point_count; k++) {
                double way = scene.targets[k].r - plain.targets[k].r, bins = scene.targets[k].r / bin;
                assert_close(scene.patches[k].r_first - plain.patches[k].r_first, way, 1e-9);
                for (int n = 0; n < scene.reference_count; n++)
                    assert_close(scene.reference_patches[n].r_first - plain.reference_patches[n].r_first, way, 1e-9);
                if (s == 0)
                    assert_close(bins - floor(bins), set->off_bins ? 0.5 : round(bins) - floor(bins), 1e-6);
                if (set->off_bins)
                    assert_close(way, bin / 2, 1e-9);
            }
            scene_free(&scene);
            scene_free(&plain);
        }
    assumptions_choose(assumption_sets);
}

static int asked; /* measurements */

/* Errors of 1, and 0.1 at other sound speeds. */
static enum status plant(const char *directory, struct need *needs, int count)
{
    struct provenance provenance;
    provenance_fill(&provenance, 1);
    assert_int_equal(results_folder_open(directory, &provenance, &rows), STATUS_OK);
    for (int k = 0; k < count; k++, asked++) {
        struct spec spec;
        const char *name = assumed_scene_name(needs[k].scene);
        assert_int_equal(spec_parse(needs[k].spec, &spec), STATUS_OK);
        struct measurement row = planted_row(name, &spec);
        row.threads = 1;
        row.error = strstr(name, "@c_") ? 0.1 : 1;
        assert_int_equal(results_folder_add(rows, &row), STATUS_OK);
        spec_free(&spec);
    }
    results_folder_close(rows);
    return STATUS_OK;
}

static void flips_are_marked(void **state)
{
    (void)state;
    static const struct {
        const char *comparison, *arguments;
        int asked; /* nominal; two sound speeds; three beams; half a bin; half a ping; taps */
        int flips;
        const char *assumption, *verdict; /* NULL: no claim takes part */
    } cases[] = {
        {"above(x, 0.5)", "x = error(bp22/table3, bp_nearest)", 8, 2, "sound speed 1550 m/s", "does not hold"},
        {"above(x, 0.5)", "x = error(zp15/speckle, bp_nearest)", 4, 2, "sound speed 1450 m/s", "does not hold"},
        {"above(x, 0)", "x = error(bp22/table3, bp_nearest)", 8, 0, "targets half a range bin farther", "holds"},
        {"identity above(c, 1500.5)", "c = scene(bp22/table3, sound_speed_m_s)", 0, 1, "sound speed 1550 m/s",
         "identity"},
        {"above(x, 0)", "x = error(zp15/speckle, bp_sinc:taps=8)", 6, 0, "sinc of 4 taps", "holds"},
        {"above(x, 0)", "x = error(zp15/speckle@c_1450, bp_nearest)", 1, 0, "sound speed 1550 m/s", "holds"},
        {"above(x, 0)", "x = error(bp22/full, bp_nearest)", 0, 0, NULL, NULL}, /* a scene for times */
        {"above(x, 0)", "x = rule(bp22_eq20, met, 0.1); y = error(bp22/speckle, bp_nearest)", 0, 0, NULL,
         NULL}, /* scenes from seeds */
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct claims claims;
        struct csv csv;
        assert_int_equal(planted_claim(cases[k].comparison, cases[k].arguments, &claims), STATUS_OK);
        asked = 0;
        assert_int_equal(sensitivity_study(folder, folder, &claims, plant), STATUS_OK);
        assert_int_equal(csv_read(path_of("sensitivity.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
        int flips = 0;
        bool found = !cases[k].assumption && csv.row_count == 0;
        for (int row = 0; row < csv.row_count; row++) {
            flips += strcmp(csv_cell(&csv, row, 3), csv_cell(&csv, 0, 3)) != 0;
            found |= cases[k].assumption && strcmp(csv_cell(&csv, row, 2), cases[k].assumption) == 0
                     && strcmp(csv_cell(&csv, row, 3), cases[k].verdict) == 0;
        }
        if (asked != cases[k].asked || flips != cases[k].flips || !found)
            fail_msg("%s: %d measurements asked for, %d of %d verdicts flip", cases[k].arguments, asked, flips,
                     csv.row_count);
        csv_free(&csv);
        claims_free(&claims);
        folder_remove(NULL);
        folder_make(NULL);
    }
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, folder_make, folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_are_named),
        cmocka_unit_test(targets_move_with_pixels),
        IN_FOLDER(flips_are_marked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
