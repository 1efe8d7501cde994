/* One of the two results that `compare` compares: its rows, found by their keys. */
#ifndef SASBENCH_GATE_DIFF_SIDE_H
#define SASBENCH_GATE_DIFF_SIDE_H

#include "results/results.h"

/* The key of a row. Measurements have target 0 and no axis and definition. */
struct row_key {
    const char *scene, *algorithm, *options, *precision;
    int target;
    const char *axis, *definition;
    int row;
};

/* One of the two results, ready to be searched. */
struct diff_side {
    struct results results;
    struct row_key *keys; /* [row_count] sorted */
    bool *matched;        /* [row_count] by row: found on the other side, too */
    bool *closed;         /* [row_count] by row: all that belongs to it is reported */
};

/* The file's rows with their keys. Errors: as results_read; STATUS_INVALID naming both lines of a row that is given
   twice; STATUS_FAILED without memory. *side is to be closed in any case. */
enum status side_open(const char *path, struct diff_side *side);
void side_close(struct diff_side *side); /* accepts a zeroed struct */

/* The key of a row, 0 <= row < row_count; its texts belong to the results. */
struct row_key row_key_of(const struct results *results, int row);
/* The row of this key; NULL where there is none. */
const struct row_key *side_find(const struct diff_side *side, const struct row_key *key);
/* A row of the same scene, algorithm, options and precision, whatever its target. */
const struct row_key *side_find_measurement(const struct diff_side *side, const struct row_key *key);
/* The content of a scene as the file's head names it; NULL when it does not. */
const char *side_hash(const struct diff_side *side, const char *scene);

#endif
