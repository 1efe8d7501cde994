/* Algorithms by name in the command `bench`. */
#ifndef SASBENCH_BENCH_BENCH_ALGORITHMS_H
#define SASBENCH_BENCH_BENCH_ALGORITHMS_H

#include "contract/status.h"

/* Measure SPECs [count] at the papers' sizes into DIRECTORY/bench_algorithms.csv and on standard output, each in the
   precision that it names or else in both, on one thread and on all: seconds, operations and pairs a second, the
   fraction of the multiply-add peak, the ratio to the scalar reference loop. The folder is there. Errors: as
   spec_parse; STATUS_UNSUPPORTED where an algorithm takes none of the scenes; what scene_load, scene_simulate, plan or
   execute return; STATUS_INVALID where the file cannot be written. */
enum status bench_algorithms(const char *directory, const char *const *specs, int count);

#endif
