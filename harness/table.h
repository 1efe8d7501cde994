/* The terminal's table of measurements: one line a row, grouped by scene, at most 110 columns wide. */
#ifndef SASBENCH_TABLE_H
#define SASBENCH_TABLE_H

#include <stdio.h>

#include "record.h"

/* What the columns mean and their names. The next row begins with its scene's heading. */
void table_header(FILE *stream);
/* One measurement; a heading line whenever the scene is another than the row's before. Undefined values are "-". */
void table_row(FILE *stream, const struct measurement *row);

/* One line: the FLOPs that the plan counted, and those of the papers' formulas, which contradict each other. */
void table_work(FILE *stream, const char *spec, const struct work *work);

#endif
