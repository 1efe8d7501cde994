/* What `run` keeps of the plans of `auto`: the chosen setting and the best of every other algorithm, for each image
   that was measured by this program. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command/task.h"
#include "files/csv.h"
#include "results/results.h"
#include "tests/support.h"

static void run_auto(const char *text)
{
    const char *const names[] = {"study/quick"};
    char output[400];
    struct spec spec;
    snprintf(output, sizeof output, "%s", path_of("out"));
    setenv("XDG_CACHE_HOME", path_of("cache"), 1);
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    struct task task = {.names = names, .name_count = 1, .output = output, .specs = &spec, .spec_count = 1};
    if (command_run(&task) != STATUS_OK)
        fail_msg("%s", status_message());
    spec_free(&spec);
}

static const char *cell(const struct csv *csv, int row, const char *column)
{
    return csv_cell(csv, row, csv_column(csv, column));
}

/* How many rows a budget has, one for each algorithm; *chosen is the row of the chosen one. */
static int rows_of(const struct csv *csv, const char *options, int *chosen)
{
    int count = 0, found = 0;
    for (int row = 0; row < csv->row_count; row++) {
        if (strcmp(cell(csv, row, "options"), options) != 0)
            continue;
        count++;
        assert_string_equal(cell(csv, row, "scene"), "study/quick");
        assert_true(*cell(csv, row, "text") != '\0');
        if (strcmp(cell(csv, row, "verdict"), "chosen") == 0) {
            *chosen = row;
            found++;
        }
        for (int other = 0; other < row; other++)
            if (strcmp(cell(csv, other, "options"), options) == 0)
                assert_string_not_equal(cell(csv, other, "algorithm"), cell(csv, row, "algorithm"));
    }
    assert_int_equal(found, count > 0);
    return count;
}

static void plans_are_kept(void **state)
{
    (void)state;
    struct csv csv;
    struct results results;
    int chosen = 0;
    run_auto("auto:error=1e-2");
    assert_int_equal(csv_read(path_of("out/plans.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_true(rows_of(&csv, "error=0.01", &chosen) >= 6);
    assert_true(strncmp(cell(&csv, chosen, "text"), "left out: ", 10) == 0);
    assert_true(atof(cell(&csv, chosen, "error")) <= 0.01);
    assert_int_equal(results_read(path_of("out/measurements.csv"), &results), STATUS_OK);
    char name[100];
    snprintf(name, sizeof name, "%s:", cell(&csv, chosen, "algorithm")); /* what was imaged is what was planned */
    assert_int_equal(results.csv.row_count, 1);
    assert_true(strncmp(results.measurements[0].engine, name, strlen(name)) == 0);
    results_free(&results);
    csv_free(&csv);

    /* Another budget joins it; where nothing is measured, nothing is planned. */
    run_auto("auto:error=1e-4");
    run_auto("auto:error=1e-4");
    assert_int_equal(csv_read(path_of("out/plans.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    const int first = rows_of(&csv, "error=0.01", &chosen), second = rows_of(&csv, "error=0.0001", &chosen);
    assert_true(first >= 6 && second >= 6 && first + second == csv.row_count);
    csv_free(&csv);

    /* Another program's plans are not ours. */
    char *text = support_read("out/plans.csv"), *program = strstr(text, "# program: ");
    assert_non_null(program);
    memcpy(program + 11, "0000", 4);
    support_write("out/plans.csv", text);
    free(text);
    run_auto("auto:error=1e-3");
    assert_int_equal(csv_read(path_of("out/plans.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_int_equal(rows_of(&csv, "error=0.001", &chosen), csv.row_count);
    csv_free(&csv);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test_setup_teardown(plans_are_kept, folder_make, folder_remove)};
    return cmocka_run_group_tests_name("plans", tests, NULL, NULL);
}
