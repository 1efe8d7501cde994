/* The command `bench`: how near the engines come to the machine's limits at the papers' sizes, as ratios within one
   run. */
#ifndef SASBENCH_BENCH_BENCH_H
#define SASBENCH_BENCH_BENCH_H

#include "contract/status.h"

#define BENCH_FOLDER SASBENCH_ROOT "/scenes/bench"

/* Measure the lines of a folder's lines.csv into DIRECTORY/bench.csv with a picture, hold them against the folder's
   goals.csv into DIRECTORY/goals.csv, and say on standard output which goals hold. DIRECTORY is made. Errors: those of
   csv_read, spec_parse, scene_load and session_open; STATUS_INVALID for a cell that is not accepted, and where a file
   cannot be written or DIRECTORY belongs to another program; STATUS_FAILED for a measurement that fails. */
enum status bench_goals(const char *folder, const char *directory);

/* Measure SPECs [count] alone, each at the first of the papers' sizes that it takes, in the precision that it names or
   else in both, on one thread and on all, into DIRECTORY/bench.csv. Errors: as above, and STATUS_UNSUPPORTED where an
   algorithm takes none of the scenes. */
enum status bench_specs(const char *directory, const char *const *specs, int count);

#endif
