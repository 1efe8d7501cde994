/* CSV files after RFC 4180 but without line ends in fields, with `# key: value` comment lines between the rows: the one
   reader and the one writer. */
#ifndef SASBENCH_FILES_CSV_H
#define SASBENCH_FILES_CSV_H

#include <stdbool.h>
#include <stdio.h>

#include "contract/status.h"

/* A whole file in memory, freed with csv_free, which accepts a zeroed struct. Texts belong to the struct. */
struct csv {
    char *path;
    int column_count;
    char **columns; /* [column_count] names from the header line */
    int row_count;
    char **cells; /* [row_count][column_count]; an empty field is "" */
    int *lines;   /* [row_count] line of the file where the row begins, from 1 */
    int comment_count;
    char **comments; /* [comment_count] without the leading '#' and blank */
    char *text;      /* the file; all texts above point into it */
};

/* What to do with a last line without newline. A reader of finished files accepts it, as RFC 4180 does. One that
   resumes after a cut drops it, since an unknown part of it is missing. */
enum csv_tail { CSV_TAIL_KEEP, CSV_TAIL_DROP };

/* Errors: STATUS_INVALID naming file and line (not readable, above 256 MiB, broken quoting, a row whose fields do not
   match the header), and the column of a control character other than a line end; STATUS_FAILED without memory. *csv is
   then zeroed. A comment line begins with '#'. A byte order mark is skipped. */
enum status csv_read(const char *path, enum csv_tail tail, struct csv *csv);
void csv_free(struct csv *csv);

/* Index of a column by name, -1 if there is none. */
int csv_column(const struct csv *csv, const char *name);
const char *csv_cell(const struct csv *csv, int row, int column);
/* The places of the columns `names`, which NULL ends; `places` NULL: they must be the first ones, in this order.
   Errors: STATUS_INVALID naming the first that is missing. */
enum status csv_columns(const struct csv *csv, const char *const *names, int *places);
/* The value of the comment `# key: value`; NULL if there is none. */
const char *csv_comment(const struct csv *csv, const char *key);

/* A number of these files: empty is NAN. False for anything that is not a number from end to end. */
bool csv_number(const char *cell, double *value);

/* Write one field, quoted where RFC 4180 (or a leading '#') asks for it, control characters as '?'. NULL becomes an
   empty field. */
void csv_write_text(FILE *file, const char *text);
/* %.9g; NAN is an empty field. */
void csv_write_number(FILE *file, double value);
/* Fields of a row, texts first, then numbers; NULL ends the texts. `ends`: they end the row, else a comma follows. */
void csv_write_fields(FILE *file, const char *const *texts, const double *numbers, int number_count, bool ends);

#endif
