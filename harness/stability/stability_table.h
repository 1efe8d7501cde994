/* Rows of stability.csv: on the terminal, in the file, and compared with the expected ones. */
#ifndef SASBENCH_STABILITY_STABILITY_TABLE_H
#define SASBENCH_STABILITY_STABILITY_TABLE_H

#include <stdio.h>

#include "stability/stability_verdict.h"

struct stability_row {
    const char *scene; /* borrowed, like the spec */
    const struct spec *spec;
    struct stability_verdict verdict;
};

/* One line a scene: the number of images, the most digits lost and the algorithm that loses them, and the number of
   refusals by a condition. */
void stability_table_head(void);
void stability_table_line(int spec_count, const struct stability_row *rows);

/* All rows, measured, and the committed part of them. Errors: as text_file.h. */
enum status stability_write(const char *path, int mode_count, int count, const struct stability_row *rows);
enum status stability_expected_write(const char *path, int count, const struct stability_row *rows);

/* Print every row that differs from `path`. *differ: their number; *unknown: the number of rows that the file lacks,
   which only must not fail. Errors: STATUS_INVALID for a file that is not ours. */
enum status stability_compare(const char *path, int count, const struct stability_row *rows, int *differ, int *unknown);

#endif
