/* What stands beside the points of a chart: all entries of a legend in the picture, every name free of the others. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contract/algorithm.h"
#include "show/chart.h"
#include "show/plot.h"
#include "tests/report/report_fixture.h"
#include "tests/support.h"

/* Three points of every algorithm, twice where it has a `rest`, which makes the names of its settings long. */
static void settings_record(const char *rest)
{
    enum { MOST = 200 };
    static struct measurement rows[MOST];
    static char options[MOST][100];
    int count = 0;
    for (int k = 0; algorithms[k]; k++)
        for (int n = 1; n <= (*rest ? 6 : 3); n++, count++) {
            snprintf(options[count], sizeof options[0], "n=%d%s%s%s", n, *rest ? "," : "", rest, n > 3 ? "2" : "");
            rows[count] = row_of("a", algorithms[k]->name, options[count], 0.01 * (1 + k) * n, 0.1 / n);
        }
    record_rows(rows, count);
}

/* Every text of an SVG picture, and the entries that are asked for among them. */
static void texts_check(const char *name, const char *const *wanted)
{
    char *text = support_read(name);
    double width = 0, height = 0;
    assert_non_null(text);
    assert_int_equal(sscanf(strstr(text, "viewBox="), "viewBox=\"0 0 %lf %lf\"", &width, &height), 2);
    assert_true(width == 1000 && height >= 400);
    for (const char *at = text; (at = strstr(at, "translate(")); at++) {
        double x, y;
        assert_int_equal(sscanf(at, "translate(%lf,%lf)", &x, &y), 2);
        if (!(x >= 0 && x < width && y > 0 && y < height))
            fail_msg("%s: a text at %g, %g of %g x %g", name, x, y, width, height);
    }
    for (int k = 0; wanted[k]; k++)
        if (!strstr(text, wanted[k]))
            fail_msg("%s: no '%s'", name, wanted[k]);
    free(text);
}

static void every_series_has_its_entry(void **state)
{
    (void)state;
    static const char *const rests[] = {"", "window=kaiser_band", "window=kaiser_band,steps=1024,taps=1"};
    for (int r = 0; r < 3; r++) {
        int undrawn = 0;
        settings_record(rests[r]);
        assert_int_equal(plot_results(folder, "a", &undrawn), STATUS_OK);
        assert_int_equal(undrawn, 0);
        texts_check("a-error_time.svg",
                    (const char *const[]){">bp_nearest", ">auto", ">open, thin: in double", ">3<", NULL});
        assert_false(support_exists("a-upsampling.svg") || support_exists("overview.svg"));
    }
}

/* Of a run every algorithm has its name, however near its point lies to others, and the run its overview. */
static void names_do_not_cover_each_other(void **state)
{
    (void)state;
    struct measurement rows[64];
    struct results results;
    struct points points;
    struct chart_label labels[32];
    int count = 0, undrawn = 0;
    for (int scene = 0; scene < 2; scene++)
        for (int k = 0; algorithms[k]; k++, count++)
            rows[count] =
                row_of(scene ? "b" : "a", algorithms[k]->name, "", 0.01 * (1 + 0.02 * k), 0.1 + 0.003 * (k % 5));
    record_rows(rows, count);
    assert_int_equal(results_read(path_of("measurements.csv"), &results), STATUS_OK);
    assert_int_equal(points_find(&results, "a", &points), STATUS_OK);
    for (int small = 0; small < 2; small++) {
        const struct chart chart = chart_fit(&points, 1, false, small ? 460 : 865, small ? 300 : 520);
        const int named = chart_label(&chart, &points, small ? 6.6 : 8, labels);
        assert_int_equal(named, points.count);
        for (int a = 0; a < named; a++)
            for (int b = 0; b < named; b++) {
                const double apart_x =
                    fmax(labels[a].x - labels[b].x - labels[b].width, labels[b].x - labels[a].x - labels[a].width);
                assert_true(labels[a].x >= 0 && labels[a].x + labels[a].width <= chart.width);
                if (a != b && !(apart_x >= 0 || fabs(labels[a].y - labels[b].y) >= 12))
                    fail_msg("%s covers %s", labels[a].text, labels[b].text);
            }
    }
    points_free(&points);
    results_free(&results);
    assert_int_equal(plot_results(folder, NULL, &undrawn), STATUS_OK);
    assert_int_equal(undrawn, 0);
    texts_check("a-error_time.svg", (const char *const[]){">bp_nearest<", ">auto<", ">rma_delay<", ">100x<", NULL});
    texts_check("overview.svg", (const char *const[]){">a<", ">b<", ">auto", ">100x<", ">1e-1<", NULL});
    assert_false(support_exists("a-upsampling.svg"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(every_series_has_its_entry, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(names_do_not_cover_each_other, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
