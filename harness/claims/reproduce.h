/* The papers' tables and claims beside our own measurements: measured, printed, and written into a results folder. */
#ifndef SASBENCH_CLAIMS_REPRODUCE_H
#define SASBENCH_CLAIMS_REPRODUCE_H

#include "contract/status.h"

/* The tables of these ids (all of them when count is 0), measured where the folder does not hold them yet. Errors:
   STATUS_INVALID for an id that is none (naming those that are), a folder whose claims.csv is the list of claims, or
   files that cannot be read or written; STATUS_FAILED when a measurement failed. */
enum status papers_reproduce(const char *const *ids, int count, const char *directory);

#endif
