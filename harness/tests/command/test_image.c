/* The command `image`: the error that it measures of its own image. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "files/csv.h"
#include "tests/command/program.h"

/* `image --verify` measures what `run` does: of few pixels all, of recorded echoes as of a scene's. */
static void errors_are_verified(void **state)
{
    (void)state;
    static const char *const verified[ARGUMENTS_MAX] = {"image",     "--scene", "study/quick", "-a",
                                                        "bp_linear", "-o",      "v.mat",       "--verify"};
    static const char *const measured[ARGUMENTS_MAX] = {"run", "study/quick", "-a", "bp_linear", "-o", "verified"};
    struct csv csv;
    char *told = program_output(verified);
    const char *error = strstr(told, "Relative error ");
    assert_non_null(error);
    assert_non_null(strstr(told, ", of all 793 pixels.\n"));
    program_good(measured);
    assert_int_equal(csv_read(path_in("verified/measurements.csv"), CSV_TAIL_KEEP, &csv), STATUS_OK);
    const double gained = strtod(csv_cell(&csv, 0, csv_column(&csv, "error_gain")), NULL);
    assert_true(fabs(strtod(error + 15, NULL) / gained - 1) < 5e-3); /* three digits are printed */
    csv_free(&csv);
    free(told);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(errors_are_verified)};
    return cmocka_run_group_tests(tests, inputs_make, folder_remove);
}
