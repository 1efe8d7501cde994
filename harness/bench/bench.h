/* Speed of the engines and of range migration at the papers' sizes, as ratios within one run. */
#ifndef SASBENCH_BENCH_BENCH_H
#define SASBENCH_BENCH_BENCH_H

#include <stdio.h>

#include "bench/bench_goals.h"

/* Measure everything into CSV files with pictures in the folder, which is made, and say which goals are held; or,
   where SPECs [count] are given, these algorithms alone (bench_algorithms.h). Errors: as bench_algorithms;
   STATUS_INVALID for a folder that cannot be written or belongs to another program, STATUS_FAILED for memory or a
   measurement that fails. */
enum status bench_run(const char *directory, const char *const *specs, int count);

/* DIR/NAME.csv, which `measure_into` fills, adding to the goals, and from it DIR/NAME.png and .svg by the script
   NAME of plots/; their names go to standard output. Errors: those of `measure_into`; STATUS_INVALID where a file
   cannot be written, STATUS_FAILED where it cannot be drawn. */
enum status bench_file(const char *directory, const char *name,
                       enum status (*measure_into)(FILE *file, struct bench_goals *goals), struct bench_goals *goals);

#endif
