/* Rows on disk: the columns of both files, their header, and how one row is written and read. Used within measure/ only. */
#ifndef SASBENCH_MEASURE_ROWS_H
#define SASBENCH_MEASURE_ROWS_H

#include <stdio.h>

#include "measure/provenance.h"
#include "measure/results.h"

/* One column: where the value lies in the row's struct. Header, writer and reader all come from these tables. */
struct column {
    const char *name; /* NULL ends the table */
    enum { COLUMN_TEXT, COLUMN_INTEGER, COLUMN_REAL } type;
    size_t offset;
};

/* Both tables begin with the columns that tell one measurement from another. */
#define KEY_COLUMNS 4

enum { KIND_MEASUREMENTS, KIND_TARGETS, KINDS };

/* One of the two files. */
struct row_kind {
    const char *file, *format; /* the format is the first line: by it we know a file as ours */
    const struct column *columns;
};
extern const struct row_kind row_kinds[KINDS];

/* The lines ahead of the rows; without a provenance, `note` stands in its place. */
void head_write(FILE *file, const struct row_kind *kind, const struct provenance *provenance, const char *note,
                const struct scene_hash *scenes, int scene_count);
void row_write(FILE *file, const struct column *columns, const void *row);

/* Does a file's header line name the columns of its kind? Errors: STATUS_INVALID naming the first that differs. */
enum status header_check(const struct csv *csv, const struct row_kind *kind);
/* One cell into its field. Errors: STATUS_INVALID naming file, line, column and value. */
enum status cell_parse(const struct csv *csv, int row, int index, const struct column *column, void *out);

/* Why rows of a file are not gone on with by a program of this provenance; empty when they are. */
void provenance_differs(const struct csv *csv, const struct provenance *provenance, char *text, size_t size);

#endif
