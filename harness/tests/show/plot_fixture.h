/* Tests of pictures: a temporary folder with pictures and scripts of the test's own. */
#ifndef SASBENCH_TESTS_SHOW_PLOT_FIXTURE_H
#define SASBENCH_TESTS_SHOW_PLOT_FIXTURE_H

#include <stddef.h>

#include "status.h"

extern const char *const real_plots; /* the project's scripts */
extern char folder[4000];            /* temporary: pictures, and the test's scripts */

/* Fixtures of a group: make and remove the folder. */
int plot_set_up(void **state);
int plot_tear_down(void **state);

void path_in(char path[4096], const char *name); /* of a file in the folder */
void text_to_file(const char *name, const char *text);
void file_to_text(const char *name, char *text, size_t size); /* up to size - 1 bytes */
void assert_png(const char *name);
void assert_drawn(enum status status);
void assert_nothing_left(void); /* no temporary file */

#endif
