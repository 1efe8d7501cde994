/* Several results folders, of the shards or ranks of one run, as one. */
#ifndef SASBENCH_RESULTS_MERGE_H
#define SASBENCH_RESULTS_MERGE_H

#include "contract/status.h"

enum { KINDS_OF_MACHINES = 64 };

/* What became one folder. */
struct merged {
    char directory[4200];
    char machine[300];  /* its kind: processor, cores, memory, instruction set */
    int folders, cells; /* merged; finished ones, or refused, or failed */
};

/* The rows of `folders`, and of a `directory` that exists, into `directory`. Times are compared inside a folder, so
   that rows of several kinds of machine become a folder of each: DIRECTORY/1, 2, ... in the order of `folders`. A row
   that several folders hold is one; a finished row replaces a failed one. All is read before anything is written, and
   merging again changes nothing. Errors: STATUS_INVALID for a place that holds no results, or that another program
   uses; for rows of another program, version or content of a scene than the first folder's, and for two different rows
   of one cell, naming both places. */
enum status results_merge(int count, const char *const *folders, const char *directory,
                          struct merged merged[KINDS_OF_MACHINES], int *merged_count);

#endif
