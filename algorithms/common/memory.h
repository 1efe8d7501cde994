/* Available memory: large needs are refused before the work, with their size. */
#ifndef SASBENCH_COMMON_MEMORY_H
#define SASBENCH_COMMON_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

#include "contract/status.h"

/* STATUS_FAILED when this process cannot get `bytes` more (its limit on address space, or the machine's free memory):
   "no memory for WHAT: 12.3 GB are needed, 4.5 GB are free". Small needs are not checked. FFTW ends the program when it
   finds no memory for a plan, and the system may end it when memory runs out. */
enum status memory_check(double bytes, const char *what);

/* As aligned_alloc, of any size, 0 among them. NULL without memory. */
void *memory_aligned(size_t alignment, size_t bytes);

/* The same for arrays that are read by columns, with another page at each row: large ones lie on huge pages where the
   system has them. Their first use can take a third of a second, as the system clears and gathers the pages. */
void *memory_columns(size_t alignment, size_t bytes);

/* Set to zero by all threads: memory that is touched first takes longer to get than to fill. */
void memory_clear(void *memory, size_t bytes);

/* Zeroed memory, at a page; only pages that are written take room. Huge ones, where the system has them, are faster to
   write in long stretches, and take up to 2 MB more at the ends of each. Freed by memory_sparse_free, which accepts
   NULL. NULL where the address space is too small. */
void *memory_sparse(size_t bytes, bool huge);
/* Give up the room of bytes [begin, end), whose values are then lost, but for pages that have others as well. */
void memory_sparse_drop(void *memory, size_t begin, size_t end);
void memory_sparse_free(void *memory);

/* Memory and FFT plans of a plan, released together. A zeroed struct owns nothing. */
struct store {
    struct stored *last;
    double bytes; /* of counted memory, and of its bookkeeping */
    bool failed;  /* a request failed */
};
/* Zeroed memory at a cache line, whole lines of it, by memory_columns; `share` of it is counted. NULL without. */
void *store_take(struct store *store, size_t count, size_t size, double share);
/* Memory at a cache line as it comes, by memory_aligned; counted to the byte. NULL without. */
void *store_room(struct store *store, size_t count, size_t size, double share);
/* Add an object with its release function; NULL: its making failed. Returns the object, NULL where it cannot be
   kept. */
void *store_keep(struct store *store, void *thing, void (*release)(void *thing));
/* Release all, the last one first. */
void store_release(struct store *store);

#endif
