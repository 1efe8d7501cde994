/* Rows of stability.csv: on the terminal, in the file, and against those that are expected. */
#ifndef SASBENCH_STABILITY_STABILITY_TABLE_H
#define SASBENCH_STABILITY_STABILITY_TABLE_H

#include <stdio.h>

#include "stability/stability_verdict.h"

struct stability_row {
    const char *scene; /* borrowed, like the spec */
    const struct spec *spec;
    struct stability_verdict verdict;
};

/* One line a scene: how many images, the most digits lost and by which algorithm, and how many a condition refuses. */
void stability_table_head(void);
void stability_table_line(int spec_count, const struct stability_row *rows);

/* All rows, measured, and what of them is committed. Errors: as text_file.h. */
enum status stability_write(const char *path, int mode_count, int count, const struct stability_row *rows);
enum status stability_expected_write(const char *path, int count, const struct stability_row *rows);

/* Print every row that is not as `path` expects. *differ: how many; *unknown: how many the file does not hold, which
   must only not fail. Errors: STATUS_INVALID for a file that is none of ours. */
enum status stability_compare(const char *path, int count, const struct stability_row *rows, int *differ, int *unknown);

#endif
