/* The command `bench`: how near the engines come to the machine's limits at the papers' sizes, as ratios within one
   run. */
#ifndef SASBENCH_BENCH_BENCH_H
#define SASBENCH_BENCH_BENCH_H

#include "contract/status.h"

/* Measure the lines of a folder's lines.csv into DIRECTORY/bench.csv with a picture, compare them with the folder's
   goals.csv in DIRECTORY/goals.csv, and print which goals are met. DIRECTORY is made. Errors: those of csv_read,
   spec_parse, scene_load and session_open; STATUS_INVALID for a cell that is not accepted, and where a file cannot be
   written or DIRECTORY belongs to another program; STATUS_FAILED for a measurement that fails. */
enum status bench_goals(const char *folder, const char *directory);

/* Measure SPECs [count] without goals into DIRECTORY/bench.csv, on one thread and on all. Each has the first of the
   papers' sizes that it can image, and the precision that it names or else both. Errors: as above, and
   STATUS_UNSUPPORTED where an algorithm can image none of the scenes. */
enum status bench_specs(const char *directory, const char *const *specs, int count);

#endif
