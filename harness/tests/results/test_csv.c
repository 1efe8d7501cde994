/* CSV files: what is read, refused, and dropped after a cut. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "files/csv.h"
#include "tests/results/results_fixture.h"

static void test_csv_read(void **state)
{
    (void)state;
    struct csv csv;
    file_write(measurements_path, "w",
               "# key: first\r\n# other: x: y\na,\"b,c\",\r\n1,\"say \"\"hi\"\", there\",\n\n#between: rows\n"
               "\"# no comment\",,3\n,\"\",\"last\"");
    assert_int_equal(csv_read(measurements_path, CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_int_equal(csv.column_count, 3);
    assert_int_equal(csv_column(&csv, "b,c"), 1);
    assert_int_equal(csv_column(&csv, "none"), -1);
    assert_int_equal(csv.row_count, 3);
    assert_string_equal(csv_cell(&csv, 0, 1), "say \"hi\", there");
    assert_string_equal(csv_cell(&csv, 0, 2), "");
    assert_string_equal(csv_cell(&csv, 1, 0), "# no comment");
    assert_string_equal(csv_cell(&csv, 1, 2), "3");
    assert_string_equal(csv_cell(&csv, 2, 2), "last");
    assert_int_equal(csv.lines[0], 4);
    assert_int_equal(csv.lines[1], 7);
    assert_int_equal(csv.comment_count, 3);
    assert_string_equal(csv_comment(&csv, "key"), "first");
    assert_string_equal(csv_comment(&csv, "other"), "x: y");
    assert_string_equal(csv_comment(&csv, "between"), "rows");
    assert_null(csv_comment(&csv, "ke"));
    csv_free(&csv);
    assert_int_equal(csv_read(measurements_path, CSV_TAIL_DROP, &csv), STATUS_OK);
    assert_int_equal(csv.row_count, 2);
    csv_free(&csv);
    file_write(measurements_path, "w", "\xef\xbb\xbf# key: first\na\n1\n"); /* a byte order mark */
    assert_int_equal(csv_read(measurements_path, CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_string_equal(csv_comment(&csv, "key"), "first");
    assert_int_equal(csv_column(&csv, "a"), 0);
    csv_free(&csv);
    file_write(measurements_path, "w", "");
    assert_int_equal(csv_read(measurements_path, CSV_TAIL_KEEP, &csv), STATUS_OK);
    assert_int_equal(csv.column_count + csv.row_count, 0);
    csv_free(&csv);
}

static void test_csv_faults(void **state)
{
    (void)state;
    static const struct {
        const char *text, *place;
    } faults[] = {
        {"a,b\n1,2\n3\n", ":3: 1 fields"},
        {"# c\na;b\n1,5;2\n", ":2: ';' stands between"},
        {"a,b\n1,2,3\n", ":2: 3 fields"},
        {"a\n\"x\"z\n", ":2: stray"},
        {"a\n1\n\"x\n2\n", ":3: a quoted field never ends"},
        {"a\nx\"y\n", ":2: stray"},
        {"a\nx\ry\n", ":2:2: control character 0x0d"},
        {"a\nb\n\x1b[31mc\n", ":3:1: control character 0x1b"},
        {"a\n\"b\tc\"\n", ":2:3: control character 0x09"},
        {"# k: v\x07\na\n", ":1:7: control character 0x07"},
        {"a\nb\x7f\n", ":2:2: control character 0x7f"},
        {"a\nb\xc2\x9b\n", ":2:2: control character 0x9b"},
        {"a\nb\u202e\n", ":2:2: control character 0x202e"}, /* turns the line around */
        {"a\n\ufeff\n", ":2:1: control character 0xfeff"},
    };
    struct csv csv;
    for (size_t k = 0; k < sizeof faults / sizeof *faults; k++) {
        file_write(measurements_path, "w", faults[k].text);
        assert_int_equal(csv_read(measurements_path, CSV_TAIL_KEEP, &csv), STATUS_INVALID);
        assert_non_null(strstr(status_message(), measurements_path));
        assert_non_null(strstr(status_message(), faults[k].place));
        assert_null(csv.text);
    }
    FILE *file = fopen(measurements_path, "w");
    assert_non_null(file);
    fwrite("a\n1\0\n", 1, 5, file);
    fclose(file);
    assert_int_equal(csv_read(measurements_path, CSV_TAIL_KEEP, &csv), STATUS_INVALID);
    assert_int_equal(csv_read(results_directory, CSV_TAIL_KEEP, &csv), STATUS_INVALID);
    assert_int_equal(csv_read(targets_path, CSV_TAIL_KEEP, &csv), STATUS_INVALID);
    assert_int_equal(csv_read("/dev/zero", CSV_TAIL_KEEP, &csv), STATUS_INVALID);
    assert_int_equal(truncate(measurements_path, (off_t)3 << 30), 0);
    assert_int_equal(csv_read(measurements_path, CSV_TAIL_KEEP, &csv), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "has 3221225472 bytes, must have at most 268435456; a readable CSV file"));
    assert_int_equal(mkfifo(targets_path, 0600), 0);
    assert_int_equal(csv_read(targets_path, CSV_TAIL_KEEP, &csv), STATUS_INVALID); /* without a wait for a writer */
    remove(targets_path);
}

/* A text cut at every byte: what is left are its whole lines. */
static void test_csv_cut(void **state)
{
    (void)state;
    static const char head[] = "# c \" d\na,b\n", row_1[] = "1,\"x\"\"y,\"\n", comment[] = "#\"\n";
    static const char row_2[] = "\"\",2\n";
    char text[128];
    snprintf(text, sizeof text, "%s%s%s%s", head, row_1, comment, row_2);
    int whole = (int)strlen(text), first = (int)(strlen(head) + strlen(row_1));
    struct csv csv;
    for (int length = 0; length <= whole; length++) {
        char cut[sizeof text];
        snprintf(cut, sizeof cut, "%.*s", length, text);
        file_write(measurements_path, "w", cut);
        assert_int_equal(csv_read(measurements_path, CSV_TAIL_DROP, &csv), STATUS_OK);
        assert_int_equal(csv.row_count, (length >= first) + (length >= whole));
        csv_free(&csv);
    }
}

static void test_csv_numbers(void **state)
{
    (void)state;
    double value;
    assert_true(csv_number("", &value) && isnan(value));
    assert_true(csv_number("-1.5e-3", &value) && value == -1.5e-3);
    assert_true(csv_number("inf", &value) && isinf(value));
    assert_false(csv_number("1,5", &value));
    assert_false(csv_number(" 1", &value));
    assert_false(csv_number("1 ", &value));
    assert_false(csv_number("x", &value));
    char text[64] = "";
    FILE *file = fmemopen(text, sizeof text, "w");
    assert_non_null(file);
    csv_write_number(file, 0.1234567891234);
    csv_write_text(file, ",");
    csv_write_number(file, NAN);
    csv_write_text(file, NULL);
    fclose(file);
    assert_string_equal(text, "0.123456789\",\"");
    assert_true(csv_number("0.5", &value) && value == 0.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_csv_read, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_csv_faults, results_make, results_remove),
        cmocka_unit_test_setup_teardown(test_csv_cut, results_make, results_remove),
        cmocka_unit_test(test_csv_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
