/* The command `filter`: its table, its settings, what it refuses, and echoes that any algorithm images as the table
   says. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "files/csv.h"
#include "echoes/echo_data.h"
#include "echoes/matfile.h"
#include "tests/algorithms/squint_numbers.h"
#include "tests/command/program.h"

enum { NINE = 9, INSIDE = 4, EDGE = 3 }; /* targets of pf05/nine: all, the first ones, the last of these */

/* A target inside the area and one outside it, of equal strength, which both beams see. */
#define SONAR                                                                                                          \
    "sonar = { fc = 30e3; bandwidth = 10e3; fs = 15e3; };\n"                                                           \
    "pulse = { kind = \"lfm\"; duration = 2e-3; };\n"                                                                  \
    "array = { tx_length = 0.1; rx_length = 0.1; receivers = 1; };\n"                                                  \
    "track = { speed = 0.0; pri = 0.1; spacing = 0.025; pings = 300; x_first = -3.75; };\n"                            \
    "record = { first_sample = 360; samples = 130; };\n"
#define BEAM    "beam = { kind = \"rect\"; truncation = \"tx\"; limit = 0.5; };\n"
#define AREA    "area = { x = -1.0; r = 20.0; half_x = 1.0; half_r = 1.5; };\n"
#define TARGETS "targets = { points = ( { x = -1.0; r = 20.0; }, { x = 1.4; r = 20.0; } ); };\n"
#define IMAGE   "image = { around_targets = { half_x = 0.3; half_r = 0.3; x_step = 0.025; r_step = 0.025; }; };\n"
#define CURVED  "wk_polar:subapertures=1,curvature=on,precision=double"

static const char small_scene[] = SONAR BEAM AREA TARGETS IMAGE;

/* The table of a call, which the caller frees. */
static void table_read(const char *const *arguments, struct csv *csv)
{
    char *text = program_output(arguments);
    text_write("table.csv", text);
    free(text);
    if (csv_read(path_in("table.csv"), CSV_TAIL_KEEP, csv) != STATUS_OK)
        fail_msg("%s", status_message());
}

static double number_of(const struct csv *csv, int row, const char *column)
{
    double value = NAN;
    assert_true(row < csv->row_count && csv_column(csv, column) >= 0);
    csv_number(csv_cell(csv, row, csv_column(csv, column)), &value);
    return value;
}

/* PF05's scene: each target's energy by each number of sub-apertures as an independent implementation has it. */
static void table_is_as_published(void **state)
{
    (void)state;
    double last_all = 0;
    for (size_t n = 0; n < COUNT_OF(pf05_filter); n++) {
        const struct filter_number *number = &pf05_filter[n];
        char spec[60];
        struct csv csv;
        snprintf(spec, sizeof spec, "wk_polar:subapertures=%d", number->subapertures);
        table_read((const char *const[ARGUMENTS_MAX]){"filter", "pf05/nine", "-a", spec, "-o", "nine.mat"}, &csv);
        assert_int_equal(csv.row_count, NINE + 1);
        for (int k = 0; k < NINE; k++) {
            assert_true(number_of(&csv, k, "target") == k + 1);
            assert_true(number_of(&csv, k, "inside") == (k < INSIDE));
            if (!(fabs(number_of(&csv, k, "kept_db") - number->energy_db[k]) <= 0.3))
                fail_msg("%s, target %d: %g dB, must be %g", spec, k + 1, number_of(&csv, k, "kept_db"),
                         number->energy_db[k]);
        }
        assert_true(fabs(number_of(&csv, EDGE, "changed_db") - number->change_db[EDGE]) <= 0.3);
        assert_true(number_of(&csv, 3, "x_m") == 4.6 && number_of(&csv, 3, "r_m") == 37);
        assert_string_equal(csv_cell(&csv, NINE, 0), "all");
        double all = number_of(&csv, NINE, "kept_db"); /* four and a bit of nine */
        assert_true(all < -2.5 && all > -5 && all != last_all);
        last_all = all;
        csv_free(&csv);
    }
}

static void echoes_read(const char *name, struct acquisition *acquisition, struct echoes *echoes)
{
    if (echo_file_read(path_in(name), acquisition, echoes) != STATUS_OK)
        fail_msg("%s", status_message());
}

/* A scene and the file of its echoes are filtered alike; the setting that is not named is wk_polar's own. */
static void scene_and_file_are_filtered_alike(void **state)
{
    (void)state;
    static const char *const calls[][ARGUMENTS_MAX] = {
        {"filter", "small.cfg", "-o", "from_scene.mat"},
        {"filter", "--echoes", "raw.mat", "-a", "wk_polar:subapertures=4,curvature=off", "-o", "from_file.mat"},
    };
    struct acquisition a[2], raw;
    struct echoes echoes[2], before;
    struct csv csv[2];
    program_good((const char *const[ARGUMENTS_MAX]){"simulate", "small.cfg", "-o", "raw.mat"});
    for (int k = 0; k < 2; k++)
        table_read(calls[k], &csv[k]);
    assert_int_equal(csv[0].row_count, 3);
    assert_int_equal(csv[1].row_count, 1); /* a file does not know its targets */
    assert_string_equal(csv_cell(&csv[0], 2, 4), csv_cell(&csv[1], 0, 4));
    echoes_read("from_scene.mat", &a[0], &echoes[0]);
    echoes_read("from_file.mat", &a[1], &echoes[1]);
    echoes_read("raw.mat", &raw, &before);
    assert_true(a[0].compressed && a[0].pulse_length == 0 && a[0].area.half_x == 0 && raw.area.half_x == 1);
    assert_memory_equal(echoes[0].samples, echoes[1].samples,
                        (size_t)raw.samples * (size_t)raw.pings * sizeof(double complex));
    for (int k = 0; k < 2; k++) {
        echoes_free(&echoes[k]);
        acquisition_free(&a[k]);
        csv_free(&csv[k]);
    }
    echoes_free(&before);
    acquisition_free(&raw);
}

/* About the targets; the largest magnitude of an image, and its distance from another's. */
static const char *const grids[] = {"-1.3:0.025:25,19.7:0.025:25", "1.1:0.025:25,19.7:0.025:25"};

static double complex *image_of(const char *file, const char *grid, const char *spec)
{
    struct grid read;
    double complex *pixels;
    struct outcome outcome = program_run(
        (const char *const[ARGUMENTS_MAX]){"image", "--echoes", file, "--grid", grid, "-a", spec, "-o", "image.mat"});
    const bool taken_off = strcmp(file, "kept.mat") == 0 && grid == grids[1]; /* beside the target that is kept */
    if (outcome.status != 0 || !taken_off != !strstr(outcome.err, "dark_image") || (!taken_off && *outcome.err))
        fail_msg("%s of %s exits with %d: %s", spec, file, outcome.status, outcome.err);
    outcome_free(&outcome);
    if (image_file_read(path_in("image.mat"), &read, &pixels) != STATUS_OK)
        fail_msg("%s", status_message());
    assert_int_equal(read.x_count * read.r_count, 25 * 25);
    return pixels;
}

static double peak_of(const double complex *pixels)
{
    double peak = 0;
    for (int k = 0; k < 25 * 25; k++)
        peak = fmax(peak, cabs(pixels[k]));
    return peak;
}

static double distance_of(const double complex *a, const double complex *b)
{
    double difference = 0, norm = 0;
    for (int k = 0; k < 25 * 25; k++) {
        difference += pow(cabs(a[k] - b[k]), 2);
        norm += pow(cabs(b[k]), 2);
    }
    return sqrt(difference / norm);
}

/* What the table says of energies is what images show, whoever forms them; and wk_polar is the filter ahead of
   omega-k. */
static void any_algorithm_images_what_is_kept(void **state)
{
    (void)state;
    static const char *const specs[] = {"reference", "bp_sinc:window=kaiser,taps=16", "rma_numeric", "wk_classic"};
    struct csv csv;
    program_good((const char *const[ARGUMENTS_MAX]){"simulate", "small.cfg", "-o", "raw.mat"});
    table_read((const char *const[ARGUMENTS_MAX]){"filter", "small.cfg", "-a", CURVED, "-o", "kept.mat"}, &csv);
    assert_true(number_of(&csv, 0, "kept_db") > -0.1 && number_of(&csv, 1, "kept_db") < -20);
    for (size_t k = 0; k < COUNT_OF(specs); k++) {
        double complex *raw[2], *kept[2];
        for (int t = 0; t < 2; t++) {
            raw[t] = image_of("raw.mat", grids[t], specs[k]);
            kept[t] = image_of("kept.mat", grids[t], specs[k]);
        }
        double inside = 20 * log10(peak_of(kept[0]) / peak_of(raw[0]));
        double outside = 20 * log10(peak_of(kept[1]) / peak_of(raw[1]));
        print_message("%s: %.2f dB inside, %.1f dB outside\n", specs[k], inside, outside);
        assert_true(fabs(inside) < 0.1 && outside < -20);
        for (int t = 0; t < 2; t++) {
            free(raw[t]);
            free(kept[t]);
        }
    }
    double complex *polar = image_of("raw.mat", grids[0], CURVED);
    double complex *classic = image_of("kept.mat", grids[0], "wk_classic:precision=double");
    double complex *again = image_of("kept.mat", grids[0], CURVED); /* the area has done its work */
    double complex *wanted = image_of("kept.mat", grids[0], "reference");
    assert_true(distance_of(polar, classic) <= 1e-12);
    assert_true(distance_of(again, classic) <= 1e-12);
    print_message("wk_classic from reference: %.1e\n", distance_of(classic, wanted));
    assert_true(distance_of(classic, wanted) <= 0.03);
    free(polar);
    free(classic);
    free(again);
    free(wanted);
    csv_free(&csv);
}

/* A squinted beam's file is imaged as its scene is, also in turned axes. */
static void squinted_files_are_imaged_as_scenes(void **state)
{
    (void)state;
    static const char *const specs[] = {"wk_squint", "wk_classic", "wk_polar", "bp_linear"};
    program_good((const char *const[ARGUMENTS_MAX]){"simulate", "gate/squint", "-o", "squint.mat"});
    for (size_t k = 0; k < COUNT_OF(specs); k++) {
        const char *grid = "-0.24:0.02:25,20.7:0.025:25,20";
        struct grid read;
        double complex *pixels[2];
        pixels[0] = image_of("squint.mat", grid, specs[k]);
        program_good((const char *const[ARGUMENTS_MAX]){"image", "--scene", "gate/squint", "--grid", grid, "-a",
                                                        specs[k], "-o", "image.mat"});
        assert_int_equal(image_file_read(path_in("image.mat"), &read, &pixels[1]), STATUS_OK);
        assert_true(read.angle_rad == 20 * M_PI / 180);
        assert_true(peak_of(pixels[0]) > 1);
        assert_memory_equal(pixels[0], pixels[1], 25 * 25 * sizeof **pixels);
        free(pixels[0]);
        free(pixels[1]);
    }
}

static void bad_calls_are_refused(void **state)
{
    (void)state;
    static const struct refusal refusals[] = {
        {{"filter", "-o", "x.mat"}, {"filter: exactly one of SCENE and --echoes FILE.mat is needed"}},
        {{"filter", "small.cfg", "--echoes", "raw.mat", "-o", "x.mat"}, {"filter: exactly one of SCENE and --echoes"}},
        {{"filter", "small.cfg"}, {"filter: -o FILE.mat is missing"}},
        {{"filter", "small.cfg", "-o", "x.csv"}, {"filter: -o x.csv has another ending; accepted: FILE.mat"}},
        {{"filter", "small.cfg", "-o", "none/x.mat"}, {"none/x.mat: cannot be written"}},
        {{"filter", "small.cfg", "-o", "x.mat", "-a", "wk_classic"},
         {"the last is wk_classic", "accepted: one of wk_polar"}},
        {{"filter", "small.cfg", "-o", "x.mat", "-a", "wk_polar", "-a", "wk_polar"},
         {"filter: 2 --algorithm SPEC given"}},
        {{"filter", "small.cfg", "-o", "x.mat", "-a", "wk_polar:subapertures=-1"}, {"subapertures", "-1"}},
        {{"filter", "small.cfg", "-o", "x.mat", "-a", "wk_polar:subapertures=151"},
         {"151 sub-apertures of 300 pings", "at most 150"}},
        {{"filter", "no/scene", "-o", "x.mat"}, {"no/scene"}},
        {{"filter", "--echoes", "none.mat", "-o", "x.mat"}, {"none.mat"}},
        {{"filter", "--echoes", "empty.mat", "-o", "x.mat"}, {"empty.mat"}},
        {{"filter", "study/point", "-o", "x.mat"}, {"no target area is given"}},
        {{"filter", "--echoes", "good.mat", "-o", "x.mat"}, {"no target area is given"}},
        {{"filter", "outside.cfg", "-o", "x.mat"}, {"the target area lies", "outside the record's"}},
        {{"filter", "many.cfg", "-o", "x.mat"}, {"2 receivers", "needs one receiver at the transmitter"}},
    };
    program_good((const char *const[ARGUMENTS_MAX]){"simulate", "small.cfg", "-o", "raw.mat"});
    text_write("outside.cfg", SONAR BEAM "area = { x = -1.0; r = 60.0; half_x = 1.0; half_r = 1.5; };\n" TARGETS IMAGE);
    text_write("many.cfg", "base = { " SONAR BEAM AREA TARGETS IMAGE "};\n"
                           "array = { tx_length = 0.1; receivers = 2; first_offset = 0.05; pitch = 0.05; };\n");
    assert_all_refused(refusals, COUNT_OF(refusals));
}

static int small_make(void **state)
{
    if (inputs_make(state) != 0)
        return -1;
    text_write("small.cfg", small_scene);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_is_as_published),
        cmocka_unit_test(scene_and_file_are_filtered_alike),
        cmocka_unit_test(any_algorithm_images_what_is_kept),
        cmocka_unit_test(squinted_files_are_imaged_as_scenes),
        cmocka_unit_test(bad_calls_are_refused),
    };
    return cmocka_run_group_tests(tests, small_make, folder_remove);
}
