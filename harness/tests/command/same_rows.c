/* Rows of two results folders (same_rows.h). */
#include "tests/command/same_rows.h"

#include <string.h>

#include "files/csv.h"
#include "tests/command/program.h"

/* Up to what a reason says of the times' spread, which stands at its end. */
static size_t length_without_noise(const char *text)
{
    const char *noise = strstr(text, "warning: times scatter"); /* outcome.h */
    size_t length = noise ? (size_t)(noise - text) : strlen(text);
    return length >= 2 && noise && strncmp(noise - 2, "; ", 2) == 0 ? length - 2 : length;
}

static bool same_cell(const char *a, const char *b)
{
    size_t length = length_without_noise(a);
    return length == length_without_noise(b) && strncmp(a, b, length) == 0;
}

void assert_same_rows(const char *whole, const char *killed)
{
    static const char *const seconds[] = {"plan_s",   "run_s",    "run_min_s", "runs", "stages",
                                          "run_q1_s", "run_q3_s", "control_s", "load"};
    struct csv a, b;
    assert_int_equal(csv_read(path_of(whole), CSV_TAIL_KEEP, &a), STATUS_OK);
    assert_int_equal(csv_read(path_of(killed), CSV_TAIL_KEEP, &b), STATUS_OK);
    if (a.row_count != b.row_count || a.column_count != b.column_count)
        fail_msg("%s has %d rows of %d columns, undisturbed %d of %d", killed, b.row_count, b.column_count, a.row_count,
                 a.column_count);
    bool timed[64] = {false};
    for (size_t k = 0; k < COUNT_OF(seconds); k++)
        if (csv_column(&a, seconds[k]) >= 0)
            timed[csv_column(&a, seconds[k])] = true;
    for (int row = 0; row < a.row_count; row++) {
        bool found = false;
        for (int other = 0; other < b.row_count && !found; other++) {
            found = true;
            for (int k = 0; k < a.column_count && found; k++)
                found = timed[k] || same_cell(csv_cell(&a, row, k), csv_cell(&b, other, k));
        }
        if (!found)
            fail_msg("%s: row %d of the undisturbed file is not there: %s %s %s", killed, row + 1, csv_cell(&a, row, 0),
                     csv_cell(&a, row, 1), csv_cell(&a, row, 2));
    }
    csv_free(&a);
    csv_free(&b);
}

void assert_same_results(const char *whole, const char *other)
{
    static const char *const files[] = {"measurements.csv", "targets.csv"};
    char paths[2][100];
    for (size_t k = 0; k < COUNT_OF(files); k++) {
        snprintf(paths[0], sizeof paths[0], "%.60s/%s", whole, files[k]);
        snprintf(paths[1], sizeof paths[1], "%.60s/%s", other, files[k]);
        assert_same_rows(paths[0], paths[1]);
    }
}
