/* What a run ends with: the fastest algorithm for four errors on each scene, within half a terminal. */
#include <stdlib.h>
#include <string.h>

#include "imaging/spec.h"
#include "scene/scene.h"
#include "run/run_summary.h"
#include "tests/report/report_fixture.h"
#include "tests/support.h"

enum { SCENES = 22, SPECS = 7, WIDTH = 80 };
static const char *const names[SPECS] = {"reference", "bp_linear",  "bp_factorised", "bp_farrow",
                                         "rma_delay", "wk_classic", "auto"};
static struct scene scenes[SCENES];
static char scene_texts[SCENES][32];
static struct spec specs[SPECS];
static struct measurement rows[SCENES * SPECS + 1];
static char text[1 << 14];

static int specs_make(void **state)
{
    (void)state;
    for (int k = 0; k < SPECS; k++)
        assert_int_equal(spec_parse(names[k], &specs[k]), STATUS_OK);
    for (int s = 0; s < SCENES; s++) {
        snprintf(scene_texts[s], sizeof scene_texts[s], s % 2 ? "reference/d_lbf21_long%d" : "sq18/s%d", s);
        scenes[s].name = scene_texts[s];
    }
    return 0;
}

static int specs_free(void **state)
{
    (void)state;
    for (int k = 0; k < SPECS; k++)
        spec_free(&specs[k]);
    return 0;
}

/* Each algorithm is faster than the next, and less exact: four columns, four answers. */
static void rows_make(void)
{
    static const double times[SPECS] = {1, 1.16e-3, 2.04e-3, 0.322, 11.5e-3, 1, 12e-3},
                        errors[SPECS] = {0, 7e-2, 7e-3, 1.8e-5, 7e-4, 0, 5e-4};
    for (int s = 0; s < SCENES; s++)
        for (int k = 0; k < SPECS; k++) {
            rows[s * SPECS + k] = row_of(scenes[s].name, names[k], specs[k].text, times[k], errors[k]);
            if (k == 5) {
                rows[s * SPECS + k].status = "unsupported";
                rows[s * SPECS + k].reason = "wk_classic: condition one_receiver: 8; at most 1 is needed";
                rows[s * SPECS + k].error = rows[s * SPECS + k].run_s = NAN;
            }
        }
}

/* The summary of the first scenes, as a text of lines. */
static void summary_of(int scene_count, int spec_count)
{
    struct results results = {.measurements = rows, .csv.row_count = scene_count * SPECS};
    FILE *stream = fmemopen(text, sizeof text, "w");
    assert_non_null(stream);
    setenv("COLUMNS", "80", 1);
    run_summary_print(stream, &results, scene_count, scenes, spec_count, specs, "9 s: all");
    unsetenv("COLUMNS");
    fclose(stream);
}

static void holds(const char *line)
{
    if (!strstr(text, line))
        fail_msg("'%s' is not in%s", line, text);
}

static void half_a_terminal(void **state)
{
    (void)state;
    int lines = 0;
    rows_make();
    for (int s = 1; s < SCENES; s++) /* one scene has four long answers: a line more */
        rows[s * SPECS + 4].error = 7e-3;
    summary_of(SCENES, SPECS);
    holds("\nsq18/s0|bp_linear 1.2ms 862x|bp_factorised 2.0ms 490x|rma_delay 12ms 87x\n");
    holds("|bp_farrow 322ms 3.1x\n");
    holds("\nreference/d_lbf21_long1|bp_linear 1.2ms 862x|bp_factorised 2.0ms 490x");
    holds("\nRefused (./sasbench check SCENE: why): wk_classic on 22 scenes (one_receiver)\n");
    for (char *line = strtok(text + 1, "\n"); line; line = strtok(NULL, "\n"), lines++)
        if (strlen(line) > WIDTH)
            fail_msg("%zu columns: %s", strlen(line), line);
    assert_in_range(lines, SCENES + 2, 2 * SCENES);
}

/* What the same algorithm answers is said once; where none comes so far, how far they come; auto is measured against
   the fastest within its error, and stands in where it is alone. */
static void errors_are_kept(void **state)
{
    (void)state;
    rows_make();
    rows[1].error = 1e-2; /* up to, and with it */
    rows[3].error = 1.04e-4;
    rows[4].run_s = 0.01;
    rows[6].run_s = 0.03;
    summary_of(1, SPECS);
    holds("\nsq18/s0|bp_linear 1.2ms 862x|=          |rma_delay 10ms 100x|none: least 1.0e-04\n");
    holds("\nauto takes at most 3.0 times as long as the fastest (sq18/s0), at most 1.1 times\non 0 of 1 scenes\n");
    rows[4].run_s = NAN;
    rows[3].error = 2e-3;
    summary_of(1, SPECS);
    holds("|auto 30ms 33x");
    assert_null(strstr(text, "\nauto takes"));
    summary_of(1, 1); /* only the exact image */
    holds("\nsq18/s0|no image");
}

/* Several settings of one algorithm are told apart; noise is counted. */
static void settings_are_named(void **state)
{
    (void)state;
    struct spec kept = specs[2];
    rows_make();
    assert_int_equal(spec_parse("bp_linear:beta=16", &specs[2]), STATUS_OK);
    rows[2] = row_of(scenes[0].name, "bp_linear", "beta=16", 2e-3, 1e-2);
    rows[2].reason = "warning: times scatter: much";
    summary_of(1, SPECS);
    holds("bp_linear:beta=8 1.2ms 862x|bp_linear:beta=16 2.0ms 500x");
    holds("\n9 s: all; 1 of 6 times noisy (~)\n");
    spec_free(&specs[2]);
    specs[2] = kept;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(half_a_terminal),
        cmocka_unit_test(errors_are_kept),
        cmocka_unit_test(settings_are_named),
    };
    return cmocka_run_group_tests(tests, specs_make, specs_free);
}
