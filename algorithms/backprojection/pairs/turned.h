/* A problem with turned grids, in the grids' axes: their pixels then lie in rows and columns along x and r, and all
   delays and angles stay the same. */
#ifndef SASBENCH_BACKPROJECTION_PAIRS_TURNED_H
#define SASBENCH_BACKPROJECTION_PAIRS_TURNED_H

#include "contract/algorithm.h"

/* Owner: whoever called problem_turn_back; freed with turned_free, which accepts a zeroed struct. */
struct turned_problem {
    struct acquisition acquisition; /* turned by the grids' angle; zero where no grid is turned */
    struct grid *patches;           /* [patch_count] the grids, angle_rad 0; NULL where none is turned */
};

/* Fill *turned and let problem->acquisition and problem->patches point to it; where no grid is turned, change nothing.
   *bytes (may be NULL) grows by what was allocated. Errors: STATUS_UNSUPPORTED where patches are turned by different
   angles, STATUS_FAILED without memory. Free *turned after an error, too. */
enum status problem_turn_back(struct problem *problem, struct turned_problem *turned, double *bytes);
void turned_free(struct turned_problem *turned);

#endif
