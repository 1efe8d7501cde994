/* Numbers sent between ranks: by MPI (link_mpi.c), or by nothing where it is missing (link_none.c). */
#ifndef SASBENCH_RANKS_LINK_H
#define SASBENCH_RANKS_LINK_H

#include <stdbool.h>
#include <stddef.h>

/* False: this build is without MPI. */
bool link_open(int *number, int *count);
/* All ranks call it: does this one have the same bytes as rank 0? `theirs` receives rank 0's. */
bool link_same(const void *ours, void *theirs, size_t size);
void link_send(int to, int value);
/* One that has arrived; false: none has. */
bool link_take(int *from, int *value);
/* All ranks call it at their end. */
void link_close(void);
/* End all ranks. */
_Noreturn void link_abort(int status);

#endif
