/* Where the ranks of a run keep their rows until these are joined: rank 0 in DIR, the others in DIR/rank-1, ... */
#ifndef SASBENCH_RANKS_RANK_FOLDERS_H
#define SASBENCH_RANKS_RANK_FOLDERS_H

#include <stddef.h>

#include "contract/status.h"

void rank_folder(const char *directory, int number, char *path, size_t size);
/* Move the rows of all ranks, of this run or of one that was ended, into DIR. Errors: as results_merge, for the first
   folder that cannot be joined; it stays, and the others are joined. */
enum status rank_folders_join(const char *directory);

#endif
