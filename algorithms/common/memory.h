/* How much memory there is: large needs are refused before the work, by their figure. */
#ifndef SASBENCH_COMMON_MEMORY_H
#define SASBENCH_COMMON_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

#include "contract/status.h"

/* STATUS_FAILED when `bytes` more are not to be had by this process (its limit on address space, or what the machine
   has free): "no memory for WHAT: 12.3 GB are needed, 4.5 GB are free". Small needs are not looked at. FFTW ends the
   program when it finds no memory for a plan, and the system may end it when it takes more than there is. */
enum status memory_check(double bytes, const char *what);

/* As aligned_alloc, of any size, 0 among them. NULL without memory. */
void *memory_aligned(size_t alignment, size_t bytes);

/* The same for what is walked through by columns and meets another page at each row: what is large lies on huge pages
   where the system gives them. Its first use can take a third of a second, for the system clears and gathers them. */
void *memory_columns(size_t alignment, size_t bytes);

/* Zeroed memory, at a page, of which only the pages that are written take room. Freed by memory_sparse_free, which
   accepts NULL. NULL where the address space does not hold it. */
void *memory_sparse(size_t bytes);
void memory_sparse_free(void *memory);

/* What a plan owns, memory and FFT plans: released together. A zeroed struct owns nothing. */
struct store {
    struct stored *last;
    double bytes; /* of memory, as far as it is counted, and of the account of it */
    bool failed;  /* something was not to be had */
};
/* Zeroed memory at a cache line, whole lines of it, by memory_columns; `share` of it is counted. NULL without. */
void *store_take(struct store *store, size_t count, size_t size, double share);
/* Memory at a cache line as it comes, by memory_aligned; counted to the byte. NULL without. */
void *store_room(struct store *store, size_t count, size_t size, double share);
/* A thing that was made, with what releases it; NULL: it failed. Returns it, NULL where it cannot be kept. */
void *store_keep(struct store *store, void *thing, void (*release)(void *thing));
/* Release all, what came last first. */
void store_release(struct store *store);

#endif
