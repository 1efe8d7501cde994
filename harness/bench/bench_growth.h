/* How time and memory of back projection grow, in the command `bench`. */
#ifndef SASBENCH_BENCH_BENCH_GROWTH_H
#define SASBENCH_BENCH_BENCH_GROWTH_H

#include "contract/status.h"

/* Images of 100 x 100 to 2880 x 4800 pixels in the middle of BP22's full size, in float on all threads: nanoseconds a
   pair, compression included, and the plan's bytes; then the plan's bytes over the settings of each interpolator. Into
   DIRECTORY/growth.csv with a picture. The folder is there. Errors: what scene_load, scene_simulate, plan or execute
   return; STATUS_INVALID where a file cannot be written. */
enum status bench_growth(const char *directory);

#endif
