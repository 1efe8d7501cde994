/* Any bytes as results: read, compared, and resumed. The byte 0x1e, which no CSV file of ours may hold, separates
   measurements of two programs, or of one folder the measurements from the targets. */
#include <glob.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "gate/diff.h"
#include "results/results_folder.h"
#include "tests/fuzz/input.h"

static FILE *nowhere;

int LLVMFuzzerInitialize(int *count, char ***arguments)
{
    (void)count;
    (void)arguments;
    nowhere = fopen("/dev/null", "w");
    /* What is reported of older files would fill the terminal; libFuzzer keeps a copy of standard error for itself only
       when asked (-close_fd_mask=2). */
    return nowhere ? 0 : -1;
}

static void files_compare(const char *old, const char *new)
{
    struct diff diff;
    if (diff_results(old, new, &diff) == STATUS_OK) {
        diff_print(&diff, nowhere);
        diff_status(&diff);
        if (diff_markdown(&diff, "/dev/null") != STATUS_OK || diff_json(&diff, "/dev/null") != STATUS_OK)
            fuzz_fail("not written: %s", status_message());
    }
    diff_free(&diff);
}

/* A folder with an earlier run's files: all of them are dropped, kept beside, or gone on with. */
static void folder_resume(void)
{
    const struct provenance provenance = {.machine = "m",
                                          .isa = "v3",
                                          .compiler = "c",
                                          .flags = "f",
                                          .libraries = "l",
                                          .commit = "a",
                                          .program = "p",
                                          .date = "d",
                                          .threads = 2};
    struct results_folder *results;
    if (results_folder_open(fuzz_folder(), &provenance, &results) != STATUS_OK)
        return;
    if (results_folder_scene(results, "s", 1) == STATUS_OK)
        results_folder_find(results, "s", "bp_nearest", "", "float");
    results_folder_close(results);
}

static void folder_empty(void)
{
    char pattern[300];
    glob_t found;
    snprintf(pattern, sizeof pattern, "%s/*", fuzz_folder());
    if (glob(pattern, 0, NULL, &found) == 0) {
        for (size_t i = 0; i < found.gl_pathc; i++)
            unlink(found.gl_pathv[i]);
        globfree(&found);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint8_t *apart = size > 0 ? memchr(data, 0x1e, size) : NULL;
    size_t first = apart ? (size_t)(apart - data) : size;
    const uint8_t *second = apart ? apart + 1 : data;
    size_t rest = apart ? size - first - 1 : size;
    const char *old = fuzz_file(0, "measurements.csv", data, first), *new = fuzz_file(1, "targets.csv", second, rest);
    files_compare(old, new);
    folder_resume();
    folder_empty();
    return 0;
}
