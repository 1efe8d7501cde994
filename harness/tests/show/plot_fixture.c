/* Pictures in a temporary folder (plot_fixture.h). */
#include "tests/show/plot_fixture.h"

#include <stdio.h>
#include <stdlib.h>

#include "tests/assertions.h"

/* SASBENCH_ROOT, the repository, comes from the build. */
const char *const real_plots = SASBENCH_ROOT "/plots";

char folder[4000]; /* temporary: pictures, and our own scripts */

void path_in(char path[4096], const char *name)
{
    snprintf(path, 4096, "%s/%s", folder, name);
}

int plot_set_up(void **state)
{
    (void)state;
    const char *temporary = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/it's a sasbench-test-XXXXXX", temporary && *temporary ? temporary : "/tmp");
    return mkdtemp(folder) ? 0 : -1;
}

int plot_tear_down(void **state)
{
    (void)state;
    char command[4096];
    snprintf(command, sizeof command, "rm -r \"%.4000s\"", folder);
    return system(command);
}

void text_to_file(const char *name, const char *text)
{
    char path[4096];
    path_in(path, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

void file_to_text(const char *name, char *text, size_t size)
{
    char path[4096];
    path_in(path, name);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, size - 1, file)] = '\0';
    fclose(file);
}

void assert_png(const char *name)
{
    char start[10] = "";
    file_to_text(name, start, 9);
    assert_memory_equal(start, "\x89PNG\r\n\x1a\n", 8);
}

void assert_drawn(enum status status)
{
    if (status != STATUS_OK)
        fail_msg("%s", status_message());
}

/* Nothing temporary is left behind. */
void assert_nothing_left(void)
{
    char command[4096];
    snprintf(command, sizeof command, "ls -A \"%.4000s\" | grep -q '^[.]'", folder);
    assert_int_not_equal(system(command), 0);
}
