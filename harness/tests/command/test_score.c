/* Images that another program formed: `score`, and `compare` of two image files. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/matfile.h"
#include "files/csv.h"
#include "tests/command/program.h"

static void image_make(const char *spec, const char *output)
{
    program_good((const char *const[ARGUMENTS_MAX]){"image", "--scene", "study/quick", "-a", spec, "-o", output});
}

/* A file's first cell of a column. */
static double cell(const char *file, const char *column)
{
    struct csv csv;
    assert_int_equal(csv_read(path_in(file), CSV_TAIL_KEEP, &csv), STATUS_OK);
    const char *text = csv_cell(&csv, 0, csv_column(&csv, column));
    const double value = *text ? strtod(text, NULL) : NAN;
    csv_free(&csv);
    return value;
}

enum layout { ROWS, ONE_ROW, COLUMNS };

/* The pixels as NumPy writes them, by rows in float, also as one row, or by columns in double. */
static void npy_write(const char *name, const struct image *image, enum layout layout)
{
    const bool columns = layout == COLUMNS;
    const struct grid *grid = &image->patches[0];
    const size_t size = columns ? sizeof(double complex) : sizeof(float complex);
    unsigned char *bytes = calloc(128 + grid_pixels(grid), size);
    assert_non_null(bytes);
    memcpy(bytes, "\x93NUMPY\1\0\x76\0", 10);
    memset(bytes + 10, ' ', 118);
    char shape[40], text[100];
    if (layout == ONE_ROW)
        snprintf(shape, sizeof shape, "%d,", grid->r_count * grid->x_count);
    else
        snprintf(shape, sizeof shape, "%d, %d", grid->r_count, grid->x_count);
    const int length = snprintf(text, sizeof text, "{'descr': '<c%zu', 'fortran_order': %s, 'shape': (%s), }", size,
                                columns ? "True" : "False", shape);
    memcpy(bytes + 10, text, (size_t)length);
    unsigned char *to = bytes + 128;
    for (int k = 0; k < grid->r_count * grid->x_count; k++, to += size) {
        const int row = columns ? k % grid->r_count : k / grid->x_count;
        const int column = columns ? k / grid->r_count : k % grid->x_count;
        const double complex value = image_pixel(image, 0, row, column);
        const float complex single = (float complex)value;
        memcpy(to, columns ? (const void *)&value : (const void *)&single, size);
    }
    bytes_write(name, bytes, (size_t)(to - bytes));
    free(bytes);
}

/* A foreign image has the metrics that `run` measures of the same pixels; its row says which time is only stated. */
static void scores_are_those_of_run(void **state)
{
    (void)state;
    static const char *const numbers[] = {"error",   "error_gain", "phase_rms_rad", "width_m",
                                          "pslr_db", "islr_db",    "entropy",       "contrast"};
    struct image_file file;
    size_t size;
    image_make("bp_linear", "own.mat");
    assert_int_equal(image_file_open(path_in("own.mat"), &file), STATUS_OK);
    npy_write("rows.npy", &file.image, ROWS);
    npy_write("row.npy", &file.image, ONE_ROW);
    npy_write("columns.npy", &file.image, COLUMNS);
    image_file_close(&file);
    program_good((const char *const[ARGUMENTS_MAX]){"run", "study/quick", "-a", "bp_linear", "-o", "ran"});
    program_good((const char *const[ARGUMENTS_MAX]){"image", "--scene", "study/quick", "-a", "bp_linear", "-o",
                                                    "73.mat", "--tile", "17x5"});
    static const char *const files[] = {"own.mat", "rows.npy", "row.npy", "columns.npy", "73.mat"};
    for (size_t k = 0; k < COUNT_OF(files); k++) {
        char results[40], table[80];
        snprintf(results, sizeof results, "scored_%zu", k);
        program_good((const char *const[ARGUMENTS_MAX]){"score", files[k], "study/quick", "--name", "mine", "-o",
                                                        results, "--seconds", "0.25"});
        snprintf(table, sizeof table, "%s/measurements.csv", results);
        for (size_t n = 0; n < COUNT_OF(numbers); n++)
            assert_true(fabs(cell(table, numbers[n]) / cell("ran/measurements.csv", numbers[n]) - 1) < 1e-6);
        assert_true(cell(table, "run_s") == 0.25);
        assert_true(!(cell(table, "runs") > 0));
    }
    char *text = bytes_read("scored_0/measurements.csv", &size);
    assert_non_null(strstr(text, "study/quick,mine,,double,"));
    assert_non_null(strstr(text, ",image,ok,\"warning: the run time is stated, not measured"));
    free(text);
}

/* Echoes that `simulate` wrote have their scene's image and targets, also of several patches, filtered ones too. */
static void echo_files_know_their_scene(void **state)
{
    (void)state;
    static const char *const same[] = {"error", "pslr_db", "islr_db", "width_m"};
    static const char *const scenes[] = {"study/quick", "pf05/nine"};
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        program_good((const char *const[ARGUMENTS_MAX]){"simulate", scenes[k], "-o", "known.mat"});
        program_good((const char *const[ARGUMENTS_MAX]){"run", "--echoes", "known.mat", "-a", "bp_linear", "-o",
                                                        k ? "known_1" : "known_0"});
        program_good(
            (const char *const[ARGUMENTS_MAX]){"run", scenes[k], "-a", "bp_linear", "-o", k ? "scene_1" : "scene_0"});
        for (size_t n = 0; n < COUNT_OF(same); n++)
            assert_true(fabs(cell(k ? "known_1/measurements.csv" : "known_0/measurements.csv", same[n])
                                 / cell(k ? "scene_1/measurements.csv" : "scene_0/measurements.csv", same[n])
                             - 1)
                        < 1e-6);
    }
    program_good((const char *const[ARGUMENTS_MAX]){"simulate", "study/quick", "-o", "known.mat"});
    program_good((const char *const[ARGUMENTS_MAX]){"score", "own.mat", "--echoes", "known.mat", "-o", "by_echoes"});
    program_good((const char *const[ARGUMENTS_MAX]){"score", "own.mat", "study/quick", "-o", "by_scene"});
    for (size_t n = 0; n < COUNT_OF(same); n++)
        assert_true(cell("by_echoes/measurements.csv", same[n]) == cell("by_scene/measurements.csv", same[n]));
}

/* With motion unknown to the imager, the image by the true track is far from the one by the stated track. */
static void true_tracks_are_the_second_reference(void **state)
{
    (void)state;
    text_write("known.cfg",
               "base = {\n@include \"study/quick.cfg\"\n};\ntrack = { speed = 2.5; pri = 0.064; pings = 18; "
               "x_first = -1.52; errors_known = true; errors = ( { axis = \"sway\"; amplitude = 0.002; "
               "period = 0.8; phase = 30.0; } ); };\n");
    program_good(
        (const char *const[ARGUMENTS_MAX]){"image", "--scene", "known.cfg", "-a", "bp_sinc", "-o", "sharp.mat"});
    struct outcome blur = program_run(
        (const char *const[ARGUMENTS_MAX]){"image", "--scene", "study/sway", "-a", "bp_sinc", "-o", "blur.mat"});
    assert_int_equal(blur.status, 0); /* the condition `motion` warns */
    outcome_free(&blur);
    program_good((const char *const[ARGUMENTS_MAX]){"score", "sharp.mat", "study/sway", "-o", "sharp"});
    program_good((const char *const[ARGUMENTS_MAX]){"score", "blur.mat", "study/sway", "-o", "blur"});
    assert_true(cell("sharp/measurements.csv", "error_flown") < 0.05);
    assert_true(cell("sharp/measurements.csv", "error") > 0.5);
    assert_true(cell("blur/measurements.csv", "error_flown") > 0.5);
    assert_true(cell("blur/measurements.csv", "error") < 0.05);
    assert_true(isnan(cell("by_scene/measurements.csv", "error_flown")));
}

static void unfit_images_are_refused(void **state)
{
    (void)state;
    image_make("bp_nearest", "other.mat");
    program_good((const char *const[ARGUMENTS_MAX]){"image", "-s", "study/quick", "-g", "-0.6:0.02:40,19.85:0.025:13",
                                                    "-a", "bp_nearest", "-o", "part.mat"});
    static const struct refusal refusals[] = {
        {{"score", "part.mat", "study/quick"}, {"-0.6:0.02:40,19.85:0.025:13,0", "needed is -0.6:0.02:61", "cure: "}},
        {{"score", "other.mat", "study/swath"}, {"-0.6:0.02:61,19.85:0.025:13,0", "needed is -3.6:0.02:101"}},
        {{"score", "other.mat", "study/quick", "--name", "bp_sinc"}, {"--name is 'bp_sinc'"}},
        {{"score", "other.mat", "study/quick", "--name", "a,b"}, {"--name is 'a,b'", "letters"}},
        {{"score", "other.mat", "study/quick", "--seconds", "0"}, {"--seconds is '0'", "above 0"}},
        {{"score", "other.mat", "study/quick", "--grid", "0:1:2,3:4:5"}, {"--grid 0:1:2,3:4:5", ".npy"}},
        {{"score", "other.mat"}, {"exactly one of SCENE and --echoes"}},
        {{"score", "rows.npy", "study/quick", "--grid", "0:1:2,3:4:5"}, {"[13, 61]", "5 ranges and 2 places"}},
        {{"score", "scene.cfg", "study/quick"}, {"scene.cfg"}},
        {{"score", "short.npy", "study/quick"}, {"ends after 1 of 793 numbers"}},
        {{"score", "nan.npy", "study/quick"}, {"nan.npy has pixels that are not finite"}},
        {{"score", "three.npy", "study/quick"}, {"(13, 61,7)}; an array of", "two dimensions"}},
        {{"score", "/dev/zero.npy", "study/quick"}, {"/dev/zero.npy"}},
        {{"compare", "other.mat", "scene.mat"}, {"scene.mat"}},
        {{"compare", "ran", "ran", "-o", "x.png"}, {"two image files"}},
        {{"compare", "rows.npy", "other.mat"}, {"rows.npy", "NumPy array", "savemat"}},
        {{"compare", "nan.mat", "other.mat"}, {"compare: nan.mat has pixels that are not finite"}},
    };
    struct image_file file;
    assert_int_equal(image_file_open(path_in("other.mat"), &file), STATUS_OK);
    *(double complex *)file.image.pixels[0] = NAN;
    assert_int_equal(image_file_write(path_in("nan.mat"), &file.image, &file.origin), STATUS_OK);
    image_file_close(&file);
    size_t size;
    char *bytes = bytes_read("rows.npy", &size);
    bytes_write("short.npy", bytes, 128 + 12);
    memset(bytes + 128 + 40, 0xff, 4);
    bytes_write("nan.npy", bytes, size);
    char *shape = strstr(bytes + 10, "(13, 61)");
    assert_non_null(shape);
    memcpy(shape, "(13, 61,7)}", 11);
    bytes_write("three.npy", bytes, size);
    free(bytes);
    assert_all_refused(refusals, COUNT_OF(refusals));
    struct outcome twice = program_run(
        (const char *const[ARGUMENTS_MAX]){"score", "own.mat", "study/quick", "--name", "mine", "-o", "scored_0"});
    assert_int_equal(twice.status, 2);
    assert_non_null(strstr(twice.err, "scored_0 has a row of 'mine' on study/quick; another --name is needed"));
    outcome_free(&twice);
}

/* One of two images is the other, moved by whole pixels and multiplied. */
static void differences_are_measured(void **state)
{
    (void)state;
    struct image_file file;
    assert_int_equal(image_file_open(path_in("own.mat"), &file), STATUS_OK);
    struct image *image = &file.image;
    double complex *pixels = image->pixels[0];
    const int rows = file.patches[0].r_count, columns = file.patches[0].x_count;
    for (int i = rows - 1; i >= 0; i--)
        for (int j = columns - 1; j >= 0; j--)
            pixels[i * columns + j] = i >= 1 && j >= 2 ? 2 * I * pixels[(i - 1) * columns + j - 2] : 0;
    assert_int_equal(image_file_write(path_in("moved.mat"), image, &file.origin), STATUS_OK);
    for (int n = 0; n < rows * columns; n++)
        pixels[n] *= -2 * I;
    assert_int_equal(image_file_write(path_in("turned.mat"), image, &file.origin), STATUS_OK);
    memset(pixels, 0, (size_t)rows * (size_t)columns * sizeof *pixels);
    assert_int_equal(image_file_write(path_in("zero.mat"), image, &file.origin), STATUS_OK);
    image_file_close(&file);
    char *told = program_output((const char *const[ARGUMENTS_MAX]){"compare", "moved.mat", "own.mat"});
    const char *shift = strstr(told, "shift ");
    assert_non_null(shift);
    assert_true(fabs(strtod(shift + 6, NULL) - 2 * 0.02) < 1e-3);
    assert_true(fabs(strtod(strstr(shift, "along x, ") + 9, NULL) - 0.025) < 1e-3);
    free(told);
    told = program_output((const char *const[ARGUMENTS_MAX]){"compare", "moved.mat", "turned.mat", "-o", "moved.png"});
    assert_non_null(strstr(told, "Gain 2 at -1.571 rad"));
    assert_non_null(strstr(told, "after one complex gain 0;"));
    free(told);
    told = program_output((const char *const[ARGUMENTS_MAX]){"compare", "own.mat", "zero.mat"});
    assert_non_null(strstr(told, "the exact image is zero\nRelative error undefined, "));
    assert_null(strstr(told, "nan"));
    free(told);
}

/* An image of the other sign of phase, and one of magnitudes: the row is kept, and what it lacks is said. */
static void missing_phase_is_said(void **state)
{
    (void)state;
    static const struct {
        const char *name, *said;
    } cases[] = {{"good.npy", NULL},
                 {"conjugate.npy", "complex conjugate has an error"},
                 {"magnitude.npy", "no pixel has an imaginary part"}};
    struct image_file file;
    image_make("bp_linear", "own.mat");
    assert_int_equal(image_file_open(path_in("own.mat"), &file), STATUS_OK);
    const struct grid *grid = &file.image.patches[0];
    for (size_t k = 0; k < COUNT_OF(cases); k++) {
        for (int i = 0; k > 0 && i < grid->r_count; i++)
            for (int j = 0; j < grid->x_count; j++) {
                const double complex value = image_pixel(&file.image, 0, i, j);
                support_pixel_set(&file.image, 0, i, j, k == 1 ? conj(value) : cabs(value));
            }
        npy_write(cases[k].name, &file.image, COLUMNS);
        struct outcome outcome = program_run((const char *const[ARGUMENTS_MAX]){"score", cases[k].name, "study/quick"});
        assert_int_equal(outcome.status, 0);
        assert_true(!strstr(outcome.out, "warning: ") == !cases[k].said);
        assert_true(!cases[k].said || strstr(outcome.out, cases[k].said));
        outcome_free(&outcome);
    }
    image_file_close(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(missing_phase_is_said),       cmocka_unit_test(scores_are_those_of_run),
        cmocka_unit_test(echo_files_know_their_scene), cmocka_unit_test(true_tracks_are_the_second_reference),
        cmocka_unit_test(unfit_images_are_refused),    cmocka_unit_test(differences_are_measured)};
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
