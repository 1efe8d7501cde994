/* Checks of our own algorithms beside those of `sasbench conformance`: each allocation is counted, and their quality
   and work are on record. */
#ifndef SASBENCH_TEST_CONFORMANCE_COUNTED_H
#define SASBENCH_TEST_CONFORMANCE_COUNTED_H

#include "tests/support.h"

/* All checks by the algorithm's defaults; returns the number of broken promises. */
int conformance_counted(const char *algorithm);

#endif
