/* Finished files of results: read and written as a whole. */
#ifndef SASBENCH_RESULTS_RESULTS_H
#define SASBENCH_RESULTS_RESULTS_H

#include <stdbool.h>
#include <stdint.h>

#include "files/csv.h"
#include "results/measurement.h"

/* What rows were measured on, a "scene" with the hash of its content; or by, an "algorithm" from outside the program
   with its origin. */
enum { CONTENT_TEXT = 160 };
struct content {
    const char *kind;
    char *name;
    char text[CONTENT_TEXT]; /* without a colon */
};
struct content content_scene(char *name, uint64_t hash);

/* Lines of a file's head, as csv.h has them. Is one of a content, "scene NAME: HASH" or "algorithm NAME: ORIGIN"? The
   length of "key" in "key: value"; a content's name may hold anything. The line of a file with the same key; NULL
   without one. */
bool comment_names_content(const char *comment);
size_t comment_key_length(const char *comment);
const char *comment_like(const struct csv *csv, const char *comment);

/* A finished file, measurements.csv, targets.csv or a baseline, in memory; freed with results_free, which accepts a
   zeroed struct. Texts of the rows belong to the csv. */
struct results {
    struct csv csv;
    bool targets;                     /* targets.csv, not measurements.csv */
    struct measurement *measurements; /* [csv.row_count], or NULL */
    struct target_row *target_rows;   /* [csv.row_count], or NULL */
};
/* Errors: STATUS_INVALID naming file, line, column and value: not our file or another version of it, other columns,
   no number or one that is not finite, a time that is not above 0, a status that does not exist. */
enum status results_read(const char *path, struct results *results);
void results_free(struct results *results);
/* A whole measurements file without provenance, the same on every machine. `note` is one line: what the file is and
   how it is made. Errors: STATUS_INVALID when it cannot be written; an older file is then left as it is. */
enum status measurements_write(const char *path, const char *note, const struct content *contents, int content_count,
                               const struct measurement *rows, int row_count);

#endif
