/* Rows on disk: the header of both files, and how one row is written and read. Used within results/ only. */
#ifndef SASBENCH_RESULTS_ROWS_H
#define SASBENCH_RESULTS_ROWS_H

#include <stdio.h>

#include "results/provenance.h"
#include "results/results.h"

/* Both kinds begin with these columns, which identify a measurement. */
#define KEY_COLUMNS 4

enum { KIND_MEASUREMENTS, KIND_TARGETS, KINDS };

/* One of the two files. */
struct row_kind {
    const char *file, *format; /* `format`: the first line of our files */
    const struct column *columns;
};
extern const struct row_kind row_kinds[KINDS];

/* A line "# key: value" for each part but the threads. */
void provenance_write(FILE *file, const struct provenance *provenance);
/* The lines ahead of the rows; without a provenance, `note` stands in its place. */
void head_write(FILE *file, const struct row_kind *kind, const struct provenance *provenance, const char *note,
                const struct content *contents, int content_count);
void row_write(FILE *file, const struct column *columns, const void *row);

/* Is a file of this kind, by its first line? */
bool kind_is(const struct csv *csv, const struct row_kind *kind);
/* Does a file's header line name the columns of its kind? Errors: STATUS_INVALID naming the first that
   differs. */
enum status header_check(const struct csv *csv, const struct row_kind *kind);
/* One row into its struct. Errors: STATUS_INVALID naming file, line,
   column and value. */
enum status row_parse(const struct csv *csv, int row, const struct row_kind *kind, void *out);

/* Why a program of this provenance cannot continue a file's rows; empty when it can. */
void provenance_differs(const struct csv *csv, const struct provenance *provenance, char *text, size_t size);

#endif
