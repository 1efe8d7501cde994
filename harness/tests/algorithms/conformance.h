/* Every promise of algorithm.h, checked for one registered algorithm on ordinary and extreme scenes. An algorithm may
   refuse a scene as unsupported, with a reason, unless its traits promise it; what it accepts must hold. */
#ifndef SASBENCH_TEST_CONFORMANCE_H
#define SASBENCH_TEST_CONFORMANCE_H

#include "tests/support.h"

/* Returns the number of failed checks; each failure names algorithm, setting, value and bound. */
int conformance_run(const struct algorithm *algorithm);

#endif
