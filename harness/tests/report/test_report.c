/* The report page: a small parser reads it as a browser would have to, and everything in the folder must be on it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "show/plot.h"
#include "report/report.h"
#include "sweep/sweep_tables.h"
#include "tests/report/report_fixture.h"
#include "tests/support.h"

static void assert_holds(const char *text, const char *part)
{
    if (!strstr(text, part))
        fail_msg("'%s' is not there", part);
}

/* --- Pages ---------------------------------------------------------------------------------------------------- */

static const char *const odd_scene = "b<i>it's \"b\" & c";

/* Three scenes, one with signs that HTML gives a meaning, with all that `run`, `sweep` and `reproduce` leave. */
static void folder_fill(void)
{
    struct measurement rows[] = {
        row_of("a", "reference", "", 0.9, 1e-6),
        row_of("a", "bp_nearest", "", 0.01, 0.2),
        row_of("a", "bp_linear", "beta=2", 0.02, 0.1),
        row_of("a", "bp_linear", "beta=8", 0.03, 0.09),
        row_of("a", "bp_linear", "beta=4", 0.025, 0.095),
        row_of(odd_scene, "reference", "", 0.9, 1e-6),
        row_of(odd_scene, "bp_zeropad", "factor=4", 0.2, 0.01),
        row_of(odd_scene, "rma_pca", "blocks=2", 0, 0),
        row_of(odd_scene, "rma_wu", "blocks=2", 0, 0),
        row_of("no/rate", "rma_pca", "blocks=2", 0.1, 0.1),
        row_of("no/rate", "rma_pca", "blocks=4", 0.2, 0.05),
        row_of("no/rate", "rma_pca", "blocks=8", 0.3, 0.04),
        row_of(odd_scene, "bp_zeropad", "factor=8", 0.3, 0.005),
        row_of(odd_scene, "bp_zeropad", "factor=16", 0.4, 0.003),
    };
    rows[7].status = "unsupported";
    rows[7].reason = "a track of <3 pings | none";
    rows[8].status = "failed";
    rows[8].reason = "no & memory";
    for (int k = 7; k < 9; k++)
        rows[k].run_s = rows[k].run_min_s = rows[k].error = NAN;
    record_rows(rows, sizeof rows / sizeof *rows);
    support_write("cheapest.csv", "# sasbench cheapest 1\nscene,cost,error_below,algorithm,options,precision,run_s,"
                                  "speed_up,flops,error,error_gain,pslr_db,islr_db,family,ties,noise\n"
                                  "a,run_s,1e-1,bp_linear,beta=8,float,0.03,33,3e7,0.09,0.09,-13.39,,all,,\n");
    support_write("slopes.csv", "scene,algorithm,options,precision,setting,part,first,last,rate_first,rate_last,points,"
                                "slope,error_first,error_last,residual_log10\n"
                                "a,bp_zeropad,,float,factor,finest,8,64,8,64,4,-1.0321,0.1,0.01,0.00123\n");
    support_write("rules.csv", "scene,fc_hz,fs_hz,bandwidth_hz,bp22_eq20_rate,zp15_rate,edge_phase_rad,linear_floor\n"
                               "a,150000,30000,15000,3.125,10,0.785,0.0685\n");
    support_write("plans.csv",
                  "scene,options,precision,algorithm,settings,verdict,seconds,error,text\n"
                  "a,error=0.01,float,bp_fitted,taps=4,chosen,0.02,0.0051,left out: double precision: 3e-07\n"
                  "a,error=0.01,float,bp_nearest,,error,0.01,0.2,error 0.2 is over the budget\n");
    support_write("predictions.csv", "algorithm,images,least,lower_quartile,median,upper_quartile,largest\n"
                                     "bp_linear,3,1.0625,1.1,-nan,inf,1.75\n");
    support_write("claims.csv", "id,paper,section,claim,verdict,corrected,evidence\n"
                                "x-1,BP22,4.1,\"linear, at <beta> = 2\",holds,,1 < 2\n"
                                "x-2,BP22,4.2,second,does not hold,holds,two & three\n"
                                "x-3,ZP15,3,third,holds under stated assumption,,e\n"
                                "x-4,ZP15,4,fourth,cannot be decided,,e\n");
    support_write("reproduced.csv",
                  "table,item,quantity,definition,unit,paper,ours,difference,assumption\n"
                  "bp22_t3,T1,pslr_db,null,dB,-14.62,-13.46,1.159,the text prints no target positions\n"
                  "bp22_t3,T1,islr_db,null,dB,-8.08,,,the text prints no target positions\n"
                  "unheard_of,T1,islr_db,null,dB,-8.08,,,\n");
    static const char *const pictures[][2] = {{"a", "slices"}, {"a", "bp_linear:beta=8"}, {"a", "not a row"}};
    for (size_t k = 0; k < sizeof pictures / sizeof *pictures; k++) {
        char path[400], name[64];
        snprintf(name, sizeof name, "%s.png", pictures[k][1]);
        picture_path("", pictures[k][0], name, path, sizeof path);
        support_write(path + 1, "not looked into");
    }
    support_write("phase-x.png", "abc");
}

/* Every link within the page leads somewhere. */
static void assert_links_lead_somewhere(const char *html, const struct parser *page)
{
    for (const char *link = html; (link = strstr(link, "href=\"#"));) {
        char id[48];
        bool found = false;
        link += strlen("href=\"#");
        snprintf(id, sizeof id, "%.*s", (int)strcspn(link, "\""), link);
        for (int k = 0; k < page->id_count; k++)
            found |= strcmp(page->ids[k], id) == 0;
        if (!found)
            fail_msg("a link to #%s, which is not there", id);
    }
}

/* A point of the front has a name, can be focused and says how it is measured again, without the script as well. */
static void assert_fronts_say_how(const char *html)
{
    assert_holds(html,
                 "<p>12 images by 6 algorithms on 3 scenes, with 2 threads on a machine &amp; its &lt;cores&gt;.</p>\n"
                 "<p>Nothing measured comes within a relative error of 1e-3.</p>\n<p>1 image was refused, 1 failed; ");
    assert_holds(html,
                 "<g class=\"point\" tabindex=\"0\" role=\"img\" aria-label=\"bp_linear:beta=8: error 9.0e-02, 30 ms, "
                 "33.3x\"><title>bp_linear:beta=8: error 9.0e-02, 30 ms, 33.3x\n"
                 "./sasbench run a.cfg --algorithm bp_linear:beta=8 -o results/again</title>");
    assert_holds(html, "<pre>./sasbench run a.cfg --algorithm bp_nearest -o results/again\n");
    assert_holds(html, "./sasbench run &#39;b&lt;i&gt;it&#39;\\&#39;&#39;s &quot;b&quot; &amp; c.cfg&#39; --algorithm "
                       "bp_zeropad:factor=8 -o");
}

static void test_everything_is_on_the_page(void **state)
{
    (void)state;
    folder_fill();
    assert_int_equal(report_write(folder), STATUS_OK);
    char *html = support_read("report.html"), *cells = support_read_cells("report.html");
    assert_true(html && cells);
    struct parser *page = page_parse(html);
    /* Three fronts, the fastest, machine, three scenes, cheapest, slopes, choices of all scenes and plans of one,
       predictions, rules, two papers, two reproduced tables. */
    assert_int_equal(page->tables, 3 + 1 + 1 + 3 + 1 + 1 + 2 + 1 + 1 + 2 + 2);
    assert_holds(cells, "|a|error=0.01|bp_fitted:taps=4|0.02|0.0051|left out: double precision: 3e-07|");
    assert_holds(html, "error 0.2 is over the budget");
    assert_holds(html, "<h2 id=\"predictions\">Predicted errors</h2>");
    assert_holds(html, ">1.062</td>");
    assert_true(!strstr(html, "nan<"));          /* from a stranger */
    assert_int_equal(page->drawings, 3 + 3 + 5); /* a chart and a panel of each scene, marks of five algorithms */
    assert_fronts_say_how(html);
    /* Slices, one image, one figure of `phase`: the picture without a row is not of these results. */
    assert_int_equal(page->images, 3);
    static const char *const parts[] = {
        "a machine &amp; its &lt;cores&gt;",
        "bp_linear:<wbr/>beta=8",
        "unsupported: a track of &lt;3 pings | none",
        "failed: no &amp; memory",
        "b&lt;i&gt;it&#39;s &quot;b&quot; &amp; c",
        "-1.032",
        "0.00123",
        "3.125",
        "class=\"good\">holds<",
        "class=\"bad\">does not hold<",
        "class=\"soft\">holds under stated assumption<",
        "class=\"open\">cannot be decided<",
        "<p>as printed: 1 holds, 1 holds under stated assumption, 0 identity, 1 does not hold, 1 cannot be decided</p>",
        "BP22 Table 3: PSLR and ISLR of six targets",
        "unheard_of",
        "src=\"data:image/png;base64,bm90IGxvb2tlZCBpbnRv\"",
        "src=\"data:image/png;base64,YWJj\"",
        "@media print"};
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        assert_holds(html, parts[k]);
    static const char *const lines[] = {"|machine|a machine &amp; its &lt;cores&gt;|", "|bp_linear:beta=8|30 ms|33.3x|",
                                        "|rma_pca:blocks=2|unsupported: a track of &lt;3 pings | none|",
                                        "|x-2|4.2|second|does not hold|holds|two &amp; three|"};
    for (size_t k = 0; k < sizeof lines / sizeof *lines; k++)
        assert_holds(cells, lines[k]);
    const char *lost = strstr(html, "the text prints no target positions");
    assert_true(lost && !strstr(lost + 1, "the text prints no target positions"));
    assert_false(support_exists("report.html.part"));
    assert_links_lead_somewhere(html, page);
    free(page), free(html), free(cells);
}

/* The fastest within an error is what cheapest.csv has, and a noisy time has its mark in both; a setting is told where
   its algorithm has several. */
static void test_fastest_and_cheapest_agree(void **state)
{
    (void)state;
    enum { ROWS = 12 };
    char names[ROWS][16];
    struct measurement rows[ROWS];
    for (int k = 0; k < ROWS; k++) { /* from fast and rough to slow and exact: the fourth is enough */
        snprintf(names[k], sizeof names[k], "bp_%c", 'a' + k);
        rows[k] = row_of("s", k == 4 ? names[3] : names[k], k == 4 ? "taps=8" : "", 0.01 * (k + 1), 0.8 / (1 << k));
        rows[k].reason = k == 3 ? "warning: times scatter: the middle half of 5 runs spans 60 % of the median" : "";
    }
    record_rows(rows, ROWS);
    assert_int_equal(sweep_tables(folder, NULL, 0, NULL), STATUS_OK);
    assert_int_equal(report_write(folder), STATUS_OK);
    char *cheapest = support_read("cheapest.csv"), *cells = support_read_cells("report.html");
    assert_holds(cells, "|error up to|1e-1|1e-2|1e-3|\n\n"
                        "|s|bp_d, 40 ms~, 25x|bp_h, 80 ms, 12.5x|bp_k, 110 ms, 9.09x|\n");
    assert_holds(cheapest, "\ns,run_s,1e-1,bp_d,,float,0.04,25,");
    assert_holds(cheapest, "\ns,run_s,1e-2,bp_h,,float,0.08,12.5,");
    assert_holds(cells, "|bp_d|1.0e-01|40 ms~|25x|\n|bp_d:taps=8|5.0e-02|50 ms|20x|\n");
    free(cheapest);
    free(cells);
}

static int count_of(const char *text, const char *part)
{
    const char *next = strstr(text, part);
    return next ? 1 + count_of(next + 1, part) : 0;
}

/* A scene's warnings stand once, with the images that have them, and in no row. */
static void test_warnings_stand_once(void **state)
{
    (void)state;
    struct measurement rows[] = {row_of("a", "reference", "", 0.9, 1e-6), row_of("a", "bp_nearest", "", 0.01, 0.2),
                                 row_of("a", "bp_sinc", "taps=8", 0.02, 0.1), row_of("b", "bp_nearest", "", 0.01, 0.2),
                                 row_of("b", "rma_wu", "", NAN, NAN)};
    rows[0].reason = "warning: condition pixel_x: too <coarse>";
    rows[1].reason = "no point targets; warning: condition pixel_x: too <coarse>; warning: condition ghost: two";
    rows[2].reason = "warning: condition pixel_x: too <coarse>; warning: condition ghost: two; warning: condition own: "
                     "one; warning: times scatter: much";
    rows[3].reason = "warning: condition pixel_x: alone";
    rows[4].status = "unsupported";
    record_rows(rows, sizeof rows / sizeof *rows);
    assert_int_equal(report_write(folder), STATUS_OK);
    char *html = support_read("report.html"), *cells = support_read_cells("report.html");
    assert_holds(cells, "|a|condition pixel_x: too &lt;coarse&gt;|all|\n|a|condition ghost: two|bp_nearest, "
                        "bp_sinc:taps=8|\n|a|condition own: one|bp_sinc:taps=8|\n|b|condition pixel_x: alone|");
    assert_holds(html, "colspan=\"11\">invariant; no point targets</td>");
    assert_holds(cells, "|bp_sinc:taps=8|20 ms~|");
    assert_int_equal(count_of(html, "too &lt;coarse"), 1);
    assert_int_equal(count_of(cells, "condition ghost"), 1);
    assert_int_equal(count_of(html, "scatter"), 0);
    assert_int_equal(count_of(html, "alone"), 1);
    free(html);
    free(cells);
}

static void test_failures_alone_make_a_page(void **state)
{
    (void)state;
    struct measurement row = row_of("a", "bp_nearest", "", NAN, NAN);
    row.status = "failed";
    row.reason = "out of luck";
    record_rows(&row, 1);
    assert_int_equal(report_write(folder), STATUS_OK);
    char *html = support_read("report.html");
    assert_non_null(html);
    struct parser *page = page_parse(html);
    assert_int_equal(page->drawings, 0);
    assert_int_equal(page->tables, 2);
    assert_holds(html, "failed: out of luck");
    free(page);
    free(html);
}

/* What `stability` writes needs no measurements beside it. */
static void test_stability_alone_makes_a_page(void **state)
{
    (void)state;
    support_write("stability.csv",
                  "# sasbench stability 1\n# commit: abc\nscene,algorithm,options,precision,modes,engine,"
                  "verdict,error,error_bound,difference,conditioning,digits,spread,same_bits,finite,"
                  "exceptions,reason\n"
                  "extreme/base,bp_nearest,,float,4,general,works,0.036,0.15,1e-5,1e-4,-1.01,2e-5,yes,"
                  "yes,0,\n"
                  "extreme/base,rma_lbf,blocks=0,float,4,,refused: lbf_law,,,,,,,,,,too <wide>\n");
    support_write("stability.png", "abc");
    support_write("stability.svg", "<svg></svg>");
    assert_int_equal(report_write(folder), STATUS_OK);
    char *page = support_read_cells("report.html"), *html = support_read("report.html");
    assert_holds(page, "Stability\nExtreme scenes");
    assert_holds(page, "|bp_nearest||float|general|works|0.036|0.15|-1.01|");
    assert_holds(page, "refused: lbf_law");
    assert_holds(page, "|commit|abc|");
    assert_null(strstr(page, "\nMeasurements\n"));
    assert_holds(html, "aria-label=\"stability.png\">\n<svg></svg>");
    free(page);
    free(html);
    support_write("stability.csv", "scene,algorithm\n");
    assert_int_equal(report_write(folder), STATUS_INVALID);
}

static void test_faults_leave_the_old_pages(void **state)
{
    (void)state;
    static const struct {
        const char *file, *text, *part;
    } faults[] = {
        {"measurements.csv", NULL, "measurements.csv"},
        {"measurements.csv", "scene,algorithm\n\"a", "measurements.csv"},
        {"claims.csv", "id,paper\nx,BP22,more\n", "claims.csv:2: 3 fields"},
        {"claims.csv", "id,paper,section,claim,evidence\n", "'verdict'"},
        {"slopes.csv", "algorithm\n", "'scene'"},
    };
    struct measurement row = row_of("a", "bp_nearest", "", 0.1, 0.1);
    for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
        record_rows(&row, 1);
        support_write("report.html", "old");
        if (faults[k].text)
            support_write(faults[k].file, faults[k].text);
        else
            remove(path_of(faults[k].file));
        assert_int_equal(report_write(folder), STATUS_INVALID);
        assert_holds(status_message(), faults[k].part);
        char *html = support_read("report.html");
        assert_non_null(html);
        assert_string_equal(html, "old");
        free(html);
        assert_false(support_exists("report.html.part"));
        remove(path_of(faults[k].file));
    }
    assert_int_equal(report_write("/nowhere/at/all"), STATUS_INVALID);
}

/* A picture is on the page as a small one that links to it. */
static void test_images_are_thumbnails(void **state)
{
    (void)state;
    struct measurement row = row_of("a", "bp_nearest", "", 0.1, 0.1);
    double places[] = {-1, 0, 1}, powers[] = {-20, 0, -20};
    const struct slice_line line = {"bp_nearest", places, powers, 3, NULL, NULL, 0};
    const char *const titles[] = {"one"};
    record_rows(&row, 1);
    assert_int_equal(plot_slices(NULL, path_of("a-slices.png"), SASBENCH_ROOT "/plots",
                                 &(struct slices_picture){"a", NULL, 1, 1, titles, &line, false}),
                     STATUS_OK);
    assert_int_equal(report_write(folder), STATUS_OK);
    char *html = support_read("report.html");
    assert_non_null(html);
    struct parser *page = page_parse(html);
    assert_int_equal(page->images, 1);
    assert_holds(html, "<a href=\"a-slices.png\"><img alt=\"a: azimuth slices\" src=\"data:image/jpeg;base64,/9j/");
    assert_null(strstr(html, "image/png"));
    free(page);
    free(html);
}

/* Where there are too many, the others are links. */
static void test_images_beyond_are_links(void **state)
{
    (void)state;
    enum { ROWS = 66 };
    static struct measurement rows[ROWS];
    static char options[ROWS][24];
    double places[] = {-1, 0, 1}, powers[] = {-20, 0, -20};
    const struct slice_line line = {"bp_linear", places, powers, 3, NULL, NULL, 0};
    const char *const titles[] = {"one"};
    char name[64], path[400];
    for (int k = 0; k < ROWS; k++) {
        snprintf(options[k], sizeof options[k], "beta=%d", k);
        rows[k] = row_of("a", "bp_linear", options[k], 0.1 + k, 0.1);
        snprintf(name, sizeof name, "bp_linear:beta=%d.png", k);
        picture_path(folder, "a", name, path, sizeof path);
        if (k == 0)
            assert_int_equal(plot_slices(NULL, path, SASBENCH_ROOT "/plots",
                                         &(struct slices_picture){"a", NULL, 1, 1, titles, &line, false}),
                             STATUS_OK);
        else
            assert_int_equal(link(path_of("a-bp_linear_beta_0.png"), path), 0);
    }
    record_rows(rows, ROWS);
    assert_int_equal(report_write(folder), STATUS_OK);
    char *html = support_read("report.html");
    assert_non_null(html);
    struct parser *page = page_parse(html);
    assert_int_equal(page->images, 63);
    assert_true(strlen(html) < REPORT_HTML_BYTES);
    assert_holds(html, "<p>Beside this page: <a href=\"a-bp_linear_beta_63.png\">a: bp_linear:beta=63</a>, ");
    assert_holds(html, ">a: bp_linear:beta=65</a></p>");
    free(page);
    free(html);
}

static void test_pages_stay_small(void **state)
{
    (void)state;
    struct measurement row = row_of("a", "bp_nearest", "", 0.1, 0.1);
    record_rows(&row, 1);
    FILE *claims = fopen(path_of("claims.csv"), "w"), *picture = fopen(path_of("a-slices.png"), "w");
    fputs("id,paper,section,claim,verdict,corrected,evidence\n", claims);
    for (int k = 0; k < 3000; k++)
        fprintf(claims, "x-%d,BP22,4.1,some words that are claimed,holds,,some words of evidence\n", k);
    assert_int_equal(fclose(claims), 0);
    assert_int_equal(ftruncate(fileno(picture), REPORT_HTML_BYTES), 0);
    assert_int_equal(fclose(picture), 0);
    assert_int_equal(report_write(folder), STATUS_OK);
    char *html = support_read("report.html");
    assert_non_null(html);
    struct parser *page = page_parse(html);
    assert_true(strlen(html) < REPORT_HTML_BYTES);
    assert_int_equal(page->images, 0);
    assert_holds(html, "x-2999");
    assert_holds(html, "1 pictures are left out");
    free(page);
    free(html);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_everything_is_on_the_page, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_fastest_and_cheapest_agree, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_warnings_stand_once, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_failures_alone_make_a_page, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_faults_leave_the_old_pages, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_stability_alone_makes_a_page, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_images_are_thumbnails, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_images_beyond_are_links, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_pages_stay_small, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
