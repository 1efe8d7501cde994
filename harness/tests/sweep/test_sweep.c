/* `sweep`: settings, Pareto fronts and lines on made-up numbers; the whole command on a small speckle scene, cut short
   and resumed; and the two laws that a sweep has to show there: linear upsampling's floor and zero padding's order
   1/K. */
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files/csv.h"
#include "results/results_folder.h"
#include "sweep/sweep_settings.h"
#include "show/plot_points.h"
#include "sweep/sweep_tables.h"
#include "command/task.h"
#include "tests/support.h"

/* --- Made-up numbers ------------------------------------------------------------------------------------------ */

static void test_front(void **state)
{
    (void)state;
    /* The third is beaten by the first, the fourth equals the second, the fifth is no point, the last is cheapest. */
    const double cost[] = {2, 4, 3, 4, NAN, 5, 0, 1}, error[] = {.1, .01, .1, .01, .001, .02, 1e-9, .5};
    int front[8];
    assert_int_equal(pareto_front_find(8, cost, error, front), 3);
    assert_int_equal(front[0], 7);
    assert_int_equal(front[1], 0);
    assert_int_equal(front[2], 1);
    assert_int_equal(pareto_front_find(0, NULL, NULL, front), 0);
}

static void test_line(void **state)
{
    (void)state;
    double rate[] = {1, 2, 4, 8}, error[4];
    for (int k = 0; k < 4; k++)
        error[k] = 0.3 / rate[k];
    struct line_fit fit = line_fit(4, rate, error);
    assert_int_equal(fit.points, 4);
    assert_close(fit.slope, -1, 1e-12);
    assert_close(fit.first, 0.3, 1e-12);
    assert_close(fit.last, 0.0375, 1e-12);
    assert_close(fit.residual_log10, 0, 1e-12);
    /* Off the line by a tenth of a decade, up and down, such that the slope stays. */
    const double off[] = {.1, -.1, -.1, .1};
    for (int k = 0; k < 4; k++)
        error[k] *= pow(10, off[k]);
    fit = line_fit(4, rate, error);
    assert_close(fit.slope, -1, 1e-12);
    assert_close(fit.residual_log10, .1, 1e-12);
    assert_true(isnan(line_fit(1, rate, error).slope));
    assert_true(isnan(line_fit(2, (double[]){2, 2}, error).slope));
}

static void test_floor(void **state)
{
    (void)state;
    assert_int_equal(floor_find(5, (double[]){1, .5, .102, .101, .1}), 2);
    assert_int_equal(floor_find(4, (double[]){1, .5, .25, .125}), 4);
    assert_int_equal(floor_find(3, (double[]){.1, .1, .1}), 0);
    assert_int_equal(floor_find(1, (double[]){.1}), 1);
}

static int settings_count(const char *text)
{
    struct sweep_settings settings = {0};
    struct spec spec;
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    assert_int_equal(settings_add(&settings, &spec), STATUS_OK);
    assert_int_equal(settings_add(&settings, &spec), STATUS_OK); /* nothing twice */
    int count = settings.count;
    for (int a = 0; a < count; a++)
        for (int b = 0; b < a; b++)
            assert_false(spec_equal(&settings.specs[a], &settings.specs[b]));
    settings_free(&settings);
    spec_free(&spec);
    return count;
}

static void test_settings(void **state)
{
    (void)state;
    static const struct {
        const char *spec;
        int count;
    } lists[] = {
        {"reference", 1},
        {"bp_nearest", 2},
        {"bp_linear", 7 * 2}, /* beta 0 1 2 4 8 16 32, float and double */
        {"bp_linear:beta=3", 2},
        {"bp_linear:precision=double", 7},
        {"bp_linear:beta=3,precision=double", 1},
        {"bp_sinc", 7 * 2 * 2}, /* taps 4 6 8 10 12 16 32, window none and kaiser */
        {"bp_sinc:window=kaiser", 7 * 2},
        {"bp_zeropad", 7 * 2},    /* factor 1 2 4 8 16 32 64 */
        {"bp_farrow", 6 * 2},     /* degree 2 3 4 5 6 7 */
        {"bp_fitted", 3 * 3 * 2}, /* taps 4 6 8, factor 1 2 4 */
    };
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
        assert_int_equal(settings_count(lists[k].spec), lists[k].count);
}

/* The first row with these values in the first two columns named; -1 if there is none. */
static int row_find(const struct csv *csv, const char *const names[2], const char *const values[2])
{
    for (int row = 0; row < csv->row_count; row++)
        if (strcmp(csv_cell(csv, row, csv_column(csv, names[0])), values[0]) == 0
            && strcmp(csv_cell(csv, row, csv_column(csv, names[1])), values[1]) == 0)
            return row;
    return -1;
}

static double cell(const struct csv *csv, int row, const char *column)
{
    double value;
    assert_true(row >= 0 && csv_column(csv, column) >= 0);
    assert_true(csv_number(csv_cell(csv, row, csv_column(csv, column)), &value));
    return value;
}

/* A series of two settings, and rows that never become a point: one that failed, one that images only a part. */
static void rows_beside(struct results_folder *results, struct measurement *row)
{
    /* As fast as factor=4 within the noise, and less exact; slower than factor=8 beyond it. */
    row->algorithm = "rma_pca";
    row->options = "blocks=2";
    row->run_s = 0.042;
    row->run_q1_s = 0.041;
    row->run_q3_s = 0.05;
    row->flops = 2e9;
    row->error = 0.08;
    assert_int_equal(results_folder_add(results, row), STATUS_OK);
    row->options = "blocks=8";
    row->run_s = 0.1;
    row->run_q1_s = 0.09;
    row->run_q3_s = 0.11;
    row->error = 0.04;
    assert_int_equal(results_folder_add(results, row), STATUS_OK);
    row->run_s = row->flops = 1e-9; /* would beat everything */
    row->error = 1e-9;
    row->options = "";
    row->algorithm = "failed";
    row->status = "failed";
    assert_int_equal(results_folder_add(results, row), STATUS_OK);
    row->algorithm = "partial";
    row->status = "ok";
    row->pairs = 1e5;
    assert_int_equal(results_folder_add(results, row), STATUS_OK);
}

/* A series of seven settings, and what stands beside it. */
static void rows_make_up(void)
{
    struct provenance provenance = {.machine = "m", .commit = "abc", .program = "def", .date = "now", .threads = 2};
    struct results_folder *results;
    char options[7][24];
    assert_int_equal(results_folder_open(folder, &provenance, &results), STATUS_OK);
    assert_int_equal(results_folder_scene(results, "made/up", 1), STATUS_OK);
    struct measurement row = {.scene = "made/up",
                              .algorithm = "bp_zeropad",
                              .precision = "float",
                              .threads = 2,
                              .engine = "x",
                              .status = "ok",
                              .reason = "",
                              .skipped = "",
                              .stages = "",
                              .plan_s = 1,
                              .runs = 3,
                              .control_s = 8,
                              .flops_published = NAN,
                              .pairs = 1e6,
                              .bytes = 1,
                              .error_gain = NAN,
                              .phase_rms_rad = NAN,
                              .width_m = NAN,
                              .pslr_db = NAN,
                              .islr_db = NAN};
    for (int k = 0; k < 7; k++) {
        int rate = 1 << k;
        snprintf(options[k], sizeof options[k], "factor=%d", rate);
        row.options = options[k];
        row.run_s = row.run_min_s = 0.01 * rate;
        row.flops = 1e9 - 1e6 * rate; /* by operations the finest is cheapest */
        row.error = 0.3 / rate;
        row.run_q1_s = 0.95 * row.run_s;
        row.run_q3_s = 1.05 * row.run_s;
        assert_int_equal(results_folder_add(results, &row), STATUS_OK);
    }
    rows_beside(results, &row);
    results_folder_close(results);
}

/* What fails, is unsupported or images only a part never becomes a point; the tables say what was put in. */
static void test_tables_of_made_up_rows(void **state)
{
    (void)state;
    rows_make_up();
    assert_int_equal(sweep_tables(folder, NULL, 0, NULL), STATUS_OK);
    struct csv csv;
    assert_int_equal(csv_read(path_of("slopes.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_int_equal(csv.row_count, 3); /* all of it, and its finest half; two settings of rma_pca */
    int slope = row_find(&csv, (const char *const[]){"setting", "part"}, (const char *const[]){"factor", "finest"});
    assert_close(cell(&csv, slope, "slope"), -1, 1e-8);
    assert_close(cell(&csv, slope, "residual_log10"), 0, 1e-8);
    assert_close(cell(&csv, slope, "points"), 4, 0);
    csv_free(&csv);
    assert_int_equal(csv_read(path_of("fronts.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_int_equal(csv.row_count, 7 + 1 + 1);
    const int tie =
        row_find(&csv, (const char *const[]){"cost", "algorithm"}, (const char *const[]){"run_s", "rma_pca"});
    assert_string_equal(csv_cell(&csv, tie, csv_column(&csv, "options")), "blocks=2");
    assert_close(cell(&csv, tie, "tie"), 1, 0);
    assert_close(cell(&csv, 0, "tie"), 0, 0);
    csv_free(&csv);
    assert_int_equal(csv_read(path_of("cheapest.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    const char *const names[2] = {"cost", "error_below"};
    int tenth = row_find(&csv, names, (const char *const[]){"run_s", "1e-1"});
    assert_close(cell(&csv, tenth, "error"), 0.075, 1e-9);
    assert_close(cell(&csv, tenth, "speed_up"), 200, 1e-6);
    assert_string_equal(csv_cell(&csv, tenth, csv_column(&csv, "ties")), "rma_pca:blocks=2");
    int family = row_find(&csv, (const char *const[]){"family", "error_below"}, (const char *const[]){"rma", "1e-1"});
    assert_close(cell(&csv, family, "run_s"), 0.042, 1e-9);
    assert_string_equal(csv_cell(&csv, family, csv_column(&csv, "ties")), "");
    assert_int_equal(row_find(&csv, (const char *const[]){"family", "error_below"}, (const char *const[]){"wk", "1e0"}),
                     -1);
    tenth = row_find(&csv, names, (const char *const[]){"flops", "1e-1"});
    assert_close(cell(&csv, tenth, "run_s"), 0.64, 1e-9);
    assert_int_equal(row_find(&csv, names, (const char *const[]){"run_s", "1e-3"}), -1);
    csv_free(&csv);
}

/* --- The command ---------------------------------------------------------------------------------------------- */

/* BP22's array, shortened, over a strip of speckle. */
static const char small_scene[] =
    "description = \"speckle for the test of sweep\";\n"
    "sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\n"
    "pulse = { kind = \"flat\"; };\n"
    "array = { tx_length = 0.08; rx_length = 0.04; receivers = 20; first_offset = 0.04; pitch = 0.04; };\n"
    "track = { speed = 2.5; pri = 0.16; pings = 12; x_first = -2.4; };\n"
    "record = { first_sample = 1920; samples = 256; };\n"
    "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.443; };\n"
    "targets = { fields = ( { x = [-0.5, 0.5]; r = [49.0, 53.0]; count = 150; seed = 1; } ); };\n"
    "image = { x = { first = -0.3; step = 0.02; count = 31; };\n"
    "          r = { first = 50.012; step = 0.025; count = 81; }; };\n";

static void sweep_small(void)
{
    char output[400];
    const char *const names[] = {path_of("small.cfg")};
    static const char *const texts[] = {"bp_linear:precision=float", "bp_zeropad:precision=float",
                                        "rma_numeric:precision=float"};
    enum { SPECS = sizeof texts / sizeof *texts };
    struct spec specs[SPECS];
    snprintf(output, sizeof output, "%s", path_of("out"));
    for (int k = 0; k < SPECS; k++)
        assert_int_equal(spec_parse(texts[k], &specs[k]), STATUS_OK);
    struct task task = {.names = names, .name_count = 1, .output = output, .specs = specs, .spec_count = SPECS};
    assert_int_equal(command_sweep(&task), STATUS_OK);
    for (int k = 0; k < SPECS; k++)
        spec_free(&specs[k]);
}

static size_t files_count(const char *pattern)
{
    glob_t found;
    size_t count = glob(path_of(pattern), 0, NULL, &found) == 0 ? found.gl_pathc : 0;
    globfree(&found);
    return count;
}

/* The rows; the comment ahead of them holds the date of the last call. */
static char *rows_read(void)
{
    char *text = support_read("out/measurements.csv"), *rows = text ? strstr(text, "\nscene,") : NULL;
    assert_non_null(rows);
    memmove(text, rows, strlen(rows) + 1);
    return text;
}

/* Every setting but the reference and blocks that are asked for by number is predicted, hardly ever too low; the
   summary is of these rows. */
static void predictions_check(void)
{
    struct csv csv;
    double least = INFINITY, largest = 0;
    assert_int_equal(csv_read(path_of("out/predicted.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_int_equal(csv.row_count, 7 + 7);
    for (int row = 0; row < csv.row_count; row++) {
        const double ratio = cell(&csv, row, "ratio");
        assert_close(ratio, cell(&csv, row, "predicted") / cell(&csv, row, "error_gain"), 1e-6 * ratio);
        assert_true(ratio > 0.95 && ratio < 20);
        least = fmin(least, ratio);
        largest = fmax(largest, ratio);
    }
    csv_free(&csv);
    assert_int_equal(csv_read(path_of("out/predictions.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_int_equal(csv.row_count, 3);
    assert_string_equal(csv_cell(&csv, 0, 0), "all");
    assert_close(cell(&csv, 0, "images"), 14, 0);
    assert_close(cell(&csv, 0, "least"), least, 1e-6);
    assert_close(cell(&csv, 0, "largest"), largest, 1e-6);
    assert_true(cell(&csv, 0, "median") >= least && cell(&csv, 0, "median") <= largest);
    csv_free(&csv);
    assert_int_equal(files_count("out/predicted.png"), 1);
}

static void test_speckle_sweep_is_resumed_and_shows_the_laws(void **state)
{
    (void)state;
    FILE *file = fopen(path_of("small.cfg"), "w");
    assert_true(file && fputs(small_scene, file) >= 0 && fclose(file) == 0);
    sweep_small();
    char *first = rows_read();
    static const char *const plots[] = {"error_time", "upsampling"};
    for (size_t k = 0; k < sizeof plots / sizeof *plots; k++) {
        char pattern[64];
        snprintf(pattern, sizeof pattern, "out/*small*-%s.[ps][nv]g", plots[k]);
        assert_int_equal(files_count(pattern), 2); /* PNG and SVG */
    }

    /* Done: nothing is measured again. */
    sweep_small();
    char *second = rows_read();
    assert_true(strcmp(first, second) == 0);
    free(second);

    /* Cut in the last row but one: what was whole stays as it was, to the byte, the rest is measured anew. */
    size_t length = strlen(first), kept;
    for (kept = length - 2; first[kept] != '\n'; kept--)
        ;
    for (kept--; first[kept] != '\n'; kept--)
        ;
    struct stat info;
    assert_int_equal(stat(path_of("out/measurements.csv"), &info), 0);
    assert_int_equal(truncate(path_of("out/measurements.csv"), info.st_size - (off_t)(length - kept) + 30), 0);
    sweep_small();
    second = rows_read();
    assert_true(strncmp(first, second, kept) == 0);
    struct results results;
    assert_int_equal(results_read(path_of("out/measurements.csv"), &results), STATUS_OK);
    assert_int_equal(results.csv.row_count, 1 + 7 + 7 + 6);
    results_free(&results);

    /* Zero padding is of first order in 1/K; linear upsampling stops at a floor that beta = 4 nearly reaches, and
       that the loss over the band foretells. */
    struct csv csv;
    assert_int_equal(csv_read(path_of("out/slopes.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    const char *const columns[2] = {"algorithm", "part"};
    int order = row_find(&csv, columns, (const char *const[]){"bp_zeropad", "finest"});
    int floor = row_find(&csv, columns, (const char *const[]){"bp_linear", "floor"});
    assert_close(cell(&csv, order, "slope"), -1, 0.15);
    assert_true(cell(&csv, order, "residual_log10") < 0.05);
    assert_true(fabs(cell(&csv, floor, "slope")) < 0.05);
    assert_true(cell(&csv, floor, "first") >= 2 && cell(&csv, floor, "first") <= 8);
    double floor_error = cell(&csv, floor, "error_last");
    csv_free(&csv);
    assert_int_equal(csv_read(path_of("out/rules.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_close(cell(&csv, 0, "bp22_eq20_rate"), 3.125, 1e-6);
    assert_close(cell(&csv, 0, "zp15_rate"), 10, 1e-6);
    assert_close(floor_error, cell(&csv, 0, "linear_floor"), 0.03);
    csv_free(&csv);
    predictions_check();
    free(first);
    free(second);
}

/* Errors leave no folder behind. */
static void test_bad_scene_makes_nothing(void **state)
{
    (void)state;
    char output[400];
    snprintf(output, sizeof output, "%s", path_of("none"));
    struct task task = {.names = (const char *const[]){"no/such/scene"}, .name_count = 1, .output = output};
    assert_int_equal(command_sweep(&task), STATUS_INVALID);
    assert_false(support_exists("none"));
    assert_int_equal(sweep_tables(folder, NULL, 0, NULL), STATUS_INVALID);
    assert_false(support_exists("fronts.csv") || support_exists("fronts.csv.part"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_front),
        cmocka_unit_test(test_line),
        cmocka_unit_test(test_floor),
        cmocka_unit_test(test_settings),
        cmocka_unit_test_setup_teardown(test_tables_of_made_up_rows, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_speckle_sweep_is_resumed_and_shows_the_laws, folder_make, folder_remove),
        cmocka_unit_test_setup_teardown(test_bad_scene_makes_nothing, folder_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
