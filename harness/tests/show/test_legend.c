/* The legends below the plots of a sweep: every entry stands inside the picture, however many series there are. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contract/algorithm.h"
#include "show/plot.h"
#include "tests/support.h"

/* Three points of every algorithm, twice where it has a `rest`, which makes the names of its settings long. */
static void points_write(const char *rest)
{
    static char text[40000];
    int used = snprintf(text, sizeof text,
                        "# sasbench points 2\nscene,algorithm,precision,rest,value,rate,run_s,flops,error,pslr_db,"
                        "islr_db,control_s,is_point,front_run_s,front_flops,run_q1_s,run_q3_s\n");
    for (int k = 0; algorithms[k]; k++)
        for (int n = 1; n <= (*rest ? 6 : 3); n++)
            used += snprintf(text + used, sizeof text - (size_t)used,
                             "a,%s,float,\"%s%s\",%d,,%g,%g,%g,-13.%d,-10,1,1,0,0,%g,%g\n", algorithms[k]->name, rest,
                             n > 3 ? "2" : "", n, 0.01 * (1 + k) * n, 1e6 * (1 + k) * n, 0.1 / n, n, 0.01 * (1 + k),
                             0.03 * (1 + k));
    support_write("points.csv", text);
}

/* Every text of an SVG picture, and the entry that is asked for among them. */
static void texts_check(const char *name, const char *const *wanted)
{
    char *text = support_read(name);
    double width = 0, height = 0;
    assert_non_null(text);
    assert_int_equal(sscanf(strstr(text, "viewBox="), "viewBox=\"0 0 %lf %lf\"", &width, &height), 2);
    assert_true(width == 1000 && height >= 800);
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
    static const char *const names[] = {"error_time", "error_flops", "lobes_time"};
    static const char *const rests[] = {"", "window=kaiser_band", "window=kaiser_band,steps=1024,taps=1"};
    for (int r = 0; r < 3; r++)
        for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
            bool drawn = false;
            points_write(rests[r]);
            if (plot_folder(path_of("p.svg"), SASBENCH_ROOT "/plots", names[k], folder, "a", &drawn) != STATUS_OK)
                fail_msg("%s", status_message());
            assert_true(drawn);
            texts_check("p.svg", (const char *const[]){">bp_nearest", ">auto", ">open, thin: in double", NULL});
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(every_series_has_its_entry, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
