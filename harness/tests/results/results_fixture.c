/* What the tests of results share (results_fixture.h). */
#include "tests/results/results_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "files/csv.h"

char results_directory[256], measurements_path[300], targets_path[300];

int results_make(void **state)
{
    (void)state;
    const char *base = getenv("TMPDIR");
    snprintf(results_directory, sizeof results_directory, "%s/sasbench-XXXXXX", base ? base : "/tmp");
    if (!mkdtemp(results_directory))
        return -1;
    snprintf(measurements_path, sizeof measurements_path, "%s/measurements.csv", results_directory);
    snprintf(targets_path, sizeof targets_path, "%s/targets.csv", results_directory);
    return 0;
}

int results_remove(void **state)
{
    (void)state;
    static const char *const kept[] = {"measurements.1.csv", "measurements.2.csv", "targets.1.csv", "targets.2.csv"};
    remove(measurements_path);
    remove(targets_path);
    for (size_t k = 0; k < sizeof kept / sizeof *kept; k++) {
        char path[300];
        snprintf(path, sizeof path, "%s/%s", results_directory, kept[k]);
        remove(path);
    }
    return rmdir(results_directory); /* fails when a temporary file was left behind */
}

void file_write(const char *path, const char *mode, const char *text)
{
    FILE *file = fopen(path, mode);
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

char *file_text(const char *path)
{
    static char text[1 << 16];
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    size_t size = fread(text, 1, sizeof text - 1, file);
    text[size] = '\0';
    fclose(file);
    return text;
}

struct provenance provenance_of(const char *commit, int threads)
{
    struct provenance provenance = {.machine = "a machine",
                                    .isa = "v3",
                                    .libraries = "some",
                                    .compiler = "gcc\n12",
                                    .program = "0123",
                                    .date = "today",
                                    .threads = threads};
    snprintf(provenance.commit, sizeof provenance.commit, "%s", commit);
    return provenance;
}

struct measurement measurement_of(const char *scene, const char *algorithm)
{
    return (struct measurement){.scene = scene,
                                .algorithm = algorithm,
                                .options = "taps=8,window=none",
                                .precision = "float",
                                .threads = 2,
                                .engine = "general",
                                .status = "ok",
                                .reason = "",
                                .skipped = "half \"of\" it,\nand more",
                                .plan_s = 0.25,
                                .run_s = 1.0 / 3,
                                .run_min_s = 0.3,
                                .runs = 5,
                                .control_s = 2,
                                .stages = "compress=0.1;focus=0.9",
                                .flops_published = NAN,
                                .flops = 1e12,
                                .pairs = 12345678901.0,
                                .bytes = 4096,
                                .error = 1e-7,
                                .error_gain = NAN,
                                .phase_rms_rad = 0.001,
                                .width_m = 0.0384,
                                .pslr_db = -13.3,
                                .islr_db = -10.4,
                                .run_q1_s = 0.32,
                                .run_q3_s = 0.34,
                                .entropy = 4.5,
                                .contrast = 2,
                                .peak_over_median = NAN};
}

struct target_row target_of(const char *scene, const char *algorithm)
{
    return (struct target_row){
        scene, algorithm, "taps=8,window=none", "float", 3, "azimuth", "null", 3, 1e-5, NAN, 0.0384, -13.3, -10.4};
}

struct results_folder *open_ok(const char *commit, int threads)
{
    struct provenance provenance = provenance_of(commit, threads);
    struct results_folder *results = NULL;
    assert_int_equal(results_folder_open(results_directory, &provenance, &results), STATUS_OK);
    assert_non_null(results);
    return results;
}

void add_ok(struct results_folder *results, const char *scene, const char *algorithm)
{
    struct target_row target = target_of(scene, algorithm);
    struct measurement row = measurement_of(scene, algorithm);
    assert_int_equal(results_folder_targets(results, &target, 1), STATUS_OK);
    assert_int_equal(results_folder_add(results, &row), STATUS_OK);
}

const struct measurement *find(const struct results_folder *results, const char *scene, const char *algorithm)
{
    return results_folder_find(results, scene, algorithm, "taps=8,window=none", "float");
}

int rows_of(const char *path)
{
    struct csv csv;
    assert_int_equal(csv_read(path, CSV_TAIL_KEEP, &csv), STATUS_OK);
    int rows = csv.row_count;
    csv_free(&csv);
    return rows;
}
