/* The memory of a process that forms an image. */
#ifndef SASBENCH_CHOICE_PROCESS_H
#define SASBENCH_CHOICE_PROCESS_H

#include "contract/algorithm.h"

/* An upper bound in bytes: the program with its libraries, the image, and the plan with the echoes in double, as
   simulated or read, and in the image's precision; or, if larger, a copy of the image while it is written. The memory
   of threads beyond the first is not in it. */
double process_bytes(const struct problem *problem, double plan_bytes);
/* Of a process that forms the problem's window from an echo file: with the pings that it holds, and the window's image
   twice, as formed and as written. */
double process_tile_bytes(const struct problem *problem, double plan_bytes, double pings);
/* Of a process that reads all samples of an echo file at once. */
double process_reading_bytes(const struct acquisition *acquisition);

#endif
