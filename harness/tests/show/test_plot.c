/* Pictures: the real scripts draw, and a script of our own reads back what they are given. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "echoes/echo_data.h"
#include "show/plot.h"
#include "show/plot_script.h"
#include "tests/support.h"

static const char real_plots[] = SASBENCH_ROOT "/plots";

/* A file of the test's folder holds this and nothing else. */
static void assert_text(const char *name, const char *expected)
{
    char *text = support_read(name);
    assert_non_null(text);
    assert_string_equal(text, expected);
    free(text);
}

static void assert_png(const char *name)
{
    char *text = support_read(name);
    assert_true(text && strncmp(text, "\x89PNG\r\n\x1a\n", 8) == 0);
    free(text);
}

static void assert_drawn(enum status status)
{
    if (status != STATUS_OK)
        fail_msg("%s", status_message());
}

/* Nothing temporary is left behind. */
static void assert_nothing_left(void)
{
    char command[300];
    snprintf(command, sizeof command, "ls -A \"%s\" | grep -q '^[.]'", folder);
    assert_int_not_equal(system(command), 0);
}

static void image_is_drawn(void **state)
{
    (void)state;
    /* The last one's edges are whole numbers, farther apart than the picture has pixels. */
    struct grid patches[] = {{-1, 0.01, 200, 40, 0.02, 50},
                             {5, 0.01, 1, 50, 0.02, 1},
                             {5, 0.01, 4, 50, 0.02, 1},
                             {0, 0.5, 520, -10000, 5000, 5}};
    struct image image;
    assert_int_equal(image_allocate(4, patches, PRECISION_FLOAT, &image), STATUS_OK);
    assert_drawn(plot_image(NULL, path_of("it's.png"), real_plots,
                            &(struct image_picture){.image = &image, .title = "all zero, 'quoted' \"twice\"\n\\n $x"}));
    assert_png("it's.png");
    ((float complex *)image.pixels[0])[77] = 3;
    ((float complex *)image.pixels[1])[0] = NAN;
    assert_drawn(plot_image(NULL, path_of("it's.png"), real_plots,
                            &(struct image_picture){.image = &image, .title = "with NAN"}));
    assert_png("it's.png");
    image_free(&image);
    assert_nothing_left();
}

/* What the script is given: variables, panels, blocks by their maximum, positions of block centres. */
static void image_data_are_right(void **state)
{
    (void)state;
    support_write("image.gp", "set print output\n"
                              "print title\n"
                              "print |panels|\n"
                              "stats panels[1] binary matrix using 1 name 'sx' nooutput\n"
                              "stats panels[1] binary matrix using 2 name 'sr' nooutput\n"
                              "stats panels[1] binary matrix using 3 name 'v' nooutput\n"
                              "print sprintf('%d %.3f %.3f %.3f %.3f', v_records, sx_min, sx_max, sr_min, sr_max)\n"
                              "stats panels[1] binary matrix using ($3 > -50) name 'n' nooutput\n"
                              "stats panels[1] binary matrix using ($3 > -50 ? $1 : 0) name 'sx' nooutput\n"
                              "stats panels[1] binary matrix using ($3 > -50 ? $2 : 0) name 'sr' nooutput\n"
                              "print sprintf('%d %.3f %.3f %.2f', n_sum, sx_max, sr_max, v_max)\n"
                              "print sprintf('%s %g %g %g %g', shapes[1], x_low[1], x_high[1], r_low[1], r_high[1])\n"
                              "print has_differences, range_db, target_count[1]\n"
                              "print '</svg>'\n");
    /* 2700 columns make blocks of 3; the brightest pixel of all is in a patch that is not shown. */
    struct grid patches[9];
    for (int p = 0; p < 9; p++)
        patches[p] = (struct grid){0, 1, 2700, 10, 0.5, 3};
    struct image image;
    assert_int_equal(image_allocate(9, patches, PRECISION_DOUBLE, &image), STATUS_OK);
    ((double complex *)image.pixels[0])[2 * 2700 + 301] = 3 + 4 * I;
    ((double complex *)image.pixels[0])[5] = INFINITY;
    ((double complex *)image.pixels[8])[0] = 50;
    assert_drawn(plot_image(NULL, path_of("variables.svg"), folder,
                            &(struct image_picture){.image = &image, .title = "it's\ta_title"}));
    assert_text("variables.svg", "it's a_title (1 pixel not finite) (first 8 of 9 patches)\n8\n"
                                 "2700 1.000 2698.000 10.000 11.000\n"
                                 "1 301.000 11.000 -20.00\nimage -0.5 2699.5 9.75 11.25\n0 60 0\n</svg>\n");
    image_free(&image);
    assert_nothing_left();
}

/* Pixels of 2 cm at the coordinates of a map projection: places and labels keep their digits. */
static void far_pixels_are_told_apart(void **state)
{
    (void)state;
    support_write("image.gp", "set print output\n"
                              "stats panels[1] binary matrix using ($3 > -50 ? $1 : 0) name 'sx' nooutput\n"
                              "stats panels[1] binary matrix using ($3 > -50 ? $2 : 0) name 'sr' nooutput\n"
                              "print sprintf('brightest at %.3f %.3f', x_origin[1] + sx_max, r_origin[1] + sr_max)\n"
                              "print '</svg>'\n");
    const struct grid patch = {4000003, 0.02, 101, 500019.5, 0.02, 51, 0};
    struct image image;
    assert_int_equal(image_allocate(1, &patch, PRECISION_DOUBLE, &image), STATUS_OK);
    ((double complex *)image.pixels[0])[26 * 101 + 51] = 1;
    const struct image_picture picture = {.image = &image, .title = "a"};
    assert_drawn(plot_image(NULL, path_of("variables.svg"), folder, &picture));
    assert_text("variables.svg", "brightest at 4000004.020 500020.020\n</svg>\n");
    assert_drawn(plot_image(NULL, path_of("far.svg"), real_plots, &picture));
    char *whole = support_read("far.svg");
    assert_true(whole && strstr(whole, "4000003.5") && strstr(whole, "500020.5"));
    free(whole);
    image_free(&image);
    assert_nothing_left();
}

/* The difference to the exact image, relative to its peak; thin patches as curves; the targets that a patch holds. */
static void differences_curves_and_targets(void **state)
{
    (void)state;
    support_write("image.gp", "set print output\n"
                              "print shapes[1], ' ', shapes[2], ' ', shapes[3], curves[1], curves[2], curves[3]\n"
                              "print has_differences, range_db, difference_top\n"
                              "stats differences[1] index 0 using 2 name 'd' nooutput\n"
                              "print sprintf('%.2f', d_max)\n"
                              "stats panels[2] index 1 using 1:2 name 'c' nooutput\n"
                              "print sprintf('%.2f %.2f', c_pos_max_y, c_max_y)\n"
                              "print target_count[1], target_count[2], target_count[3], ' ', footer\n"
                              "plot targets[3] using (t = strcol(3), $1):(u = $2)\n"
                              "print t, ' ', u\n"
                              "print '</svg>'\n");
    const struct grid patches[3] = {{0, 1, 20, 10, 1, 1, 0}, {0, 1, 2, 10, 1, 30, 0}, {0, 1, 5, 100, 1, 5, 0}};
    const struct target targets[] = {{50, 50, 1}, {2, 102, 1}};
    struct image image, exact;
    assert_int_equal(image_allocate(3, patches, PRECISION_DOUBLE, &image), STATUS_OK);
    assert_int_equal(image_allocate(3, patches, PRECISION_DOUBLE, &exact), STATUS_OK);
    ((double complex *)exact.pixels[0])[7] = 10;
    ((double complex *)image.pixels[0])[7] = 10 + 0.5 * I;
    ((double complex *)image.pixels[1])[2 * 11 + 1] = 1; /* second column, at 21 m */
    const struct image_picture picture = {.image = &image,
                                          .reference = &exact,
                                          .title = "a",
                                          .footer = "from here",
                                          .range_db = 40,
                                          .targets = targets,
                                          .target_count = 2};
    assert_drawn(plot_image(NULL, path_of("variables.svg"), folder, &picture));
    /* 1 of 10: the difference in the second patch is the largest, -20 dB; that in the first 0.5 of 10. */
    assert_text(
        "variables.svg",
        "rows   columns   image 1 2 0\n1 40 -20\n-26.02\n21.00 -20.01\n0 0 1   from here\nT2   102.0\n</svg>\n");
    assert_drawn(plot_image(NULL, path_of("all.png"), real_plots, &picture));
    assert_png("all.png");
    image_free(&image);
    image_free(&exact);
    assert_nothing_left();
}

static void slices_are_drawn(void **state)
{
    (void)state;
    double position[101], power[101];
    for (int k = 0; k < 101; k++) {
        position[k] = 0.01 * (k - 50);
        power[k] = k == 3 ? -INFINITY : k == 4 ? NAN : -0.02 * (k - 50) * (k - 50);
    }
    struct slice_line lines[4];
    for (int l = 0; l < 4; l++)
        lines[l] = (struct slice_line){
            l % 2 ? "bp_'sinc'" : "reference", position, power, 101, l == 3 ? power : NULL, NULL, 0};
    lines[1].count = 0;
    const char *titles[] = {"target 0", "target_1"};
    assert_drawn(plot_slices(NULL, path_of("slices.png"), real_plots,
                             &(struct slices_picture){"two targets", "here", 2, 2, titles, lines, false}));
    assert_png("slices.png");
    for (int l = 0; l < 4; l++)
        lines[l].count = 0;
    assert_drawn(plot_slices(NULL, path_of("slices.png"), real_plots,
                             &(struct slices_picture){"nothing", NULL, 2, 2, titles, lines, false}));
    assert_png("slices.png");
    assert_nothing_left();
}

static void phase_errors_are_drawn(void **state)
{
    (void)state;
    double place[] = {-2, 0, 1}, error[] = {0.1, 0, 0.2};
    const struct slice_line line = {"LBF", place, error, 3, NULL, "rma_lbf", 0.15};
    const char *panel = "r = 50 m";
    assert_drawn(plot_slices(NULL, path_of("phase.png"), real_plots,
                             &(struct slices_picture){"title", "here", 1, 1, &panel, &line, true}));
    assert_png("phase.png");
}

/* What these statements print once the style of all pictures is loaded. */
static void assert_style_prints(const char *statements, const char *expected)
{
    char script[4000], whole[1000];
    const char *panel = "panel";
    const struct slice_line line = {.label = "reference"};
    snprintf(script, sizeof script,
             "plots = %s; name = output; format = 'svg'; load plots.'/style.gp'; set print name\n%s\nprint '</svg>'\n",
             gnuplot_text(real_plots), statements);
    support_write("slices.gp", script);
    assert_drawn(plot_slices(NULL, path_of("variables.svg"), folder,
                             &(struct slices_picture){"title", NULL, 1, 1, &panel, &line, false}));
    snprintf(whole, sizeof whole, "%s\n</svg>\n", expected);
    assert_text("variables.svg", whole);
}

/* An algorithm has its number by its name, whatever its settings; one without a row is drawn as the others. A row
   without an algorithm is left over, or misspelt. */
static void families_are_told_by_name(void **state)
{
    (void)state;
    char statements[3000] =
        "print family_number('reference'), family_number('bp_sinc:taps=8,window=none'), family_number('bp_sinc "
        "double')\n"
        "print family_number('bp_sincere'), family_number('bp'), family_drawn('mine') == |family_names| + 1\n"
        "print |family_colour| == |family_names| + 1, family_drawn('auto') <= |family_names|\n"
        "of = ' ";
    char *at = statements + strlen(statements);
    for (int k = 0; algorithms[k]; k++)
        at += snprintf(at, 80, "%s ", algorithms[k]->name);
    strcpy(at, "'\ndo for [k = 1:|family_names|] { if (!strstrt(of, ' '.family_names[k].' ')) { print 'no algorithm "
               "of plots/families.gp: '.family_names[k] } }\nprint 'all names are algorithms'");
    assert_style_prints(statements, "1 4 4\n0 0 1\n1 1\nall names are algorithms");
}

/* Labels of short slices are farther apart: "-0.004" is longer than "-1". */
static void labels_do_not_collide(void **state)
{
    (void)state;
    assert_style_prints(
        "print tic_apart(1.5*0.00465, 2*0.00465, 500), tic_apart(1.5*1.2, 2*1.2, 500), tic_step(1.5*0.00465)\n"
        "print tic_format(0, 80, 10), ' ', tic_format(4000003, 4000005, 0.5)",
        "0.002 0.5 0.001\n%.6g   %.8g");
}

/* A file for each line, without what lies beyond those that are shown; an empty line has one, too. */
static void slice_data_are_right(void **state)
{
    (void)state;
    support_write("slices.gp",
                  "set print output\n"
                  "print title, |panels|, |lines|, panels[2], lines[2]\n"
                  "print sprintf('%d %.3f %d %g', has_differences, extent, point_interval, difference_top)\n"
                  "stats data[4] using 3 name 'e' nooutput\n"
                  "print sprintf('%.1f %d', e_min, e_records)\n"
                  "do for [b = 1:4] {\n"
                  "    stats data[b] using ($2 == $2 ? $1 : NaN) name 'x' nooutput\n"
                  "    print sprintf('%d', exists('x_records') ? x_records : 0)\n"
                  "    stats data[b] using ($2 == $2 ? $2 : NaN) name 'p' nooutput\n"
                  "    print exists('p_max') && b != 2 ? sprintf('%.2f %.2f', x_max, p_max) : '-'\n"
                  "}\n"
                  "print '</svg>'\n");
    double position[] = {-9, -0.5, 0, 0.25, 7, 8}, difference[] = {-12, -41, -INFINITY, -43, -12, -12};
    double power[4][6] = {{-40, -9, -1, -9, -40, -40}, {0}, {-40, -9, -2, -9, -40, -40}, {-40, -9, -3, -9, -40, -40}};
    struct slice_line lines[4];
    for (int l = 0; l < 4; l++)
        lines[l] = (struct slice_line){l % 2 ? "b" : "a",          position, power[l], l == 1 ? 0 : 6,
                                       l == 3 ? difference : NULL, NULL,     0};
    const char *titles[] = {"t0", "t1"};
    assert_drawn(plot_slices(NULL, path_of("variables.svg"), folder,
                             &(struct slices_picture){"title", NULL, 2, 2, titles, lines, false}));
    assert_text("variables.svg",
                "title 2 2 t1 b\n1 0.575 0 -40\n-200.0 5\n5\n7.00 -1.00\n0\n-\n5\n7.00 -2.00\n5\n7.00 -3.00\n"
                "</svg>\n");
    assert_nothing_left();
}

static void failures_are_told(void **state)
{
    (void)state;
    struct grid patch = {0, 1, 4, 10, 1, 4};
    struct image image;
    assert_int_equal(image_allocate(1, &patch, PRECISION_FLOAT, &image), STATUS_OK);

    assert_int_equal(plot_image(NULL, path_of("no/such/folder.png"), real_plots,
                                &(struct image_picture){.image = &image, .title = "a"}),
                     STATUS_INVALID);
    assert_non_null(strstr(status_message(), "no/such/folder.png"));

    /* A failing script leaves the old picture alone. */
    support_write("image.gp", "set print output; print 'half'; nonsense here\n");
    support_write("old.png", "old");
    assert_int_equal(
        plot_image(NULL, path_of("old.png"), folder, &(struct image_picture){.image = &image, .title = "a"}),
        STATUS_FAILED);
    assert_non_null(strstr(status_message(), "old.png"));
    assert_non_null(strstr(status_message(), "nonsense"));
    assert_non_null(strstr(status_message(), ": line 1: invalid command"));
    assert_text("old.png", "old");

    char *paths = strdup(getenv("PATH"));
    setenv("PATH", folder, 1);
    enum status status =
        plot_image(NULL, path_of("old.png"), real_plots, &(struct image_picture){.image = &image, .title = "a"});
    setenv("PATH", paths, 1);
    free(paths);
    assert_int_equal(status, STATUS_FAILED);
    assert_non_null(strstr(status_message(), "gnuplot-nox"));

    image_free(&image);
    assert_nothing_left();
}

/* gnuplot does not notice a full disk: what it leaves has no end. */
static void cut_pictures_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *name, *script;
        bool whole;
    } cuts[] = {
        {"a.png", "set output output\n", false},
        {"a.png", "set print output; print \"\\211PNG, half of it and more than 32 bytes of that\"\n", false},
        {"a.png", "set print output; print '<svg>all of it, but another kind</svg>'\n", false},
        {"a.svg", "set print output; print '<svg>half of it, and more than 32 bytes of that</sv'\n", false},
        {"a.svg", "set print output; print '<svg>all of it to its end</svg>'; print ''; print ''\n", true},
    };
    struct grid patch = {0, 1, 4, 10, 1, 4};
    struct image image;
    assert_int_equal(image_allocate(1, &patch, PRECISION_FLOAT, &image), STATUS_OK);
    for (size_t k = 0; k < sizeof cuts / sizeof *cuts; k++) {
        support_write("image.gp", cuts[k].script);
        support_write(cuts[k].name, "old");
        assert_int_equal(
            plot_image(NULL, path_of(cuts[k].name), folder, &(struct image_picture){.image = &image, .title = "a"}),
            cuts[k].whole ? STATUS_OK : STATUS_FAILED);
        assert_text(cuts[k].name, cuts[k].whole ? "<svg>all of it to its end</svg>\n\n\n" : "old");
        if (!cuts[k].whole) {
            assert_non_null(strstr(status_message(), cuts[k].name));
            assert_non_null(strstr(status_message(), "without its end"));
        }
    }
    image_free(&image);
    assert_nothing_left();
}

/* Pictures that wait are drawn together, from what they were added with; one that fails leaves the others alone. */
static void queued_pictures_are_drawn(void **state)
{
    (void)state;
    struct grid patch = {0, 1, 4, 10, 1, 4};
    struct image image;
    struct plot_queue queue = {NULL, 0, 0};
    double position[] = {-1, 0, 1}, power[] = {-20, 0, -20};
    struct slice_line line = {.label = "a", .position_m = position, .power_db = power, .count = 3};
    const char *panel = "t0";
    char name[10];
    assert_int_equal(image_allocate(1, &patch, PRECISION_FLOAT, &image), STATUS_OK);
    support_write("image.gp", "nonsense here\n");
    const struct image_picture picture = {.image = &image, .title = "a"};
    for (int k = 0; k < 5; k++) {
        snprintf(name, sizeof name, "q%d.png", k);
        assert_drawn(plot_image(&queue, path_of(name), k == 2 ? folder : real_plots, &picture));
        assert_int_not_equal(access(path_of(name), F_OK), 0);
    }
    assert_drawn(plot_slices(&queue, path_of("s.png"), real_plots,
                             &(struct slices_picture){"title", NULL, 1, 1, &panel, &line, false}));
    image_free(&image);
    line.count = 0;
    assert_int_equal(queue.count, 6);
    plot_queue_draw(&queue);
    assert_int_equal(queue.count, 0);
    assert_int_equal(queue.undrawn, 1);
    assert_non_null(strstr(status_message(), "q2.png"));
    assert_non_null(strstr(status_message(), "nonsense"));
    for (int k = 0; k < 5; k++) {
        snprintf(name, sizeof name, "q%d.png", k);
        if (k == 2)
            assert_int_not_equal(access(path_of(name), F_OK), 0);
        else
            assert_png(name);
    }
    assert_png("s.png");
    assert_nothing_left();

    /* What is dropped leaves nothing, either. */
    assert_int_equal(image_allocate(1, &patch, PRECISION_FLOAT, &image), STATUS_OK);
    assert_drawn(
        plot_image(&queue, path_of("dropped.png"), real_plots, &(struct image_picture){.image = &image, .title = "a"}));
    plot_queue_free(&queue);
    assert_int_not_equal(access(path_of("dropped.png"), F_OK), 0);
    image_free(&image);
    assert_nothing_left();
}

/* The last test: nothing is drawn after it. */
static void hanging_gnuplot_is_stopped(void **state)
{
    (void)state;
    struct grid patch = {0, 1, 4, 10, 1, 4};
    struct image image;
    assert_int_equal(image_allocate(1, &patch, PRECISION_FLOAT, &image), STATUS_OK);
    support_write("image.gp", "pause 1000\n");
    plot_seconds_most = 0.2;
    assert_int_equal(plot_image(NULL, path_of("a.png"), folder, &(struct image_picture){.image = &image, .title = "a"}),
                     STATUS_FAILED);
    assert_non_null(strstr(status_message(), "did not end within 0.2 s"));
    plot_seconds_most = 60;
    assert_int_equal(
        plot_image(NULL, path_of("a.png"), real_plots, &(struct image_picture){.image = &image, .title = "a"}),
        STATUS_FAILED);
    assert_non_null(strstr(status_message(), "did not end on a picture before"));
    image_free(&image);
    assert_nothing_left();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(image_is_drawn),
        cmocka_unit_test(image_data_are_right),
        cmocka_unit_test(far_pixels_are_told_apart),
        cmocka_unit_test(differences_curves_and_targets),
        cmocka_unit_test(slices_are_drawn),
        cmocka_unit_test(phase_errors_are_drawn),
        cmocka_unit_test(families_are_told_by_name),
        cmocka_unit_test(labels_do_not_collide),
        cmocka_unit_test(slice_data_are_right),
        cmocka_unit_test(failures_are_told),
        cmocka_unit_test(cut_pictures_are_told),
        cmocka_unit_test(queued_pictures_are_drawn),
        cmocka_unit_test(hanging_gnuplot_is_stopped),
    };
    return cmocka_run_group_tests_name("plot", tests, folder_make_quoted, folder_remove);
}
