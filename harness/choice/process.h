/* The memory of a process that forms an image. */
#ifndef SASBENCH_CHOICE_PROCESS_H
#define SASBENCH_CHOICE_PROCESS_H

#include "contract/algorithm.h"

/* Bytes at most: the program with its libraries, the image, and the plan with the echoes in double, as they are
   simulated or read, and in the image's precision; or, where that is more, a copy of the image, as it is written. What
   threads beyond the first take is not in it. */
double process_bytes(const struct problem *problem, double plan_bytes);

#endif
