/* How much memory there is: large needs are refused before the work, by their figure. */
#ifndef SASBENCH_COMMON_MEMORY_H
#define SASBENCH_COMMON_MEMORY_H

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

#endif
